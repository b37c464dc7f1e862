//! Scaled samples: S about 100 on the PUMA, and the same base parameters on every robot.

use std::ops::ControlFlow;

use roberval_base::{
    BaseError, Engine, Model, Options, Samples, Scaling, ScalingOptions, base_parameters,
    base_parameters_at, scale,
};
use roberval_mechanism::{Mechanism, SourceFormat};
use roberval_regressor::Regressor;
use roberval_testkit::Family;

/// The paper's "about 100" for the PUMA.
const ABOUT_100: f64 = 150.0;
/// |T_41,41| is rounding noise: ratios to it differ by this factor between seeds.
const GAP_LOTTERY: f64 = 3.0;
/// S of one matrix reached on two ways; its smallest entry is a difference of numbers
/// some hundred times larger.
const S_ROUNDING: f64 = 1e-10;

fn puma() -> Mechanism {
    let description = roberval_formats::load("puma560").expect("in the catalogue");
    Mechanism::new(&description).expect("valid")
}

fn generated(seed: u64) -> Mechanism {
    let format = if seed.is_multiple_of(2) {
        SourceFormat::Mdh
    } else {
        SourceFormat::Urdf
    };
    let family = Family {
        links: (1, 7),
        format,
        ..Family::default()
    };
    Mechanism::new(&family.robot(seed)).expect("a generated robot is valid")
}

fn scaled(robot: &Mechanism, model: Model, seed: u64) -> Scaling {
    let options = ScalingOptions {
        model,
        seed,
        ..ScalingOptions::default()
    };
    scale(robot, &options, |_| ControlFlow::Continue(())).expect("valid options")
}

#[test]
fn the_pumas_h_of_55_rows_reaches_s_of_about_100_for_several_seeds() {
    for seed in 0..3 {
        let scaling = scaled(&puma(), Model::H, seed);
        assert_eq!((scaling.w.rows(), scaling.w.cols()), (55, 55));
        assert!(
            scaling.before.s > 1e4,
            "random samples are badly scaled: {}",
            scaling.before.s
        );
        assert!(scaling.after.s <= ABOUT_100, "{}", scaling.after.s);
        assert_eq!((scaling.before.rank, scaling.after.rank), (40, 40));
        let (before, after) = (scaling.before.gap, scaling.after.gap);
        assert!(
            after.expect("15 dependent columns") * GAP_LOTTERY >= before.expect("as before"),
            "{before:?} {after:?}"
        );
        assert!(scaling.after.j < scaling.before.j);
    }
}

#[test]
fn the_pumas_d_and_d0_are_scaled_as_well() {
    for model in [Model::D, Model::D0] {
        let scaling = scaled(&puma(), model, 1);
        assert!(
            scaling.after.s <= ABOUT_100 && scaling.after.s < scaling.before.s / 10.0,
            "{model:?}: {} {}",
            scaling.before.s,
            scaling.after.s
        );
        assert_eq!((scaling.before.rank, scaling.after.rank), (40, 40));
    }
}

#[test]
fn s_is_the_ratio_of_the_extreme_energy_differences() {
    let (robot, scaling) = (puma(), scaled(&puma(), Model::H, 7));
    let regressor = Regressor::new(&robot);
    let width = regressor.parameters().len();
    let mut h = vec![0.0; scaling.samples.count * width];
    let states = scaling.samples.states();
    regressor
        .fill(Model::H, states, &mut h)
        .expect("states fit");
    let (reference, rows) = h.split_at(width);
    let sizes: Vec<f64> = rows
        .chunks(width)
        .flat_map(|row| {
            scaling
                .columns
                .iter()
                .map(|&j| (row[j] - reference[j]).abs())
        })
        .collect();
    let high = sizes.iter().copied().fold(0.0, f64::max);
    let low = sizes.iter().copied().fold(f64::INFINITY, f64::min);
    let s = scaling.after.s;
    assert!(
        (high / low - s).abs() <= S_ROUNDING * s,
        "{} {s}",
        high / low
    );
    let worst_row = scaling.row_s.iter().copied().fold(0.0, f64::max);
    assert!(worst_row <= s && scaling.row_s.len() == 55);
}

