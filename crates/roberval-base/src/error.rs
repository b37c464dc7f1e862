use roberval_linalg::LinalgError;
use roberval_mechanism::MechanismError;
use roberval_regressor::RegressorError;

use crate::{ExactError, SampleError};

/// Why base parameters could not be computed. A doubtful rank is not an error but a
/// [`crate::Diagnosis`].
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BaseError {
    /// A preference names a parameter that the robot does not have.
    #[error("the robot has no parameter \"{label}\"{}", hint(nearest))]
    UnknownParameter {
        /// The label asked for.
        label: String,
        /// The closest labels.
        nearest: Vec<String>,
    },
    /// A parameter is to be kept and dropped.
    #[error("\"{label}\" is asked to be kept and to be dropped: leave it in one list")]
    KeptAndDropped {
        /// The label.
        label: String,
    },
    /// Fewer rows than columns cannot show the rank.
    #[error(
        "W has {rows} rows for {columns} parameters with an effect: ask for at least {columns}, better twice that many (the default)"
    )]
    TooFewRows {
        /// Rows of W.
        rows: usize,
        /// Columns with an effect, c.
        columns: usize,
    },
    /// More samples than can be stored.
    #[error("{rows} rows are more than fit in memory; at most {most} are taken")]
    TooManyRows {
        /// Rows asked for.
        rows: usize,
        /// The limit.
        most: usize,
    },
    /// An array of parameters has the wrong length.
    #[error("{array} has {found} values, expected {expected}: {meaning}")]
    Length {
        /// Which array.
        array: &'static str,
        /// What its entries are.
        meaning: String,
        /// Entries expected.
        expected: usize,
        /// Entries found.
        found: usize,
    },
    /// The user stopped a search.
    #[error("stopped after {done} of at most {most} searches for samples")]
    Stopped {
        /// Searches done.
        done: usize,
        /// Searches at most.
        most: usize,
    },
    /// The states do not fit the robot.
    #[error(transparent)]
    Regressor(#[from] RegressorError),
    /// The description as written is no mechanism.
    #[error(transparent)]
    Mechanism(#[from] MechanismError),
    /// The exact engine has no answer.
    #[error(transparent)]
    Exact(#[from] ExactError),
    /// Loops without configurations to sample.
    #[error(transparent)]
    Samples(#[from] SampleError),
    /// Loops are not searched for scaled samples.
    #[error("the search for scaled samples would open the robot's loops: take random samples")]
    LoopsNotScaled,
    /// A factorisation failed.
    #[error(transparent)]
    Linalg(#[from] LinalgError),
}

fn hint(nearest: &[String]) -> String {
    if nearest.is_empty() {
        return String::new();
    }
    format!("; did you mean {}?", nearest.join(" or "))
}
