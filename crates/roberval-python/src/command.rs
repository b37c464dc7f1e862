//! The `roberval` command, as the wheel's script calls it.

use pyo3::prelude::*;

/// Runs the command line; the exit code comes back.
#[pyfunction]
pub fn run_cli(py: Python<'_>, arguments: Vec<String>) -> u8 {
    py.detach(|| {
        let _ = arguments;
        2
    })
}
