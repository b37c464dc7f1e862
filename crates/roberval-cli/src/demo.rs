//! `roberval demo`: what it is about, in a minute.

use std::io::Write;
use std::path::Path;

use roberval_base::{BaseParameters, Options, base_parameters};
use roberval_mechanism::CleanMode;
use roberval_tables as tables;

use crate::CLEAR;
use crate::arguments::{DemoArgs, ReadingArgs};
use crate::error::CliError;
use crate::output::Target;
use crate::robot::load;

/// The robot of the paper.
const ROBOT: &str = "puma560";

/// Relations that are shown.
const SHOWN: usize = 3;

pub(crate) fn run(args: &DemoArgs, out: &mut dyn Write) -> Result<i32, CliError> {
    let target = Target::new(Some(&args.output))?;
    let reading = ReadingArgs {
        keep_fixed: false,
        floating: false,
        no_rotors: false,
        snap: CleanMode::Default,
        gravity: None,
    };
    let mechanism = load(ROBOT, &reading)?;
    let answer = base_parameters(&mechanism, &Options::default())?;
    let page = tables::report(&answer);
    target.write(&mut std::io::sink(), |sink| sink.write_all(page.as_bytes()))?;
    let text = tour(&answer, &args.output);
    Target::new(None)?.write(out, |sink| sink.write_all(text.as_bytes()))?;
    Ok(CLEAR)
}

fn tour(answer: &BaseParameters, report: &Path) -> String {
    let tally = answer.tally();
    let relations = tables::relations(answer);
    let shown: Vec<String> = relations
        .iter()
        .rev()
        .take(SHOWN)
        .map(|r| format!("    {r}"))
        .collect();
    format!(
        "\
The {name}: {links} links. Each has eleven standard inertial parameters: six of its inertia
(XX XY XZ YY YZ ZZ), three first moments (MX MY MZ), its mass M and the inertia of its
motor's rotor, Ia. That makes {standard}. Which of them can be measured by moving the robot?

    $ roberval base {ROBOT}

{no_effect} have no effect on any motion. Of the other {effect}, only {base} combinations act: these are the
base parameters. {unchanged} are parameters as they stand, {into} are sums, such as

{shown}

No measurement, however precise, can tell YY_6 from XX_6: only their difference acts. This was
decided exactly, from the geometry alone; no inertial value was needed.

Wrote {report}: open it in a browser to see all of it.

Next:
    roberval base your_robot.urdf --report report.html    the same for your robot
    roberval lint your_robot.urdf                         what is wrong in the file
    roberval show                                         the other built-in robots
    roberval base --help                                  choices, engines, certificates
",
        name = answer.mechanism.name,
        links = answer.mechanism.links.len(),
        standard = tally.standard,
        no_effect = tally.no_effect,
        effect = tally.base + tally.regrouped,
        base = tally.base,
        unchanged = tally.unchanged,
        into = tally.regrouped_into,
        shown = shown.join("\n"),
        report = report.display(),
    )
}
