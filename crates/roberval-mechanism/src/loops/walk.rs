//! Random configurations far apart on one branch.
//!
//! A walk keeps to the variety of closed configurations by small steps. Where branches meet,
//! the Jacobian loses rank: the size of its smallest kept |R_kk| bounds how far that is,
//! steps are a part of it, and the walk turns back before it is lost. So no step can pass
//! from one branch to another, and what is analytic on the branch is decided on the arc
//! between its singular points. In the same way the walk turns back where the independent
//! joints cease to lead the others: it keeps to one assembly mode.

use roberval_scalar::{Real, SplitMix64};

use super::Assembly;
use super::pivoted_qr::PivotedQr;
use super::solution::{columns_qr, largest, largest_difference};

/// Longest step (rad, or units of length).
const STEP: f64 = 0.15;

/// Steps as a part of the smallest kept |R_kk|: derivatives of J are at most about 1 a
/// joint in units of length.
const CAUTION: f64 = 0.25;

/// Where a regularity is below this part of the best seen, the walk turns back.
const SINGULAR: f64 = 0.1;

/// Samples have at least this part of the best regularity, and G is at most `LARGEST_G`.
const REGULAR: f64 = 0.15;

/// What a unit velocity of an independent joint may do to another, at a sample.
const LARGEST_G: f64 = 50.0;

/// Of a step, what the return to the variety may undo or bend.
const BEND: f64 = 0.3;

/// The way between two samples.
const BETWEEN: (f64, f64) = (0.5, 2.0);

/// Lengths stay within this of the start.
const FARTHEST: f64 = 3.0;

/// Steps tried for one sample.
const MOST_STEPS: usize = 2000;

/// Halvings before the walk turns.
const MOST_HALVINGS: usize = 4;

/// How far a place is from singular: smallest kept |R_kk| over the largest.
#[derive(Debug, Clone, Copy)]
struct Regularity {
    /// Of all equations: 0 where branches meet.
    all: f64,
    /// Of those for the dependent joints: 0 where the independent ones do not lead them.
    led: f64,
}

/// A walk on the branch of the assembly's start.
#[derive(Debug, Clone)]
pub struct Walk<'a> {
    assembly: &'a Assembly,
    /// Where it is, in units.
    q: Vec<f64>,
    /// A basis of the tangent space there.
    tangent: Vec<Vec<f64>>,
    regularity: Regularity,
    /// The largest of either so far.
    best: Regularity,
    direction: Vec<f64>,
    random: SplitMix64,
    /// Configurations that were too near to a singular one to be samples.
    pub redrawn: usize,
}

impl<'a> Walk<'a> {
    /// A walk that begins at the assembly's start; all that is random comes from `seed`.
    #[must_use]
    pub fn new(assembly: &'a Assembly, seed: u64) -> Self {
        let q = assembly.in_units(&assembly.start);
        let (tangent, regularity) = tangent_space(assembly, &q);
        let mut walk = Self {
            assembly,
            q,
            tangent,
            regularity,
            best: regularity,
            direction: Vec::new(),
            random: SplitMix64::new(seed),
            redrawn: 0,
        };
        walk.turn();
        walk
    }

    /// The next configuration (all n joints, rad or m); `None` if none that is regular is
    /// found.
    pub fn next_configuration(&mut self) -> Option<Vec<f64>> {
        let mut left = self.random.uniform(BETWEEN.0, BETWEEN.1);
        self.turn();
        for _ in 0..MOST_STEPS {
            left -= self.step();
            if left > 0.0 {
                continue;
            }
            if self.is_regular() {
                self.free_joints();
                return Some(self.assembly.in_si(&self.q));
            }
            self.redrawn += 1;
            left = self.random.uniform(0.0, BETWEEN.1);
        }
        None
    }

    /// Goes back to a configuration that it was at (rad or m).
    pub fn go_back(&mut self, q: &[f64]) {
        self.q = self.assembly.in_units(q);
        (self.tangent, self.regularity) = tangent_space(self.assembly, &self.q);
    }

    /// The distance of the start in the joint that moved most, after some steps.
    pub(super) fn excursion(&mut self, steps: usize) -> f64 {
        let start = self.q.clone();
        let mut farthest = 0.0_f64;
        for _ in 0..steps {
            self.step();
            farthest = farthest.max(largest_difference(&self.q, &start));
        }
        farthest
    }

    /// Where it is, in units.
    pub(super) fn place(&self) -> &[f64] {
        &self.q
    }

