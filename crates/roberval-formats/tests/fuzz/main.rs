//! Mutated files and expressions: no panic, no hang, every error with a code, a place and
//! one line; everything that is accepted keeps the readers' promises.
//!
//! The short form runs with the other tests. The long form:
//! `ROBERVAL_FUZZ_SECONDS=600 ROBERVAL_FUZZ_SEED=1 cargo test -p roberval-formats --test fuzz`.

mod mutate;

use std::collections::HashSet;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use roberval_formats::{
    FormatError, RobotDescription, UrdfOptions, catalogue, clean_toml, clean_urdf, parse_toml,
    parse_urdf, to_toml,
};
use roberval_mechanism::{CleanPolicy, Mechanism, clean};
use roberval_scalar::{LiteralFault, Quantity, SplitMix64};

/// Inputs of the short form, a few seconds.
const SHORT: u64 = 10_000;

/// No input of at most 64 KiB takes a second; this is a hang, on any machine.
const HANG: Duration = Duration::from_secs(60);

/// The most texts that are kept as a start for further ones.
const CORPUS: usize = 2000;

/// Feeds mutated texts to `check` on a thread of its own. A check answers with the kind
/// of its outcome; a text with an outcome not seen before joins the corpus, so that the
/// readers' later checks are reached too.
fn fuzz(seeds: Vec<String>, check: fn(&str) -> String) {
    let seconds = number("ROBERVAL_FUZZ_SECONDS");
    let mut random = SplitMix64::new(number("ROBERVAL_FUZZ_SEED").unwrap_or(1991));
    let until = seconds.map(|s| Instant::now() + Duration::from_secs(s));
    let input = Arc::new(Mutex::new(String::new()));
    let shown = Arc::clone(&input);
    let (done, heartbeat) = channel();
    let worker = std::thread::spawn(move || {
        let mut corpus = seeds;
        let mut seen: HashSet<String> = corpus.iter().map(|text| check(text)).collect();
        let mut count = 0;
        while until.map_or(count < SHORT, |end| Instant::now() < end) {
            let text = mutate::mutated(&corpus, &mut random);
            input.lock().unwrap().clone_from(&text);
            if seen.insert(check(&text)) && corpus.len() < CORPUS {
                corpus.push(text);
            }
            count += 1;
            let _ = done.send(());
        }
        (count, seen.len())
    });
    loop {
        match heartbeat.recv_timeout(HANG) {
            Ok(()) => {}
            Err(RecvTimeoutError::Disconnected) => break,
            Err(RecvTimeoutError::Timeout) => panic!("hangs: {:?}", shown.lock().unwrap()),
        }
    }
    match worker.join() {
        Ok((count, kinds)) => println!("{count} inputs, {kinds} kinds of outcome"),
        Err(_) => panic!("panics: {:?}", shown.lock().unwrap()),
    }
}

fn number(variable: &str) -> Option<u64> {
    std::env::var(variable).ok()?.parse().ok()
}

/// What every error must be; gives its kind, the message without names and numbers.
fn check_error(error: &FormatError, text: &str) -> String {
    let line = error.to_string();
    assert!(line.chars().count() < 1500, "{line:.200}");
    assert!(!line.contains(char::is_control), "{line:?}");
    assert!(line.starts_with("fuzz:") && line.contains(&format!("[{}]", error.code)));
    assert!((100..700).contains(&(error.code as u16)));
    assert!(!error.what.is_empty());
    if let Some(position) = error.position {
        let lines = text.split('\n').count();
        assert!(
            position.line >= 1 && position.line as usize <= lines,
            "{line}"
        );
        assert!(position.column >= 1 && position.column as usize <= text.len() + 1);
    }
    let mut quoted = false;
    let mut kind = line;
    kind.retain(|c| {
        quoted ^= c == '"';
        !quoted && !c.is_ascii_digit()
    });
    kind
}

