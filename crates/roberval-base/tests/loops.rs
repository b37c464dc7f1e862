//! Mechanisms with loops given by their cut joints.

use roberval_base::{
    BaseParameters, CertificateError, Engine, LoopForm, Options, Samples, base_parameters,
};
use roberval_formats::parse_toml;
use roberval_mechanism::{Assembly, CleanPolicy, Mechanism, MechanismError};
use roberval_regressor::{Model, Regressor, States};
use roberval_scalar::SplitMix64;

mod common {
    pub mod loop_robots;
}
use common::loop_robots::*;

/// Two routes' coefficients are the same if they differ by less than this: those in pairs
/// of doubles are known to 1e-20, the fractions they are compared with are rounded.
const SAME_BETA: f64 = 1e-12;

fn mechanism(text: &str) -> Mechanism {
    let description = parse_toml(text, "loop.toml").unwrap_or_else(|e| panic!("{e}\n{text}"));
    Mechanism::new(&description).unwrap_or_else(|e| panic!("{e}"))
}

fn answer(mechanism: &Mechanism, model: Model, engine: Engine, seed: u64) -> BaseParameters {
    let options = Options {
        model,
        engine,
        seed,
        ..Options::default()
    };
    let answer = base_parameters(mechanism, &options).unwrap_or_else(|e| panic!("{e}"));
    assert!(
        answer.diagnosis.clear,
        "{} {}: {:?} {:?}",
        mechanism.name,
        model.name(),
        answer.diagnosis.messages,
        answer.diagnosis.precision
    );
    answer
}

/// c, b and the labels of the regrouped parameters.
type Counts = (usize, usize, String);

fn count(a: &BaseParameters) -> Counts {
    let c = a.base.len() + a.regrouped.len();
    (c, a.rank(), a.labels(&a.regrouped).join(" "))
}

/// The counts by these models and engines, which all must agree, with several seeds.
fn counts(text: &str, engines: &[Engine]) -> Counts {
    let mechanism = mechanism(text);
    let first = count(&answer(&mechanism, Model::D, Engine::Exact, 1));
    for (seed, model) in (2..).zip(Model::ALL) {
        for &engine in engines {
            let found = answer(&mechanism, model, engine, seed);
            assert_eq!(
                count(&found),
                first,
                "{} {} {engine:?}",
                mechanism.name,
                model.name()
            );
        }
    }
    first
}

const ALL: &[Engine] = &Engine::ALL;

/// The two that decide far from rounding.
const SURE: &[Engine] = &[Engine::Exact, Engine::Precise];

#[test]
fn planar_four_and_five_bars_have_the_counts_of_the_table() {
    let table = [
        (four_bar(IN_PLANE), 11, 8, "Ia_1 M_2 MX_3"),
        (four_bar(NORMAL), 7, 4, "Ia_1 M_2 ZZ_3"),
        (five_bar(IN_PLANE), 16, 11, "Ia_1 M_2 Ia_3 MX_4 M_4"),
        (five_bar(NORMAL), 12, 7, "Ia_1 M_2 Ia_3 MX_4 M_4"),
    ];
    for (text, c, b, deleted) in table {
        assert_eq!(counts(&text, ALL), (c, b, deleted.to_owned()), "{text}");
    }
}

/// How the exact engine decided; `None` if it left it to pairs of doubles.
fn form(text: &str) -> Option<LoopForm> {
    let answer = answer(&mechanism(text), Model::D, Engine::Exact, 1);
    answer.diagnosis.structure.and_then(|s| s.loops)
}

