//! Certificates against their checker, a Python file that shares nothing with this crate.

use std::path::{Path, PathBuf};
use std::process::Command;

use roberval_base::{
    CertificateError, CertificateNotes, Engine, ExactDecision, ExactNumber, Model, Options,
    Witness, base_parameters, certificate, certificate_text, decide_exactly,
};
use roberval_mechanism::{Geometry, Mechanism, RobotDescription, SourceFormat};
use roberval_scalar::Quantity;
use roberval_testkit::{Angles, Family, literal_style, make_planar};

/// Of the PUMA, the issue says; it takes a tenth.
const LARGEST_CERTIFICATE: usize = 200_000;

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn mechanism(description: &RobotDescription) -> Mechanism {
    Mechanism::new(description).expect("valid")
}

fn robot(name: &str) -> Mechanism {
    mechanism(&roberval_formats::load(name).expect("readable"))
}

fn small_urdf() -> Mechanism {
    let path = repository().join("crates/roberval-formats/tests/data/small.urdf");
    robot(path.to_str().expect("a path in UTF-8"))
}

fn decide(robot: &Mechanism, model: Model) -> ExactDecision {
    let order: Vec<usize> = (0..robot.parameters().len()).collect();
    decide_exactly(robot, model, &order, 1).expect("decided")
}

fn text(robot: &Mechanism, model: Model, decision: &ExactDecision) -> String {
    let notes = CertificateNotes {
        changes: &["joint3 rpy[0] = 1.5708 is 3.7e-6 rad from pi/2".to_owned()],
        witnesses: &[Witness {
            engine: Engine::Qrii,
            rank: decision.kept.len(),
            gap: Some(1.5e11),
            gap_at_structural: None,
            spectrum: Vec::new(),
            tolerance: 0.0,
        }],
    };
    certificate_text(&certificate(robot, model, decision, notes).expect("certified"))
}

/// Certificates in a directory of their own, which goes with this.
struct Files(PathBuf);