    /// One step on; the way made, 0 if it had to turn instead.
    fn step(&mut self) -> f64 {
        let led = self.regularity.led / self.best.led;
        let mut h = (STEP * led.min(1.0)).min(CAUTION * self.regularity.all);
        for _ in 0..MOST_HALVINGS {
            if let Some((q, tangent, regularity)) = self.try_step(h) {
                self.direction = projected(&self.direction, &tangent);
                (self.q, self.tangent, self.regularity) = (q, tangent, regularity);
                self.best = self.best.max(regularity);
                return h;
            }
            h *= 0.5;
        }
        self.turn();
        0.0
    }

    fn try_step(&self, h: f64) -> Option<(Vec<f64>, Vec<Vec<f64>>, Regularity)> {
        let Assembly { linkage, rank, .. } = self.assembly;
        let guess: Vec<f64> = self
            .q
            .iter()
            .zip(&self.direction)
            .map(|(q, d)| q + h * d)
            .collect();
        let q = linkage.close(guess.clone(), *rank)?;
        let start = &self.assembly.start;
        let far = |k: usize| (q[k] - start[k] / self.assembly.unit(k)).abs() > FARTHEST;
        if (0..q.len()).any(|k| linkage.is_length(k) && far(k)) {
            return None;
        }
        let (tangent, regularity) = tangent_space(self.assembly, &q);
        let straight = norm(&projected_raw(&self.direction, &tangent));
        let kept = largest_difference(&q, &guess) <= BEND * h && straight >= 1.0 - BEND;
        let allowed =
            regularity.is_above(SINGULAR, self.best) || regularity.is_above(1.0, self.regularity);
        (kept && allowed).then_some((q, tangent, regularity))
    }

    /// A new random direction.
    fn turn(&mut self) {
        let random = &mut self.random;
        let wish: Vec<f64> = self.q.iter().map(|_| random.uniform(-1.0, 1.0)).collect();
        self.direction = projected(&wish, &self.tangent);
    }

    fn is_regular(&self) -> bool {
        let Assembly {
            linkage,
            independent,
            ..
        } = self.assembly;
        if !self.regularity.is_above(REGULAR, self.best) {
            return false;
        }
        let jacobian = linkage.at(&self.q).jacobian();
        let dependent = self.assembly.dependent();
        let qr = columns_qr(&jacobian, &dependent);
        let rates = |k: &usize| qr.solve(jacobian.iter().map(|row| row[*k]).collect());
        independent.iter().all(|k| largest(&rates(k)) <= LARGEST_G)
    }

    /// Joints outside of all loops stand anywhere.
    fn free_joints(&mut self) {
        for k in 0..self.q.len() {
            if !self.assembly.linkage.is_constrained(k) {
                let reach = if self.assembly.linkage.is_length(k) {
                    1.0
                } else {
                    std::f64::consts::PI
                };
                self.q[k] = self.random.uniform(-reach, reach);
            }
        }
        (self.tangent, self.regularity) = tangent_space(self.assembly, &self.q);
    }
}

/// An orthonormal basis of the directions that keep the loops closed, and how far the
/// place is from a singular one.
fn tangent_space(assembly: &Assembly, q: &[f64]) -> (Vec<Vec<f64>>, Regularity) {
    let jacobian = assembly.linkage.at(q).jacobian();
    let led = match assembly.independent.is_empty() {
        true => 1.0, // not yet known
        false => smallest(&columns_qr(&jacobian, &assembly.dependent()), assembly.rank),
    };
    let qr = PivotedQr::of(jacobian, q.len());
    let all = smallest(&qr, assembly.rank);
    (qr.complement(assembly.rank), Regularity { all, led })
}

impl Regularity {
    fn max(self, other: Self) -> Self {
        Self {
            all: self.all.max(other.all),
            led: self.led.max(other.led),
        }
    }

    fn is_above(self, part: f64, other: Self) -> bool {
        self.all >= part * other.all && self.led >= part * other.led
    }
}

/// |R_kk| of this rank over the largest (or over 1, if that is less).
fn smallest<T: Real>(qr: &PivotedQr<T>, rank: usize) -> f64 {
    let diagonal = qr.diagonal();
    let ratio = |x: &f64| x / diagonal[0].max(1.0);
    let last = rank.checked_sub(1).map(|k| diagonal.get(k));
    last.map_or(1.0, |x| x.map_or(0.0, ratio))
}

fn projected_raw(direction: &[f64], tangent: &[Vec<f64>]) -> Vec<f64> {
    let mut sum = vec![0.0; direction.len()];
    for t in tangent {
        let along: f64 = t.iter().zip(direction).map(|(t, d)| t * d).sum();
        sum.iter_mut().zip(t).for_each(|(s, t)| *s += along * t);
    }
    sum
}

/// The direction's part in the tangent space, of length 1.
fn projected(direction: &[f64], tangent: &[Vec<f64>]) -> Vec<f64> {
    let mut part = projected_raw(direction, tangent);
    let length = norm(&part);
    part.iter_mut().for_each(|x| *x /= length);
    part
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}
