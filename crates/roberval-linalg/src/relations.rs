//! The relations `W2 = W1 beta` between deleted and kept columns, eq. (17) and eq. (27),
//! with an entrywise error bound that tells coefficients from rounding dust.

use roberval_scalar::cancellation_point;

use crate::householder::{Echelon, eliminate};
use crate::scale::{equilibrate, norm, unscale_relations};
use crate::{LinalgError, Matrix, Svd};

/// How far a column of W may be from exact, relative to its norm: the observation matrix itself is
/// rounded (a regressor's recursion loses a few units in the last place), so is what it tells of beta.
const DATA_ERROR: f64 = 16.0 * f64::EPSILON;

/// `sigma_1 / sigma_b` assumed where only V2 is known: on 400 random robots of 3 to 36 links it was
/// below 1.5e3 with raw columns and below 50 with equilibrated ones.
const ASSUMED_SEPARATION: f64 = 1e3;

/// V2 of c columns is off by about `c eps sigma_1 / sigma_b`; small matrices are not that much better.
fn null_space_error(cols: usize, separation: f64) -> f64 {
    cols.max(16) as f64 * f64::EPSILON * separation
}

/// `beta` (b x (c - b)) with `|error of beta_ij| <= bound_ij`.
#[derive(Debug, Clone, PartialEq)]
pub struct Relations {
    /// Row i belongs to kept column i, column j to deleted column j: `W2 = W1 beta`.
    pub beta: Matrix,
    /// First-order error bound of every entry.
    pub bound: Matrix,
}

impl Relations {
    /// Sets every entry within its own error bound to an exact 0.
    pub fn clean(&mut self) {
        for (beta, bound) in self
            .beta
            .as_mut_slice()
            .iter_mut()
            .zip(self.bound.as_slice())
        {
            if beta.abs() <= *bound {
                *beta = 0.0;
            }
        }
    }
}

/// `beta = R1^-1 R2`, eq. (17), by Householder QR of `[W1 W2]` with equilibrated columns and one step
/// of iterative refinement on residuals in twice the precision.
///
/// The bound: columns of W in error by `e_k` change beta_ij by at most
/// `|row i of W1^+| (e_j + sum_k e_k |beta_kj|)`. `e_k` is 16 eps of the column's norm; what W1 leaves
/// unexplained of column j is added, as noise that also hides within the span of W1.
///
/// # Errors
/// [`LinalgError::NotFinite`]; [`LinalgError::Shape`] if a column does not exist;
/// [`LinalgError::Singular`] if the kept columns are dependent to working precision.
pub fn relations_qr(
    w: &Matrix,
    kept: &[usize],
    deleted: &[usize],
) -> Result<Relations, LinalgError> {
    check_indices("kept columns", kept, w.cols())?;
    check_indices("deleted columns", deleted, w.cols())?;
    w.check_finite()?;
    let (scaled, exponents) = equilibrate(w);
    let (w1, w2) = (scaled.select_columns(kept), scaled.select_columns(deleted));
    let dust = w1.rows().max(w1.cols()) as f64 * f64::EPSILON;
    let solver = Solver::new(&w1, &w2, dust, "kept columns of W")?;
    let doubled = Doubled::new(&w1);
    let mut beta = solver.solution();
    let mut bound = Matrix::zeros(kept.len(), deleted.len());
    let pseudo_inverse = solver.inverse_row_norms();
    let norms: Vec<f64> = (0..w1.cols()).map(|k| w1.column_norm(k)).collect();
    let (rows, b) = (w1.rows(), w1.cols());
    for j in 0..deleted.len() {
        cancellation_point();
        let data = DATA_ERROR * (w2.column_norm(j) + weighted(&norms, beta.col(j)));
        // Dust need not be refined: starting from 0 is as close, and most of beta is dust.
        for (beta, row) in beta.col_mut(j).iter_mut().zip(&pseudo_inverse) {
            if beta.abs() <= row * data {
                *beta = 0.0;
            }
        }
        let mut rest = doubled.residual(beta.col(j), w2.col(j));
        solver.form.apply_q_transposed(&mut rest);
        let hidden = if rows > b {
            (rows as f64 / (rows - b) as f64).sqrt()
        } else {
            0.0
        };
        let unexplained = hidden * norm(&rest[b..]);
        solver.back_substitute(&mut rest[..b]);
        beta.col_mut(j)
            .iter_mut()
            .zip(&rest)
            .for_each(|(beta, step)| *beta += step);
        let data = DATA_ERROR * (w2.column_norm(j) + weighted(&norms, beta.col(j)));
        let error = data + unexplained;
        for i in 0..b {
            bound[(i, j)] = pseudo_inverse[i] * error;
        }
    }
    Ok(Relations {
        beta: unscale_relations(&beta, &exponents, kept, deleted)?,
        bound: unscale_relations(&bound, &exponents, kept, deleted)?,
    })
}

