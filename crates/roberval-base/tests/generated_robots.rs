//! The method's own laws on generated chains and trees.

use roberval_base::{
    Choice, Engine, Model, Options, Samples, Tolerance, base_parameters, compare, observe,
};
use roberval_mechanism::{
    Couple, Geometry, Mechanism, Origin, RobotDescription, SourceFormat, Term,
};
use roberval_scalar::{Quantity, SplitMix64};
use roberval_testkit::{Family, lengths_mut};

const ROBOTS: u64 = 300;

/// Rounding of W X against W1 XB1, relative to the sizes summed.
const REGROUPING_ROUNDING: f64 = 1e-11;

fn robot(seed: u64) -> Mechanism {
    let format = if seed.is_multiple_of(2) {
        SourceFormat::Mdh
    } else {
        SourceFormat::Urdf
    };
    let family = Family {
        format,
        ..Family::default()
    };
    let robot = family.robot(seed);
    let floats = seed % 5 == 4;
    let robot = if floats {
        robot.with_floating_base()
    } else {
        robot
    };
    Mechanism::new(&robot).expect("a generated robot is valid")
}

#[test]
fn all_models_and_engines_give_one_answer() {
    let mut wrong = Vec::new();
    for seed in 0..ROBOTS {
        let robot = robot(seed);
        let comparison =
            compare(&robot, &Choice::Paper, Tolerance::default(), seed).expect("valid");
        if !comparison.agree {
            let ranks: Vec<_> = comparison
                .routes
                .iter()
                .map(|r| {
                    (
                        r.answer.rank(),
                        r.answer.no_effect.len(),
                        r.same_columns,
                        r.beta_difference,
                        r.answer.diagnosis.messages.clone(),
                    )
                })
                .collect();
            wrong.push((seed, robot.links.len(), ranks));
        }
    }
    assert!(
        wrong.is_empty(),
        "{} of {ROBOTS}: {:#?}",
        wrong.len(),
        &wrong[..wrong.len().min(3)]
    );
}

/// A joint that follows another at a rational gear, on a base that floats.
#[test]
fn floating_robots_with_geared_joints_have_one_answer() {
    let number = |text: &str| Quantity::parse_number(text, &[]).expect("a number");
    let mut coupled = 0;
    for seed in 0..12 {
        let family = Family {
            links: (2, 5),
            ..Family::default()
        };
        let mut description = family.robot(seed);
        let joints = description.links.iter().filter(|l| l.joint.has_axis());
        let names: Vec<String> = joints.map(|l| l.name.clone()).collect();
        let [first, .., last] = &names[..] else {
            continue;
        };
        coupled += 1;
        description.couples.push(Couple {
            joint: last.clone(),
            terms: vec![Term {
                joint: first.clone(),
                multiplier: number(["-1", "3/2", "2", "-1/2"][seed as usize % 4]),
            }],
            offset: number("0"),
            expression: None,
        });
        let robot = Mechanism::new(&description.with_floating_base()).expect("valid");
        assert_eq!(robot.positions(), 7 + names.len() - 1);
        let answer = compare(&robot, &Choice::Paper, Tolerance::default(), seed).expect("valid");
        assert!(answer.agree, "robot {seed}");
    }
    assert!(coupled > 6);
}

#[test]
fn the_reduced_model_gives_the_torques_of_the_full_one_at_fresh_samples() {
    for seed in 0..ROBOTS {
        let robot = robot(seed);
        let answer = base_parameters(
            &robot,
            &Options {
                seed,
                ..Options::default()
            },
        )
        .expect("valid");
        let x = robot.standard_parameters().expect("inertias");
        let xb = answer.values(&x).expect("right length");
        let samples = Samples::draw(&robot, 5, !seed).expect("samples");
        let w = observe(&robot, Model::D, &samples).expect("fits").w;
        let reduced = w.select_columns(&answer.base);
        for row in 0..w.rows() {
            let full: f64 = (0..w.cols()).map(|j| w[(row, j)] * x[j]).sum();
            let size: f64 = (0..w.cols()).map(|j| (w[(row, j)] * x[j]).abs()).sum();
            let ours: f64 = xb
                .iter()
                .enumerate()
                .map(|(i, xb)| reduced[(row, i)] * xb)
                .sum();
            assert!(
                (full - ours).abs() <= REGROUPING_ROUNDING * (1.0 + size),
                "robot {seed}: {full} {ours}"
            );
        }
    }
}

#[test]
fn the_answer_does_not_depend_on_the_seed() {
    for seed in 0..100 {
        let robot = robot(seed);
        let answer = |sample_seed| {
            let options = Options {
                seed: sample_seed,
                model: Model::H,
                ..Options::default()
            };
            let answer = base_parameters(&robot, &options).expect("valid");
            (answer.no_effect, answer.base, answer.unchanged)
        };
        assert_eq!(answer(1), answer(99), "robot {seed}");
    }
}

