//! The subcommands.

use std::io::Write;

use roberval_base::base_parameters;
use roberval_tables as tables;

use crate::arguments::{BaseArgs, Command, ShowArgs};
use crate::error::CliError;
use crate::output::Target;
use crate::robot::load;
use crate::{CLEAR, DOUBTFUL, say};

/// Runs a subcommand; gives the exit code.
pub(crate) fn execute(
    command: &Command,
    out: &mut dyn Write,
    err: &mut dyn Write,
) -> Result<i32, CliError> {
    match command {
        Command::Show(args) => show(args, out, err),
        Command::Base(args) => base(args, out, err),
    }
}

fn show(args: &ShowArgs, out: &mut dyn Write, err: &mut dyn Write) -> Result<i32, CliError> {
    let _ = (args, out, err);
    Ok(CLEAR)
}

fn base(args: &BaseArgs, out: &mut dyn Write, err: &mut dyn Write) -> Result<i32, CliError> {
    let options = args.method.options(&args.choice)?;
    let target = Target::new(args.output.output.as_deref())?;
    let (description, mechanism) = load(&args.robot.robot, &args.robot.reading, err)?;
    let answer = base_parameters(&mechanism, &options)?;
    let text = tables::base(&answer, &description.warnings, args.output.format);
    target.write(out, |sink| sink.write_all(text.as_bytes()))?;
    for message in &answer.diagnosis.messages {
        say(err, "doubt", message);
    }
    Ok(if answer.diagnosis.clear {
        CLEAR
    } else {
        DOUBTFUL
    })
}