/// `sum_k norm_k |beta_k|`.
fn weighted(norms: &[f64], beta: &[f64]) -> f64 {
    norms.iter().zip(beta).map(|(n, beta)| n * beta.abs()).sum()
}

/// `beta = -V21 V22^-1`, eq. (27), from the null space V2 (c x (c - b)) alone.
///
/// The bound takes V2 to be accurate to `c eps sigma_1 / sigma_b` with an assumed `sigma_1 / sigma_b` of
/// 1e3; [`Svd::relations`] knows the true one.
///
/// # Errors
/// [`LinalgError::NotFinite`]; [`LinalgError::Shape`] if `kept` and `deleted` do not fit V2;
/// [`LinalgError::Singular`] if V22 is singular to working precision.
pub fn relations_svd(
    v2: &Matrix,
    kept: &[usize],
    deleted: &[usize],
) -> Result<Relations, LinalgError> {
    null_space_relations(
        v2,
        kept,
        deleted,
        null_space_error(v2.rows(), ASSUMED_SEPARATION),
    )
}

impl Svd {
    /// `beta = -V21 V22^-1`, eq. (27), for the null space at `rank`, bound by `c eps sigma_1 / sigma_b`.
    ///
    /// # Errors
    /// Those of [`relations_svd`].
    pub fn relations(
        &self,
        rank: usize,
        kept: &[usize],
        deleted: &[usize],
    ) -> Result<Relations, LinalgError> {
        let separation = match rank.min(self.sigma.len()).checked_sub(1) {
            Some(last) if self.sigma[last] > 0.0 => self.sigma[0] / self.sigma[last],
            Some(_) => f64::INFINITY,
            None => 1.0,
        };
        let error = null_space_error(self.sigma.len(), separation);
        null_space_relations(&self.null_space(rank), kept, deleted, error)
    }
}

/// `error` bounds the 2-norm of V2's error; then beta_ij is in error by at most
/// `error * |(1, row i of beta)| * |column j of V22^-1|`.
fn null_space_relations(
    v2: &Matrix,
    kept: &[usize],
    deleted: &[usize],
    error: f64,
) -> Result<Relations, LinalgError> {
    check_indices("kept rows of V2", kept, v2.rows())?;
    check_indices("deleted rows of V2", deleted, v2.rows())?;
    if deleted.len() != v2.cols() {
        return Err(LinalgError::Shape {
            what: "deleted rows of V2",
            expected: format!("{}, one for each column of V2", v2.cols()),
            found: deleted.len().to_string(),
        });
    }
    v2.check_finite()?;
    let mut v21 = v2.select_rows(kept).transpose();
    v21.as_mut_slice().iter_mut().for_each(|x| *x = -*x);
    let solver = Solver::new(&v2.select_rows(deleted).transpose(), &v21, error, "V22")?;
    let beta = solver.solution().transpose();
    let inverse = solver.inverse_row_norms();
    let row_norms: Vec<f64> = (0..beta.rows())
        .map(|i| (0..beta.cols()).fold(1.0_f64, |norm, j| norm.hypot(beta[(i, j)])))
        .collect();
    let bound = Matrix::from_fn(beta.rows(), beta.cols(), |i, j| {
        error * row_norms[i] * inverse[j]
    });
    Ok(Relations { beta, bound })
}

/// Least squares `A1 x = A2` by one Householder sweep over `[A1 A2]`.
struct Solver {
    form: Echelon,
    size: usize,
}

