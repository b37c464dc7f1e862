//! Joints that follow from others by expressions, decided in pairs of doubles.

use roberval_base::{
    BaseError, BaseParameters, Engine, Model, Options, base_parameters, decide_exactly,
};
use roberval_mechanism::{Expression, JointKind, Mechanism, RobotDescription};
use roberval_regressor::{Regressor, States};
use roberval_scalar::{Formula, SplitMix64};
use roberval_testkit::{Family, coupled};

/// Central differences at step 1e-5 are good to about 1e-9 times the third derivative.
const STEP: f64 = 1e-5;
const DIFFERENCES: f64 = 1e-5;

/// A crank 1 of 0.3 m that turns fully, a coupler 2 of 0.9 m and a rocker 3 of 0.7 m on a
/// ground of 1 m: both angles in closed form.
const FOUR_BAR: &str = r#"
[[link]]
name = "1"
alpha = 0
d = 0
r = 0
[[link]]
name = "2"
alpha = 0
d = 0.3
r = 0
[[link]]
name = "3"
antecedent = "base"
alpha = 0
d = 1
r = 0
[[couple]]
joint = "2"
expression = "atan2(0.7*sin(q.3) - 0.3*sin(q.1), 1 + 0.7*cos(q.3) - 0.3*cos(q.1)) - q.1"
[[couple]]
joint = "3"
expression = "atan2(0.3*sin(q.1), 0.3*cos(q.1) - 1) - atan2(sqrt(1.96*(1.09 - 0.6*cos(q.1)) - (0.77 - 0.6*cos(q.1))*(0.77 - 0.6*cos(q.1))), 0.77 - 0.6*cos(q.1))"
"#;

fn read(text: &str) -> RobotDescription {
    roberval_formats::parse_toml(text, "text").unwrap_or_else(|e| panic!("{e}"))
}

fn answer(robot: &RobotDescription, model: Model, engine: Engine) -> BaseParameters {
    let options = Options {
        model,
        engine,
        ..Options::default()
    };
    let mechanism = Mechanism::new(robot).expect("valid");
    let answer = base_parameters(&mechanism, &options).expect("decided");
    assert!(answer.diagnosis.clear, "{:?}", answer.diagnosis.messages);
    answer
}

/// c, b and the parameters that are regrouped away.
fn counts(robot: &RobotDescription, model: Model) -> (usize, usize, String) {
    let answer = answer(robot, model, Engine::Exact);
    assert_eq!(answer.engine, Engine::Precise, "never called exact");
    let space = answer.mechanism.parameters();
    let away: Vec<&str> = answer
        .regrouped
        .iter()
        .map(|&c| space.labels()[c].as_str())
        .collect();
    (
        space.len() - answer.no_effect.len(),
        answer.rank(),
        away.join(" "),
    )
}

/// The counts of a float program that closed the loop by iteration.
#[test]
fn a_four_bar_in_closed_form_has_its_known_base_parameters() {
    let in_plane = read(&format!("gravity = [0, -9.81, 0]\n{FOUR_BAR}"));
    let normal = read(&format!("gravity = [0, 0, -9.81]\n{FOUR_BAR}"));
    for model in Model::ALL {
        let expected = (11, 8, "Ia_1 M_2 MX_3".to_owned());
        assert_eq!(counts(&in_plane, model), expected, "{}", model.name());
        let expected = (7, 4, "Ia_1 M_2 ZZ_3".to_owned());
        assert_eq!(counts(&normal, model), expected, "{}", model.name());
    }
}

