//! The first closed configuration, and what it tells of the mechanism.

use nalgebra::{DMatrix, DVector};
use roberval_scalar::SplitMix64;

use super::pivoted_qr::PivotedQr;
use super::solution::largest;
use super::{Linkage, Walk};

/// Random starts before a mechanism counts as impossible to assemble.
const MOST_STARTS: usize = 200;

/// Starts with the joints of `near` held, and assembled configurations among which the
/// nearest is taken.
const NEAR_STARTS: usize = 20;

/// The seed of the starts: the branch that is found does not depend on the seed of the
/// samples.
const SEED: u64 = 0x10_0b5;

/// Steps of Levenberg's and Marquardt's method for one start.
const MOST_STEPS: usize = 100;

/// A descent ends with the equations closed to this (rad, or units of length), for
/// Newton's method to go on.
const NEARLY_CLOSED: f64 = 1e-6;

/// Equations with |R_kk| below this part of the largest depend on the others. Rounding
/// leaves 1e-13; a configuration with 1e-6 is as good as singular.
const DEPENDENT: f64 = 1e-8;

/// A start has |R_kk| of at least this part of the largest, if one such is found.
const REGULAR: f64 = 2e-2;

/// Steps of a walk that must lead away, and how far (rad, or units of length).
const EXCURSION: (usize, f64) = (12, 1e-2);

/// A joint leads others if its part of the tangent space that the joints before it do not
/// have is at least this.
const LEADS: f64 = 1e-4;

/// A linkage assembled: the branch of closed configurations that an analysis is about.
#[derive(Debug, Clone, PartialEq)]
pub struct Assembly {
    /// The tree and its loops.
    pub linkage: Linkage<f64>,
    /// A closed configuration (rad or m), which names the branch.
    pub start: Vec<f64>,
    /// Rank of J: the number of independent equations.
    pub rank: usize,
    /// The variables that determine the others, ascending: m of them.
    pub independent: Vec<usize>,
    /// The smallest kept |R_kk| over the largest dropped one at the start; `None` where
    /// no equation is redundant.
    pub gap: Option<f64>,
}

/// Why a linkage with loops is no mechanism.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum AssemblyError {
    /// No closed configuration.
    #[error(
        "the loops cannot be assembled: of {starts} starts the best leaves a gap of {best:.2e} m or rad; \
         check the lengths, the points or frames of the loops and their axes"
    )]
    Open {
        /// Starts tried.
        starts: usize,
        /// The largest equation's residual at the best of them.
        best: f64,
    },
    /// Closed, but immovable.
    #[error(
        "the loops leave no motion: {joints} joints and {rank} independent equations of {equations}; \
         take a loop away, or let its cut joint move more"
    )]
    Rigid {
        /// Joint variables n.
        joints: usize,
        /// Rank of the equations.
        rank: usize,
        /// Equations.
        equations: usize,
    },
    /// Closed at places from which no motion leads away.
    #[error(
        "the loops leave no motion: the {equations} equations have rank {rank} of {joints} where they are closed, \
         but hold the joints there to second order"
    )]
    Shaky {
        /// Joint variables n.
        joints: usize,
        /// Rank of the equations.
        rank: usize,
        /// Equations.
        equations: usize,
    },
    /// The configuration asked for is singular.
    #[error(
        "near gives a singular configuration, where branches of the motion meet: give joint values away from it"
    )]
    Singular,
}

/// A closed configuration.
struct Candidate {
    q: Vec<f64>,
    rank: usize,
    /// The smallest kept |R_kk| over the largest.
    regularity: f64,
    gap: Option<f64>,
}

impl Assembly {
    /// Assembles a linkage near some values of variables (variable, rad or m). `order` has
    /// all variables, the first being those that are to be independent if they can.
    ///
    /// # Errors
    /// An [`AssemblyError`] that tells why it cannot be assembled or moved.
    pub fn of(
        linkage: Linkage<f64>,
        near: &[(usize, f64)],
        order: &[usize],
    ) -> Result<Self, AssemblyError> {
        let mut search = Search::new(&linkage, near);
        let candidates = search.candidates();
        if candidates.is_empty() {
            return Err(AssemblyError::Open {
                starts: search.starts,
                best: search.best,
            });
        }
        let (joints, equations) = (linkage.dof(), linkage.equations());
        let mut movable = false;
        for candidate in &candidates {
            movable |= candidate.rank < joints;
            if candidate.rank == joints {
                continue;
            }
            if let Some(assembly) = Self::from_candidate(&linkage, candidate, order) {
                return Ok(assembly);
            }
        }
        if !near.is_empty() && Self::of(linkage, &[], order).is_ok() {
            return Err(AssemblyError::Singular);
        }
        let rank = candidates[0].rank;
        Err(match movable {
            false => AssemblyError::Rigid {
                joints,
                rank,
                equations,
            },
            true => AssemblyError::Shaky {
                joints,
                rank,
                equations,
            },
        })
    }

