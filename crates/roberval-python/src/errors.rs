//! The one place where errors of Rust become exceptions of Python.

use pyo3::prelude::*;
use pyo3::types::PyType;
use roberval_base::{BaseError, CertificateError};
use roberval_formats::FormatError;
use roberval_mechanism::MechanismError;
use roberval_regressor::RegressorError;
use roberval_symbolic::SymbolicError;

/// An error that knows its Python class, one of `roberval.errors`.
pub trait IntoPython {
    /// The Python exception.
    fn into_python(self, py: Python<'_>) -> PyErr;
}

/// The exception `roberval.errors.<class>` with this message.
pub fn raise(py: Python<'_>, class: &str, message: &str) -> PyErr {
    let class = py
        .import("roberval.errors")
        .and_then(|errors| errors.getattr(class))
        .and_then(|class| Ok(class.cast_into::<PyType>()?));
    match class {
        Ok(class) => PyErr::from_type(class, message.to_owned()),
        Err(error) => error,
    }
}

impl IntoPython for FormatError {
    /// `RobotError` with the attributes `code`, `file`, `line` and `column`.
    fn into_python(self, py: Python<'_>) -> PyErr {
        let error = raise(py, "RobotError", &self.to_string());
        let value = error.value(py);
        let (line, column) = self.position.map(|p| (p.line, p.column)).unzip();
        let set = value
            .setattr("code", self.code.to_string())
            .and_then(|()| value.setattr("file", self.file))
            .and_then(|()| value.setattr("line", line))
            .and_then(|()| value.setattr("column", column));
        set.err().unwrap_or(error)
    }
}

impl IntoPython for MechanismError {
    fn into_python(self, py: Python<'_>) -> PyErr {
        raise(py, "RobotError", &self.to_string())
    }
}

impl IntoPython for SymbolicError {
    fn into_python(self, py: Python<'_>) -> PyErr {
        let class = match self {
            Self::NotVerified { .. } => "InternalError",
            _ => "RobotError",
        };
        raise(py, class, &self.to_string())
    }
}

impl IntoPython for RegressorError {
    fn into_python(self, py: Python<'_>) -> PyErr {
        let class = match self {
            Self::Length { .. } => "ShapeError",
            Self::NotFinite { .. }
            | Self::NotZero { .. }
            | Self::Quaternion { .. }
            | Self::NoValue { .. } => "ArrayError",
        };
        raise(py, class, &self.to_string())
    }
}

impl IntoPython for CertificateError {
    fn into_python(self, py: Python<'_>) -> PyErr {
        let class = match self {
            Self::NotExact | Self::Loops => "OptionError",
            Self::TooLong { .. } | Self::Couple { .. } => "RobotError",
            Self::Unsure { .. } => "NumericalError",
        };
        raise(py, class, &self.to_string())
    }
}

impl IntoPython for BaseError {
    fn into_python(self, py: Python<'_>) -> PyErr {
        let class = match self {
            Self::Regressor(error) => return error.into_python(py),
            Self::Mechanism(error) => return error.into_python(py),
            Self::UnknownParameter { .. } => "UnknownParameterError",
            Self::KeptAndDropped { .. }
            | Self::TooFewRows { .. }
            | Self::TooManyRows { .. }
            | Self::LoopsNotScaled => "OptionError",
            Self::Samples(_) => "RobotError",
            Self::Length { .. } => "ShapeError",
            Self::Stopped { .. } | Self::Exact(_) | Self::Linalg(_) => "NumericalError",
        };
        raise(py, class, &self.to_string())
    }
}
