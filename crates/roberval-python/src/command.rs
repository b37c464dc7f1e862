//! The `roberval` command, as the wheel's script calls it.

use std::ffi::OsString;

use pyo3::prelude::*;
use roberval_formats::{self as formats, Kind};

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

/// From now on reads this text, robot TOML (or URDF), where the file of this path is asked for.
#[pyfunction]
pub fn read_instead(path: &str, urdf: bool, text: String) {
    let kind = if urdf { Kind::Urdf } else { Kind::Toml };
    formats::read_instead(path, kind, text);
}