#[test]
fn every_member_of_the_family_gives_the_same_torques() {
    for seed in 0..60 {
        let robot = robot(seed);
        let answer = base_parameters(&robot, &Options::default()).expect("valid");
        let x = robot.standard_parameters().expect("inertias");
        let mut random = SplitMix64::new(seed);
        let xr2: Vec<f64> = answer
            .regrouped
            .iter()
            .map(|_| random.uniform(-1.0, 1.0))
            .collect();
        let xr1 = answer.regrouped_values(&x, &xr2).expect("right length");
        let mut xr = vec![0.0; x.len()];
        for (&c, v) in answer
            .base
            .iter()
            .zip(&xr1)
            .chain(answer.regrouped.iter().zip(&xr2))
        {
            xr[c] = *v;
        }
        let xm = answer.minimum_norm(&x).expect("right length");
        let norm = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>();
        assert!(norm(&xm) <= norm(&xr) * (1.0 + 1e-12), "XM is the shortest");
        let samples = Samples::draw(&robot, 5, !seed).expect("samples");
        let w = observe(&robot, Model::D, &samples).expect("fits").w;
        for row in 0..w.rows() {
            let times = |x: &[f64]| (0..w.cols()).map(|j| w[(row, j)] * x[j]).sum::<f64>();
            let size: f64 = (0..w.cols()).map(|j| (w[(row, j)] * x[j]).abs()).sum();
            for other in [&xr, &xm] {
                assert!((times(&x) - times(other)).abs() <= REGROUPING_ROUNDING * (1.0 + size));
            }
        }
    }
}

#[test]
fn no_choice_changes_the_number_or_the_model() {
    for seed in 0..80 {
        let robot = robot(seed);
        let space = robot.parameters();
        let paper = base_parameters(&robot, &Options::default()).expect("valid");
        let keep: Vec<String> = paper
            .regrouped
            .iter()
            .rev()
            .take(3)
            .map(|&c| space.labels()[c].clone())
            .collect();
        let drop: Vec<String> = paper
            .regrouped_into
            .iter()
            .take(2)
            .map(|&c| space.labels()[c].clone())
            .collect();
        let prefer = Choice::Prefer {
            keep: keep.clone(),
            drop,
        };
        for choice in [Choice::Pivoted, prefer] {
            let answer = base_parameters(
                &robot,
                &Options {
                    choice: choice.clone(),
                    ..Options::default()
                },
            )
            .expect("valid");
            assert_eq!(answer.rank(), paper.rank(), "robot {seed}");
            assert_eq!(answer.no_effect, paper.no_effect);
            assert!(
                answer.diagnosis.clear,
                "robot {seed}: {:?}",
                answer.diagnosis.messages
            );
            if let (Choice::Prefer { .. }, Some(first)) = (&choice, keep.first()) {
                let column = space.column(first).expect("a label");
                assert!(
                    answer.base.contains(&column),
                    "the first wish is always granted"
                );
            }
        }
    }
}

/// No-effect, base and unchanged columns by every engine.
fn columns(robot: &RobotDescription) -> Vec<[Vec<usize>; 3]> {
    let mechanism = Mechanism::new(robot).expect("valid");
    let answer = |engine| {
        let options = Options {
            engine,
            ..Options::default()
        };
        let answer = base_parameters(&mechanism, &options).expect("valid");
        [answer.no_effect, answer.base, answer.unchanged]
    };
    Engine::ALL.map(answer).to_vec()
}

#[test]
fn the_answer_does_not_depend_on_the_unit_of_length() {
    for seed in 0..60 {
        let description = robot(seed).description;
        let mut in_mm = (*description).clone();
        let mut numbers = lengths_mut(&mut in_mm);
        for number in &mut numbers {
            let text = format!("1000*({})", number.text);
            **number = Quantity::parse_number(&text, &[]).expect("a product");
        }
        for g in &mut in_mm.gravity {
            *g = Quantity::parse_number(&format!("1000*({})", g.text), &[]).expect("a product");
        }
        assert_eq!(columns(&description), columns(&in_mm), "robot {seed}");
    }
}

#[test]
fn the_answer_does_not_depend_on_the_choice_of_the_base_frame() {
    let number = |text: &str| Quantity::parse_number(text, &[]).expect("a number");
    for seed in (1..121).step_by(2) {
        let description = robot(seed).description;
        let mut moved = (*description).clone();
        // The new base frame is turned by -90 degrees about z and shifted.
        let placement = Origin {
            joint: "base".to_owned(),
            xyz: [number("0.3"), number("-1.7"), number("0.67")],
            rpy: [number("0"), number("0"), number("pi/2")],
        };
        for link in moved.links.iter_mut().filter(|l| l.antecedent.is_none()) {
            let Geometry::Placed { origins, .. } = &mut link.geometry else {
                panic!("robots of odd seeds have URDF placements")
            };
            origins.insert(0, placement.clone());
        }
        let [x, y, z] = description.gravity.clone();
        moved.gravity = [number(&format!("-({})", y.text)), x, z];
        assert_eq!(columns(&description), columns(&moved), "robot {seed}");
    }
}