impl Solver {
    /// Columns of A1 are about 1 in norm; a residual of at most `dust` makes them dependent.
    fn new(a1: &Matrix, a2: &Matrix, dust: f64, what: &'static str) -> Result<Self, LinalgError> {
        let (rows, size) = (a1.rows(), a1.cols());
        let both = Matrix::from_fn(rows, size + a2.cols(), |i, j| {
            if j < size {
                a1[(i, j)]
            } else {
                a2[(i, j - size)]
            }
        });
        let mut independent = 0;
        let form = eliminate(&both, |j, residual| {
            independent += usize::from(j < size && residual > dust);
            j < size
        });
        if independent < size {
            return Err(LinalgError::Singular {
                what,
                rank: independent,
                expected: size,
            });
        }
        Ok(Solver { form, size })
    }

    /// `R1^-1 R2`.
    fn solution(&self) -> Matrix {
        let right: Vec<usize> = (self.size..self.form.r.cols()).collect();
        let mut x = self.form.r.select_columns(&right);
        for j in 0..x.cols() {
            self.back_substitute(x.col_mut(j));
        }
        x
    }

    /// `x <- R1^-1 x`.
    fn back_substitute(&self, x: &mut [f64]) {
        for k in (0..x.len()).rev() {
            let column = self.form.r.col(k);
            x[k] /= column[k];
            let factor = -x[k];
            crate::scale::add_multiple(&mut x[..k], factor, &column[..k]);
        }
    }

    /// The 2-norms of the rows of `A1^+ = R1^-1 Q1'`, which are those of `R1^-1`.
    fn inverse_row_norms(&self) -> Vec<f64> {
        let mut squares = vec![0.0; self.size];
        let mut x = vec![0.0; self.size];
        for k in 0..self.size {
            x.fill(0.0);
            x[k] = 1.0;
            self.back_substitute(&mut x[..=k]);
            squares
                .iter_mut()
                .zip(&x)
                .for_each(|(sum, x)| *sum += x * x);
        }
        squares.into_iter().map(f64::sqrt).collect()
    }
}

/// A matrix beside the halves of its entries, for residuals in twice the working precision.
struct Doubled<'a> {
    a: &'a Matrix,
    high: Matrix,
    low: Matrix,
}

impl<'a> Doubled<'a> {
    fn new(a: &'a Matrix) -> Self {
        let high = Matrix::from_fn(a.rows(), a.cols(), |i, j| split(a[(i, j)]).0);
        let low = Matrix::from_fn(a.rows(), a.cols(), |i, j| a[(i, j)] - high[(i, j)]);
        Doubled { a, high, low }
    }

    /// `b - A x`: Dekker's exact products, Knuth's exact sums.
    fn residual(&self, x: &[f64], b: &[f64]) -> Vec<f64> {
        let mut sum = b.to_vec();
        let mut rest = vec![0.0; b.len()];
        for (k, &x) in x.iter().enumerate().filter(|&(_, &x)| x != 0.0) {
            let (x_high, x_low) = split(x);
            let halves = self.high.col(k).iter().zip(self.low.col(k));
            let sums = sum.iter_mut().zip(&mut rest);
            for ((&a, (&high, &low)), (sum, rest)) in self.a.col(k).iter().zip(halves).zip(sums) {
                let product = a * x;
                let lost = ((high * x_high - product) + high * x_low + low * x_high) + low * x_low;
                let next = *sum - product;
                let back = next - *sum;
                *rest += ((*sum - (next - back)) - (product + back)) - lost;
                *sum = next;
            }
        }
        sum.iter()
            .zip(&rest)
            .map(|(sum, rest)| sum + rest)
            .collect()
    }
}

/// Veltkamp's split of a double into two halves of 26 bits.
fn split(x: f64) -> (f64, f64) {
    let c = 134_217_729.0 * x;
    let high = c - (c - x);
    (high, x - high)
}

pub(crate) fn check_indices(
    what: &'static str,
    indices: &[usize],
    size: usize,
) -> Result<(), LinalgError> {
    match indices.iter().find(|&&i| i >= size) {
        None => Ok(()),
        Some(bad) => Err(LinalgError::Shape {
            what,
            expected: format!("indices below {size}"),
            found: bad.to_string(),
        }),
    }
}
