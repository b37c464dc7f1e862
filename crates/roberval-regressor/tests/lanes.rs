//! Batches in lanes of every width against the scalar path, over generated robots.

use std::ops::RangeInclusive;

use roberval_mechanism::{Mechanism, SourceFormat};
use roberval_regressor::{Columns, Model, Regressor, RegressorError, States, Writing};
use roberval_scalar::{SplitMix64, Width};
use roberval_testkit::{Angles, Family, coupled, make_planar};

/// What issue 5 asks, relative to the largest entry.
const ACCURACY: f64 = 1e-14;

const ROBOTS: u64 = 120;

/// Whole and incomplete tiles of all widths, and one sample alone.
const SAMPLES: [usize; 5] = [1, 2, 7, 8, 21];

/// Trees, some with links that have no body, trees that float, and trees whose joints follow
/// from others.
fn robots() -> impl Iterator<Item = Mechanism> {
    (0..ROBOTS).map(|seed| {
        let family = Family {
            format: [SourceFormat::Mdh, SourceFormat::Urdf][seed as usize % 2],
            angles: [Angles::Right, Angles::Mixed, Angles::Oblique][seed as usize % 3],
            ..Family::default()
        };
        let mut robot = family.robot(seed);
        if seed % 8 == 5 {
            make_planar(&mut robot, 0);
        }
        let robot = match seed % 4 {
            2 => robot.with_floating_base(),
            3 => coupled(robot, seed),
            _ => robot,
        };
        Mechanism::new(&robot).expect("valid")
    })
}

/// A robot with a joint that follows another by a ratio that varies: of its states none stays
/// out of another's way.
fn bent() -> Mechanism {
    let text = "
        [[link]]
        name = 'a'
        joint = 'revolute'
        xyz = [0, 0, 0]
        [[link]]
        name = 'b'
        joint = 'revolute'
        xyz = [0.5, 0, 0]
        axis = [0, 1, 0]
        [[couple]]
        joint = 'b'
        expression = 'atan2(0.3 * sin(q.a), 0.3 * cos(q.a) - 1)'
    ";
    let described = roberval_formats::parse_toml(text, "bent").expect("valid");
    Mechanism::new(&described).expect("valid")
}

fn widths() -> impl Iterator<Item = Width> {
    let lanes = |width: &Width| width.is_available() && *width > Width::Plain;
    Width::ALL.into_iter().filter(lanes)
}

struct Batch {
    arrays: [Vec<f64>; 3],
}

impl Batch {
    fn random(robot: &Mechanism, samples: usize, seed: u64) -> Self {
        let regressor = Regressor::new(robot);
        let (positions, n) = (regressor.positions(), regressor.independent());
        let mut random = SplitMix64::new(seed);
        let mut draw = |size: f64, width: usize| -> Vec<f64> {
            let count = samples * width;
            (0..count).map(|_| random.uniform(-size, size)).collect()
        };
        let mut arrays = [draw(3.0, positions), draw(2.0, n), draw(4.0, n)];
        if positions > n {
            for q in arrays[0].chunks_mut(positions) {
                let length = q[3..7].iter().map(|x| x * x).sum::<f64>().sqrt();
                q[3..7].iter_mut().for_each(|x| *x /= length);
            }
        }
        Self { arrays }
    }

    fn states(&self) -> States<'_> {
        let [q, qd, qdd] = &self.arrays;
        States { q, qd, qdd }
    }

    /// One of so many samples.
    fn one(&self, sample: usize, samples: usize) -> Self {
        let one = |array: &Vec<f64>| {
            let width = array.len() / samples;
            array[sample * width..][..width].to_vec()
        };
        Self {
            arrays: self.arrays.each_ref().map(one),
        }
    }
}

fn rows(regressor: &Regressor, model: Model, batch: &Batch, samples: usize) -> Vec<f64> {
    let size = model.rows(regressor.independent()) * regressor.parameters().len();
    // Zeros must be written too.
    let mut out = vec![f64::NAN; samples * size];
    regressor
        .fill(model, batch.states(), &mut out)
        .expect("valid");
    out
}

fn same(found: &[f64], expected: &[f64]) -> bool {
    let bits = |x: &f64| x.to_bits();
    found.iter().map(bits).eq(expected.iter().map(bits))
}

