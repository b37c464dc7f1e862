//! The SVD, eq. (21): gap of the singular values, null space V2 and the minimum-norm parameters.

use crate::check::{RATIO_BAR, worst_ratio};
use crate::faer_calls::square_svd;
use crate::householder::eliminate;
use crate::jacobi::jacobi_svd;
use crate::scale::{dot, scale_globally, times_power_of_two};
use crate::tolerance::Tolerance;
use crate::{LinalgError, Matrix, RankDecision};

/// `U' W V = S`, eq. (21), without U.
#[derive(Debug, Clone, PartialEq)]
pub struct Svd {
    /// Singular values, nonincreasing, c of them (0 beyond row r).
    pub sigma: Vec<f64>,
    /// V, c x c, orthogonal; its last c - b columns span the null space.
    pub v: Matrix,
    /// Residual or orthogonality found, whichever is worse, in units of rounding; below [`RATIO_BAR`].
    pub ratio: f64,
    rows: usize,
}

/// The SVD of `w` (r x c). A tall `w` is first reduced to its c x c triangle, a wide one gets zero rows.
///
/// # Errors
/// [`LinalgError::NotFinite`]; [`LinalgError::NoConvergence`] or [`LinalgError::NumericalFailure`] if both
/// faer's SVD and one-sided Jacobi fail; [`LinalgError::Overflow`].
pub fn svd(w: &Matrix) -> Result<Svd, LinalgError> {
    w.check_finite()?;
    let (scaled, up) = scale_globally(w);
    let (mut sigma, v, ratio) = checked_svd(&square(&scaled), square_svd)?;
    sigma
        .iter_mut()
        .for_each(|s| *s = times_power_of_two(*s, -up));
    if sigma.iter().all(|s| s.is_finite()) {
        Ok(Svd {
            sigma,
            v,
            ratio,
            rows: w.rows(),
        })
    } else {
        Err(LinalgError::Overflow {
            what: "singular values",
        })
    }
}

/// The 2-norm condition number `sigma_1 / sigma_min(r,c)`: infinite for a singular matrix, 1 for an empty one.
///
/// # Errors
/// Those of [`svd`].
pub fn condition(w: &Matrix) -> Result<f64, LinalgError> {
    let size = w.rows().min(w.cols());
    if size == 0 {
        return Ok(1.0);
    }
    let sigma = svd(w)?.sigma;
    Ok(if sigma[size - 1] == 0.0 {
        f64::INFINITY
    } else {
        sigma[0] / sigma[size - 1]
    })
}

impl Svd {
    /// The rank: the number of leading `sigma_i` above tau.
    ///
    /// # Errors
    /// [`LinalgError::Tolerance`].
    pub fn decide(&self, tolerance: &Tolerance) -> Result<RankDecision, LinalgError> {
        tolerance.decide(&self.sigma, self.rows)
    }

    /// V2, c x (c - rank): the last columns of V (none if `rank >= c`).
    pub fn null_space(&self, rank: usize) -> Matrix {
        let last: Vec<usize> = (rank.min(self.v.cols())..self.v.cols()).collect();
        self.v.select_columns(&last)
    }

    /// The minimum-norm parameters `XM = V1 V1' X` of the same behaviour as X, after eq. (25).
    ///
    /// # Errors
    /// [`LinalgError::Shape`] unless X has c entries and `rank <= c`.
    pub fn minimum_norm(&self, rank: usize, x: &[f64]) -> Result<Vec<f64>, LinalgError> {
        let cols = self.v.cols();
        if x.len() != cols || rank > cols {
            return Err(LinalgError::Shape {
                what: "minimum-norm parameters",
                expected: format!("{cols} parameters and a rank of at most {cols}"),
                found: format!("{} parameters and rank {rank}", x.len()),
            });
        }
        let mut projected = vec![0.0; cols];
        for k in 0..rank {
            let column = self.v.col(k);
            crate::scale::add_multiple(&mut projected, dot(column, x), column);
        }
        Ok(projected)
    }
}