#[test]
fn loops_are_decided_exactly_where_their_variety_is_irreducible_and_has_points_in_prime_fields() {
    let crossed = "near = { 1 = 1, 2 = -2.0494, 3 = -2.3315 }";
    for text in [
        four_bar(IN_PLANE),
        five_bar(NORMAL),
        four_bar_cut_at_the_crank(IN_PLANE),
        four_bar(IN_PLANE).replace("\"revolute\"", "\"spherical\""),
        waist_with_four_bar(),
        spherical_four_bar(),
        slider_crank(),
    ] {
        assert_eq!(form(&text), Some(LoopForm::Points), "{text}");
    }
    let parallel = form(&parallelogram("near = { 1 = 1, 2 = -1, 3 = 1 }"));
    assert!(matches!(parallel, Some(LoopForm::Couples(c)) if c.len() == 2));
    let points = answer(&mechanism(&four_bar(IN_PLANE)), Model::D, Engine::Exact, 1);
    assert_eq!(points.certificate(), Err(CertificateError::Loops));
    // A branch that is a variety of its own, and no couple; loops without easy points.
    for text in [parallelogram(crossed), bennett(), delta(), stewart(1)] {
        assert_eq!(form(&text), None, "{text}");
    }
}

#[test]
fn a_slider_crank_has_one_count_by_all_engines() {
    counts(&slider_crank(), ALL);
}

#[test]
fn the_two_branches_of_a_parallelogram_are_never_mixed() {
    // The cranks parallel, and crossed: the other crank's tip mirrored at the diagonal.
    let parallel = "near = { 1 = 1, 2 = -1, 3 = 1 }";
    let crossed = "near = { 1 = 1, 2 = -2.0494, 3 = -2.3315 }";
    for (near, b) in [(parallel, 3), (crossed, 8)] {
        let (_, found, _) = counts(&parallelogram(near), ALL);
        assert_eq!(found, b, "{near}");
    }
}

#[test]
fn couples_and_loops_hold_together() {
    // Equal cranks leave the parallelogram one branch; geared ones leave the five-bar a freedom.
    let equal = "[[couple]]\njoint = \"3\"\nequals = { 1 = 1 }\n";
    let (_, b, _) = counts(&format!("{}{equal}", parallelogram("")), ALL);
    assert_eq!(b, 3);
    let geared = "[[couple]]\njoint = \"3\"\nequals = { 1 = \"-1/2\" }\noffset = \"pi/2\"\n";
    let text = format!("{}{geared}", five_bar(IN_PLANE));
    let robot = mechanism(&text);
    assert_eq!((robot.independent(), robot.dof()), (1, 4));
    let start = &robot.assembly.as_ref().expect("a loop").start;
    let miss = start[2] + start[0] / 2.0 - std::f64::consts::FRAC_PI_2;
    assert!(miss.abs() < 1e-12, "{start:?}");
    counts(&text, SURE);
}

#[test]
fn cutting_a_loop_elsewhere_gives_the_same_count() {
    for gravity in [IN_PLANE, NORMAL] {
        let (_, b, _) = counts(&four_bar(gravity), SURE);
        for text in [
            four_bar_cut_at_the_crank(gravity),
            four_bar_cut_at_the_ground(gravity),
        ] {
            assert_eq!(counts(&text, SURE).1, b, "{text}");
        }
    }
}

#[test]
fn cutting_spatial_loops_elsewhere_gives_the_same_count() {
    let delta = include_str!("../../roberval-formats/catalogue/delta.toml");
    let pairs = [
        (waist_with_four_bar(), waist_cut_elsewhere()),
        (spherical_four_bar(), spherical_cut_elsewhere()),
        (rssr(), rssr_cut_elsewhere()),
        (delta.to_owned(), delta_cut_elsewhere(delta)),
        (stewart(1), stewart(4)),
    ];
    for (text, elsewhere) in pairs {
        let count = |text: &str| answer(&mechanism(text), Model::D, Engine::Exact, 1).rank();
        assert_eq!(count(&elsewhere), count(&text), "{elsewhere}");
    }
}

#[test]
fn the_count_does_not_depend_on_the_assembly_mode_of_an_irreducible_loop() {
    let (c, b, deleted) = counts(&four_bar(IN_PLANE), SURE);
    for near in ["{ 1 = 1, 2 = 0, 3 = 1 }", "{ 1 = 1, 2 = -2, 3 = -2 }"] {
        let text = format!("{}near = {near}\n", four_bar(IN_PLANE));
        let start = &mechanism(&text).assembly.expect("a loop").start;
        let up = start[2].sin() > 0.0;
        assert_eq!(up, near.contains("3 = 1"), "{start:?}");
        assert_eq!(counts(&text, SURE), (c, b, deleted.clone()), "{near}");
    }
}