#[test]
fn lanes_agree_with_the_scalar_path_and_among_each_other() {
    for (seed, robot) in robots().enumerate() {
        let samples = SAMPLES[seed % SAMPLES.len()];
        let batch = Batch::random(&robot, samples, seed as u64);
        let plain = Regressor::new(&robot).with_width(Width::Plain);
        for model in Model::ALL {
            let expected = rows(&plain, model, &batch, samples);
            let largest = expected.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
            let mut first: Option<Vec<f64>> = None;
            for width in widths() {
                let found = rows(&plain.clone().with_width(width), model, &batch, samples);
                for (found, expected) in found.iter().zip(&expected) {
                    let error = (found - expected).abs();
                    assert!(
                        error <= ACCURACY * largest,
                        "robot {seed}, {width:?}, {model:?}"
                    );
                }
                let first = first.get_or_insert_with(|| found.clone());
                assert!(
                    same(&found, first),
                    "robot {seed}: bits of {width:?} differ"
                );
            }
        }
    }
}

#[test]
fn torques_are_the_rows_times_x() {
    for (seed, robot) in robots().enumerate().take(40) {
        let samples = SAMPLES[seed % SAMPLES.len()];
        let batch = Batch::random(&robot, samples, seed as u64);
        let x = robot.standard_parameters().expect("generated with values");
        for width in Width::ALL.into_iter().filter(|width| width.is_available()) {
            let regressor = Regressor::new(&robot).with_width(width);
            let mut torques = vec![f64::NAN; samples * regressor.independent()];
            regressor
                .torques(&x, batch.states(), &mut torques)
                .expect("valid");
            let rows = rows(&regressor, Model::D, &batch, samples);
            for (row, torque) in rows.chunks(x.len()).zip(&torques) {
                let terms = row.iter().zip(&x).map(|(d, x)| d * x);
                let size: f64 = terms.clone().map(f64::abs).sum();
                let error = (terms.sum::<f64>() - torque).abs();
                assert!(error <= ACCURACY * size, "robot {seed}, {width:?}");
            }
        }
    }
}

#[test]
fn torques_have_the_same_bits_in_lanes_of_every_width_and_alone() {
    for (seed, robot) in robots().enumerate().take(40) {
        let samples = SAMPLES[seed % SAMPLES.len()];
        let batch = Batch::random(&robot, samples, seed as u64);
        let x = robot.standard_parameters().expect("generated with values");
        let torques = |width: Width, batch: &Batch, samples: usize| {
            let regressor = Regressor::new(&robot).with_width(width);
            let mut torques = vec![f64::NAN; samples * regressor.independent()];
            regressor
                .torques(&x, batch.states(), &mut torques)
                .expect("valid");
            torques
        };
        let expected = torques(Width::One, &batch, samples);
        for width in widths() {
            let all = torques(width, &batch, samples);
            assert!(same(&all, &expected), "robot {seed}, {width:?}");
            let alone = (0..samples).flat_map(|k| torques(width, &batch.one(k, samples), 1));
            let alone: Vec<f64> = alone.collect();
            assert!(same(&alone, &expected), "robot {seed}, {width:?}, alone");
        }
    }
}