#[test]
fn the_power_of_the_torque_is_the_rate_of_the_energy_on_a_four_bar() {
    let robot = Mechanism::new(&read(&format!("gravity = [1, -9.81, 3]\n{FOUR_BAR}")));
    let regressor = Regressor::new(&robot.expect("valid"));
    let width = regressor.parameters().len();
    let rows = |model, [q, qd, qdd]: [f64; 3]| {
        let states = States {
            q: &[q],
            qd: &[qd],
            qdd: &[qdd],
        };
        let mut out = vec![f64::NAN; width];
        regressor.fill(model, states, &mut out).expect("a state");
        out
    };
    let mut random = SplitMix64::new(5);
    for _ in 0..50 {
        let [q, qd, qdd] = [3.0, 1.0, 2.0].map(|size| random.uniform(-size, size));
        let at = |t: f64| {
            rows(
                Model::H,
                [q + qd * t + qdd * t * t / 2.0, qd + qdd * t, qdd],
            )
        };
        let (before, after) = (at(-STEP), at(STEP));
        let d = rows(Model::D, [q, qd, qdd]);
        for column in 0..width {
            let rate = (after[column] - before[column]) / (2.0 * STEP);
            assert!((d[column] * qd - rate).abs() < DIFFERENCES * (1.0 + rate.abs()));
        }
    }
}

/// Sums of multiples, once as such and once as expressions.
#[test]
fn expressions_of_sums_give_the_base_parameters_of_the_sums() {
    let mut compared = 0;
    for seed in 0..40 {
        let family = Family {
            links: (2, 5),
            ..Family::default()
        };
        let sums = coupled(family.robot(seed), seed);
        if sums.couples.is_empty() {
            continue;
        }
        compared += 1;
        let mut formulas = sums.clone();
        for couple in &mut formulas.couples {
            let terms = couple.terms.iter();
            let terms: Vec<String> = terms
                .map(|t| format!("({:?}) * q['{}']", t.multiplier.value, t.joint))
                .collect();
            let text = format!("({:?}) + {}", couple.offset.value, terms.join(" + "));
            let formula = Formula::parse(&text, &[]).expect("an expression");
            couple.expression = Some(Expression { text, formula });
            couple.terms.clear();
        }
        let mechanism = Mechanism::new(&sums).expect("valid");
        let all: Vec<usize> = (0..mechanism.parameters().len()).collect();
        let exact = decide_exactly(&mechanism, Model::D, &all, seed).expect("decided");
        let options = Options::default();
        let other = base_parameters(&Mechanism::new(&formulas).expect("valid"), &options);
        let other = other.expect("decided");
        assert_eq!(other.base, exact.kept, "seed {seed}");
        assert_eq!(other.no_effect, exact.no_effect, "seed {seed}");
    }
    assert!(compared > 20);
}

/// A crank and a slide of a piston engine: half of all positions have a value where the
/// rod is shorter than the crank.
#[test]
fn configurations_without_a_value_are_drawn_again() {
    let engine = |rod: f64| {
        read(&format!(
            r#"
            gravity = [0, -9.81, 0]
            [[link]]
            name = "crank"
            alpha = 0
            d = 0
            r = 0
            [[link]]
            name = "piston"
            antecedent = "base"
            joint = "prismatic"
            gamma = "90 deg"
            alpha = "90 deg"
            d = 0
            theta = 0
            [[couple]]
            joint = "piston"
            expression = "0.1*cos(q.crank) + sqrt({rod}*{rod} - 0.01*sin(q.crank)*sin(q.crank))"
            "#
        ))
    };
    for rod in [0.3, 0.05] {
        let robot = engine(rod);
        assert_eq!(robot.links[1].joint, JointKind::Prismatic);
        let [d, h] = [Model::D, Model::H].map(|model| answer(&robot, model, Engine::Precise));
        assert_eq!(d.base, h.base);
        assert!(d.rank() > 0);
    }
    let never = engine(0.3).couples[0].clone();
    let text = never
        .expression
        .expect("an expression")
        .text
        .replace("sqrt(", "sqrt(-1 - ");
    let mut robot = engine(0.3);
    let formula = Formula::parse(&text, &[]).expect("an expression");
    robot.couples[0].expression = Some(Expression { text, formula });
    let refused = base_parameters(&Mechanism::new(&robot).expect("valid"), &Options::default());
    assert!(matches!(refused, Err(BaseError::Samples(_))), "{refused:?}");
}
