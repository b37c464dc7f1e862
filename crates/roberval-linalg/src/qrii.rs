//! QRII: QR with column pivoting, eq. (14), and the paper's choice read from its triangle.

use crate::check::{RATIO_BAR, worst_ratio};
use crate::faer_calls::{PivotedFactors, pivoted_qr};
use crate::householder::{eliminate, make_reflector, reflect};
use crate::scale::{equilibrate, norm, scale_globally, scale_slice, times_power_of_two};
use crate::tolerance::Tolerance;
use crate::{LinalgError, Matrix, RankDecision};

/// |T_ii| may rise by this much, relative, and by rounding of |T11|. faer subtracts from its column norms
/// and computes them afresh only once they have fallen by sqrt(eps): below 1e-7 |T11| its |T_ii| was
/// seen to rise by 34 %.
const ORDER_SLACK: f64 = 1e-10;

/// `W P = Q T` with `|T11| >= |T22| >= ...`.
#[derive(Debug, Clone, PartialEq)]
pub struct PivotedQr {
    /// `|T_ii|`, c values, 0 beyond row r; nonincreasing to 1e-10 above rounding.
    pub diagonal: Vec<f64>,
    /// Position k of W P holds column `permutation[k]` of W.
    pub permutation: Vec<usize>,
    /// T, min(r, c) x c, upper trapezoidal, in pivoted order.
    pub r: Matrix,
    /// Residual or orthogonality found, whichever is worse, in units of rounding; below [`RATIO_BAR`].
    pub ratio: f64,
    rows: usize,
}

/// QR of `w` (r x c) with column pivoting, eq. (14).
///
/// # Errors
/// [`LinalgError::NotFinite`]; [`LinalgError::NumericalFailure`] if both faer's factorisation and the
/// fallback fail their checks; [`LinalgError::Overflow`].
pub fn qrii(w: &Matrix) -> Result<PivotedQr, LinalgError> {
    w.check_finite()?;
    let (scaled, up) = scale_globally(w);
    let (factors, ratio) = checked_pivoted_qr(&scaled, pivoted_qr)?;
    let PivotedFactors {
        mut r, permutation, ..
    } = factors;
    scale_slice(r.as_mut_slice(), -up);
    r.check_finite().map_err(|_| LinalgError::Overflow {
        what: "QR with column pivoting",
    })?;
    let diagonal = (0..w.cols())
        .map(|i| if i < r.rows() { r[(i, i)].abs() } else { 0.0 })
        .collect();
    Ok(PivotedQr {
        diagonal,
        permutation,
        r,
        ratio,
        rows: w.rows(),
    })
}

impl PivotedQr {
    /// The rank: the number of leading `|T_ii|` above tau.
    ///
    /// # Errors
    /// [`LinalgError::Tolerance`].
    pub fn decide(&self, tolerance: &Tolerance) -> Result<RankDecision, LinalgError> {
        tolerance.decide(&self.diagonal, self.rows)
    }

    /// The paper's choice of `rank` kept columns: the leftmost independent columns of
    /// `[T1 T2] P'`, the first `rank` rows of T with the columns back in W's order.
    ///
    /// A column depends on those before it when its residual is at most 1e-10 of its norm (the
    /// default tolerance) or not above what the rank decision has just called zero, `|T_{b+1,b+1}|`.
    ///
    /// # Errors
    /// [`LinalgError::Shape`] if `rank` exceeds min(r, c); [`LinalgError::Singular`] if fewer than
    /// `rank` columns turn out independent (the decision and the columns contradict each other).
    pub fn leftmost(&self, rank: usize) -> Result<Vec<usize>, LinalgError> {
        let cols = self.r.cols();
        if rank > self.r.rows() {
            return Err(LinalgError::Shape {
                what: "rank of a pivoted QR",
                expected: format!("at most {}", self.r.rows()),
                found: rank.to_string(),
            });
        }
        let mut top = Matrix::zeros(rank, cols);
        let mut norms = vec![0.0; cols];
        for (k, &j) in self.permutation.iter().enumerate() {
            top.col_mut(j).copy_from_slice(&self.r.col(k)[..rank]);
            norms[j] = norm(self.r.col(k));
        }
        let below = self.diagonal.get(rank).copied().unwrap_or(0.0);
        let largest = self.diagonal.first().copied().unwrap_or(0.0);
        let dust = below.max(dust(self.rows, cols, largest));
        let (scaled, exponents) = equilibrate(&top);
        let kept = eliminate(&scaled, |j, residual| {
            times_power_of_two(residual, -exponents[j])
                > (Tolerance::DEPENDENT * norms[j]).max(dust)
        })
        .kept;
        if kept.len() == rank {
            Ok(kept)
        } else {
            Err(LinalgError::Singular {
                what: "leftmost columns of QRII",
                rank: kept.len(),
                expected: rank,
            })
        }
    }
}

