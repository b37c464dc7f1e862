//! Chains of couples, resolved to the joints that move by themselves.

use roberval_mechanism::{Closure, Couple, CoupleError, Mechanism, Term, VariableLaw};
use roberval_scalar::Quantity;
use roberval_testkit::{Family, coupled};

fn quantity(text: &str) -> Quantity {
    Quantity::parse_angle(text, &[]).expect("a number")
}

fn couple(joint: &str, terms: &[(&str, &str)], offset: &str) -> Couple {
    let term = |(joint, multiplier): &(&str, &str)| Term {
        joint: (*joint).to_owned(),
        multiplier: quantity(multiplier),
    };
    Couple {
        joint: joint.to_owned(),
        terms: terms.iter().map(term).collect(),
        offset: quantity(offset),
        expression: None,
    }
}

/// Links "1" to "n" with revolute joints.
fn chain(n: usize, couples: Vec<Couple>) -> Result<Mechanism, CoupleError> {
    let family = Family {
        links: (n, n),
        prismatic: 0.0,
        fixed: 0.0,
        ..Family::default()
    };
    let mut robot = family.robot(1);
    robot.couples = couples;
    let order: Vec<usize> = (0..n).collect();
    Closure::of(&robot, &order)?;
    Ok(Mechanism::new(&robot).expect("valid"))
}

fn law(robot: &Mechanism, variable: usize) -> (Vec<(usize, String)>, String) {
    match &robot.closure.as_ref().expect("couples").laws[variable] {
        VariableLaw::Affine(law) => {
            let terms = law.terms.iter().map(|(p, m)| (*p, m.text.clone()));
            (terms.collect(), law.offset.text.clone())
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_chain_is_resolved_to_fractions_of_the_joint_that_moves() {
    let robot = chain(
        4,
        vec![
            couple("1", &[("3", "-1.5")], "0.25"),
            couple("3", &[("4", "1/3"), ("2", "2")], "pi/2"),
        ],
    )
    .expect("valid");
    assert_eq!((robot.dof(), robot.independent()), (4, 2));
    let names: Vec<&str> = robot
        .independent_joints()
        .iter()
        .map(|l| l.name.as_str())
        .collect();
    assert_eq!(names, ["2", "4"]);
    let (terms, offset) = law(&robot, 0);
    assert_eq!(terms, [(0, "-3".to_owned()), (1, "-1/2".to_owned())]);
    let value = 0.25 - 1.5 * std::f64::consts::FRAC_PI_2;
    assert!((quantity(&offset).value - value).abs() < 1e-15, "{offset}");
}

#[test]
fn couples_that_determine_nothing_are_refused() {
    let refused = |couples| chain(3, couples).expect_err("refused").to_string();
    let cancel = refused(vec![
        couple("1", &[("2", "1"), ("3", "1")], "0"),
        couple("2", &[("3", "-1")], "0"),
    ]);
    assert!(
        cancel.contains("\"1\"") && cancel.contains("cancel"),
        "{cancel}"
    );
    let circle = refused(vec![
        couple("1", &[("2", "1")], "0"),
        couple("2", &[("3", "1")], "0"),
        couple("3", &[("1", "1")], "0"),
    ]);
    assert!(
        circle.contains("\"1\" from \"2\" from \"3\" from \"1\""),
        "{circle}"
    );
    let unknown = refused(vec![couple("1", &[("9", "1")], "0")]);
    assert!(unknown.contains("\"9\", which does not exist"), "{unknown}");
}

/// Ten thousand gears in a row: neither a deep recursion nor a number without end.
#[test]
fn long_chains_end_with_an_answer_or_a_refusal() {
    const LONG: usize = 10_000;
    let gears = |multiplier: &str| {
        let couples = (2..=LONG)
            .map(|k| couple(&k.to_string(), &[(&(k - 1).to_string(), multiplier)], "0.1"));
        chain(LONG, couples.collect())
    };
    let robot = gears("-1").expect("valid");
    assert_eq!(robot.independent(), 1);
    assert_eq!(law(&robot, LONG - 1).0, [(0, "-1".to_owned())]);
    assert!(matches!(gears("1.1"), Err(CoupleError::TooLong { .. })));
    assert!(matches!(gears("sqrt(2)"), Err(CoupleError::TooLong { .. })));
}

#[test]
fn generated_couples_leave_a_joint_that_moves_by_itself() {
    for seed in 0..200 {
        let robot = Mechanism::new(&coupled(Family::default().robot(seed), seed)).expect("valid");
        let dependent = robot.description.couples.len();
        assert_eq!(robot.independent() + dependent, robot.dof());
        assert!(robot.independent() > 0);
    }
}
