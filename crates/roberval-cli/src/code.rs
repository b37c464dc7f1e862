//! `roberval code`.

use std::io::Write;

use roberval_base::{Options, base_parameters, robot_sha256};
use roberval_code::{Code, Request};
use roberval_tables as tables;

use crate::arguments::CodeArgs;
use crate::commands::{answer, verdict, warn};
use crate::error::CliError;
use crate::look::Look;
use crate::robot::load;
use crate::say;

pub(crate) fn run(
    args: &CodeArgs,
    out: &mut dyn Write,
    err: &mut dyn Write,
    look: Look,
) -> Result<i32, CliError> {
    without_effect(args)?;
    let options = Options {
        choice: args.choice.choice()?,
        seed: args.choice.seed,
        ..Options::default()
    };
    let mut doubts = Vec::new();
    answer(&args.output, out, look, |format| {
        let mechanism = load(&args.robot.robot, &args.robot.reading)?;
        warn(&mechanism, err);
        let standard: Vec<usize> = (0..mechanism.parameters().len()).collect();
        let answer = base_parameters(&mechanism, &options)?;
        let reduced = !takes_standard(args);
        if reduced && !answer.diagnosis.clear {
            doubts.clone_from(&answer.diagnosis.messages);
        }
        let code = |columns: &[usize]| {
            let request = Request {
                what: args.what,
                columns,
                no_effect: &answer.no_effect,
                friction: args.friction,
            };
            Code::new(&mechanism, &request)
        };
        if args.counts {
            return Ok(tables::counts(
                &code(&standard)?,
                &code(&answer.base)?,
                format,
            ));
        }
        let code = code(if reduced { &answer.base } else { &standard })?;
        let (count, once) = (code.count(), code.count_once());
        say(
            err,
            "note",
            &format!(
                "{} multiplications, {} additions, {} sines and cosines a state; {} and {} once for \
                 a set of parameters",
                count.mul, count.add, count.trig, once.mul, once.add
            ),
        );
        Ok(code.text(args.lang.unwrap_or_default(), &robot_sha256(&mechanism)?))
    })?;
    Ok(verdict(&doubts, err))
}

fn takes_standard(args: &CodeArgs) -> bool {
    args.parameters.as_deref() == Some("standard")
}

/// Refuses options that the others leave nothing to do.
fn without_effect(args: &CodeArgs) -> Result<(), CliError> {
    let what = if !args.counts && args.output.format != tables::Format::default() {
        "--format is for the table of --counts: code has its --lang"
    } else if args.counts && (args.lang.is_some() || args.parameters.is_some()) {
        "--counts is the same in all languages and has standard and base parameters side by side: \
         leave out --lang and --parameters"
    } else if takes_standard(args) && args.choice.is_asked() {
        "--parameters standard takes all of them: --choice, --keep and --drop are for base parameters"
    } else if args.choice.paper_tolerance.is_some() {
        "code is made of what is decided exactly: leave out --paper-tolerance"
    } else {
        return Ok(());
    };
    Err(CliError::Usage(what.to_owned()))
}
