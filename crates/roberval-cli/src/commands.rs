//! The subcommands.

use std::io::Write;

use roberval_base::base_parameters;
use roberval_formats::catalogue;
use roberval_mechanism::Mechanism;
use roberval_tables::{self as tables, Format, RobotEntry};

use crate::arguments::{BaseArgs, Command, CompareArgs, OutputArgs, ShowArgs};
use crate::error::CliError;
use crate::output::Target;
use crate::robot::load;
use crate::{CLEAR, DOUBTFUL, regressor, say};

/// Runs a subcommand; gives the exit code.
pub(crate) fn execute(
    command: &Command,
    out: &mut dyn Write,
    err: &mut dyn Write,
) -> Result<i32, CliError> {
    match command {
        Command::Show(args) => show(args, out),
        Command::Base(args) => base(args, out, err),
        Command::Compare(args) => compare(args, out, err),
        Command::Regressor(args) => regressor::run(args, out, err),
    }
}

fn show(args: &ShowArgs, out: &mut dyn Write) -> Result<i32, CliError> {
    answer(&args.output, out, |format| match &args.robot {
        Some(robot) => Ok(tables::show(&load(robot, &args.reading)?, format)),
        None => Ok(list(format)),
    })?;
    Ok(CLEAR)
}

/// The built-in robots.
fn list(format: Format) -> String {
    let entry = |e: &roberval_formats::CatalogueEntry| RobotEntry {
        name: e.name,
        title: e.title,
        source: e.source,
    };
    let robots: Vec<RobotEntry> = catalogue().iter().map(entry).collect();
    tables::catalogue(&robots, format)
}

fn base(args: &BaseArgs, out: &mut dyn Write, err: &mut dyn Write) -> Result<i32, CliError> {
    let options = args.method.options(&args.choice)?;
    let mut doubts = Vec::new();
    answer(&args.output, out, |format| {
        let mechanism = load(&args.robot.robot, &args.robot.reading)?;
        warn(&mechanism, err);
        let answer = base_parameters(&mechanism, &options)?;
        doubts.clone_from(&answer.diagnosis.messages);
        Ok(tables::base(&answer, format))
    })?;
    Ok(verdict(&doubts, err))
}

fn compare(args: &CompareArgs, out: &mut dyn Write, err: &mut dyn Write) -> Result<i32, CliError> {
    let (choice, tolerance) = (args.choice.choice()?, args.choice.tolerance());
    let mut doubts = Vec::new();
    answer(&args.output, out, |format| {
        let mechanism = load(&args.robot.robot, &args.robot.reading)?;
        warn(&mechanism, err);
        let comparison = roberval_base::compare(&mechanism, &choice, tolerance, args.choice.seed)?;
        doubts = tables::doubts(&comparison);
        Ok(tables::compare(&comparison, format))
    })?;
    Ok(verdict(&doubts, err))
}

/// Computes a text and writes it where it belongs; a bad `-o` is told before computing.
fn answer(
    output: &OutputArgs,
    out: &mut dyn Write,
    compute: impl FnOnce(Format) -> Result<String, CliError>,
) -> Result<(), CliError> {
    let target = Target::new(output.output.as_deref())?;
    let text = compute(output.format)?;
    target.write(out, |sink| sink.write_all(text.as_bytes()))
}

/// Tells what the reader of the robot file noticed.
fn warn(mechanism: &Mechanism, err: &mut dyn Write) {
    for warning in &mechanism.description.warnings {
        say(err, "warning", warning);
    }
}

/// Tells the doubts; gives the exit code.
fn verdict(doubts: &[String], err: &mut dyn Write) -> i32 {
    for doubt in doubts {
        say(err, "doubt", doubt);
    }
    if doubts.is_empty() { CLEAR } else { DOUBTFUL }
}
