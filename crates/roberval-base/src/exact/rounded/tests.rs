use roberval_mechanism::SourceFormat;
use roberval_testkit::{Angles, Family};

use super::*;
use crate::{ExactDecision, decide_exactly};

/// Of the exact relation; the rows are right to some 1e-30, and so are the coefficients.
const PRECISE: f64 = 1e-27;

/// Of the relation with coefficients rounded to doubles.
const ROUNDED: f64 = 1e-13;

fn family(angles: Angles, seed: u64) -> Family {
    Family {
        angles,
        links: (2, 7),
        format: if seed.is_multiple_of(2) {
            SourceFormat::Mdh
        } else {
            SourceFormat::Urdf
        },
        ..Family::default()
    }
}

fn robot(angles: Angles, seed: u64) -> Mechanism {
    Mechanism::new(&family(angles, seed).robot(seed)).expect("valid")
}

fn decide(robot: &Mechanism, model: Model, seed: u64) -> ExactDecision {
    let order: Vec<usize> = (0..robot.parameters().len()).collect();
    decide_exactly(robot, model, &order, seed).expect("decided")
}

fn doubles(beta: &[Vec<ExactNumber>]) -> Vec<f64> {
    beta.iter().flatten().map(ExactNumber::to_f64).collect()
}

/// Forgets all exact forms but zeros, and rounds again.
fn rounded_only(robot: &Mechanism, model: Model, exact: &ExactDecision) -> (Vec<f64>, f64) {
    let mut beta = exact.beta.clone();
    for x in beta.iter_mut().flatten().filter(|x| !x.is_zero()) {
        *x = ExactNumber::Rounded(f64::NAN);
    }
    let (kept, deleted) = (&exact.kept, &exact.deleted);
    let error = round_open_entries(robot, model, kept, deleted, &mut beta, 5).expect("rounded");
    (doubles(&beta), error)
}

/// W over at least `rows` rows.
fn w_of(
    robot: &Mechanism,
    model: Model,
    rows: usize,
    seed: u64,
) -> Result<Vec<Vec<DoubleDouble>>, ExactError> {
    let count = rows.div_ceil(model.rows(robot.independent())) + 1;
    columns_of_w(robot, model, &Samples::draw(robot, count, seed)?)
}

#[test]
fn rounding_gives_the_doubles_next_to_the_exact_fractions_and_surds() {
    let (mut compared, mut surds) = (0, 0);
    for angles in [Angles::Right, Angles::Fifteens] {
        for seed in 0..60 {
            let robot = robot(angles, seed);
            let model = Model::ALL[seed as usize % 3];
            let exact = decide(&robot, model, seed);
            assert_eq!(exact.rounding_error, 0.0, "all entries have exact forms");
            let (found, error) = rounded_only(&robot, model, &exact);
            assert!(error <= WANTED_ERROR, "robot {seed}: {error:e}");
            assert_eq!(found, doubles(&exact.beta), "robot {seed} {model:?}");
            compared += found.iter().filter(|x| **x != 0.0).count();
            let entries = exact.beta.iter().flatten();
            surds += entries
                .filter(|x| matches!(x, ExactNumber::Surd(_)))
                .count();
        }
    }
    assert!(
        compared > 2000 && surds > 200,
        "{compared} with {surds} surds"
    );
}

#[test]
fn coefficients_of_general_angles_do_not_depend_on_the_seed() {
    let (mut robots, mut entries) = (0, 0);
    for seed in 0..150 {
        let robot = robot(Angles::Oblique, seed);
        let model = Model::ALL[seed as usize % 3];
        let [first, second, third] = [0, 1, 2].map(|k| decide(&robot, model, 10 * seed + k));
        assert!(first.rounding_error <= WANTED_ERROR, "robot {seed}");
        let bits = |d: &ExactDecision| doubles(&d.beta);
        assert_eq!(bits(&first), bits(&second), "robot {seed}");
        assert_eq!(bits(&first), bits(&third), "robot {seed}");
        let rounded = first
            .beta
            .iter()
            .flatten()
            .filter(|x| !x.is_exact())
            .count();
        robots += usize::from(rounded > 0);
        entries += rounded;
    }
    assert!(robots >= 100, "{robots} robots with {entries} entries");
}

