//! `roberval code`.

use std::io::Write;

use roberval_base::{Engine, Model, Options, base_parameters, robot_sha256};
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
    if !args.counts && args.output.format != tables::Format::default() {
        let what = "--format is for the table of --counts: code has its --lang";
        return Err(CliError::Usage(what.to_owned()));
    }
    let options = Options {
        model: Model::D,
        engine: Engine::Exact,
        choice: args.choice.choice()?,
        tolerance: args.choice.tolerance(),
        seed: args.choice.seed,
        rows: None,
    };
    let mut doubts = Vec::new();
    answer(&args.output, out, look, |format| {
        let mechanism = load(&args.robot.robot, &args.robot.reading)?;
        warn(&mechanism, err);
        let standard: Vec<usize> = (0..mechanism.parameters().len()).collect();
        let answer = base_parameters(&mechanism, &options)?;
        let reduced = args.parameters == "base" || args.counts;
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
        Ok(code.text(args.lang, &robot_sha256(&mechanism)?))
    })?;
    Ok(verdict(&doubts, err))
}