/// A square matrix with the singular values and V of `w`.
fn square(w: &Matrix) -> Matrix {
    let cols = w.cols();
    let triangle = if w.rows() > cols {
        eliminate(w, |_, _| true).r
    } else {
        w.clone()
    };
    let rows = triangle.rows();
    Matrix::from_fn(
        cols,
        cols,
        |i, j| if i < rows { triangle[(i, j)] } else { 0.0 },
    )
}

/// U, sigma, V.
type Triple = (Matrix, Vec<f64>, Matrix);

/// The SVD of `first` if it passes its check, else one-sided Jacobi if that does: sigma, V, ratio.
fn checked_svd(
    a: &Matrix,
    first: impl Fn(&Matrix) -> Option<Triple>,
) -> Result<(Vec<f64>, Matrix, f64), LinalgError> {
    if a.cols() == 0 {
        return Ok((Vec::new(), Matrix::zeros(0, 0), 0.0));
    }
    if let Some((u, sigma, v)) = first(a) {
        let ratio = ratio_of(a, &u, &sigma, &v, &[&u, &v]);
        if ratio < RATIO_BAR {
            return Ok((sigma, v, ratio));
        }
    }
    let (u, sigma, v) = jacobi_svd(a)?;
    // U is not orthogonal where sigma is rounding: V is what counts.
    let ratio = ratio_of(a, &u, &sigma, &v, &[&v]);
    if ratio < RATIO_BAR {
        Ok((sigma, v, ratio))
    } else {
        let what = "singular value decomposition";
        Err(LinalgError::NumericalFailure {
            what,
            ratio,
            bar: RATIO_BAR,
        })
    }
}

fn ratio_of(a: &Matrix, u: &Matrix, sigma: &[f64], v: &Matrix, orthogonal: &[&Matrix]) -> f64 {
    let ordered = sigma.windows(2).all(|s| s[0] >= s[1]) && sigma.iter().all(|&s| s >= 0.0);
    let sv = Matrix::from_fn(a.rows(), a.cols(), |i, j| sigma[i] * v[(j, i)]);
    if ordered {
        worst_ratio(a, u, &sv, orthogonal)
    } else {
        f64::INFINITY
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square matrix of rank n - n / 3 with entries below 1.
    fn sample(n: usize) -> Matrix {
        let low = n - n / 3;
        let entry = |i: usize, j: usize| ((i * 29 + j * 53 + i * j * 7) % 97) as f64 / 97.0 - 0.5;
        let factor = Matrix::from_fn(low, n, |i, j| entry(j + 3, i) / n as f64);
        Matrix::from_fn(n, low, entry).matmul(&factor).unwrap()
    }

    #[test]
    fn jacobi_agrees_with_the_library_also_on_singular_matrices() {
        for n in [1, 2, 5, 33, 60] {
            let a = sample(n);
            let (u, sigma, v) = jacobi_svd(&a).unwrap();
            assert!(ratio_of(&a, &u, &sigma, &v, &[&v]) < RATIO_BAR, "n = {n}");
            let library = square_svd(&a).unwrap().1;
            for (s, t) in sigma.iter().zip(&library) {
                let rounding = n as f64 * f64::EPSILON * library[0];
                assert!((s - t).abs() <= rounding, "n = {n}: {s} against {t}");
            }
        }
    }

    #[test]
    fn no_convergence_or_a_wrong_factor_from_the_library_is_replaced() {
        let a = sample(20);
        let truth = square_svd(&a).unwrap();
        let spoilers: [fn(Triple) -> Option<Triple>; 4] = [
            |_| None,
            |(u, s, v)| Some((u, s.iter().map(|s| s * 1.001).collect(), v)),
            |(u, s, v)| Some((u, s.into_iter().rev().collect(), v)),
            |(u, s, v)| Some((u, s, Matrix::from_fn(20, 20, |i, j| v[(i, j)] * f64::NAN))),
        ];
        for spoil in spoilers {
            let (sigma, v, ratio) = checked_svd(&a, |a| spoil(square_svd(a)?)).unwrap();
            assert!(ratio < RATIO_BAR && v.check_finite().is_ok());
            assert!((sigma[0] - truth.1[0]).abs() <= 20.0 * f64::EPSILON * truth.1[0]);
        }
    }
}
