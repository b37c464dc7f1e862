//! QRII: QR with column pivoting, eq. (14), and the paper's choice read from its triangle.

use crate::check::{RATIO_BAR, worst_ratio};
use crate::faer_calls::{PivotedFactors, pivoted_qr};
use crate::householder::{eliminate, make_reflector, reflect};
use crate::scale::{equilibrate, norm, scale_globally, scale_slice, times_power_of_two};
use crate::tolerance::Tolerance;
use crate::{LinalgError, Matrix, RankDecision};

/// `W P = Q T` with `|T11| >= |T22| >= ...`.
#[derive(Debug, Clone, PartialEq)]
pub struct PivotedQr {
    /// `|T_ii|`, c values, 0 beyond row r; nonincreasing up to rounding.
    pub diagonal: Vec<f64>,
    /// Position k of W P holds column `permutation[k]` of W.
    pub permutation: Vec<usize>,
    /// T, min(r, c) x c, upper trapezoidal, in pivoted order.
    pub r: Matrix,
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
    let mut factors = if w.rows() == 0 || w.cols() == 0 {
        own_pivoted_qr(&scaled)
    } else {
        pivoted_qr(&scaled)
    };
    if ratio_of(&scaled, &factors) >= RATIO_BAR {
        factors = own_pivoted_qr(&scaled);
        let ratio = ratio_of(&scaled, &factors);
        if ratio >= RATIO_BAR {
            return Err(LinalgError::NumericalFailure {
                what: "QR with column pivoting",
                ratio,
                bar: RATIO_BAR,
            });
        }
    }
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
        let dust = below.max(cols as f64 * f64::EPSILON * largest);
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

fn ratio_of(a: &Matrix, factors: &PivotedFactors) -> f64 {
    worst_ratio(
        &a.select_columns(&factors.permutation),
        &factors.q,
        &factors.r,
        &[&factors.q],
    )
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
