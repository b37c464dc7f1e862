//! Closing loops by Newton's method, and how all joints then move.

use roberval_scalar::Real;

use super::pivoted_qr::PivotedQr;
use super::{Assembly, Linkage};

/// Newton steps at most: from a near guess each doubles the digits.
const MOST_STEPS: usize = 25;

/// A step longer than this (rad, or units of length) leaves the guess's neighbourhood.
const LONGEST_STEP: f64 = 1.0;

/// The independent joints move on to a new state by steps of at most this (rad, or units
/// of length), so that the others follow on their branch.
const STRIDE: f64 = 0.1;

/// Of a stride, what closing the loops may change.
const BEND: f64 = 0.2;

/// Halvings of a stride that does not succeed.
const MOST_HALVINGS: u32 = 8;

/// Where the equations of the dependent joints have |R_kk| below this part of the
/// largest, the independent ones do not lead them.
const DEAD_POINT: f64 = 1e-7;

/// Loops count as closed below this (rad, or units of length), in these numbers: far
/// above the rounding of a chain of fifty links, far below any length of a robot.
pub(super) fn closed<T: Real>() -> f64 {
    let pairs = (T::from(1.0) + T::from(1e-25) - T::from(1.0)).to_f64() != 0.0;
    if pairs { 1e-27 } else { 1e-12 }
}

/// The state of all n joints of a closed linkage.
#[derive(Debug, Clone)]
pub struct LoopMotion<T> {
    /// Positions, rad or m.
    pub q: Vec<T>,
    /// Velocities.
    pub qd: Vec<T>,
    /// Accelerations.
    pub qdd: Vec<T>,
    /// G, n rows of m numbers: qd = G qad.
    pub g: Vec<Vec<T>>,
}

/// The loops cannot be closed at some position of the independent joints, or these do not
/// lead the others there.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NotClosed {
    /// The other joints cannot follow that far.
    #[error(
        "the loops cannot be closed there: on the way from the last closed configuration, {:.0} % are possible",
        100.0 * part
    )]
    Open {
        /// The part of the way that was possible.
        part: f64,
    },
    /// A dead point.
    #[error("the independent joints do not lead the others there: a singular configuration")]
    DeadPoint,
}

impl<T: Real> Linkage<T> {
    /// The closed configuration nearest to q (in units), by Newton's method on `rank`
    /// independent equations; `None` if it does not converge or leaves an equation open.
    pub(super) fn close(&self, mut q: Vec<T>, rank: usize) -> Option<Vec<T>> {
        let mut last = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            let at = self.at(&q);
            let residual = at.residual();
            let size = largest(&residual);
            if size.max(last) <= closed::<T>() {
                return at.is_aligned().then_some(q); // a step beyond: rounding noise is left
            }
            let qr = PivotedQr::of(at.jacobian(), self.dof());
            if qr.rank(0.0) < rank {
                return None;
            }
            let step = qr.shortest_of_transposed(rank, &residual);
            if too_long(&step) {
                return None;
            }
            subtract(&mut q, &step);
            last = size;
        }
        None
    }

    /// The same with the independent joints held.
    fn close_dependent(&self, mut q: Vec<T>, dependent: &[usize]) -> Option<Vec<T>> {
        let mut last = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            let at = self.at(&q);
            let residual = at.residual();
            let size = largest(&residual);
            if size.max(last) <= closed::<T>() {
                return at.is_aligned().then_some(q);
            }
            let qr = columns_qr(&at.jacobian(), dependent);
            if qr.rank(DEAD_POINT) < dependent.len() {
                return None;
            }
            let step = qr.solve(residual);
            if too_long(&step) {
                return None;
            }
            for (&k, &d) in dependent.iter().zip(&step) {
                q[k] = q[k] - d;
            }
            last = size;
        }
        None
    }

    /// How all joints move where the independent ones are at qa and move with qad, qadd
    /// (SI units): `near` is a closed configuration in doubles, with these qa to 1e-9.
    ///
    /// # Errors
    /// [`NotClosed`] if Newton's method does not converge from there.
    pub fn motion(
        &self,
        assembly: &Assembly,
        near: &[f64],
        [qa, qad, qadd]: [&[T]; 3],
    ) -> Result<LoopMotion<T>, NotClosed> {
        let (independent, dependent) = (&assembly.independent, &assembly.dependent());
        let unit = |k: usize| T::from(if self.is_length(k) { self.unit() } else { 1.0 });
        let mut q: Vec<T> = (0..near.len())
            .map(|k| T::from(near[k]) / unit(k))
            .collect();
        let in_units = |x: &[T]| -> Vec<T> {
            let each = independent.iter().zip(x);
            each.map(|(&k, &x)| x / unit(k)).collect()
        };
        for (&k, qa) in independent.iter().zip(in_units(qa)) {
            q[k] = qa;
        }
        let q = self
            .close_dependent(q, dependent)
            .ok_or(NotClosed::DeadPoint)?;
        let at = self.at(&q);
        let jacobian = at.jacobian();
        let qr = columns_qr(&jacobian, dependent);
        let follow = |b: Vec<T>| qr.solve(b.into_iter().map(|x| -x).collect());
        let mut g = vec![vec![T::from(0.0); independent.len()]; q.len()];
        for (place, &k) in independent.iter().enumerate() {
            g[k][place] = T::from(1.0);
            let column = jacobian.iter().map(|row| row[k]).collect();
            for (&i, x) in dependent.iter().zip(follow(column)) {
                g[i][place] = x;
            }
        }
        let qd = product(&g, &in_units(qad));
        let mut qdd = product(&g, &in_units(qadd));
        for (&i, x) in dependent.iter().zip(follow(at.bias(&qd))) {
            qdd[i] = qdd[i] + x;
        }
        let si = |x: Vec<T>| {
            x.into_iter()
                .enumerate()
                .map(|(k, x)| x * unit(k))
                .collect()
        };
        for (i, row) in g.iter_mut().enumerate() {
            for (x, &k) in row.iter_mut().zip(independent) {
                *x = *x * unit(i) / unit(k);
            }
        }
        Ok(LoopMotion {
            q: si(q),
            qd: si(qd),
            qdd: si(qdd),
            g,
        })
    }
}

