//! The subcommands.

use std::io::Write;
use std::ops::ControlFlow;
use std::path::Path;

use clap::CommandFactory;
use roberval_base::{Choice, Engine, ScalingOptions, base_parameters};
use roberval_formats::{catalogue, clean_file};
use roberval_mechanism::{CleanMode, Mechanism};
use roberval_symbolic::{Naming, Route, SymbolicOptions, symbolic_relations};
use roberval_tables::{self as tables, Format, RobotEntry};

use crate::arguments::{
    BaseArgs, CleanArgs, Cli, Command, CompareArgs, CompletionsArgs, OutputArgs, ScaleArgs,
    ShowArgs,
};
use crate::error::CliError;
use crate::look::Look;
use crate::output::Target;
use crate::robot::{load, policy};
use crate::{CLEAR, DOUBTFUL, code, demo, lint, regressor, say};

/// Runs a subcommand; gives the exit code.
pub(crate) fn execute(
    command: &Command,
    out: &mut dyn Write,
    err: &mut dyn Write,
    look: Look,
) -> Result<i32, CliError> {
    match command {
        Command::Demo(args) => demo::run(args, out),
        Command::Show(args) => show(args, out, look),
        Command::Lint(args) => lint::run(args, out, err, look),
        Command::Completions(args) => completions(args, out),
        Command::Base(args) => base(args, out, err, look),
        Command::Compare(args) => compare(args, out, err, look),
        Command::Clean(args) => clean(args, out, err),
        Command::Regressor(args) => regressor::run(args, out, err),
        Command::Scale(args) => scale(args, out, err, look),
        Command::Code(args) => code::run(args, out, err, look),
        Command::Reduce(_) => Err(CliError::Usage(
            "reduce is in the command of the Python package, not in this one".to_owned(),
        )),
    }
}

fn show(args: &ShowArgs, out: &mut dyn Write, look: Look) -> Result<i32, CliError> {
    answer(&args.output, out, look, |format| match &args.robot {
        Some(robot) => {
            let mechanism = load(robot, &args.reading)?;
            Ok(match args.order {
                Some(order) => tables::parameters(&mechanism, order, format),
                None => tables::show(&mechanism, format),
            })
        }
        None => Ok(list(format)),
    })?;
    Ok(CLEAR)
}

fn completions(args: &CompletionsArgs, out: &mut dyn Write) -> Result<i32, CliError> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "roberval", &mut script);
    Target::new(None)?.write(out, |sink| sink.write_all(&script))?;
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

fn base(
    args: &BaseArgs,
    out: &mut dyn Write,
    err: &mut dyn Write,
    look: Look,
) -> Result<i32, CliError> {
    if args.symbolic || args.rules {
        return symbolic(args, out, err, look);
    }
    if args.name_lengths || args.sympy.is_some() {
        let what = "--name-lengths and --sympy go with --symbolic or --rules".to_owned();
        return Err(CliError::Usage(what));
    }
    let options = args.method.options(&args.choice)?;
    let certificate = beside("--certificate", args.certificate.as_deref())?;
    let report = beside("--report", args.report.as_deref())?;
    let (mut doubts, mut refused) = (Vec::new(), None);
    answer(&args.output, out, look, |format| {
        let mechanism = load(&args.robot.robot, &args.robot.reading)?;
        warn(&mechanism, err);
        let answer = base_parameters(&mechanism, &options)?;
        for warning in answer.warnings() {
            say(err, "warning", &warning);
        }
        let messages = &answer.diagnosis.messages;
        if answer.diagnosis.clear {
            messages.iter().for_each(|m| say(err, "note", m));
        } else {
            doubts.clone_from(messages);
        }
        if let Some(target) = &certificate {
            match answer.certificate() {
                Ok(text) => {
                    target.write(&mut std::io::sink(), |sink| sink.write_all(text.as_bytes()))?;
                }
                // The answer itself is none the worse for it.
                Err(error) => refused = Some(error),
            }
        }
        if let Some(target) = &report {
            let page = tables::report(&answer);
            target.write(&mut std::io::sink(), |sink| sink.write_all(page.as_bytes()))?;
            if let Some(path) = &args.report {
                let what = format!("wrote {}: open it in a browser", path.display());
                say(err, "note", &what);
            }
        }
        Ok(tables::base(&answer, format))
    })?;
    let code = verdict(&doubts, err);
    refused.map_or(Ok(code), |error| Err(error.into()))
}

fn symbolic(
    args: &BaseArgs,
    out: &mut dyn Write,
    err: &mut dyn Write,
    look: Look,
) -> Result<i32, CliError> {
    if args.certificate.is_some() || args.report.is_some() {
        let what =
            "--certificate and --report are written without --symbolic and --rules".to_owned();
        return Err(CliError::Usage(what));
    }
    if args.symbolic && args.rules {
        let what = "--rules is what the rules alone say, --symbolic is all: ask for one of them";
        return Err(CliError::Usage(what.to_owned()));
    }
    let options = args.method.options(&args.choice)?;
    let exact = args.method.engine == Engine::default() && args.method.rows.is_none();
    if !exact || args.choice.paper_tolerance.is_some() {
        let what = "--symbolic and --rules decide exactly, without samples in floats: leave out \
                    --engine, --rows and --paper-tolerance";
        return Err(CliError::Usage(what.to_owned()));
    }
    let sympy = beside("--sympy", args.sympy.as_deref())?;
    answer(&args.output, out, look, |format| {
        let mechanism = load(&args.robot.robot, &args.robot.reading)?;
        warn(&mechanism, err);
        // The paper's choice needs no answer in numbers before.
        let order = match options.choice {
            Choice::Paper => None,
            _ => base_parameters(&mechanism, &options)?
                .decision
                .map(|d| d.order),
        };
        let options = SymbolicOptions {
            route: match args.rules {
                true => Route::RulesAlone,
                false => Route::Whole,
            },
            model: options.model,
            naming: match args.name_lengths {
                true => Naming::All,
                false => Naming::Auto,
            },
            order,
            seed: options.seed,
        };
        let answer = symbolic_relations(&mechanism, &options)?;
        if let Some(target) = &sympy {
            let text = tables::sympy(&answer);
            target.write(&mut std::io::sink(), |sink| sink.write_all(text.as_bytes()))?;
        }
        Ok(tables::symbolic(&answer, format))
    })?;
    Ok(CLEAR)
}

