//! What can go wrong with a matrix.

use thiserror::Error;

/// An input that cannot be used, or a factorisation that did not hold.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum LinalgError {
    /// An entry is NaN or infinite (the first one, column by column).
    #[error("entry ({row}, {col}) of the matrix is {value}: every entry must be finite")]
    NotFinite {
        /// Row of the entry, from 0.
        row: usize,
        /// Column of the entry, from 0.
        col: usize,
        /// The entry.
        value: f64,
    },
    /// Sizes do not fit together.
    #[error("{what}: expected {expected}, found {found}")]
    Shape {
        /// The operation or argument.
        what: &'static str,
        /// What would be right.
        expected: String,
        /// What came.
        found: String,
    },
    /// A tolerance outside its range.
    #[error("tolerance {name} = {value}: {expected}")]
    Tolerance {
        /// Name of the field.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What would be right.
        expected: &'static str,
    },
    /// Columns (or rows) that should be independent are not.
    #[error("{what}: only {rank} of {expected} columns are independent")]
    Singular {
        /// The matrix.
        what: &'static str,
        /// How many independent columns were found.
        rank: usize,
        /// How many were needed.
        expected: usize,
    },
    /// The iteration of the SVD did not end.
    #[error("{what} did not converge in {sweeps} sweeps")]
    NoConvergence {
        /// The iteration.
        what: &'static str,
        /// Sweeps done.
        sweeps: usize,
    },
    /// A factorisation failed its own residual or orthogonality check, and so did the fallback.
    #[error(
        "{what}: residual or orthogonality ratio {ratio:e} is above {bar}; the result cannot be trusted"
    )]
    NumericalFailure {
        /// The factorisation.
        what: &'static str,
        /// The LAPACK-style ratio found.
        ratio: f64,
        /// The bar.
        bar: f64,
    },
    /// A result leaves the range of doubles.
    #[error("{what}: the result is too large for a double; scale the columns first (equilibrate)")]
    Overflow {
        /// The result.
        what: &'static str,
    },
}
