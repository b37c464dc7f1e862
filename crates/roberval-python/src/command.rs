//! The `roberval` command, as the wheel's script calls it.

use std::ffi::OsString;

use std::path::PathBuf;

use pyo3::prelude::*;
use roberval_cli::{ReduceArgs, Weights};
use roberval_formats::{self as formats, Kind};
use roberval_mechanism::CleanMode;

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

/// What `roberval reduce` was asked: a dict, but for the exit code where there is nothing to do.
#[derive(IntoPyObject)]
pub enum Asked {
    Reduce(ReduceArguments),
    Code(i32),
}

#[derive(IntoPyObject)]
pub struct ReduceArguments {
    robot: String,
    samples: Vec<PathBuf>,
    output: PathBuf,
    base: bool,
    friction: Vec<String>,
    /// Numbers, or none where they are in columns.
    weights: Option<Vec<f64>>,
    weight_columns: bool,
    threads: Option<usize>,
    checkpoint: Option<PathBuf>,
    quiet: bool,
    keep_fixed: bool,
    floating: bool,
    rotors: bool,
    snap: &'static str,
    gravity: Option<[String; 3]>,
}

impl From<ReduceArgs> for ReduceArguments {
    fn from(asked: ReduceArgs) -> Self {
        let reading = asked.reading;
        Self {
            robot: asked.robot,
            samples: asked.samples,
            output: asked.output,
            base: asked.base,
            friction: asked.friction,
            weight_columns: asked.weights == Some(Weights::Columns),
            weights: match asked.weights {
                Some(Weights::Rows(weights)) => Some(weights),
                _ => None,
            },
            threads: asked.threads,
            checkpoint: asked.checkpoint,
            quiet: asked.quiet,
            keep_fixed: reading.keep_fixed,
            floating: reading.floating,
            rotors: !reading.no_rotors,
            snap: match reading.snap {
                CleanMode::Off => "off",
                CleanMode::Default => "default",
                CleanMode::Aggressive => "aggressive",
            },
            gravity: reading.gravity.map(|g| g.0.map(|number| number.text)),
        }
    }
}

/// Reads the arguments of `roberval reduce` (which come first in `arguments`) as those of
/// other commands are read.
#[pyfunction]
pub fn reduce_arguments(arguments: Vec<OsString>) -> Asked {
    let arguments = [OsString::from("roberval")].into_iter().chain(arguments);
    let (mut out, mut err) = (std::io::stdout(), std::io::stderr());
    match roberval_cli::reduce_arguments(arguments, &mut out, &mut err) {
        Ok(asked) => Asked::Reduce(asked.into()),
        Err(code) => Asked::Code(code),
    }
}
