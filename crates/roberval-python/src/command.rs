//! The `roberval` command, as the wheel's script calls it.

use std::ffi::OsString;

use pyo3::prelude::*;

/// Runs the command line with these arguments (without the program's name) on the
/// process's own stdout and stderr; gives the exit code.
#[pyfunction]
pub fn run_cli(py: Python<'_>, arguments: Vec<OsString>) -> i32 {
    let arguments = [OsString::from("roberval")].into_iter().chain(arguments);
    py.detach(|| {
        let (mut out, mut err) = (std::io::stdout().lock(), std::io::stderr());
        roberval_cli::run(
            arguments,
            &mut out,
            &mut err,
            roberval_cli::Look::of_terminal(),
        )
    })
}