/// Whether a start is surely another assembly mode than others: at its independent joints,
/// these have the other joints elsewhere.
fn is_another_mode(start: &Assembly, others: &[Assembly]) -> bool {
    let qa: Vec<f64> = start.independent.iter().map(|&k| start.start[k]).collect();
    others.iter().all(|other| {
        let there = other.reach(&other.start, &qa);
        let apart = |q: &[f64]| {
            let turn = |(a, b): (&f64, &f64)| (0.5 * (a - b)).sin().abs();
            q.iter().zip(&start.start).map(turn).fold(0.0, f64::max)
        };
        there.is_ok_and(|q| apart(&q) > 1e-3)
    })
}

#[test]
fn a_floating_base_with_loops_has_the_counts_of_six_joints_that_carry_it() {
    for (name, mechanism_on) in [
        ("four-bar", four_bar_on as fn(&str) -> String),
        ("parallelogram", parallelogram_on),
        ("RSSR", rssr_on),
    ] {
        let floating = mechanism_on(FLOATING);
        let robot = mechanism(&floating);
        assert_eq!(
            (robot.base_variables(), robot.positions()),
            (6, robot.independent() + 1)
        );
        let (c, b, regrouped) = counts(&floating, SURE);
        let carried = counts(&mechanism_on(CARRIED), SURE);
        assert_eq!((c, b, regrouped), carried, "{name}");
    }
    let still = parse_toml(&four_bar_cut_at_the_ground(NORMAL), "r.toml").expect("valid");
    let afloat = Mechanism::new(&still.with_floating_base()).expect("valid");
    let b = answer(&afloat, Model::D, Engine::Exact, 1).rank();
    assert_eq!(b, counts(&four_bar_on(FLOATING), SURE).1);
    let exact = form(&four_bar_on(FLOATING));
    assert_eq!(exact, Some(LoopForm::Points));
    let couples = form(&parallelogram_on(FLOATING));
    assert!(matches!(couples, Some(LoopForm::Couples(_))));
}

#[test]
fn a_loop_on_the_ground_of_a_floating_robot_is_refused() {
    let text = four_bar_on(FLOATING).replace("[\"2\", \"3\"]", "[\"2\", \"base\"]");
    let error = Mechanism::new(&parse_toml(&text, "r.toml").expect("valid")).expect_err("ground");
    assert!(error.to_string().contains("closed on the base"), "{error}");
    let near = format!("{}near = {{ ground = 0 }}\n", four_bar_on(FLOATING));
    let error = parse_toml(&near, "r.toml").expect_err("no variable");
    assert!(error.to_string().contains("fixed or floats"), "{error}");
}

#[test]
fn every_assembly_mode_of_irreducible_loops_has_the_same_count_in_floats() {
    let mut random = SplitMix64::new(11);
    for text in [
        five_bar(IN_PLANE),
        five_bar(NORMAL),
        waist_with_four_bar(),
        spherical_four_bar(),
        slider_crank(),
        rssr(),
    ] {
        let first = mechanism(&text);
        let expected = count(&answer(&first, Model::D, Engine::Exact, 1));
        let names: Vec<&str> = first.moving().map(|l| l.name.as_str()).collect();
        let mut modes = vec![Assembly::clone(first.assembly.as_ref().expect("a loop"))];
        for _ in 0..40 {
            let values = names.iter();
            let values = values.map(|name| format!("{name:?} = {:.3}", random.uniform(-3.0, 3.0)));
            let near = values.collect::<Vec<_>>().join(", ");
            let description = parse_toml(&format!("{text}near = {{ {near} }}\n"), "near.toml");
            let Ok(robot) = Mechanism::new(&description.expect("valid")) else {
                continue;
            };
            let assembly = robot.assembly.as_ref().expect("a loop");
            if is_another_mode(assembly, &modes) {
                let found = answer(&robot, Model::D, Engine::Precise, 2);
                assert_eq!(count(&found), expected, "{near}\n{text}");
                modes.push(Assembly::clone(assembly));
            }
        }
        assert!(modes.len() > 1, "{text}");
    }
}