/// What every accepted robot must be.
fn check_robot(robot: &RobotDescription) {
    assert!(robot.antecedents().is_ok());
    let inertias = robot
        .links
        .iter()
        .flat_map(|link| link.inertia.iter().flatten());
    let finite = |x: &Quantity| x.value.is_finite();
    assert!(robot.gravity.iter().chain(inertias).all(finite));
    assert!(robot.warnings.iter().all(|w| !w.contains(char::is_control)));
    // A robot may be refused later (no moving joint), but must not panic.
    let _ = Mechanism::new(robot);
    for policy in [CleanPolicy::default(), CleanPolicy::aggressive()] {
        let cleaned = clean(robot, &policy);
        assert!(clean(&cleaned.description, &policy).changes.is_empty());
    }
}

fn check_urdf(text: &str) -> String {
    let kept = UrdfOptions {
        keep_fixed: true,
        floating: true,
    };
    let lumped = parse_urdf(text, "fuzz", UrdfOptions::default());
    if let Ok(robot) = parse_urdf(text, "fuzz", kept) {
        check_robot(&robot);
    }
    match lumped {
        Err(error) => check_error(&error, text),
        Ok(robot) => {
            check_robot(&robot);
            let (text, changes, near) = clean_urdf(text, "fuzz", &CleanPolicy::default()).unwrap();
            let again = parse_urdf(&text, "fuzz", UrdfOptions::default()).unwrap();
            let left = clean(&again, &CleanPolicy::default());
            assert!(left.changes.iter().all(|c| c.is_last_digit()));
            format!(
                "{:?}",
                (
                    robot.links.len().min(8),
                    changes.len().min(8),
                    near.len().min(8),
                    robot.warnings.len()
                )
            )
        }
    }
}

fn check_toml(text: &str) -> String {
    match parse_toml(text, "fuzz") {
        Err(error) => check_error(&error, text),
        Ok(robot) => {
            check_robot(&robot);
            let again = parse_toml(&to_toml(&robot).unwrap(), "fuzz").unwrap();
            assert!(again == robot);
            let policy = CleanPolicy::default();
            let (text, changes, near) = clean_toml(text, "fuzz", &policy).unwrap();
            assert!(parse_toml(&text, "fuzz").unwrap() == clean(&robot, &policy).description);
            format!(
                "{:?}",
                (
                    robot.links.len().min(8),
                    changes.len().min(8),
                    near.len().min(8),
                    robot.warnings.len()
                )
            )
        }
    }
}

fn check_expression(text: &str) -> String {
    let half = Quantity::parse_decimal("0.5").unwrap();
    let constants = [("L".to_owned(), half.clone()), ("pip".to_owned(), half)];
    let readers = [
        Quantity::parse_angle(text, &constants),
        Quantity::parse_number(text, &constants),
        Quantity::parse_decimal(text),
    ];
    let kinds = readers.map(|result| match result {
        Err(error) => {
            assert!(!error.message.is_empty() && error.to_string().len() < 1000);
            assert!(error.offset.is_none_or(|at| at <= text.len()), "{error:?}");
            format!("{:?} {:?}", error.fault, error.hint.map(|h| h.len()))
        }
        Ok(quantity) => {
            assert!(quantity.value.is_finite());
            let written = quantity.expr.to_string();
            match Quantity::parse_number(&written, &constants) {
                Ok(again) => assert!(again.expr == quantity.expr && again.value == quantity.value),
                // Spelled out, signs have brackets: deeper and longer than as written.
                Err(error) => assert_eq!(error.fault, LiteralFault::TooLarge, "{written}"),
            }
            let parts = written.matches([' ', '(']).count();
            format!("value {}", parts.min(20))
        }
    });
    kinds.concat()
}

#[test]
fn mutated_urdf_files_are_read_or_refused_with_a_code() {
    fuzz(urdf_seeds(), check_urdf);
}

