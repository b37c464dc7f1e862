//! Coefficients without an exact form, correctly rounded: W2 = W1 beta is solved in pairs
//! of doubles, for the entries that the prime fields know to be there and have not named.

use num_integer::Integer;
use roberval_mechanism::Mechanism;
use roberval_regressor::{Model, PreciseModel};
use roberval_scalar::{DoubleDouble, cancellation_point};

use super::ExactError;
use super::number::ExactNumber;
use crate::Samples;

#[cfg(test)]
mod tests;

/// Relative error asked for: a number lies so close to the middle of two doubles, where
/// the error would decide, with a probability of 2^-26.
const WANTED_ERROR: f64 = 1.0 / (1_u128 << 80) as f64;

/// Sets of samples tried until all errors are small; each is twice as large. Long chains
/// with tiny coefficients stop at 1e-22: still 1e-6 of what decides a rounding.
const MOST_SETS: usize = 4;

/// Refinements at most; each wins at least one digit, or is the last.
const MOST_REFINEMENTS: usize = 40;

/// Of a random error in the rows, the part that the columns can follow is not seen in
/// the residual; with twice as many rows as columns it is hardly larger than the rest.
const SAFETY: f64 = 4.0;

/// Replaces the entries of `beta` (kept x deleted) that are still
/// [`ExactNumber::Rounded`] by the double nearest to their value. Returns the largest
/// relative error that any of them may have had before it was rounded; 0 if there was
/// none.
pub(super) fn round_open_entries(
    mechanism: &Mechanism,
    model: Model,
    kept: &[usize],
    deleted: &[usize],
    beta: &mut [Vec<ExactNumber>],
    seed: u64,
) -> Result<f64, ExactError> {
    let is_open = |x: &ExactNumber| !x.is_exact();
    let open = |beta: &[Vec<ExactNumber>], j: usize| -> Vec<usize> {
        (0..kept.len()).filter(|&i| is_open(&beta[i][j])).collect()
    };
    let mut columns: Vec<usize> = (0..deleted.len())
        .filter(|&j| beta.iter().any(|row| is_open(&row[j])))
        .collect();
    let (mut worst, mut set) = (0.0_f64, 0);
    while !columns.is_empty() {
        let last = set + 1 == MOST_SETS;
        let rows = (kept.len() + deleted.len()) << (1 + set);
        let per_sample = model.rows(mechanism.independent());
        let count = Integer::div_ceil(&rows, &per_sample) + 1;
        let samples = Samples::draw(mechanism, count, seed.wrapping_add(set as u64))?;
        let w = columns_of_w(mechanism, model, &samples)?;
        let mut again = Vec::new();
        for &j in &columns {
            cancellation_point();
            let unknown = open(beta, j);
            let known = known_part(beta, kept, &w, j);
            let rest = difference(&w[deleted[j]], &known);
            let a: Vec<&[DoubleDouble]> = unknown.iter().map(|&i| &w[kept[i]][..]).collect();
            let solution = Solution::of(&a, &rest);
            let error = solution.relative_error();
            if error <= WANTED_ERROR || last {
                worst = worst.max(error);
                for (&i, x) in unknown.iter().zip(&solution.x) {
                    beta[i][j] = ExactNumber::Rounded(x.to_f64());
                }
            } else {
                again.push(j);
            }
        }
        columns = again;
        set += 1;
    }
    Ok(worst)
}

/// All columns of W at these samples in pairs of doubles; those of h are differences to
/// the first sample's.
pub(crate) fn columns_of_w(
    mechanism: &Mechanism,
    model: Model,
    samples: &Samples,
) -> Result<Vec<Vec<DoubleDouble>>, ExactError> {
    let precise = PreciseModel::new(mechanism)?;
    let (n, c) = (mechanism.independent(), mechanism.parameters().len());
    let per_sample = model.rows(n);
    let count = samples.count;
    let mut work = precise.workspace();
    let mut sample = vec![DoubleDouble::ZERO; per_sample * c];
    let mut reference = None;
    let mut columns = vec![Vec::with_capacity(count * per_sample); c];
    for k in 0..count {
        cancellation_point();
        let [qd, qdd] = [&samples.qd, &samples.qdd].map(|x| &x[k * n..(k + 1) * n]);
        let positions = mechanism.positions();
        let q = &samples.q[k * positions..(k + 1) * positions];
        precise.fill(model, [q, qd, qdd], &mut work, &mut sample)?;
        if model == Model::H && reference.is_none() {
            reference = Some(sample.clone());
            continue;
        }
        for row in sample.chunks_exact(c) {
            for (j, &x) in row.iter().enumerate() {
                columns[j].push(match &reference {
                    None => x,
                    Some(first) => x - first[j],
                });
            }
        }
    }
    Ok(columns)
}

/// What the exact entries of a column of beta contribute to W2.
fn known_part(
    beta: &[Vec<ExactNumber>],
    kept: &[usize],
    w: &[Vec<DoubleDouble>],
    j: usize,
) -> Vec<DoubleDouble> {
    let mut sum = vec![DoubleDouble::ZERO; w[0].len()];
    for (row, &column) in beta.iter().zip(kept) {
        if row[j].is_exact() && !row[j].is_zero() {
            let factor = row[j].to_double_double();
            for (s, &x) in sum.iter_mut().zip(&w[column]) {
                *s = *s + factor * x;
            }
        }
    }
    sum
}