#[test]
fn a_loop_is_its_couple_on_the_branch_of_the_couple() {
    let cases = [
        (
            include_str!("../../roberval-formats/catalogue/hitachi_hpr.toml"),
            &["2", "5"][..],
            "between = [\"4\", \"5\"]\nat = [[\"L2\", 0, 0], [\"-L1\", 0, 0]]\ncut = \"revolute\"\n\
             near = { 2 = -1, 3 = 0, 4 = 1, 5 = \"3*pi - 1\" }",
            (62, 35, 46),
        ),
        (
            include_str!("../../roberval-formats/catalogue/sr400.toml"),
            &["3", "8"][..],
            "between = [\"8\", \"3\"]\nat = [[\"D3\", 0, 0], [0, \"-D8\", 0]]\ncut = \"revolute\"\n\
             near = { 2 = 1, 3 = \"pi/2 - 1\", 7 = 0, 8 = 1 }",
            (75, 42, 53),
        ),
    ];
    for (couples, passive, closure, (c, b, tree)) in cases {
        let coupled = answer(&mechanism(couples), Model::D, Engine::Exact, 1);
        let text = loop_instead_of_couples(couples, passive, closure);
        let implicit = mechanism(&text);
        for (seed, model) in (1..).zip(Model::ALL) {
            let looped = answer(&implicit, model, Engine::Exact, seed);
            assert_eq!(count(&looped), count(&coupled));
            assert_eq!((count(&looped).0, looped.rank()), (c, b));
            let difference = coupled.beta.as_slice().iter().zip(looped.beta.as_slice());
            let largest = difference.fold(0.0_f64, |m, (x, y)| m.max((x - y).abs()));
            assert!(largest <= SAME_BETA, "{largest}");
            assert_eq!(looped.diagnosis.opened().expect("a tree").rank, tree);
            looped.certificate().expect("that of the couples");
            let structure = looped.diagnosis.structure.expect("decided exactly");
            assert!(matches!(structure.loops, Some(LoopForm::Couples(_))));
            let precise = answer(&implicit, model, Engine::Precise, seed);
            assert_eq!(count(&precise), count(&coupled));
            let precision = precise.diagnosis.precision.expect("high-precision floats");
            assert!(precision.gap().expect("a gap") > 1e20);
        }
    }
}

#[test]
fn spatial_loops_have_one_count_by_all_models_and_seeds() {
    let robots = [
        (waist_with_four_bar(), 2),
        (spherical_four_bar(), 1),
        (rssr(), 2),
        (bennett(), 1),
        (delta(), 3),
    ];
    for (text, mobility) in robots {
        let robot = mechanism(&text);
        assert_eq!(robot.independent(), mobility, "{}", robot.name);
        counts(&text, SURE);
    }
}

#[test]
fn a_delta_robot_whose_platform_keeps_its_orientation_has_fewer_base_parameters() {
    let text = include_str!("../../roberval-formats/catalogue/delta.toml");
    let (c, b, _) = counts(text, SURE);
    assert_eq!((c, b), (43, 34));
    // The same loops have a branch on which the platform turns.
    let turning = answer(&mechanism(&delta()), Model::D, Engine::Exact, 1);
    assert!(turning.rank() > b, "{}", turning.rank());
    let robot = mechanism(text);
    let answer = answer(&robot, Model::D, Engine::Exact, 9);
    let labels = answer.labels(&answer.no_effect);
    let inertia = ["XX", "XY", "XZ", "YY", "YZ", "ZZ", "MX", "MY", "MZ"];
    assert!(
        inertia
            .iter()
            .all(|kind| labels.contains(&format!("{kind}_platform").as_str()))
    );
}

