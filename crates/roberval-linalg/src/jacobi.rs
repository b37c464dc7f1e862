//! One-sided Jacobi SVD: slow, simple and accurate; the fallback behind faer's.

use roberval_scalar::cancellation_point;

use crate::scale::{dot, norm};
use crate::{LinalgError, Matrix};

/// 400 matrices of all ranks up to 61 columns took at most 23 sweeps.
const MAX_SWEEPS: usize = 60;

/// `A = U diag(sigma) V'` of a square matrix (entries about 1), sigma nonincreasing.
/// A column of U whose sigma is 0 is 0.
///
/// # Errors
/// [`LinalgError::NoConvergence`].
pub(crate) fn jacobi_svd(a: &Matrix) -> Result<(Matrix, Vec<f64>, Matrix), LinalgError> {
    let n = a.cols();
    let mut work = a.clone();
    let mut v = Matrix::identity(n);
    // Columns this small are rounding of the others: they need to be orthogonal only to that level.
    let floor = f64::EPSILON * a.frobenius_norm();
    let mut sweeps = 0;
    while sweep(&mut work, &mut v, floor) {
        sweeps += 1;
        if sweeps == MAX_SWEEPS {
            return Err(LinalgError::NoConvergence {
                what: "one-sided Jacobi SVD",
                sweeps,
            });
        }
    }
    let norms: Vec<f64> = (0..n).map(|j| norm(work.col(j))).collect();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&i, &j| norms[j].total_cmp(&norms[i]));
    let mut u = work.select_columns(&order);
    let sigma: Vec<f64> = order.iter().map(|&j| norms[j]).collect();
    for (j, &s) in sigma.iter().enumerate().filter(|&(_, &s)| s > 0.0) {
        u.col_mut(j).iter_mut().for_each(|x| *x /= s);
    }
    Ok((u, sigma, v.select_columns(&order)))
}

/// Rotates every pair of columns to orthogonality once; true if a pair still needed it.
fn sweep(work: &mut Matrix, v: &mut Matrix, floor: f64) -> bool {
    let n = work.cols();
    let small = n as f64 * f64::EPSILON;
    let mut rotated = false;
    for p in 0..n {
        cancellation_point();
        for q in p + 1..n {
            let (alpha, beta) = (norm(work.col(p)), norm(work.col(q)));
            let gamma = dot(work.col(p), work.col(q));
            if gamma.abs() <= small * alpha.max(floor) * beta.max(floor) {
                continue;
            }
            rotated = true;
            let zeta = (beta - alpha) * (beta + alpha) / (2.0 * gamma);
            let t = 1.0_f64.copysign(zeta) / (zeta.abs() + zeta.hypot(1.0));
            let c = 1.0 / t.hypot(1.0);
            rotate(work, p, q, c, c * t);
            rotate(v, p, q, c, c * t);
        }
    }
    rotated
}

fn rotate(a: &mut Matrix, p: usize, q: usize, c: f64, s: f64) {
    let rows = a.rows();
    let (left, right) = a.as_mut_slice().split_at_mut(q * rows);
    for (x, y) in left[p * rows..(p + 1) * rows]
        .iter_mut()
        .zip(&mut right[..rows])
    {
        (*x, *y) = (c * *x - s * *y, s * *x + c * *y);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn matrices_of_low_rank_converge_although_their_last_columns_are_rounding() {
        let entry = |i: usize, j: usize| ((i * 31 + j * 17 + i * j * 5) % 19) as f64 / 19.0 - 0.5;
        for n in [5, 7, 9, 14, 15, 28, 45] {
            for rank in [1, 2, n / 2] {
                let right = Matrix::from_fn(rank, n, |i, j| entry(j + 2, i + 7) / n as f64);
                let a = Matrix::from_fn(n, rank, entry).matmul(&right).unwrap();
                let (_, sigma, v) = jacobi_svd(&a).unwrap();
                // Ten of LAPACK's units, for some twenty sweeps of rotations.
                let rounding = 10.0 * n as f64 * f64::EPSILON;
                assert!(
                    sigma[rank..].iter().all(|&s| s <= rounding * sigma[0]),
                    "n = {n}"
                );
                let gram = v.transpose().matmul(&v).unwrap();
                for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                    assert!(
                        (gram[(i, j)] - f64::from(i == j)).abs() <= rounding,
                        "n = {n}"
                    );
                }
            }
        }
    }
}