fn difference(a: &[DoubleDouble], b: &[DoubleDouble]) -> Vec<DoubleDouble> {
    a.iter().zip(b).map(|(&a, &b)| a - b).collect()
}

/// The least squares solution of `A x = y` with its errors.
struct Solution {
    x: Vec<DoubleDouble>,
    errors: Vec<f64>,
}

impl Solution {
    /// Refines the solution by a factorisation in doubles with residuals in pairs. The
    /// system has a solution, so that what is left of the residual is rounding error.
    fn of(a: &[&[DoubleDouble]], y: &[DoubleDouble]) -> Self {
        let factor = Factor::of(a);
        let mut x = vec![DoubleDouble::ZERO; a.len()];
        let mut rest = y.to_vec();
        let mut last = f64::INFINITY;
        let mut step = Vec::new();
        for _ in 0..MOST_REFINEMENTS {
            step = factor.solve(&rest);
            let size = norm(&factor.scaled(&step));
            if size == 0.0 || size > 0.1 * last || size.is_nan() {
                break; // what this step would still change is rounding error, too
            }
            x.iter_mut()
                .zip(&step)
                .for_each(|(x, &d)| *x = *x + d.into());
            rest = residual(a, &x, y);
            last = size;
        }
        let noise = norm(&rest.iter().map(|r| r.to_f64()).collect::<Vec<_>>());
        let errors = factor.row_norms().into_iter().zip(&step);
        Self {
            x,
            errors: errors
                .map(|(row, d)| SAFETY * row * noise + d.abs())
                .collect(),
        }
    }

    /// The largest; infinite where one is not a number.
    fn relative_error(&self) -> f64 {
        let each = self.errors.iter().zip(&self.x);
        let ratios = each.map(|(e, x)| e / x.to_f64().abs());
        ratios.fold(0.0, |worst, e| {
            if e.is_nan() {
                f64::INFINITY
            } else {
                e.max(worst)
            }
        })
    }
}

fn residual(a: &[&[DoubleDouble]], x: &[DoubleDouble], y: &[DoubleDouble]) -> Vec<DoubleDouble> {
    let mut rest = y.to_vec();
    for (&x, column) in x.iter().zip(a) {
        for (r, &a) in rest.iter_mut().zip(*column) {
            *r = *r - a * x;
        }
    }
    rest
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// `A = Q R D` in doubles by modified Gram-Schmidt, D being the columns' norms: good
/// enough to refine with.
struct Factor {
    /// Columns of Q.
    q: Vec<Vec<f64>>,
    /// Columns of R, upper triangular.
    r: Vec<Vec<f64>>,
    d: Vec<f64>,
}

impl Factor {
    fn of(a: &[&[DoubleDouble]]) -> Self {
        let (mut q, mut r, mut d): (Vec<Vec<f64>>, Vec<_>, Vec<_>) = Default::default();
        for column in a {
            cancellation_point();
            let mut v: Vec<f64> = column.iter().map(|x| x.to_f64()).collect();
            let size = norm(&v);
            v.iter_mut().for_each(|x| *x /= size);
            let mut above = Vec::with_capacity(q.len() + 1);
            for q in &q {
                let along = dot(q, &v);
                v.iter_mut().zip(q).for_each(|(v, q)| *v -= along * q);
                above.push(along);
            }
            let rest = norm(&v);
            v.iter_mut().for_each(|x| *x /= rest);
            above.push(rest);
            q.push(v);
            r.push(above);
            d.push(size);
        }
        Self { q, r, d }
    }

    fn solve(&self, y: &[DoubleDouble]) -> Vec<f64> {
        let mut y: Vec<f64> = y.iter().map(|y| y.to_f64()).collect();
        let mut x = Vec::with_capacity(self.q.len());
        for q in &self.q {
            let along = dot(q, &y);
            y.iter_mut().zip(q).for_each(|(y, q)| *y -= along * q);
            x.push(along);
        }
        self.back(&mut x);
        x
    }

    /// `D^-1 R^-1 x`, in place.
    fn back(&self, x: &mut [f64]) {
        for k in (0..x.len()).rev() {
            x[k] /= self.r[k][k];
            for i in 0..k {
                x[i] -= self.r[k][i] * x[k];
            }
        }
        x.iter_mut().zip(&self.d).for_each(|(x, d)| *x /= d);
    }

    /// D x
    fn scaled(&self, x: &[f64]) -> Vec<f64> {
        x.iter().zip(&self.d).map(|(x, d)| x * d).collect()
    }

    /// The norms of the rows of the pseudoinverse `D^-1 R^-1 Q'`: what a unit error in W2
    /// does to each entry of beta.
    fn row_norms(&self) -> Vec<f64> {
        let mut squares = vec![0.0; self.q.len()];
        for k in 0..self.q.len() {
            let mut column = vec![0.0; self.q.len()];
            column[k] = 1.0;
            self.back(&mut column);
            squares
                .iter_mut()
                .zip(column)
                .for_each(|(s, x)| *s += x * x);
        }
        squares.into_iter().map(f64::sqrt).collect()
    }
}