impl Assembly {
    /// The closed configuration with the independent joints at `qa` that is reached from
    /// the closed configuration `from` by moving these straight there (SI units).
    ///
    /// # Errors
    /// [`NotClosed`] where the other joints cannot follow.
    pub fn reach(&self, from: &[f64], qa: &[f64]) -> Result<Vec<f64>, NotClosed> {
        let linkage = &self.linkage;
        let mut q = self.in_units(from);
        let dependent = self.dependent();
        let target: Vec<f64> = self
            .independent
            .iter()
            .zip(qa)
            .map(|(&k, x)| x / self.unit(k))
            .collect();
        let begin: Vec<f64> = self.independent.iter().map(|&k| q[k]).collect();
        let way = begin
            .iter()
            .zip(&target)
            .fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
        let (mut done, mut stride) = (0.0_f64, (STRIDE / way).min(1.0));
        let shortest = stride * 0.5_f64.powi(MOST_HALVINGS as i32);
        while done < 1.0 {
            let next = (done + stride).min(1.0);
            let mut guess = self.predict(&q, &dependent, next - done, &begin, &target);
            for ((&k, a), b) in self.independent.iter().zip(&begin).zip(&target) {
                guess[k] = if next == 1.0 { *b } else { a + next * (b - a) };
            }
            let found = linkage.close_dependent(guess.clone(), &dependent);
            // Far from the prediction is another branch.
            let near = BEND * largest_difference(&guess, &q) + closed::<f64>();
            match found.filter(|f| largest_difference(f, &guess) <= near) {
                Some(found) => {
                    q = found;
                    done = next;
                    stride = (2.0 * stride).min(STRIDE / way);
                }
                None => stride *= 0.5,
            }
            if stride < shortest {
                return Err(NotClosed::Open { part: done });
            }
        }
        Ok(self.in_si(&q))
    }

    /// The dependent joints a part of the way on, to first order.
    fn predict(
        &self,
        q: &[f64],
        dependent: &[usize],
        part: f64,
        begin: &[f64],
        target: &[f64],
    ) -> Vec<f64> {
        let jacobian = self.linkage.at(q).jacobian();
        let moves = self.independent.iter().zip(begin.iter().zip(target));
        let moves: Vec<(usize, f64)> = moves.map(|(&k, (a, b))| (k, part * (b - a))).collect();
        let rate = |row: &Vec<f64>| -moves.iter().map(|(k, d)| row[*k] * d).sum::<f64>();
        let step = columns_qr(&jacobian, dependent).solve(jacobian.iter().map(rate).collect());
        let mut guess = q.to_vec();
        for (&k, d) in dependent.iter().zip(step) {
            guess[k] += d;
        }
        guess
    }
}

/// The factors of these columns of a matrix given by rows.
pub(super) fn columns_qr<T: Real>(rows: &[Vec<T>], columns: &[usize]) -> PivotedQr<T> {
    let column = |&k: &usize| rows.iter().map(|row| row[k]).collect();
    PivotedQr::of(columns.iter().map(column).collect(), rows.len())
}

/// The largest size; not a number if one is.
pub(super) fn largest<T: Real>(x: &[T]) -> f64 {
    x.iter().fold(0.0, |m, x| {
        let size = x.to_f64().abs();
        if size > m || size.is_nan() { size } else { m }
    })
}

pub(super) fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |m, (a, b)| m.max((a - b).abs()))
}

/// Also of a step that is not a number.
fn too_long<T: Real>(step: &[T]) -> bool {
    let size = largest(step);
    size.is_nan() || size > LONGEST_STEP
}

fn subtract<T: Real>(q: &mut [T], step: &[T]) {
    q.iter_mut().zip(step).for_each(|(q, &d)| *q = *q - d);
}

fn product<T: Real>(g: &[Vec<T>], x: &[T]) -> Vec<T> {
    let row = |row: &Vec<T>| {
        row.iter()
            .zip(x)
            .fold(T::from(0.0), |s, (&g, &x)| g.mul_add(x, s))
    };
    g.iter().map(row).collect()
}
