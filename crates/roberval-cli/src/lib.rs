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
mod states;

use std::ffi::OsString;
use std::io::{self, Write};

use clap::Parser;
use roberval_tables::printable;

use arguments::Cli;
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
    let result = match Cli::try_parse_from(args) {
        Ok(cli) => commands::execute(&cli.command, out, err, look),
        Err(error) if error.use_stderr() => {
            // Nobody is left to tell if even this cannot be written.
            let _ = write!(err, "{}", error.render());
            let refused = error.get(clap::error::ContextKind::InvalidValue);
            if refused.is_some_and(|value| value.to_string() == "sympy") {
                say(
                    err,
                    "note",
                    "base --symbolic --sympy FILE writes a module for SymPy",
                );
            }
            return BAD_INPUT;
        }
        Err(help) => write!(out, "{}", help.render())
            .and_then(|()| out.flush())
            .map(|()| CLEAR)
            .map_err(CliError::Stdout),
    };
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