#[test]
fn calls_leave_nothing_behind_for_others() {
    for (seed, robot) in robots().enumerate().take(20) {
        let samples = SAMPLES[seed % SAMPLES.len()];
        let batch = Batch::random(&robot, samples, seed as u64);
        let x = robot.standard_parameters().expect("generated with values");
        let twice: Vec<f64> = x.iter().map(|x| 2.0 * x).collect();
        for width in Width::ALL.into_iter().filter(|width| width.is_available()) {
            let one = Regressor::new(&robot).with_width(width);
            let torques = |regressor: &Regressor, x: &[f64]| {
                let mut torques = vec![f64::NAN; samples * regressor.independent()];
                regressor
                    .torques(x, batch.states(), &mut torques)
                    .expect("valid");
                torques
            };
            // A clone has no working memory of earlier calls.
            for x in [&x, &twice, &x] {
                let found = torques(&one, x);
                assert!(
                    same(&found, &torques(&one.clone(), x)),
                    "robot {seed}, {width:?}"
                );
                for model in [Model::D, Model::D0, Model::D, Model::H, Model::D] {
                    let found = rows(&one, model, &batch, samples);
                    let expected = rows(&one.clone(), model, &batch, samples);
                    assert!(
                        same(&found, &expected),
                        "robot {seed}, {width:?}, {model:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn a_sample_has_the_same_bits_alone_and_among_others() {
    for (seed, robot) in robots().enumerate().take(20) {
        let samples = 11;
        let batch = Batch::random(&robot, samples, seed as u64);
        let regressor = Regressor::new(&robot);
        let all = rows(&regressor, Model::D, &batch, samples);
        for sample in 0..samples {
            let one = rows(&regressor, Model::D, &batch.one(sample, samples), 1);
            assert!(same(&one, &all[sample * one.len()..][..one.len()]));
        }
    }
}

#[test]
fn rows_past_the_cache_and_between_zeros_are_the_same_wherever_they_begin() {
    // From rows of a number to some thousands.
    for (seed, robot) in trees(16..=20)
        .chain(trees(40..=44))
        .chain(robots().take(36))
        .enumerate()
    {
        for (samples, width) in SAMPLES.iter().flat_map(|&s| widths().map(move |w| (s, w))) {
            let batch = Batch::random(&robot, samples, seed as u64);
            let regressor = Regressor::new(&robot).with_width(width);
            let model = Model::ALL[seed % 3];
            // Of the first link alone: a tile then ends with lines of zeros.
            let [few, first] = [1 + seed % 9, 10];
            let [few, first] =
                [few, first].map(|n| regressor.columns(model, &Vec::from_iter(0..n)));
            for columns in [None, Some(&few), Some(&first)] {
                let all = (samples, 0, Writing::default());
                let expected = part(&regressor, model, columns, &batch, all);
                for (past_cache, keep_zeros) in [(true, false), (true, true), (false, true)] {
                    let writing = Writing {
                        past_cache,
                        keep_zeros,
                    };
                    let to = (samples, seed % 9, writing);
                    let rows = part(&regressor, model, columns, &batch, to);
                    assert!(same(&rows, &expected), "robot {seed}, {samples} samples");
                }
            }
        }
    }
}

#[test]
fn packed_numbers_past_the_cache_are_the_same_wherever_they_begin() {
    for (seed, robot) in robots().take(36).enumerate() {
        for width in widths() {
            let batch = Batch::random(&robot, 37, seed as u64);
            let regressor = Regressor::new(&robot).with_width(width);
            let model = Model::ALL[seed % 3];
            let layout = regressor.packed_layout(model);
            let count = layout.len(37, regressor.lanes());
            let [mut expected, mut memory] = [count, count + 17].map(|count| vec![f64::NAN; count]);
            let states = batch.states();
            let filled = regressor.fill_packed_part(model, states, &mut expected, false);
            filled.expect("valid");
            let (head, out) = memory.split_at_mut(seed % 9);
            let (out, tail) = out.split_at_mut(count);
            let filled = regressor.fill_packed_part(model, states, out, true);
            filled.expect("valid");
            assert!(same(out, &expected), "robot {seed}, {width:?}");
            assert!(head.iter().chain(&*tail).all(|x| x.is_nan()));
        }
    }
}

#[test]
fn zeros_to_keep_that_are_none_are_named() {
    let mut named = 0;
    for (seed, robot) in robots().enumerate().take(20) {
        for (samples, width) in SAMPLES.iter().flat_map(|&s| widths().map(move |w| (s, w))) {
            let batch = Batch::random(&robot, samples, seed as u64);
            let regressor = Regressor::new(&robot).with_width(width);
            let rows = rows(&regressor, Model::D, &batch, samples);
            let (n, columns) = (regressor.independent(), regressor.parameters().len());
            // All samples, or the last one alone.
            for from in [0, (samples - 1) * n * columns] {
                let mut out = vec![0.0; rows.len()];
                out[from..].fill(7.0);
                match regressor.check_zeros(Model::D, None, &out) {
                    Err(RegressorError::NotZero {
                        sample,
                        row,
                        column,
                        value,
                    }) => {
                        let at = (sample * n + row) * columns + column;
                        assert!(at >= from && rows[at] == 0.0 && value == 7.0);
                        named += 1;
                    }
                    // Zeros beside numbers are written with them.
                    other => {
                        let writing = Writing {
                            past_cache: seed % 2 == 0,
                            keep_zeros: true,
                        };
                        let states = batch.states();
                        let filled = regressor.fill_part(Model::D, None, states, &mut out, writing);
                        assert!(other.is_ok() && filled.is_ok() && same(&out, &rows));
                    }
                }
            }
        }
    }
    assert!(named > 0);
}

/// A few large trees.
fn trees(links: RangeInclusive<usize>) -> impl Iterator<Item = Mechanism> {
    let family = Family {
        links: links.into_inner(),
        ..Family::default()
    };
    (0..2).map(move |seed| Mechanism::new(&family.robot(seed)).expect("valid"))
}

/// Rows that begin so many numbers into an array, of which no other is touched.
fn part(
    regressor: &Regressor,
    model: Model,
    columns: Option<&Columns>,
    batch: &Batch,
    (samples, before, writing): (usize, usize, Writing),
) -> Vec<f64> {
    let width = columns.map_or(regressor.parameters().len(), |columns| {
        columns.columns().len()
    });
    let count = samples * model.rows(regressor.independent()) * width;
    let mut memory = vec![f64::NAN; before + count + 9];
    let (head, out) = memory.split_at_mut(before);
    let (out, tail) = out.split_at_mut(count);
    if writing.keep_zeros {
        out.fill(0.0);
    }
    regressor
        .fill_part(model, columns, batch.states(), out, writing)
        .expect("valid");
    assert!(head.iter().chain(&*tail).all(|x| x.is_nan()));
    out.to_vec()
}

#[test]
fn chosen_columns_and_packed_tiles_are_those_of_all_columns() {
    for (seed, robot) in robots().enumerate().take(40) {
        let samples = SAMPLES[seed % SAMPLES.len()];
        let batch = Batch::random(&robot, samples, seed as u64);
        for (width, model) in widths().flat_map(|w| Model::ALL.map(|m| (w, m))) {
            let regressor = Regressor::new(&robot).with_width(width);
            let all = rows(&regressor, model, &batch, samples);
            let columns = regressor.parameters().len();
            let chosen: Vec<usize> = (0..columns).filter(|c| c % 3 != seed % 3).rev().collect();
            let mut some = vec![f64::NAN; all.len() / columns * chosen.len()];
            regressor
                .fill_columns(model, &chosen, batch.states(), &mut some)
                .expect("valid");
            let picked = all
                .chunks(columns)
                .flat_map(|row| chosen.iter().map(|&c| row[c]));
            assert!(same(&some, &picked.collect::<Vec<_>>()), "robot {seed}");

            let layout = regressor.packed_layout(model);
            let mut packed = vec![f64::NAN; layout.len(samples, regressor.lanes())];
            regressor
                .fill_packed(model, batch.states(), &mut packed)
                .expect("valid");
            let mut unpacked = vec![0.0; all.len()];
            let (lanes, rows) = (regressor.lanes(), model.rows(regressor.independent()));
            for (sample, unpacked) in unpacked.chunks_mut(rows * columns).enumerate() {
                let tile = &packed[sample / lanes * lanes * layout.entries().len()..];
                for (slot, (row, column)) in layout.entries().iter().enumerate() {
                    unpacked[row * columns + column] = tile[slot * lanes + sample % lanes];
                }
            }
            assert!(same(&unpacked, &all), "robot {seed}");
        }
    }
}

#[test]
fn a_state_that_is_not_finite_is_named_wherever_it_stands() {
    let robot = robots()
        .find(|r| r.dof() == 5 && Regressor::new(r).expansion().is_none() && r.positions() == 5)
        .expect("among so many");
    let regressor = Regressor::new(&robot);
    for (array, at) in [(0, 0), (1, 52), (2, 99)] {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut batch = Batch::random(&robot, 20, 1);
            batch.arrays[array][at] = value;
            let mut out = vec![0.0; 20 * 5 * regressor.parameters().len()];
            let fault = regressor.fill(Model::D, batch.states(), &mut out);
            let Err(RegressorError::NotFinite {
                array: name,
                sample,
                joint,
                ..
            }) = fault
            else {
                panic!("{fault:?}");
            };
            assert_eq!(
                (name, sample, joint),
                (["q", "qd", "qdd"][array], at / 5, at % 5)
            );
        }
    }
}

#[test]
fn what_a_model_does_not_look_at_may_be_anything() {
    for (seed, robot) in robots().take(40).chain([bent()]).enumerate() {
        let samples = SAMPLES[seed % SAMPLES.len()];
        for (model, unused) in [(Model::D0, 1), (Model::H, 2)] {
            let mut batch = Batch::random(&robot, samples, seed as u64);
            let (mut zeros, seen) = (batch.arrays.clone(), 3 - unused);
            batch.arrays[unused].fill(f64::NAN);
            zeros[unused].fill(0.0);
            let zeros = Batch { arrays: zeros };
            for width in Width::ALL.into_iter().filter(|width| width.is_available()) {
                let regressor = Regressor::new(&robot).with_width(width);
                let [found, expected] =
                    [&batch, &zeros].map(|batch| rows(&regressor, model, batch, samples));
                assert!(
                    same(&found, &expected),
                    "robot {seed}, {model:?}, {width:?}"
                );
                let mut bad = zeros.arrays.clone();
                *bad[seen].last_mut().expect("a state") = f64::NAN;
                bad[unused].fill(f64::NAN);
                let bad = Batch { arrays: bad };
                let mut out = vec![0.0; found.len()];
                let fault = regressor.fill(model, bad.states(), &mut out);
                let name = ["q", "qd", "qdd"][seen];
                assert!(
                    matches!(fault, Err(RegressorError::NotFinite { array, sample, .. })
                        if (array, sample) == (name, samples - 1)),
                    "robot {seed}, {model:?}, {width:?}: {fault:?}"
                );
            }
        }
    }
}