    /// The assembly that starts there; `None` if nothing moves or the place is singular.
    fn from_candidate(
        linkage: &Linkage<f64>,
        candidate: &Candidate,
        order: &[usize],
    ) -> Option<Self> {
        let mut assembly = Self {
            linkage: linkage.clone(),
            start: Vec::new(),
            rank: candidate.rank,
            independent: Vec::new(),
            gap: candidate.gap,
        };
        assembly.start = assembly.in_si(&candidate.q);
        let mut walk = Walk::new(&assembly, SEED);
        let (steps, distance) = EXCURSION;
        if walk.excursion(steps) < distance {
            return None;
        }
        let there = Candidate::of(linkage, walk.place().to_vec());
        if there.rank != candidate.rank {
            return None; // the start is singular
        }
        assembly.independent = leaders(linkage, &there, order);
        Some(assembly)
    }

    /// m
    #[must_use]
    pub fn mobility(&self) -> usize {
        self.linkage.dof() - self.rank
    }

    /// Equations beyond the independent ones: a planar loop closed by a revolute joint has
    /// three.
    #[must_use]
    pub fn redundant(&self) -> usize {
        self.linkage.equations() - self.rank
    }

    /// The variables that follow, ascending.
    #[must_use]
    pub fn dependent(&self) -> Vec<usize> {
        let follows = |k: &usize| self.independent.binary_search(k).is_err();
        (0..self.linkage.dof()).filter(follows).collect()
    }

    /// The unit of a variable, rad or m.
    pub(super) fn unit(&self, variable: usize) -> f64 {
        if self.linkage.is_length(variable) {
            self.linkage.unit()
        } else {
            1.0
        }
    }

    pub(super) fn in_units(&self, q: &[f64]) -> Vec<f64> {
        q.iter()
            .enumerate()
            .map(|(k, q)| q / self.unit(k))
            .collect()
    }

    pub(super) fn in_si(&self, q: &[f64]) -> Vec<f64> {
        q.iter()
            .enumerate()
            .map(|(k, q)| q * self.unit(k))
            .collect()
    }
}

/// The first variables of `order` whose rates span those of all.
fn leaders(linkage: &Linkage<f64>, at: &Candidate, order: &[usize]) -> Vec<usize> {
    let qr = PivotedQr::of(linkage.at(&at.q).jacobian(), linkage.dof());
    let basis = qr.complement(at.rank);
    // Rows of the basis: what each variable sees of a motion.
    let mut seen: Vec<Vec<f64>> = Vec::new();
    let mut leaders = Vec::new();
    for &k in order {
        let mut row: Vec<f64> = basis.iter().map(|t| t[k]).collect();
        for s in &seen {
            let along: f64 = s.iter().zip(&row).map(|(a, b)| a * b).sum();
            row.iter_mut().zip(s).for_each(|(r, s)| *r -= along * s);
        }
        let rest = row.iter().map(|x| x * x).sum::<f64>().sqrt();
        if rest > LEADS && leaders.len() < basis.len() {
            row.iter_mut().for_each(|x| *x /= rest);
            seen.push(row);
            leaders.push(k);
        }
    }
    leaders.sort_unstable();
    leaders
}

impl Candidate {
    fn of(linkage: &Linkage<f64>, q: Vec<f64>) -> Self {
        let qr = PivotedQr::of(linkage.at(&q).jacobian(), linkage.dof());
        let (rank, diagonal) = (qr.rank(DEPENDENT), qr.diagonal());
        let largest = diagonal.first().copied().unwrap_or(1.0);
        let smallest = rank.checked_sub(1).map_or(largest, |k| diagonal[k]);
        Self {
            q,
            rank,
            regularity: smallest / largest,
            gap: diagonal
                .get(rank)
                .filter(|x| **x > 0.0)
                .map(|x| smallest / x),
        }
    }
}

/// The search for closed configurations.
struct Search<'a> {
    linkage: &'a Linkage<f64>,
    near: Vec<(usize, f64)>,
    random: SplitMix64,
    starts: usize,
    best: f64,
}

impl<'a> Search<'a> {
    fn new(linkage: &'a Linkage<f64>, near: &[(usize, f64)]) -> Self {
        let unit = |k: usize| {
            if linkage.is_length(k) {
                linkage.unit()
            } else {
                1.0
            }
        };
        Self {
            linkage,
            near: near.iter().map(|&(k, q)| (k, q / unit(k))).collect(),
            random: SplitMix64::new(SEED),
            starts: 0,
            best: f64::INFINITY,
        }
    }