#[test]
fn on_generated_robots_s_falls_and_the_base_parameters_stay() {
    for seed in 0..30 {
        let robot = generated(seed);
        for model in Model::ALL {
            let options = ScalingOptions {
                model,
                seed,
                starts: 60,
                rounds: 1,
                ..ScalingOptions::default()
            };
            let scaling = scale(&robot, &options, |_| ControlFlow::Continue(())).expect("valid");
            let (before, after) = (scaling.before, scaling.after);
            assert!(after.s < before.s || scaling.columns.len() == 1);
            assert_eq!(before.rank, after.rank, "robot {seed}, {model:?}");
            let options = Options {
                model,
                engine: Engine::Qrii,
                ..Options::default()
            };
            let random = base_parameters(&robot, &options).expect("valid");
            let answer = base_parameters_at(&robot, &options, &scaling.samples).expect("valid");
            assert_eq!(answer.base, random.base, "robot {seed}, {model:?}");
            assert_eq!(answer.regrouped, random.regrouped);
            assert!(answer.diagnosis.clear, "{:?}", answer.diagnosis.messages);
        }
    }
}

#[test]
fn a_poor_search_leaves_the_lucky_random_samples_of_a_single_joint() {
    let family = Family {
        links: (1, 1),
        ..Family::default()
    };
    let mut kept = 0;
    for seed in 0..200 {
        let options = ScalingOptions {
            seed,
            starts: 0,
            rounds: 0,
            ..ScalingOptions::default()
        };
        let robot = Mechanism::new(&family.robot(seed)).expect("valid");
        let scaling = scale(&robot, &options, |_| ControlFlow::Continue(())).expect("valid");
        assert!(scaling.after.s <= scaling.before.s, "robot {seed}");
        kept += usize::from(scaling.columns.len() > 1 && scaling.after == scaling.before);
    }
    assert!(kept > 0, "no random sample set was lucky");
}

#[test]
fn the_same_seed_gives_the_same_samples_and_another_seed_others() {
    let samples = |seed| scaled(&generated(4), Model::H, seed).samples;
    assert_eq!(samples(1), samples(1));
    assert_ne!(samples(1), samples(2));
}

#[test]
fn a_search_stops_when_it_is_told_to() {
    let mut asked = 0;
    let result = scale(&puma(), &ScalingOptions::default(), |progress| {
        assert_eq!(progress.done, asked, "searches are counted one by one");
        asked += 1;
        if progress.done == 5 {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    });
    assert_eq!(result, Err(BaseError::Stopped { done: 5, most: 220 }));
}

#[test]
fn a_target_out_of_reach_ends_after_the_promised_number_of_searches() {
    let options = ScalingOptions {
        target: 1.0,
        starts: 5,
        rounds: 2,
        ..ScalingOptions::default()
    };
    let mut asked = 0;
    let scaling = scale(&puma(), &options, |progress| {
        asked += 1;
        assert!(asked <= progress.most);
        ControlFlow::Continue(())
    });
    assert!(scaling.is_ok());
    assert_eq!(asked, 3 * 55);
}

#[test]
fn rows_are_as_asked_and_impossible_numbers_of_them_are_refused() {
    let with = |rows| {
        let options = ScalingOptions {
            rows: Some(rows),
            starts: 1,
            rounds: 0,
            ..ScalingOptions::default()
        };
        scale(&puma(), &options, |_| ControlFlow::Continue(()))
    };
    assert_eq!(with(80).expect("enough").w.rows(), 80);
    assert_eq!(
        with(54),
        Err(BaseError::TooFewRows {
            rows: 54,
            columns: 55
        })
    );
    assert!(matches!(with(0), Err(BaseError::TooFewRows { .. })));
    assert!(matches!(
        with(usize::MAX),
        Err(BaseError::TooManyRows { .. })
    ));
}

#[test]
fn samples_that_do_not_fit_the_robot_are_refused() {
    let samples = Samples {
        q: vec![0.0; 120],
        qd: vec![0.0; 119],
        qdd: vec![0.0; 120],
        count: 20,
        redrawn: 0,
    };
    let answer = base_parameters_at(&puma(), &Options::default(), &samples);
    assert!(matches!(answer, Err(BaseError::Regressor(_))), "{answer:?}");
}

#[test]
fn a_request_for_more_rows_than_memory_is_an_error() {
    let options = Options {
        rows: Some(usize::MAX),
        ..Options::default()
    };
    let answer = base_parameters(&puma(), &options);
    assert!(matches!(answer, Err(BaseError::TooManyRows { .. })));
}