/// The target of a file that is written beside the result.
fn beside(option: &str, path: Option<&Path>) -> Result<Option<Target>, CliError> {
    if path.is_some_and(|path| path == Path::new("-")) {
        let what = format!("{option} needs a file: the standard output is the result's");
        return Err(CliError::Usage(what));
    }
    path.map(|path| Target::new(Some(path))).transpose()
}

fn clean(args: &CleanArgs, out: &mut dyn Write, err: &mut dyn Write) -> Result<i32, CliError> {
    let target = Target::new(args.output.as_deref())?;
    let mode = if args.aggressive {
        CleanMode::Aggressive
    } else {
        CleanMode::Default
    };
    let (text, changes, near_misses) = clean_file(&args.robot, &policy(mode))?;
    for change in changes.iter().filter(|c| !c.is_last_digit()) {
        say(err, "changed", &change.to_string());
    }
    for near_miss in &near_misses {
        say(err, "warning", &near_miss.to_string());
    }
    let exact = changes.iter().filter(|c| c.is_last_digit()).count();
    say(err, "note", &tally(changes.len() - exact, exact));
    target.write(out, |sink| sink.write_all(text.as_bytes()))?;
    Ok(CLEAR)
}

/// `2 numbers were changed; 1 was exact to the last digit`.
fn tally(changed: usize, exact: usize) -> String {
    let changed = match changed {
        0 => "no number was changed".to_owned(),
        1 => "1 number was changed".to_owned(),
        n => format!("{n} numbers were changed"),
    };
    match exact {
        0 => changed,
        1 => format!("{changed}; 1 was exact to the last digit"),
        n => format!("{changed}; {n} were exact to the last digit"),
    }
}

fn compare(
    args: &CompareArgs,
    out: &mut dyn Write,
    err: &mut dyn Write,
    look: Look,
) -> Result<i32, CliError> {
    let (choice, tolerance) = (args.choice.choice()?, args.choice.tolerance());
    let mut doubts = Vec::new();
    answer(&args.output, out, look, |format| {
        let mechanism = load(&args.robot.robot, &args.robot.reading)?;
        warn(&mechanism, err);
        let comparison = roberval_base::compare(&mechanism, &choice, tolerance, args.choice.seed)?;
        doubts = tables::doubts(&comparison);
        Ok(tables::compare(&comparison, format))
    })?;
    Ok(verdict(&doubts, err))
}

fn scale(
    args: &ScaleArgs,
    out: &mut dyn Write,
    err: &mut dyn Write,
    look: Look,
) -> Result<i32, CliError> {
    let options = ScalingOptions {
        model: args.model,
        seed: args.seed,
        rows: args.rows,
        target: args.target,
        ..ScalingOptions::default()
    };
    let mut doubts = Vec::new();
    answer(&args.output, out, look, |format| {
        let mechanism = load(&args.robot.robot, &args.robot.reading)?;
        warn(&mechanism, err);
        let scaling = roberval_base::scale(&mechanism, &options, |_| ControlFlow::Continue(()))?;
        let (before, after) = (scaling.before.rank, scaling.after.rank);
        if before != after {
            doubts.push(format!(
                "the rank is {before} at random samples and {after} at those found"
            ));
        }
        Ok(tables::scale(&mechanism, &options, &scaling, format))
    })?;
    Ok(verdict(&doubts, err))
}

/// Computes a text and writes it where it belongs; a bad `-o` is told before computing.
pub(crate) fn answer(
    output: &OutputArgs,
    out: &mut dyn Write,
    look: Look,
    compute: impl FnOnce(Format) -> Result<String, CliError>,
) -> Result<(), CliError> {
    let target = Target::new(output.output.as_deref())?;
    let format = match (&target, output.format) {
        (Target::Stdout, Format::Table) if look.colour => Format::Coloured,
        (_, format) => format,
    };
    let text = look.during(|| compute(format))?;
    target.write(out, |sink| sink.write_all(text.as_bytes()))
}

/// Tells what the reader of the robot file noticed.
pub(crate) fn warn(mechanism: &Mechanism, err: &mut dyn Write) {
    for warning in &mechanism.description.warnings {
        say(err, "warning", warning);
    }
}

/// Tells the doubts; gives the exit code.
pub(crate) fn verdict(doubts: &[String], err: &mut dyn Write) -> i32 {
    for doubt in doubts {
        say(err, "doubt", doubt);
    }
    if doubts.is_empty() { CLEAR } else { DOUBTFUL }
}