    /// Closed configurations, the most wanted first: those nearest to `near`, else the
    /// first that are regular.
    fn candidates(&mut self) -> Vec<Candidate> {
        if !self.near.is_empty() {
            let found = self.near_candidates();
            if !found.is_empty() {
                return found;
            }
        }
        let mut found = Vec::new();
        while self.starts < MOST_STARTS && found.len() < NEAR_STARTS {
            let guess = self.guess(self.starts > 0);
            if let Some(candidate) = self.try_start(guess, &[]) {
                found.push(candidate);
                let regular = |c: &&Candidate| c.regularity >= REGULAR;
                if self.near.is_empty() && found.iter().filter(regular).count() >= 3 {
                    break;
                }
            }
        }
        if self.near.is_empty() {
            found.sort_by_key(|c| (std::cmp::Reverse(c.rank), c.regularity < REGULAR));
        } else {
            let distance = |c: &Candidate| self.distance(&c.q);
            found.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
            found.truncate(1);
        }
        found
    }

    /// The configuration with the joints of `near` exactly there, or the nearest one.
    fn near_candidates(&mut self) -> Vec<Candidate> {
        let held: Vec<usize> = self.near.iter().map(|(k, _)| *k).collect();
        if held.len() < self.linkage.dof() {
            for k in 0..NEAR_STARTS {
                let guess = self.guess(k > 0);
                if let Some(candidate) = self.try_start(guess, &held) {
                    return vec![candidate];
                }
            }
        }
        let guess = self.guess(false);
        self.try_start(guess, &[]).into_iter().collect()
    }

    /// `near`, the other joints at 0 or anywhere.
    fn guess(&mut self, anywhere: bool) -> Vec<f64> {
        let mut q: Vec<f64> = (0..self.linkage.dof())
            .map(|k| match anywhere {
                false => 0.0,
                true if self.linkage.is_length(k) => self.random.uniform(-1.0, 1.0),
                true => self
                    .random
                    .uniform(-std::f64::consts::PI, std::f64::consts::PI),
            })
            .collect();
        self.near.iter().for_each(|&(k, value)| q[k] = value);
        q
    }

    /// How far a configuration is from `near`; whole turns do not count.
    fn distance(&self, q: &[f64]) -> f64 {
        let each = self.near.iter().map(|&(k, value)| {
            let d = q[k] - value;
            if self.linkage.is_length(k) {
                d
            } else {
                d.sin().atan2(d.cos())
            }
        });
        each.map(|d| d * d).sum::<f64>().sqrt()
    }

    fn try_start(&mut self, q: Vec<f64>, held: &[usize]) -> Option<Candidate> {
        self.starts += 1;
        let (q, size) = descend(self.linkage, q, held);
        let end = self.linkage.at(&q);
        let turned = if end.is_aligned() {
            0.0
        } else {
            std::f64::consts::PI
        };
        self.best = self.best.min(end.gap().max(turned));
        if size.is_nan() || size >= NEARLY_CLOSED {
            return None;
        }
        let rough = PivotedQr::of(self.linkage.at(&q).jacobian(), q.len()).rank(1e-4);
        let q = self.linkage.close(q, rough)?;
        Some(Candidate::of(self.linkage, q))
    }
}

/// Levenberg's and Marquardt's descent to closed loops, some variables held: where it
/// ends, and the largest equation's residual there.
fn descend(linkage: &Linkage<f64>, mut q: Vec<f64>, held: &[usize]) -> (Vec<f64>, f64) {
    let free: Vec<usize> = (0..q.len()).filter(|k| !held.contains(k)).collect();
    let mut residual = linkage.at(&q).residual();
    let mut damping = 1e-2;
    for _ in 0..MOST_STEPS {
        let size = largest(&residual);
        if size < 1e-14 || damping > 1e12 || size.is_nan() {
            break;
        }
        let rows = linkage.at(&q).jacobian();
        let j = DMatrix::from_fn(rows.len(), free.len(), |i, k| rows[i][free[k]]);
        let c = DVector::from_column_slice(&residual);
        let mut normal = j.tr_mul(&j);
        (0..free.len()).for_each(|k| normal[(k, k)] += damping);
        let Some(factor) = normal.cholesky() else {
            damping *= 10.0;
            continue;
        };
        let step = factor.solve(&j.tr_mul(&c));
        let mut next = q.clone();
        free.iter()
            .zip(step.iter())
            .for_each(|(&k, d)| next[k] -= d);
        let there = linkage.at(&next).residual();
        let square = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>();
        if square(&there) < square(&residual) {
            (q, residual) = (next, there);
            damping = (damping * 0.2).max(1e-15);
        } else {
            damping *= 5.0;
        }
    }
    if !linkage.at(&q).is_aligned() {
        return (q, f64::INFINITY);
    }
    let size = largest(&residual);
    (q, size)
}