#[test]
fn mutated_robot_tomls_are_read_or_refused_with_a_code() {
    let mut seeds: Vec<String> = catalogue().iter().map(|e| e.toml.to_owned()).collect();
    seeds.push(
        "name = 'f'\nconstants.L = 0.3\nconstants.A = '(45/2) deg'\ngravity = ['-L', 0, 1e-9]\n\
         link = [{ alpha = 1.5708, d = 'L', r = 0 }, { joint = 'fixed', alpha = '3.14', d = 1e-7, \
         theta = 'A*2', r = 0 }, { alpha = -1.57, d = 0, r = 0, antecedent = '1', b = 1, gamma = \
         3.1416, inertia = { M = 1, Ia = 2 } }]\n"
            .to_owned(),
    );
    fuzz(seeds, check_toml);
}

#[test]
fn mutated_expressions_are_read_or_refused_with_a_reason() {
    let seeds = [
        "1.5707963267948966",
        "-90 deg",
        "(45/2) deg",
        "3*pi/4 - 1.5e-3",
        "sqrt(2)/2 + L",
        "-(L + 2*pip)/(3 - sqrt(L*L))",
        "+-+1",
        "2e-3*(((pi)))",
        ".5",
        "5.",
        "-pi/2",
        "1e308*10",
        "0.1+0.2-0.3",
        "L/0",
        "sqrt(-1)",
        "((1+2)*(3-4))/5*6-7",
        "1 - -1",
        "--L",
        "1e-9999",
    ];
    fuzz(seeds.map(str::to_owned).to_vec(), check_expression);
}

/// A small file of every kind of element, and snippets that are nearly wrong.
fn urdf_seeds() -> Vec<String> {
    let joint = |name: &str, kind: &str, ends: [&str; 2], more: &str| {
        let [parent, child] = ends;
        format!(
            "<joint name=\"{name}\" type=\"{kind}\"><parent link=\"{parent}\"/><child \
             link=\"{child}\"/>{more}</joint>\n"
        )
    };
    let robot = |links: &[&str], joints: &[String]| {
        let links: String = links
            .iter()
            .map(|l| format!("<link name=\"{l}\"/>\n"))
            .collect();
        format!("<robot name=\"r\">\n{links}{}</robot>\n", joints.concat())
    };
    let turn =
        "<origin xyz=\"1e-17 0.3 0\" rpy=\"1.5708 -1.57 3.14159\"/><axis xyz=\"0 1e-9 -1\"/>";
    let chain = robot(
        &["a", "b", "c", "d"],
        &[
            joint("1", "revolute", ["a", "b"], turn),
            joint("2", "fixed", ["b", "c"], turn),
            joint(
                "3",
                "prismatic",
                ["c", "d"],
                "<limit lower=\"-1\" upper=\"1\"/><axis xyz=\"1 1 0\"/>",
            ),
        ],
    );
    let mimic = robot(
        &["a", "b", "c"],
        &[
            joint(
                "1",
                "continuous",
                ["a", "b"],
                "<mimic joint=\"2\" multiplier=\"-1\" offset=\"0.5\"/>",
            ),
            joint(
                "2",
                "continuous",
                ["b", "c"],
                "<limit effort=\"1\" velocity=\"2\"/>",
            ),
        ],
    );
    let inertial = "<robot xmlns:x='u' name='&#105;'><!-- c --><link name='a'><inertial><origin \
                    xyz='0 0 1' rpy='0.1 0 0'/><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' \
                    iyy='1' iyz='0' izz='1'/></inertial><visual/></link><link name='b'/><x:joint/>\
                    <joint name='j' type='revolute'><parent link='b'/><child link='a'/><origin \
                    rpy='&#49;.5708\t0\n0'/></joint><gazebo><![CDATA[<link/>]]></gazebo></robot>";
    let small = include_str!("../data/small.urdf");
    vec![small.to_owned(), chain, mimic, inertial.to_owned()]
}
