//! The paper's choice read from the null space, eq. (26).

use crate::householder::eliminate;
use crate::{LinalgError, Matrix, Tolerance, condition};

/// The columns to delete: from the last row of V2 (c x (c - b)) upward, the first rows that make a
/// regular (c - b) x (c - b) matrix V22. Increasing. [`v22_condition`] tells how regular it is.
///
/// V2's columns have norm 1, so a row's residual is judged against 1: at most 1e-10 is none (the
/// default tolerance). A row of V2 that is zero up to rounding is a column independent of all others.
///
/// # Errors
/// [`LinalgError::NotFinite`]; [`LinalgError::Singular`] if the columns of V2 are dependent.
pub fn deleted_from_null_space(v2: &Matrix) -> Result<Vec<usize>, LinalgError> {
    v2.check_finite()?;
    let (rows, size) = (v2.rows(), v2.cols());
    let upward = Matrix::from_fn(size, rows, |i, j| v2[(rows - 1 - j, i)]);
    let chosen = eliminate(&upward, |_, residual| residual > Tolerance::DEPENDENT).kept;
    if chosen.len() < size {
        return Err(LinalgError::Singular {
            what: "rows of V2",
            rank: chosen.len(),
            expected: size,
        });
    }
    Ok(chosen.into_iter().rev().map(|j| rows - 1 - j).collect())
}

/// The condition number of V22, the rows `deleted` of V2: the factor by which `beta = -V21 V22^-1`
/// magnifies the rounding errors of V2.
///
/// # Errors
/// [`LinalgError::Shape`] if a row does not exist; those of [`crate::svd`].
pub fn v22_condition(v2: &Matrix, deleted: &[usize]) -> Result<f64, LinalgError> {
    crate::relations::check_indices("deleted rows of V2", deleted, v2.rows())?;
    condition(&v2.select_rows(deleted))
}
