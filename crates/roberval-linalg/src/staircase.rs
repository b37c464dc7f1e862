//! QR without pivoting: the staircase that chooses, and the paper's plain diagonal for show.

use crate::householder::eliminate;
use crate::scale::{equilibrate, times_power_of_two};
use crate::{LinalgError, Matrix, RankDecision, Tolerance};

/// The echelon form `W = Q R` whose dependent columns use no row.
#[derive(Debug, Clone, PartialEq)]
pub struct Staircase {
    /// Columns independent of the kept columns before them, increasing: the paper's choice of W1.
    pub kept: Vec<usize>,
    /// All other columns, increasing (W2).
    pub deleted: Vec<usize>,
    /// The echelon form, rank x c: column `kept[i]` ends at row i.
    pub r: Matrix,
    /// `residual_j / norm_j` per column, 0 for a zero column.
    pub ratios: Vec<f64>,
    /// `|R_jj|` per column: the norm of what the kept columns before it do not explain.
    pub diagonal: Vec<f64>,
    /// The rank; its spectrum is `ratios` or, under the paper's tolerance, `diagonal`.
    pub decision: RankDecision,
}

/// The leftmost independent columns of `w` (r x c), by Householder reflections from left to right.
///
/// Column j is deleted when its residual against the kept columns before it is at most
/// `dependent * norm_j` ([`Tolerance::Relative`]) or `r max|Rii| eps` ([`Tolerance::Paper`], the
/// maximum from [`plain_qr_diagonal`]), or when all r rows are used. A column of rounding dust is a
/// column like any other under the relative rule: take structurally zero columns out first.
///
/// # Errors
/// [`LinalgError::NotFinite`], [`LinalgError::Tolerance`], [`LinalgError::Overflow`].
pub fn staircase_qr(w: &Matrix, tolerance: &Tolerance) -> Result<Staircase, LinalgError> {
    tolerance.check()?;
    w.check_finite()?;
    let (scaled, exponents) = equilibrate(w);
    let norms: Vec<f64> = (0..w.cols()).map(|j| scaled.column_norm(j)).collect();
    let tau = match *tolerance {
        Tolerance::Paper { eps } => {
            w.rows() as f64 * eps * plain_qr_diagonal(w)?.into_iter().fold(0.0, f64::max)
        }
        Tolerance::Relative { dependent, .. } => dependent,
    };
    let relative = matches!(tolerance, Tolerance::Relative { .. });
    let form = eliminate(&scaled, |j, residual| {
        let threshold = if relative {
            tau * norms[j]
        } else {
            times_power_of_two(tau, exponents[j])
        };
        residual > threshold
    });

    let ratios: Vec<f64> = form
        .residuals
        .iter()
        .zip(&norms)
        .map(|(&t, &n)| if n == 0.0 { 0.0 } else { t / n })
        .collect();
    let diagonal = unscale(&form.residuals, &exponents);
    let mut r = form.r;
    for (j, &e) in exponents.iter().enumerate() {
        crate::scale::scale_slice(r.col_mut(j), -e);
    }
    r.check_finite().map_err(|_| LinalgError::Overflow {
        what: "staircase QR",
    })?;

    let mut counts = vec![false; w.cols()];
    form.kept.iter().for_each(|&j| counts[j] = true);
    let deleted = (0..w.cols()).filter(|&j| !counts[j]).collect();
    let (spectrum, sure) = match *tolerance {
        Tolerance::Paper { .. } => (diagonal.clone(), 0.0),
        Tolerance::Relative { independent, .. } => (ratios.clone(), independent),
    };
    let decision = RankDecision::new(spectrum, &counts, tau, sure);
    Ok(Staircase {
        kept: form.kept,
        deleted,
        r,
        ratios,
        diagonal,
        decision,
    })
}

/// `|R_ii|` of QR without pivoting, eq. (13), as LAPACK computes it: c values, 0 beyond row r.
///
/// A dependent column uses a row here, which may cost a later column its last component
/// (at r = c); so this is for show and for the paper's tau, not for choosing.
///
/// # Errors
/// [`LinalgError::NotFinite`]; [`LinalgError::Overflow`] if a norm exceeds the largest double.
pub fn plain_qr_diagonal(w: &Matrix) -> Result<Vec<f64>, LinalgError> {
    w.check_finite()?;
    let (scaled, exponents) = equilibrate(w);
    let diagonal = unscale(&eliminate(&scaled, |_, _| true).residuals, &exponents);
    if diagonal.iter().all(|x| x.is_finite()) {
        Ok(diagonal)
    } else {
        Err(LinalgError::Overflow { what: "QR" })
    }
}

fn unscale(values: &[f64], exponents: &[i32]) -> Vec<f64> {
    values
        .iter()
        .zip(exponents)
        .map(|(&x, &e)| times_power_of_two(x, -e))
        .collect()
}
