//! The `roberval` command line, as one function: [`run`].
//!
//! The result alone goes to `out`, what there is to say about it to `err`.

mod arguments;
mod code;
mod commands;
mod demo;
mod error;
mod lint;
mod look;
mod output;
mod regressor;
mod robot;
pub mod states;

use std::ffi::OsString;
use std::io::{self, Write};

use clap::Parser;
use roberval_tables::printable;

use arguments::{Cli, Command};
pub use arguments::{Gravity, ReadingArgs, ReduceArgs, Weights};
use error::CliError;
pub use look::Look;

/// The answer is sure.
const CLEAR: i32 = 0;
/// Findings in a robot file.
const FOUND: i32 = 1;
/// There is an answer, but its rank is doubtful or the engines disagree.
const DOUBTFUL: i32 = 1;
/// Bad input: no answer.
const BAD_INPUT: i32 = 2;

/// Runs a command line; `args` begin with the program's name.
///
/// Gives the exit code: 0 clear, 1 computed but doubtful or engines disagree, 2 bad
/// input; `lint`: 0 nothing found, 1 findings, 2 a file cannot be read. A reader that goes
/// away (broken pipe) is no error.
pub fn run(
    args: impl IntoIterator<Item = OsString>,
    out: &mut dyn Write,
    err: &mut dyn Write,
    look: Look,
) -> i32 {
    let result = match parsed(args, out, err) {
        Ok(cli) => commands::execute(&cli.command, out, err, look),
        Err(result) => result,
    };
    ended(result, err)
}

/// What `roberval reduce`, which Python runs, was asked; or the exit code where it was asked
/// nothing, or for help alone.
///
/// # Errors
/// The exit code, when all is said.
pub fn reduce_arguments(
    args: impl IntoIterator<Item = OsString>,
    out: &mut dyn Write,
    err: &mut dyn Write,
) -> Result<ReduceArgs, i32> {
    match parsed(args, out, err) {
        Ok(Cli {
            command: Command::Reduce(asked),
        }) => Ok(asked),
        Ok(_) => Err(BAD_INPUT),
        Err(result) => Err(ended(result, err)),
    }
}

/// The command line; or, all being said, how it ends.
fn parsed(
    args: impl IntoIterator<Item = OsString>,
    out: &mut dyn Write,
    err: &mut dyn Write,
) -> Result<Cli, Result<i32, CliError>> {
    let told = match Cli::try_parse_from(args) {
        Ok(cli) => return Ok(cli),
        Err(told) => told,
    };
    if !told.use_stderr() {
        return Err(write!(out, "{}", told.render())
            .and_then(|()| out.flush())
            .map(|()| CLEAR)
            .map_err(CliError::Stdout));
    }
    // Nobody is left to tell if even this cannot be written.
    let _ = write!(err, "{}", told.render());
    let refused = told.get(clap::error::ContextKind::InvalidValue);
    if refused.is_some_and(|value| value.to_string() == "sympy") {
        say(
            err,
            "note",
            "base --symbolic --sympy FILE writes a module for SymPy",
        );
    }
    Err(Ok(BAD_INPUT))
}

/// The exit code; an error is told.
fn ended(result: Result<i32, CliError>, err: &mut dyn Write) -> i32 {
    match result {
        Ok(code) => code,
        Err(CliError::Stdout(error)) if error.kind() == io::ErrorKind::BrokenPipe => CLEAR,
        Err(error) => {
            say(err, "error", &error.to_string());
            BAD_INPUT
        }
    }
}

/// One line of diagnosis.
fn say(err: &mut dyn Write, what: &str, message: &str) {
    // A closed stderr must not hide the result.
    let _ = writeln!(err, "roberval: {what}: {}", printable(message));
}