impl Files {
    fn new(name: &str) -> Self {
        let directory =
            std::env::temp_dir().join(format!("roberval-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&directory).expect("a temporary directory");
        Self(directory)
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.0.join(name), text).expect("written");
    }

    /// Writes a robot's certificate, to be accepted; its length.
    fn accepted(&self, name: &str, robot: &Mechanism, model: Model) -> usize {
        let text = text(robot, model, &decide(robot, model));
        self.write(&format!("accepted-{name}.json"), &text);
        text.len()
    }

    /// Runs `tests/certificates.py` on the directory: it expects what the files' names
    /// begin with. Skips, and says so, where there is no Python.
    fn check(&self, how: &str) {
        let script = repository().join("tests/certificates.py");
        let run = Command::new("python3")
            .arg(&script)
            .arg(how)
            .arg(&self.0)
            .output();
        match run {
            Err(error) => eprintln!("skipped: python3 does not run: {error}"),
            Ok(output) => {
                let said = String::from_utf8_lossy(&output.stdout);
                let complained = String::from_utf8_lossy(&output.stderr);
                assert!(output.status.success(), "{said}{complained}");
                eprint!("{said}");
            }
        }
    }
}

impl Drop for Files {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

#[test]
fn certificates_of_the_catalogue_are_accepted_and_small() {
    let files = Files::new("catalogue");
    for (k, entry) in roberval_formats::catalogue().iter().enumerate() {
        let robot = robot(entry.name);
        if robot.assembly.is_some() {
            continue; // loops are not decided exactly
        }
        let length = files.accepted(entry.name, &robot, Model::ALL[k % 3]);
        assert!(length < LARGEST_CERTIFICATE, "{}: {length}", entry.name);
    }
    files.check("verdicts");
}

#[test]
fn certificates_of_urdfs_and_generated_robots_are_accepted() {
    let files = Files::new("generated");
    files.accepted("urdf", &small_urdf(), Model::D);
    for (k, angles) in [Angles::Right, Angles::Fifteens, Angles::Oblique]
        .into_iter()
        .enumerate()
    {
        for format in [SourceFormat::Mdh, SourceFormat::Urdf] {
            for seed in 0..4 {
                let family = Family {
                    angles,
                    format,
                    links: (2, 6),
                    ..Family::default()
                };
                let robot = mechanism(&family.robot(seed));
                let model = Model::ALL[(seed as usize + k) % 3];
                files.accepted(&format!("{k}-{format:?}-{seed}"), &robot, model);
            }
        }
    }
    files.check("verdicts");
}

/// Badly conditioned: the checker knows the coefficients to two hundred digits.
#[test]
fn certificates_of_long_oblique_chains_are_accepted() {
    let files = Files::new("long");
    for seed in [8, 17, 28] {
        let family = Family {
            angles: Angles::Oblique,
            links: (10, 16),
            ..Family::default()
        };
        let robot = mechanism(&family.robot(seed));
        files.accepted(&format!("long-{seed}"), &robot, Model::D);
    }
    files.check("verdicts");
}

#[test]
fn certificates_of_planar_floating_and_odd_robots_are_accepted() {
    let files = Files::new("odd");
    for seed in 0..6 {
        let family = Family {
            format: SourceFormat::Urdf,
            links: (2, 5),
            ..Family::default()
        };
        let mut robot = family.robot(seed);
        make_planar(&mut robot, 1);
        if seed % 2 == 0 {
            robot = robot.with_floating_base();
        }
        let model = Model::ALL[seed as usize % 3];
        files.accepted(&format!("planar-{seed}"), &mechanism(&robot), model);
    }
    for (k, robot) in odd_robots().iter().enumerate() {
        for model in Model::ALL {
            files.accepted(&format!("odd-{k}-{}", model.name()), robot, model);
        }
    }
    files.check("verdicts");
}

#[test]
fn the_checker_says_in_one_line_and_by_its_exit_code_what_it_thinks() {
    let files = Files::new("command");
    let robot = robot("two_link");
    let text = text(&robot, Model::D, &decide(&robot, Model::D));
    files.write("good.json", &text);
    files.write("changed.json", &text.replace("[\"ZZ_1\"", "[\"ZZ_2\""));
    files.write("cut.json", &text[..text.len() / 2]);
    files.write("empty.json", "{}");
    files.write("list.json", "[1]");
    files.write("without_rank.json", &text.replace("\"rank\":", "\"tank\":"));
    for (name, code, begin) in [
        ("good.json", 0, "accepted: "),
        (
            "changed.json",
            1,
            "refused: sha256 is that of something else",
        ),
        ("without_rank.json", 1, "refused: not in its form"),
        ("cut.json", 2, "cannot read "),
        ("empty.json", 2, "cannot read "),
        ("list.json", 2, "cannot read "),
        ("missing.json", 2, "cannot read "),
    ] {
        let script = repository().join("python/roberval/check_certificate.py");
        let Ok(output) = Command::new("python3")
            .arg(script)
            .arg(files.0.join(name))
            .output()
        else {
            eprintln!("skipped: python3 does not run");
            return;
        };
        let said = [output.stdout, output.stderr].concat();
        let said = String::from_utf8_lossy(&said);
        assert_eq!(output.status.code(), Some(code), "{name}: {said}");
        assert!(
            said.starts_with(begin) && said.lines().count() == 1,
            "{name}: {said}"
        );
    }
}

/// Robots with expressions: square roots, pi in lengths, angles in radians and of no form,
/// constants, names that JSON must escape.
fn odd_robots() -> Vec<Mechanism> {
    let mut description = (*robot("scara").description).clone();
    description.name = "\u{7f}\t\u{1}\"\\/ \u{e9}\u{1F916}\u{2028}".to_owned();
    let half = Quantity::parse_number("1/2", &[]).expect("a number");
    description.constants.push(("half".to_owned(), half));
    let expressions = [
        "sqrt(2)*half",
        "0.3",
        "sqrt(7)/20",
        "pi/10",
        "-0.3",
        "sqrt(50)/3 - pi",
        "pi/7 + 0.3",
        "sqrt(2)",
        "0.25",
        "sqrt(sqrt(5))",
        "37*pi/180",
        "-sqrt(2/3)",
    ];
    let mut robots = vec![mechanism(&description)];
    for shift in 0..4 {
        let mut changed = description.clone();
        let chosen = numbers(&mut changed).into_iter().skip(3 + shift).step_by(3);
        for (number, text) in chosen.zip(expressions) {
            *number = Quantity::parse_number(text, &description.constants).expect("a number");
        }
        robots.push(mechanism(&changed));
    }
    robots
}

#[test]
fn a_certificate_with_any_entry_changed_is_refused() {
    // With fractions, with square roots, and with rounded coefficients.
    let files = Files::new("mutations");
    let scara = robot("scara");
    files.write(
        "scara.json",
        &text(&scara, Model::D, &decide(&scara, Model::D)),
    );
    let floating = (*robot("two_link").description)
        .clone()
        .with_floating_base();
    let floating = mechanism(&floating);
    files.write(
        "floating.json",
        &text(&floating, Model::D, &decide(&floating, Model::D)),
    );
    for (seed, angles) in [(3, Angles::Fifteens), (2, Angles::Oblique)] {
        let family = Family {
            angles,
            links: (3, 3),
            prismatic: 0.0,
            fixed: 0.0,
            ..Family::default()
        };
        let robot = mechanism(&family.robot(seed));
        let text = text(&robot, Model::H, &decide(&robot, Model::H));
        files.write(&format!("generated-{seed}.json"), &text);
    }
    files.check("mutations");
}

/// Every number of the geometry, and gravity.
fn numbers(robot: &mut RobotDescription) -> Vec<&mut Quantity> {
    let mut numbers: Vec<&mut Quantity> = robot.gravity.iter_mut().collect();
    for link in &mut robot.links {
        match &mut link.geometry {
            Geometry::Mdh(g) => {
                numbers.extend([&mut g.gamma, &mut g.b, &mut g.alpha, &mut g.d, &mut g.theta]);
                numbers.push(&mut g.r);
            }
            Geometry::Placed { origins, axis } => {
                for origin in origins {
                    numbers.extend(origin.xyz.iter_mut().chain(&mut origin.rpy));
                }
                numbers.extend(axis);
            }
        }
    }
    numbers
}

fn same_answer(a: &ExactDecision, b: &ExactDecision) -> bool {
    (&a.no_effect, &a.kept, &a.deleted, &a.beta) == (&b.no_effect, &b.kept, &b.deleted, &b.beta)
        && (a.angle_order, a.degree, a.generic.len()) == (b.angle_order, b.degree, b.generic.len())
}

#[test]
fn an_answer_is_accepted_for_another_geometry_exactly_if_it_is_its_answer() {
    // A forger changes one number of the geometry and computes the hashes anew.
    let files = Files::new("forged");
    let (mut accepted, mut refused) = (0, 0);
    for (name, original) in [
        ("scara", robot("scara")),
        ("puma", robot("puma560")),
        ("urdf", small_urdf()),
    ] {
        let decision = decide(&original, Model::D);
        let mut description = (*original.description).clone();
        for k in 0..numbers(&mut description).len() {
            let mut changed = description.clone();
            let number = numbers(&mut changed).swap_remove(k);
            *number =
                Quantity::parse_number(&format!("{} + 1/7", number.expr), &description.constants)
                    .expect("a number");
            let Ok(other) = Mechanism::new(&changed) else {
                continue;
            };
            let same = same_answer(&decision, &decide(&other, Model::D));
            *(if same { &mut accepted } else { &mut refused }) += 1;
            let verdict = if same { "accepted" } else { "refused" };
            files.write(
                &format!("{verdict}-{name}-{k}.json"),
                &text(&other, Model::D, &decision),
            );
        }
    }
    eprintln!("{accepted} forgeries are true, {refused} are not");
    assert!(accepted > 10 && refused > 10);
    files.check("verdicts");
}

/// A URDF arm whose placements each end in turns by these angles about x.
fn turned(rolls: [&str; 3]) -> Mechanism {
    let path = repository().join("crates/roberval-formats/tests/data/small.urdf");
    let mut description = roberval_formats::load(path.to_str().expect("UTF-8")).expect("readable");
    let number = |x: &str| Quantity::parse_decimal(x).expect("a number");
    for link in &mut description.links {
        let Geometry::Placed { origins, axis } = &mut link.geometry else {
            continue;
        };
        origins[0].xyz = ["0.1", "0.2", "0.3"].map(number);
        origins[0].rpy = [(); 3].map(|()| Quantity::zero());
        for roll in rolls {
            let mut turn = origins[0].clone();
            turn.xyz = [(); 3].map(|()| Quantity::zero());
            turn.rpy[0] = Quantity::parse_angle(roll, &[]).expect("an angle");
            origins.push(turn);
        }
        *axis = ["0", "0", "1"].map(number);
    }
    mechanism(&description)
}

/// An arm of three joints with parallel axes but for the second, which is turned out of the
/// vertical by these angles.
fn tilted(rolls: [&str; 3]) -> Mechanism {
    let mut description = Family {
        links: (3, 3),
        prismatic: 0.0,
        fixed: 0.0,
        format: SourceFormat::Urdf,
        ..Family::default()
    }
    .robot(1);
    let number = |x: &str| Quantity::parse_angle(x, &[]).expect("a number");
    description.gravity = ["0", "0", "-9.81"].map(number);
    for (index, link) in description.links.iter_mut().enumerate() {
        link.antecedent = (index > 0).then(|| index.to_string());
        let Geometry::Placed { origins, axis } = &mut link.geometry else {
            panic!("a URDF")
        };
        origins.truncate(1);
        origins[0].xyz = ["0.1", "0.2", "0.3"].map(number);
        origins[0].rpy = ["0"; 3].map(number);
        for roll in rolls.iter().filter(|_| index == 1) {
            let mut turn = origins[0].clone();
            turn.xyz = ["0"; 3].map(number);
            turn.rpy[0] = number(roll);
            origins.push(turn);
        }
        *axis = ["0", "0", "1"].map(number);
    }
    mechanism(&description)
}

#[test]
fn turns_by_decimals_that_cancel_are_seen_to_cancel() {
    let files = Files::new("cancelling");
    let plain = turned(["0", "0", "0"]);
    let expected = decide(&plain, Model::D);
    for (k, rolls) in [
        ["0.3", "0.3", "-0.6"],
        ["0.5", "-0.25", "-0.25"],
        ["1.234567", "-2.5", "1.265433"],
        [
            "0.123456789012345",
            "-0.24691357802469",
            "0.123456789012345",
        ],
    ]
    .into_iter()
    .enumerate()
    {
        let robot = turned(rolls);
        let decision = decide(&robot, Model::D);
        assert_eq!(decision.kept, expected.kept, "{rolls:?}");
        for (found, expected) in decision.beta.iter().zip(&expected.beta) {
            let doubles = |row: &[ExactNumber]| row.iter().map(ExactNumber::to_f64).collect();
            let [found, expected]: [Vec<f64>; 2] = [doubles(found), doubles(expected)];
            assert_eq!(found, expected, "{rolls:?}: both correctly rounded");
        }
        // The arm has angles of few digits; twelve digits more have no unit with those.
        assert_eq!(
            decision.generic.len(),
            2 * (k / 3),
            "{:?}",
            decision.generic
        );
        assert!(decision.degree > expected.degree);
        let text = text(&robot, Model::D, &decision);
        files.write(&format!("accepted-{k}.json"), &text);
    }
    files.check("verdicts");
}

#[test]
fn robots_that_are_all_but_singular_have_coefficients_and_accepted_certificates() {
    let files = Files::new("singular");
    let right = decide(&tilted(["pi/2", "0", "0"]), Model::D);
    for (k, rolls) in [
        ["1.5707963267948966", "0", "0"],
        ["1.57079632679", "0", "0"],
        ["1.2", "0.7707963267948966", "-0.4"],
    ]
    .into_iter()
    .enumerate()
    {
        let robot = tilted(rolls);
        let decision = decide(&robot, Model::D);
        assert!(decision.kept.len() > right.kept.len(), "{rolls:?}");
        let error = decision.rounding_error;
        assert!(error < 1e-20, "{rolls:?}: {error:e}");
        let options = Options {
            engine: Engine::Qr,
            ..Options::default()
        };
        let floats = base_parameters(&robot, &options).expect("valid");
        assert_eq!(floats.rank(), right.kept.len(), "{rolls:?}");
        let text = text(&robot, Model::D, &decision);
        files.write(&format!("accepted-{k}.json"), &text);
    }
    // Right angles of whole arms in the digits of doubles, taken as written.
    for seed in 0..12 {
        let family = Family {
            links: (4, 6),
            angles: Angles::Right,
            ..Family::default()
        };
        let robot = mechanism(&literal_style(&family.robot(seed), 16));
        let decision = decide(&robot, Model::D);
        let error = decision.rounding_error;
        assert!(error < 1e-20, "robot {seed}: {error:e}");
        let text = text(&robot, Model::D, &decision);
        files.write(&format!("accepted-arm-{seed}.json"), &text);
    }
    files.check("verdicts");
}

#[test]
fn angles_that_are_taken_as_generic_and_are_not_get_no_accepted_certificate() {
    // They cancel, but their least common unit is 1e-17.
    let robot = turned(["0.12345678901234567", "0.3", "-0.42345678901234567"]);
    let decision = decide(&robot, Model::D);
    assert_eq!(decision.generic.len(), 3, "{:?}", decision.generic);
    match certificate(&robot, Model::D, &decision, CertificateNotes::default()) {
        Err(CertificateError::Unsure { error }) => assert!(error > 1e-18),
        Err(other) => panic!("{other}"),
        Ok(certificate) => {
            let files = Files::new("related");
            files.write("refused-related.json", &certificate_text(&certificate));
            files.check("verdicts");
            eprintln!("b = {}: refused by the checker", decision.kept.len());
        }
    }
}
