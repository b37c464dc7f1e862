//! Mechanisms with loops given by their cut joints.

use roberval_base::{BaseParameters, Engine, Options, Samples, base_parameters};
use roberval_formats::parse_toml;
use roberval_mechanism::{Mechanism, MechanismError};
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

const ALL: &[Engine] = &[Engine::Exact, Engine::Qr, Engine::Qrii, Engine::Svd];

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
fn cutting_a_loop_elsewhere_gives_the_same_count() {
    for gravity in [IN_PLANE, NORMAL] {
        let (_, b, _) = counts(&four_bar(gravity), &[Engine::Exact]);
        for text in [
            four_bar_cut_at_the_crank(gravity),
            four_bar_cut_at_the_ground(gravity),
        ] {
            assert_eq!(counts(&text, &[Engine::Exact]).1, b, "{text}");
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
    ];
    for (text, elsewhere) in pairs {
        let count = |text: &str| answer(&mechanism(text), Model::D, Engine::Exact, 1).rank();
        assert_eq!(count(&elsewhere), count(&text), "{elsewhere}");
    }
}

#[test]
fn the_count_does_not_depend_on_the_assembly_mode_of_an_irreducible_loop() {
    let (c, b, deleted) = counts(&four_bar(IN_PLANE), &[Engine::Exact]);
    for near in ["{ 1 = 1, 2 = 0, 3 = 1 }", "{ 1 = 1, 2 = -2, 3 = -2 }"] {
        let text = format!("{}near = {near}\n", four_bar(IN_PLANE));
        let start = &mechanism(&text).assembly.expect("a loop").start;
        let up = start[2].sin() > 0.0;
        assert_eq!(up, near.contains("3 = 1"), "{start:?}");
        assert_eq!(
            counts(&text, &[Engine::Exact]),
            (c, b, deleted.clone()),
            "{near}"
        );
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
            let precision = looped.diagnosis.precision.expect("high-precision floats");
            assert!(precision.gap().expect("a gap") > 1e20);
            assert_eq!(precision.opened.expect("a tree").rank, tree);
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
        counts(&text, &[Engine::Exact]);
    }
}

#[test]
fn a_delta_robot_whose_platform_keeps_its_orientation_has_fewer_base_parameters() {
    let text = include_str!("../../roberval-formats/catalogue/delta.toml");
    let (c, b, _) = counts(text, &[Engine::Exact]);
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
    let robot = mechanism(&stewart());
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
        waist_with_four_bar(),
        spherical_four_bar(),
        rssr(),
        bennett(),
        delta(),
        stewart(),
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
