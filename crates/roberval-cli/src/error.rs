use std::io;
use std::path::PathBuf;

use roberval_base::{BaseError, CertificateError};
use roberval_code::CodeError;
use roberval_formats::FormatError;
use roberval_mechanism::MechanismError;
use roberval_symbolic::SymbolicError;

use crate::states::StatesError;

/// Why there is no answer.
#[derive(Debug, thiserror::Error)]
pub(crate) enum CliError {
    /// The robot file.
    #[error(transparent)]
    Format(#[from] FormatError),
    /// The robot.
    #[error("{robot}: {error}")]
    Mechanism {
        robot: String,
        error: MechanismError,
    },
    /// The method.
    #[error(transparent)]
    Base(#[from] BaseError),
    /// The certificate.
    #[error(transparent)]
    Certificate(#[from] CertificateError),
    /// Relations in symbols.
    #[error(transparent)]
    Symbolic(#[from] SymbolicError),
    /// Generated code.
    #[error(transparent)]
    Code(#[from] CodeError),
    /// The file of joint states.
    #[error(transparent)]
    States(#[from] StatesError),
    /// Options that do not go together.
    #[error("{0}")]
    Usage(String),
    /// The file asked for by `-o`.
    #[error("{}: {what}", path.display())]
    Output { path: PathBuf, what: String },
    /// The standard output.
    #[error("the standard output cannot be written: {0}")]
    Stdout(#[source] io::Error),
}