#[test]
fn relations_hold_at_fresh_samples() {
    for seed in 0..40 {
        let robot = robot(Angles::Oblique, seed);
        let model = Model::ALL[seed as usize % 3];
        let exact = decide(&robot, model, seed);
        let w = w_of(&robot, model, 50, 987_654).expect("evaluated");
        for (j, &gone) in exact.deleted.iter().enumerate() {
            let column: Vec<_> = exact
                .beta
                .iter()
                .map(|row| row[j].to_f64().into())
                .collect();
            let kept: Vec<&[DoubleDouble]> = exact.kept.iter().map(|&i| &w[i][..]).collect();
            let rest = residual(&kept, &column, &w[gone]);
            let scale = largest(&w[gone]);
            assert!(
                largest(&rest) <= ROUNDED * scale,
                "robot {seed}: {:e}",
                largest(&rest)
            );
            // And before rounding, over the rows of other samples, to all digits.
            let open = (0..column.len()).filter(|&i| !exact.beta[i][j].is_zero());
            let a: Vec<&[DoubleDouble]> = open.map(|i| kept[i]).collect();
            let solution = Solution::of(&a, &w[gone]);
            let rest = residual(&a, &solution.x, &w[gone]);
            assert!(
                largest(&rest) <= PRECISE * scale,
                "robot {seed}: {:e}",
                largest(&rest)
            );
        }
    }
}

fn largest(x: &[DoubleDouble]) -> f64 {
    x.iter().map(|x| x.to_f64().abs()).fold(0.0, f64::max)
}

#[test]
fn the_error_estimate_covers_the_error() {
    // Of exact forms the error is known: it must be below the estimate, which is itself
    // not far above.
    for seed in 0..60 {
        let robot = robot(Angles::Fifteens, seed);
        let exact = decide(&robot, Model::D, seed);
        let w = w_of(&robot, Model::D, 2 * robot.parameters().len(), 3).expect("evaluated");
        for (j, &gone) in exact.deleted.iter().enumerate() {
            let open: Vec<usize> = (0..exact.kept.len())
                .filter(|&i| !exact.beta[i][j].is_zero())
                .collect();
            let a: Vec<&[DoubleDouble]> = open.iter().map(|&i| &w[exact.kept[i]][..]).collect();
            let solution = Solution::of(&a, &w[gone]);
            for ((&i, &x), &error) in open.iter().zip(&solution.x).zip(&solution.errors) {
                let known = exact.beta[i][j].to_double_double();
                let found = (x - known).abs().to_f64();
                // A pair of doubles cannot hold more than this of the number itself.
                let ulp = known.to_f64().abs() * f64::EPSILON * f64::EPSILON;
                assert!(found <= error + ulp, "robot {seed}: {found:e} > {error:e}");
            }
        }
    }
}

#[test]
fn wide_numbers_give_the_exact_fractions_and_surds_to_all_digits() {
    let mut compared = 0;
    for angles in [Angles::Right, Angles::Fifteens] {
        for seed in 0..12 {
            let robot = robot(angles, seed);
            let model = Model::ALL[seed as usize % 3];
            let exact = decide(&robot, model, seed);
            let (kept, gone) = (&exact.kept, &exact.deleted);
            let found = wide::solve(&robot, model, kept, gone, seed).expect("solved");
            for (i, row) in exact.beta.iter().enumerate() {
                for (j, x) in row.iter().enumerate().filter(|(_, x)| !x.is_zero()) {
                    let (value, error) = found.entry(i, j);
                    assert_eq!(value, x.to_f64(), "robot {seed} {model:?}");
                    assert!(error < 1e-100, "robot {seed} {model:?}: {error:e}");
                    compared += 1;
                }
            }
        }
    }
    assert!(compared > 500, "{compared}");
}

#[test]
fn base_columns_that_are_not_independent_are_noticed_by_wide_numbers() {
    let robot = robot(Angles::Right, 3);
    let exact = decide(&robot, Model::D, 3);
    let one_too_many = [&exact.kept[..], &exact.deleted[..1]].concat();
    let gone = &exact.deleted[1..2];
    let found = wide::solve(&robot, Model::D, &one_too_many, gone, 3).expect("tried");
    assert_eq!(found.entry(0, 0).1, f64::INFINITY);
}
