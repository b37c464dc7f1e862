//! The exact engine against the paper's fractions, the float engines, and itself.

use std::path::Path;

use roberval_base::{
    Engine, ExactNumber, Model, Options, base_parameters, choose_exactly, decide_exactly,
};
use roberval_mechanism::{CleanPolicy, Mechanism, RobotDescription, SourceFormat, clean};
use roberval_testkit::{Angles, Family, literal_style};
use serde_json::Value;

fn puma() -> Mechanism {
    let description = roberval_formats::load("puma560").expect("in the catalogue");
    Mechanism::new(&description).expect("valid")
}

fn all_columns(robot: &Mechanism) -> Vec<usize> {
    (0..robot.parameters().len()).collect()
}

#[test]
fn beta_of_the_puma_is_the_papers_fractions_exactly_by_every_model() {
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/spec/puma560_expected.json");
    let Ok(text) = std::fs::read_to_string(&path) else {
        eprintln!("skipped: no {} beside the checkout", path.display());
        return;
    };
    let expected: Value = serde_json::from_str(&text).expect("JSON");
    let robot = puma();
    let space = robot.parameters();
    for model in Model::ALL {
        let exact = decide_exactly(&robot, model, &all_columns(&robot), 0).expect("decided");
        assert_eq!(
            (exact.kept.len(), exact.deleted.len(), exact.no_effect.len()),
            (40, 15, 11)
        );
        assert!(exact.generic.is_empty());
        assert!(exact.failure_probability < 1e-28);
        let mut nonzero = 0;
        for (i, &base) in exact.kept.iter().enumerate() {
            for (j, &gone) in exact.deleted.iter().enumerate() {
                let value = &exact.beta[i][j];
                if value.is_zero() {
                    continue;
                }
                nonzero += 1;
                let fraction = &expected["beta"][&space.labels()[base]][&space.labels()[gone]];
                assert_eq!(value.to_string(), fraction.as_str().expect("a fraction"));
                let float = &expected["beta_float"][&space.labels()[base]][&space.labels()[gone]];
                assert_eq!(
                    value.to_f64(),
                    float.as_f64().expect("a float"),
                    "correctly rounded"
                );
            }
        }
        assert_eq!(nonzero, 58);
    }
}

#[test]
fn exact_and_float_engines_agree_on_generated_robots() {
    let mut rounded = 0;
    for seed in 0..300 {
        let format = if seed % 2 == 0 {
            SourceFormat::Mdh
        } else {
            SourceFormat::Urdf
        };
        let robot = Mechanism::new(
            &Family {
                format,
                ..Family::default()
            }
            .robot(seed),
        )
        .expect("valid");
        for model in [Model::D, Model::H] {
            let exact = decide_exactly(&robot, model, &all_columns(&robot), seed).expect("decided");
            let float = base_parameters(
                &robot,
                &Options {
                    model,
                    engine: Engine::Qr,
                    seed,
                    ..Options::default()
                },
            )
            .expect("valid");
            assert_eq!(exact.no_effect, float.no_effect, "robot {seed} {model:?}");
            assert_eq!(exact.kept, float.base, "robot {seed} {model:?}");
            assert_eq!(exact.deleted, float.regrouped, "robot {seed} {model:?}");
            let scale = float.beta.max_abs().max(1.0);
            for i in 0..exact.kept.len() {
                for j in 0..exact.deleted.len() {
                    let known = &exact.beta[i][j];
                    rounded += usize::from(!known.is_exact());
                    assert!(
                        (known.to_f64() - float.beta[(i, j)]).abs() < 1e-9 * scale,
                        "robot {seed}: {known} {}",
                        float.beta[(i, j)]
                    );
                }
            }
        }
    }
    assert!(
        rounded > 100,
        "only {rounded} coefficients without an exact form"
    );
}

#[test]
fn robots_with_angles_of_fifteen_degrees_have_coefficients_with_square_roots() {
    let mut surds = 0;
    for seed in 0..60 {
        let family = Family {
            angles: Angles::Fifteens,
            links: (2, 5),
            ..Family::default()
        };
        let robot = Mechanism::new(&family.robot(seed)).expect("valid");
        let exact = decide_exactly(&robot, Model::D, &all_columns(&robot), seed).expect("decided");
        let float = base_parameters(&robot, &Options::default()).expect("valid");
        assert_eq!(exact.kept, float.base);
        let scale = float.beta.max_abs().max(1.0);
        for (i, row) in exact.beta.iter().enumerate() {
            for (j, x) in row.iter().enumerate() {
                assert!(
                    x.is_exact(),
                    "robot {seed}: {} has an exact form",
                    float.beta[(i, j)]
                );
                assert!((x.to_f64() - float.beta[(i, j)]).abs() < 1e-9 * scale);
                surds += usize::from(matches!(x, ExactNumber::Surd(_)));
            }
        }
    }
    assert!(surds > 50, "only {surds} coefficients with square roots");
}

/// The decimals of right angles in files: a double's, and roundings of them.
const STYLES: [usize; 6] = [16, 11, 9, 6, 5, 4];

#[test]
fn robots_written_with_any_number_of_decimals_have_the_rank_of_the_exact_ones() {
    let rank = |robot: &RobotDescription| {
        let robot = Mechanism::new(robot).expect("valid");
        let kept = choose_exactly(&robot, Model::D, &all_columns(&robot), 1);
        kept.expect("in a field").len()
    };
    let mut literal = 0;
    for seed in 0..300 {
        let family = Family {
            format: [SourceFormat::Mdh, SourceFormat::Urdf][seed as usize % 2],
            angles: [Angles::Right, Angles::Fifteens][seed as usize / 2 % 2],
            ..Family::default()
        };
        let robot = family.robot(seed);
        let expected = rank(&robot);
        for decimals in STYLES {
            let styled = literal_style(&robot, decimals);
            let cleaned = clean(&styled, &CleanPolicy::default()).description;
            assert_eq!(
                rank(&cleaned),
                expected,
                "robot {seed}, {decimals} decimals"
            );
        }
        literal += usize::from(rank(&literal_style(&robot, 4)) != expected);
    }
    // The study is about something.
    assert!(
        literal > 100,
        "{literal} robots have another rank as written"
    );
}