#[test]
fn a_stewart_platform_is_led_by_its_six_legs_and_d_and_h_agree() {
    let robot = mechanism(&stewart(1));
    let joints = robot.independent_joints();
    let names: Vec<&str> = joints.iter().map(|l| l.name.as_str()).collect();
    assert_eq!(names, ["leg1", "leg2", "leg3", "leg4", "leg5", "leg6"]);
    let first = count(&answer(&robot, Model::D, Engine::Exact, 1));
    for model in [Model::D0, Model::H] {
        assert_eq!(count(&answer(&robot, model, Engine::Exact, 2)), first);
    }
}

fn refused(text: &str) -> String {
    let description = parse_toml(text, "loop.toml").unwrap_or_else(|e| panic!("{e}\n{text}"));
    match Mechanism::new(&description) {
        Err(error @ MechanismError::Assembly { .. }) => error.to_string(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn loops_that_cannot_be_assembled_or_moved_are_refused_with_the_reason() {
    let far = four_bar(IN_PLANE).replace("d = 1,", "d = 5,");
    let message = refused(&far);
    assert!(message.contains("cannot be assembled"), "{message}");
    assert!(message.contains("leaves a gap of 3"), "{message}");
    // A triangle: the coupler ends on the ground.
    let rigid =
        four_bar(IN_PLANE).replace("between = [\"2\", \"3\"]", "between = [\"2\", \"base\"]");
    let rigid = rigid.replace("[0.7, 0, 0]", "[0.8, 0, 0]");
    let rigid = rigid.replace(
        "{ name = \"3\", antecedent = \"base\", alpha = 0, d = 1, r = 0, active = false },\n",
        "",
    );
    let message = refused(&rigid);
    assert!(
        message.contains("leave no motion: 2 joints and 2 independent equations of 5"),
        "{message}"
    );
    // Stretched as far as it goes: closed, and immovable to second order.
    let stretched = four_bar(IN_PLANE).replace("d = 1,", "d = 1.9,");
    let message = refused(&stretched);
    assert!(message.contains("second order"), "{message}");
    // Out of plane: axes that are not parallel.
    let skew = four_bar(IN_PLANE).replace("alpha = 0, d = 0.3", "alpha = \"10 deg\", d = 0.3");
    let message = refused(&skew);
    assert!(
        message.contains("cannot be assembled") || message.contains("no motion"),
        "{message}"
    );
    let singular = parallelogram("near = { 1 = 0, 2 = 0, 3 = 0 }");
    let message = refused(&singular);
    assert!(message.contains("singular configuration"), "{message}");
}

/// Central differences over 1e-5 s: joints that move at 10 rad/s leave (1e-4)^2 of curvature
/// and rounding 1e-10.
const DIFFERENCE_ERROR: f64 = 1e-6;

/// A part of the usual velocities.
const SLOW: f64 = 0.02;

#[test]
fn the_power_of_the_independent_torques_is_the_rate_of_the_energy_of_the_whole_mechanism() {
    let robots = [
        four_bar(IN_PLANE),
        format!(
            "{}[[couple]]\njoint = \"3\"\nequals = {{ 1 = -2 }}\noffset = 1\n",
            five_bar(IN_PLANE)
        ),
        waist_with_four_bar(),
        spherical_four_bar(),
        rssr(),
        bennett(),
        delta(),
        stewart(1),
    ];
    for text in robots {
        let robot = mechanism(&text);
        let regressor = Regressor::new(&robot);
        let m = robot.independent();
        let space = robot.parameters();
        let mut random = SplitMix64::new(3);
        // Friction-free: rotors are part of h as well.
        let x: Vec<f64> = (0..space.len()).map(|_| random.uniform(0.0, 1.0)).collect();
        let mut samples = Samples::draw(&robot, 6, 5).expect("samples");
        // Slowly, so that differences over a short time are derivatives.
        samples.qd.iter_mut().for_each(|x| *x *= SLOW);
        samples.qdd.iter_mut().for_each(|x| *x *= SLOW * SLOW);
        for k in 0..samples.count {
            let part = |v: &[f64]| v[k * m..(k + 1) * m].to_vec();
            let (q, qd, qdd) = (part(&samples.q), part(&samples.qd), part(&samples.qdd));
            let at = |t: f64| -> [Vec<f64>; 2] {
                let q = (0..m).map(|i| q[i] + t * qd[i] + 0.5 * t * t * qdd[i]);
                [q.collect(), (0..m).map(|i| qd[i] + t * qdd[i]).collect()]
            };
            // All earlier samples lead here, so that the branch is kept.
            let energy = |t: f64| {
                let [end, rate] = at(t);
                let row = last_row(&regressor, Model::H, &samples, k, [&end, &rate, &qdd]);
                row.iter().zip(&x).map(|(h, x)| h * x).sum::<f64>()
            };
            let rows = last_row(&regressor, Model::D, &samples, k, [&q, &qd, &qdd]);
            let torque = rows
                .chunks_exact(space.len())
                .map(|row| row.iter().zip(&x).map(|(d, x)| d * x).sum::<f64>());
            let power: f64 = torque.zip(&qd).map(|(t, v)| t * v).sum();
            let step = 1e-5;
            let rate = (energy(step) - energy(-step)) / (2.0 * step);
            let size = energy(0.0).abs() + rate.abs() + 1.0;
            assert!(
                (power - rate).abs() < DIFFERENCE_ERROR * size,
                "{} sample {k}: {power} against {rate}",
                robot.name
            );
        }
    }
}

/// The rows at a state to which the samples before the k-th lead.
fn last_row(
    regressor: &Regressor,
    model: Model,
    samples: &Samples,
    k: usize,
    [q, qd, qdd]: [&[f64]; 3],
) -> Vec<f64> {
    let m = q.len();
    let with = |before: &[f64], last: &[f64]| [&before[..(k + 1) * m], last].concat();
    let all = [
        with(&samples.q, q),
        with(&samples.qd, qd),
        with(&samples.qdd, qdd),
    ];
    let states = States {
        q: &all[0],
        qd: &all[1],
        qdd: &all[2],
    };
    let size = model.rows(m) * regressor.parameters().len();
    let mut rows = vec![0.0; (k + 2) * size];
    regressor.fill(model, states, &mut rows).expect("closed");
    rows.split_off((k + 1) * size)
}

#[test]
fn loops_that_close_only_without_roundings_are_those_of_the_cleaned_robot() {
    let turned = |angle: &str| {
        format!(
            "gravity = [0, -9.81, 0]\n\
             [[link]]\nname = \"c\"\nantecedent = \"base\"\nxyz = [0, 0, 0]\nrpy = [0, {angle}, 0]\n\
             [[link]]\nname = \"k\"\nxyz = [0.3, 0, 0]\nrpy = [0, 0, 0]\nactive = false\n\
             [[link]]\nname = \"o\"\nantecedent = \"base\"\nxyz = [0, 0, -1]\n\
             rpy = [0, {angle}, 0]\nactive = false\n\
             [[loop]]\nbetween = [\"k\", \"o\"]\nat = [[0.9, 0, 0], [0.7, 0, 0]]\n\
             cut = \"revolute\"\nnear = {{ c = 1, k = 0, o = 1 }}\n"
        )
    };
    let decided = |angle: &str| {
        let description = parse_toml(&turned(angle), "loop.toml").unwrap();
        let cleaned = Mechanism::cleaned(&description, &CleanPolicy::default()).unwrap();
        answer(&cleaned, Model::D, Engine::Exact, 1)
    };
    let exact = decided("\"90 deg\"");
    assert!(exact.diagnosis.literal.is_none_or(|l| l.closes));
    for angle in ["1.5707963267948966", "1.5708"] {
        let rounded = decided(angle);
        assert_eq!(rounded.base, exact.base, "{angle}");
        assert!(
            rounded.diagnosis.literal.is_some_and(|l| !l.closes),
            "{angle}"
        );
    }
}