/// The factors of `first` if they pass their check, else the fallback's if those do.
fn checked_pivoted_qr(
    a: &Matrix,
    first: impl Fn(&Matrix) -> PivotedFactors,
) -> Result<(PivotedFactors, f64), LinalgError> {
    if a.rows() > 0 && a.cols() > 0 {
        let factors = first(a);
        let ratio = ratio_of(a, &factors);
        if ratio < RATIO_BAR {
            return Ok((factors, ratio));
        }
    }
    let factors = own_pivoted_qr(a);
    let ratio = ratio_of(a, &factors);
    if ratio < RATIO_BAR {
        Ok((factors, ratio))
    } else {
        let what = "QR with column pivoting";
        Err(LinalgError::NumericalFailure {
            what,
            ratio,
            bar: RATIO_BAR,
        })
    }
}

/// What rounding leaves of a zero in an r x c matrix whose largest column has this norm.
fn dust(rows: usize, cols: usize, largest: f64) -> f64 {
    rows.max(cols) as f64 * f64::EPSILON * largest
}

/// The worst ratio; infinite if |T_ii| rises.
fn ratio_of(a: &Matrix, factors: &PivotedFactors) -> f64 {
    let diagonal: Vec<f64> = (0..factors.r.rows())
        .map(|i| factors.r[(i, i)].abs())
        .collect();
    let rounding = dust(a.rows(), a.cols(), diagonal.first().copied().unwrap_or(0.0));
    let rises = |t: &[f64]| t[1] > t[0] * (1.0 + ORDER_SLACK) + rounding;
    if diagonal.windows(2).any(rises) {
        return f64::INFINITY;
    }
    let permuted = a.select_columns(&factors.permutation);
    worst_ratio(&permuted, &factors.q, &factors.r, &[&factors.q])
}

/// The fallback: Householder QR with column pivoting, norms computed afresh at every step.
fn own_pivoted_qr(a: &Matrix) -> PivotedFactors {
    let (rows, cols) = (a.rows(), a.cols());
    let size = rows.min(cols);
    let mut work = a.clone();
    let mut permutation: Vec<usize> = (0..cols).collect();
    let mut reflectors = Matrix::zeros(rows, size);
    let mut taus = vec![0.0; size];
    for p in 0..size {
        let tail = |k: usize, work: &Matrix| norm(&work.col(k)[p..]);
        let best = (p + 1..cols).fold((p, tail(p, &work)), |best, k| {
            let norm = tail(k, &work);
            if norm > best.1 { (k, norm) } else { best }
        });
        swap_columns(&mut work, p, best.0);
        permutation.swap(p, best.0);
        let v = &mut reflectors.col_mut(p)[p..];
        v.copy_from_slice(&work.col(p)[p..]);
        let (t_pp, tau) = make_reflector(v, best.1);
        taus[p] = tau;
        work.col_mut(p)[p..].fill(0.0);
        work[(p, p)] = t_pp;
        for k in p + 1..cols {
            reflect(&reflectors.col(p)[p..], tau, &mut work.col_mut(k)[p..]);
        }
    }
    let mut q = Matrix::from_fn(rows, size, |i, j| f64::from(i == j));
    for j in 0..size {
        for p in (0..size).rev() {
            reflect(&reflectors.col(p)[p..], taus[p], &mut q.col_mut(j)[p..]);
        }
    }
    let leading: Vec<usize> = (0..size).collect();
    PivotedFactors {
        q,
        r: work.select_rows(&leading),
        permutation,
    }
}

