//! The `roberval` command line.

mod arguments;

use std::ffi::OsString;
use std::io::Write;

use clap::Parser;
use roberval_base::base_parameters;
use roberval_formats::load;
use roberval_mechanism::Mechanism;

use arguments::{Cli, Command};

pub fn run(
    args: impl IntoIterator<Item = OsString>,
    out: &mut dyn Write,
    err: &mut dyn Write,
) -> i32 {
    0
}