fn swap_columns(a: &mut Matrix, j: usize, k: usize) {
    for i in 0..a.rows() {
        let kept = a[(i, j)];
        a[(i, j)] = a[(i, k)];
        a[(i, k)] = kept;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(rows: usize, cols: usize) -> Matrix {
        Matrix::from_fn(rows, cols, |i, j| {
            ((i * 37 + j * 91 + i * j * 13) % 101) as f64 / 101.0 - 0.5
        })
    }

    #[test]
    fn a_wrong_factor_from_the_library_is_caught_and_replaced() {
        let a = sample(12, 7);
        let sound = own_pivoted_qr(&a);
        for entry in [(0, 0), (3, 6), (6, 6)] {
            let spoiled = |a: &Matrix| {
                let mut factors = own_pivoted_qr(a);
                factors.r[entry] += 1e-12;
                factors
            };
            assert!(ratio_of(&a, &spoiled(&a)) >= RATIO_BAR);
            let (factors, ratio) = checked_pivoted_qr(&a, spoiled).unwrap();
            assert!(ratio < RATIO_BAR && factors.r == sound.r, "{entry:?}");
        }
        let with_nan = |a: &Matrix| {
            let mut factors = own_pivoted_qr(a);
            factors.q[(2, 2)] = f64::NAN;
            factors
        };
        assert!(checked_pivoted_qr(&a, with_nan).unwrap().0.q == sound.q);
    }

    #[test]
    fn a_rising_diagonal_from_the_library_is_replaced() {
        // A dominant direction and a floor at 1e-8 of it, where faer's column norms have no digit left.
        let mut rises = 0;
        for seed in 0..50 {
            let noise = sample(30, 20);
            let a = Matrix::from_fn(30, 20, |i, j| {
                let dominant = ((i * 7 + seed) % 11 + 1) as f64 * ((j * 5 + seed) % 13 + 1) as f64;
                dominant / 200.0 + 1e-8 * noise[(i, (j + seed) % 20)]
            });
            rises += usize::from(ratio_of(&a, &pivoted_qr(&a)).is_infinite());
            let (factors, _) = checked_pivoted_qr(&a, pivoted_qr).unwrap();
            for i in 1..20 {
                let (t, next) = (factors.r[(i - 1, i - 1)].abs(), factors.r[(i, i)].abs());
                assert!(
                    next <= t * (1.0 + ORDER_SLACK),
                    "|T_ii| rises at {i}: {t:e} to {next:e}"
                );
            }
        }
        // A canary: when faer computes such norms afresh, the fallback has one reason less.
        assert!(rises > 0);
    }

    #[test]
    fn the_fallback_pivots_like_the_library() {
        // Far above rounding, far below any step between two pivots that are not a tie.
        const SAME_PIVOT: f64 = 1e-13;
        for (rows, cols) in [(1, 1), (5, 5), (20, 9), (9, 20), (40, 40)] {
            let a = sample(rows, cols);
            let (own, library) = (own_pivoted_qr(&a), pivoted_qr(&a));
            assert!(ratio_of(&a, &own) < RATIO_BAR);
            for i in 0..rows.min(cols) {
                let (t, u) = (own.r[(i, i)].abs(), library.r[(i, i)].abs());
                assert!(
                    (t - u).abs() < SAME_PIVOT,
                    "{rows} x {cols}: |T_ii| {t} against {u} at {i}"
                );
            }
        }
    }
}
