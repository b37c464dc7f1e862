//! The accumulator against a one-shot Householder factorisation, and its promises.

use roberval_mechanism::{Mechanism, SourceFormat};
use roberval_reduce::{
    CheckpointError, Factor, Friction, ReduceError, Reduction, Samples, Unsolvable, Weights,
};
use roberval_regressor::{Model, Regressor, States};
use roberval_scalar::{DoubleDouble, SplitMix64, Width};
use roberval_testkit::{Family, coupled};

/// R against one-shot Householder, relative to the largest entry (issue 5).
const ACCURACY: f64 = 1e-14;

const ALL: Friction = Friction {
    viscous: true,
    coulomb: true,
    offset: true,
};

const SPEEDS: Friction = Friction {
    offset: false,
    ..ALL
};

const NONE: Friction = Friction {
    viscous: false,
    coulomb: false,
    offset: false,
};

struct Data {
    /// Coordinates of q, and rows.
    nq: usize,
    n: usize,
    q: Vec<f64>,
    qd: Vec<f64>,
    qdd: Vec<f64>,
    tau: Vec<f64>,
    weights: Vec<f64>,
}

impl Data {
    fn random(n: usize, samples: usize, seed: u64) -> Self {
        let mut random = SplitMix64::new(seed);
        let mut draw = |low: f64, high: f64| -> Vec<f64> {
            (0..n * samples)
                .map(|_| random.uniform(low, high))
                .collect()
        };
        Self {
            nq: n,
            n,
            q: draw(-3.0, 3.0),
            qd: draw(-2.0, 2.0),
            qdd: draw(-4.0, 4.0),
            tau: draw(-9.0, 9.0),
            weights: draw(0.1, 4.0),
        }
    }

    /// Data of a robot that may float.
    fn of(regressor: &Regressor, samples: usize, seed: u64) -> Self {
        let (nq, n) = (regressor.positions(), regressor.independent());
        let mut data = Self::random(n, samples, seed);
        if nq > n {
            let mut q = Vec::with_capacity(samples * nq);
            for (sample, joints) in data.q.chunks(n).enumerate() {
                let half = sample as f64;
                q.extend(&joints[..3]);
                q.extend([0.6 * half.sin(), 0.8 * half.sin(), 0.0, half.cos()]);
                q.extend(&joints[6..]);
            }
            (data.nq, data.q) = (nq, q);
        }
        data
    }

    fn part(&self, from: usize, to: usize, weighted: bool) -> Samples<'_> {
        let cut = from * self.n..to * self.n;
        Samples {
            states: States {
                q: &self.q[from * self.nq..to * self.nq],
                qd: &self.qd[cut.clone()],
                qdd: &self.qdd[cut.clone()],
            },
            tau: &self.tau[cut.clone()],
            weights: if weighted {
                Weights::Rows(&self.weights[cut])
            } else {
                Weights::Equal
            },
        }
    }

    fn len(&self) -> usize {
        self.tau.len() / self.n
    }
}

/// Plain Householder on the dense `[W tau]`, rows of P+1 numbers; nonnegative diagonal.
fn one_shot(mut a: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let p = a[0].len();
    for k in 0..p.min(a.len()) {
        let norm = a[k..].iter().map(|row| row[k] * row[k]).sum::<f64>().sqrt();
        if norm == 0.0 {
            continue;
        }
        let beta = -norm.copysign(a[k][k]);
        let v: Vec<f64> = a[k..]
            .iter()
            .enumerate()
            .map(|(i, row)| row[k] - if i == 0 { beta } else { 0.0 })
            .collect();
        let squared: f64 = v.iter().map(|x| x * x).sum();
        for c in k..p {
            let dot: f64 = v.iter().zip(&a[k..]).map(|(v, row)| v * row[c]).sum();
            for (v, row) in v.iter().zip(&mut a[k..]) {
                row[c] -= 2.0 * dot / squared * v;
            }
        }
    }
    a.truncate(p);
    for (k, row) in a.iter_mut().enumerate() {
        let sign = 1.0_f64.copysign(row[k]);
        for (c, x) in row.iter_mut().enumerate() {
            *x = if c < k { 0.0 } else { *x * sign };
        }
    }
    a
}

fn dense(
    regressor: &Regressor,
    columns: &[usize],
    friction: Friction,
    data: &Data,
    weighted: bool,
) -> Vec<Vec<f64>> {
    let (n, count) = (data.n, data.len());
    let mut w = vec![0.0; count * n * columns.len()];
    let states = data.part(0, count, false).states;
    regressor
        .fill_columns(Model::D, columns, states, &mut w)
        .expect("valid");
    (0..count * n)
        .map(|row| {
            let mut line = w[row * columns.len()..][..columns.len()].to_vec();
            let (qd, j) = (data.qd[row], row % n);
            let kinds = [
                (friction.viscous, qd),
                (friction.coulomb, if qd == 0.0 { 0.0 } else { qd.signum() }),
                (friction.offset, 1.0),
            ];
            for (_, value) in kinds.into_iter().filter(|kind| kind.0) {
                // Nothing rubs at a base that floats.
                let first = 6 * (data.nq - n);
                line.extend((first..n).map(|i| if i == j { value } else { 0.0 }));
            }
            line.push(data.tau[row]);
            let root = if weighted {
                data.weights[row].sqrt()
            } else {
                1.0
            };
            line.iter().map(|x| x * root).collect()
        })
        .collect()
}

fn robot(seed: u64, links: (usize, usize)) -> Mechanism {
    let family = Family {
        links,
        branch: 0.3,
        format: [SourceFormat::Mdh, SourceFormat::Urdf][seed as usize % 2],
        ..Family::default()
    };
    Mechanism::new(&family.robot(seed)).expect("valid")
}

/// Every third column, in reverse: independent or not, any choice must do.
fn choice(regressor: &Regressor, seed: u64) -> Vec<usize> {
    let count = regressor.parameters().len();
    (0..count)
        .filter(|c| c % 3 != seed as usize % 3)
        .rev()
        .collect()
}

fn widths() -> impl Iterator<Item = Width> {
    Width::ALL.into_iter().filter(|width| width.is_available())
}

fn worst(factor: &Factor, expected: &[Vec<f64>]) -> f64 {
    let largest = expected
        .iter()
        .flatten()
        .fold(0.0, |m: f64, x| m.max(x.abs()));
    let mut worst: f64 = 0.0;
    for (i, row) in expected.iter().enumerate() {
        for (j, x) in row.iter().enumerate() {
            worst = worst.max((factor.entry(i, j) - x).abs() / largest);
        }
    }
    worst
}

/// Columns below this norm are the rounding of zeros.
const DUST: f64 = 1e-9;

/// Columns that really are independent: those whose pivot in the one-shot factor is clear.
fn independent(regressor: &Regressor, data: &Data) -> Vec<usize> {
    let mut kept = Vec::new();
    for column in choice(regressor, 0).into_iter().rev() {
        let mut tried = kept.clone();
        tried.push(column);
        let r = one_shot(dense(regressor, &tried, NONE, data, false));
        let k = tried.len() - 1;
        let norm = r.iter().map(|row| row[k] * row[k]).sum::<f64>().sqrt();
        if r[k][k] > 0.05 * norm && norm > DUST {
            kept = tried;
        }
    }
    kept
}

#[test]
fn the_factor_is_that_of_one_householder_factorisation() {
    for seed in 0..14 {
        let robot = robot(seed, (2, 6));
        let data = Data::random(robot.dof(), 150, seed);
        let columns = independent(&Regressor::new(&robot), &data);
        for (width, weighted) in widths().map(|w| (w, seed % 2 == 1)) {
            let regressor = Regressor::new(&robot).with_width(width);
            // An offset may be what gravity makes of M: then nothing tells them apart.
            let friction = if seed % 3 == 0 { SPEEDS } else { NONE };
            let expected = one_shot(dense(&regressor, &columns, friction, &data, weighted));
            let mut reduction =
                Reduction::new(regressor, &columns, friction).expect("no constraints");
            reduction
                .update(&data.part(0, 150, weighted))
                .expect("finite");
            let error = worst(&reduction.factor(), &expected);
            assert!(error <= ACCURACY, "robot {seed}, {width:?}: {error:e}");
        }
    }
}

#[test]
fn robots_that_float_and_joints_that_follow_reduce_as_others_do() {
    for seed in 0..13 {
        let family = Family {
            links: (2, 5),
            format: [SourceFormat::Mdh, SourceFormat::Urdf][seed as usize % 2],
            ..Family::default()
        };
        let robot = family.robot(seed);
        let robot = match seed % 3 {
            0 => robot.with_floating_base(),
            1 => coupled(robot, seed),
            _ => coupled(robot.with_floating_base(), seed),
        };
        let robot = match seed {
            12 => roberval_formats::load("four_bar").expect("in the catalogue"),
            _ => robot,
        };
        let robot = Mechanism::new(&robot).expect("valid");
        let regressor = Regressor::new(&robot);
        let data = Data::of(&regressor, 150, seed);
        let columns = independent(&regressor, &data);
        for friction in [NONE, SPEEDS] {
            let expected = one_shot(dense(&regressor, &columns, friction, &data, true));
            for width in widths() {
                let regressor = regressor.clone().with_width(width);
                let mut reduction = Reduction::new(regressor, &columns, friction).expect("valid");
                for from in (0..150).step_by(50) {
                    let part = data.part(from, from + 50, true);
                    reduction.update(&part).expect("finite");
                }
                let error = worst(&reduction.factor(), &expected);
                assert!(error <= ACCURACY, "robot {seed}, {width:?}: {error:e}");
            }
        }
    }
}

#[test]
fn every_processor_gets_the_same_bits() {
    let robot = robot(3, (4, 6));
    let regressor = Regressor::new(&robot);
    let columns = choice(&regressor, 1);
    let data = Data::random(robot.dof(), 3000, 9);
    let factor = |width: Width| {
        let regressor = regressor.clone().with_width(width);
        let mut reduction = Reduction::new(regressor, &columns, ALL).expect("valid");
        reduction.update(&data.part(0, 3000, true)).expect("finite");
        reduction.to_bytes(b"")
    };
    let mut fused = widths().filter(|width| *width > Width::Plain).map(factor);
    if let Some(first) = fused.next() {
        assert!(fused.all(|bytes| bytes == first));
    }
}

/// Torques W x without noise, rounded once.
fn exact_torques(w: &[Vec<f64>], x: &[f64]) -> Vec<f64> {
    let precise = DoubleDouble::from;
    let torque = |row: &Vec<f64>| {
        let products = row.iter().zip(x).map(|(&w, &x)| precise(w) * precise(x));
        products.fold(DoubleDouble::ZERO, |sum, x| sum + x).to_f64()
    };
    w.iter().map(torque).collect()
}

/// 1, 1.1, 1.2 .. for all columns of a dense `[W tau]`.
fn coefficients(w: &[Vec<f64>]) -> Vec<f64> {
    let columns = w[0].len() - 1;
    (0..columns).map(|k| 1.0 + 0.1 * k as f64).collect()
}

/// The coefficients from the accumulator.
fn found(
    regressor: &Regressor,
    columns: &[usize],
    friction: Friction,
    data: &Data,
) -> (Factor, Vec<f64>) {
    let mut reduction = Reduction::new(regressor.clone(), columns, friction).expect("valid");
    let all = data.part(0, data.len(), false);
    reduction.update(&all).expect("finite");
    let factor = reduction.factor();
    let x = factor.solve().expect("determined");
    (factor, x)
}

#[test]
fn units_that_make_a_condition_of_1e8_cost_no_digits() {
    /// Issue 5; of each coefficient. (Found: 1e-13.)
    const COEFFICIENTS: f64 = 1e-9;
    // Speeds in units 1e8 times as large: so are the coefficients of viscous friction, and
    // its columns are that much smaller than the others.
    const UNIT: f64 = 1e-8;
    let viscous = Friction {
        viscous: true,
        ..NONE
    };
    for seed in 0..6 {
        let robot = robot(seed, (2, 4));
        let regressor = Regressor::new(&robot);
        let mut data = Data::random(robot.dof(), 1000, seed);
        data.qd.iter_mut().for_each(|x| *x *= UNIT);
        let columns = independent(&regressor, &data);
        let w = dense(&regressor, &columns, viscous, &data, false);
        let mut truth = coefficients(&w);
        let rigid = columns.len();
        truth[rigid..].iter_mut().for_each(|x| *x /= UNIT);
        data.tau = exact_torques(&w, &truth);
        let (factor, found) = found(&regressor, &columns, viscous, &data);
        let norm = |k| {
            (0..=k)
                .map(|i| factor.entry(i, k).powi(2))
                .sum::<f64>()
                .sqrt()
        };
        let largest = (0..truth.len()).map(norm).fold(0.0, f64::max);
        assert!(largest / norm(rigid) >= 1e8, "the condition is no smaller");
        for (found, truth) in found.iter().zip(&truth) {
            let error = (found - truth).abs() / truth;
            assert!(error <= COEFFICIENTS, "robot {seed}: {error:e}");
        }
    }
}

/// The largest error of the coefficients, relative to the largest of them.
fn coefficient_error(found: &[f64], truth: &[f64]) -> f64 {
    let errors = found.iter().zip(truth).map(|(x, y)| (x - y).abs());
    errors.fold(0.0, f64::max) / truth.iter().fold(0.0, |m: f64, x| m.max(*x))
}

/// The coefficients from a triangle of `[W tau]`.
fn back_substituted(r: &[Vec<f64>]) -> Vec<f64> {
    let p = r.len() - 1;
    let mut x = vec![0.0; p];
    for i in (0..p).rev() {
        let known: f64 = (i + 1..p).map(|j| r[i][j] * x[j]).sum();
        x[i] = (r[i][p] - known) / r[i][i];
    }
    x
}

#[test]
fn columns_dependent_to_1e8_err_by_one_rounding_and_no_more_than_householder() {
    // Speeds of nearly one size make qd and sign(qd) dependent up to 1e-8: the condition of
    // W is 1e8 whatever the columns' scale, so that one rounding of W's entries, of eps,
    // may change coefficients by eps times 1e8. A backward stable method in floats can
    // promise no less: the torques' rounding alone makes 1e-10 .. 1e-9 here.
    const SPREAD: f64 = 2e-8;
    const CONDITION: f64 = 1e8;
    // What the torque shows, the sum of both coefficients, has no such factor (issue 5).
    const SUMS: f64 = 1e-9;
    for seed in [3, 4, 6, 7] {
        let robot = robot(seed, (3, 3));
        let (n, regressor) = (robot.dof(), Regressor::new(&robot));
        let columns = independent(&regressor, &Data::random(n, 200, 5));
        let (mut ours, mut householder) = (0.0, 0.0);
        for draw in 0..4 {
            let mut data = Data::random(n, 2000, draw);
            for x in &mut data.qd {
                *x = x.signum() * (1.0 + SPREAD * *x);
            }
            let w = dense(&regressor, &columns, SPEEDS, &data, false);
            let truth = coefficients(&w);
            data.tau = exact_torques(&w, &truth);
            let (_, found) = found(&regressor, &columns, SPEEDS, &data);
            let error = coefficient_error(&found, &truth);
            assert!(error <= f64::EPSILON * CONDITION, "robot {seed}: {error:e}");
            for j in columns.len()..columns.len() + n {
                let sum = |x: &[f64]| x[j] + x[j + n];
                let error = (sum(&found) - sum(&truth)).abs() / sum(&truth);
                assert!(error <= SUMS, "robot {seed}: {error:e}");
            }
            let r = one_shot(dense(&regressor, &columns, SPEEDS, &data, false));
            ours += error.powi(2);
            householder += coefficient_error(&back_substituted(&r), &truth).powi(2);
        }
        assert!(
            ours <= householder,
            "robot {seed}: {ours:e}, {householder:e}"
        );
    }
}

#[test]
fn rows_of_any_size_give_the_same_bits() {
    let robot = robot(3, (3, 4));
    let n = robot.dof();
    let regressor = Regressor::new(&robot);
    let columns = choice(&regressor, 1);
    let data = Data::random(n, 500, 2);
    let factor = |weight: f64| {
        let mut reduction = Reduction::new(regressor.clone(), &columns, ALL).expect("valid");
        let mut samples = data.part(0, 500, false);
        let weights = vec![weight; n];
        samples.weights = Weights::Joints(&weights);
        reduction.update(&samples).expect("finite");
        reduction.factor()
    };
    // Rows of 1e-120 and 1e+120.
    let of_one = factor(1.0);
    for power in [-800, 800] {
        let scaled = factor(2.0_f64.powi(power));
        let root = 2.0_f64.powi(power / 2);
        for (x, of_one) in scaled.packed().iter().zip(of_one.packed()) {
            assert!(*x == of_one * root, "{x:e} for {of_one:e}");
        }
    }
}

#[test]
fn neither_cuts_nor_threads_change_a_bit() {
    let robot = robot(3, (2, 3));
    let regressor = Regressor::new(&robot);
    let columns = choice(&regressor, 1);
    let count = 150_001;
    let data = Data::random(robot.dof(), count, 9);
    let new = |threads| {
        Reduction::new(regressor.clone(), &columns, ALL)
            .expect("valid")
            .with_threads(threads)
    };
    let mut whole = new(1);
    whole.update(&data.part(0, count, false)).expect("finite");
    let expected = whole.factor();
    assert_eq!(expected.samples(), count as u64);
    for (threads, cut) in [(2, count), (3, 70_000), (1, 997), (2, 40_961)] {
        let mut reduction = new(threads);
        for from in (0..count).step_by(cut) {
            let part = data.part(from, (from + cut).min(count), false);
            reduction.update(&part).expect("finite");
        }
        assert!(
            reduction.factor() == expected,
            "{threads} threads, cuts of {cut}"
        );
    }
    let mut single = new(1);
    let mut few = new(2);
    for sample in 0..300 {
        single
            .update(&data.part(sample, sample + 1, false))
            .expect("finite");
    }
    few.update(&data.part(0, 300, false)).expect("finite");
    assert!(single.factor() == few.factor());
}

#[test]
fn weights_of_one_and_weights_of_joints_are_what_they_say() {
    let robot = robot(5, (3, 4));
    let (n, regressor) = (robot.dof(), Regressor::new(&robot));
    let columns = choice(&regressor, 0);
    let mut data = Data::random(n, 500, 4);
    let per_joint: Vec<f64> = (0..n).map(|j| 0.5 + j as f64).collect();
    data.weights = per_joint.repeat(500);
    let factor = |weights: Option<&[f64]>, cut: usize| {
        let mut reduction = Reduction::new(regressor.clone(), &columns, NONE).expect("valid");
        for from in (0..500).step_by(cut) {
            let mut part = data.part(from, (from + cut).min(500), true);
            if let Some(weights) = weights {
                part.weights = Weights::Joints(weights);
            }
            reduction.update(&part).expect("finite");
        }
        reduction.factor()
    };
    assert!(factor(Some(&per_joint), 500) == factor(None, 500));
    assert!(factor(Some(&per_joint), 7) == factor(None, 133));
    let mut equal = Reduction::new(regressor.clone(), &columns, NONE).expect("valid");
    equal.update(&data.part(0, 500, false)).expect("finite");
    assert!(factor(Some(&vec![1.0; n]), 31) == equal.factor());
}

#[test]
fn factors_of_parts_merge_into_that_of_the_whole() {
    let robot = robot(2, (3, 5));
    let regressor = Regressor::new(&robot);
    let data = Data::random(robot.dof(), 400, 8);
    let columns = independent(&regressor, &data);
    let new = || Reduction::new(regressor.clone(), &columns, ALL).expect("valid");
    let (mut all, mut first, mut second) = (new(), new(), new());
    all.update(&data.part(0, 400, false)).expect("finite");
    first.update(&data.part(0, 150, false)).expect("finite");
    second.update(&data.part(150, 300, false)).expect("finite");
    first.merge(&second).expect("finite");
    first.update(&data.part(300, 400, false)).expect("finite");
    let (whole, parts) = (all.factor(), first.factor());
    assert_eq!(whole.samples(), parts.samples());
    let size = whole.packed().iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    for (a, b) in whole.packed().iter().zip(parts.packed()) {
        assert!((a - b).abs() <= ACCURACY * size, "{a} and {b}");
    }
    let mut empty = new();
    empty.merge(&second).expect("finite");
    assert!(empty.factor() == second.factor());
}

#[test]
fn a_checkpoint_goes_on_with_the_same_bits_and_no_damage_passes() {
    let robot = robot(3, (2, 3));
    let regressor = Regressor::new(&robot);
    let columns = choice(&regressor, 1);
    let data = Data::random(robot.dof(), 70_000, 9);
    let mut reduction = Reduction::new(regressor.clone(), &columns, ALL).expect("valid");
    reduction
        .update(&data.part(0, 40_007, false))
        .expect("finite");
    let bytes = reduction.to_bytes(b"a note of the caller's");
    let load = |bytes: &[u8]| Reduction::from_bytes(bytes, regressor.clone());
    let (mut resumed, note) = load(&bytes).expect("undamaged");
    assert_eq!(note, b"a note of the caller's");
    for accumulator in [&mut reduction, &mut resumed] {
        accumulator
            .update(&data.part(40_007, 70_000, false))
            .expect("finite");
    }
    assert!(reduction.factor() == resumed.factor());
    let another = Regressor::new(&self::robot(4, (2, 3)));
    let refused = Reduction::from_bytes(&bytes, another).map(|_| ());
    assert_eq!(refused, Err(CheckpointError::Model));
    for old in [b"RBVLQR\x002", b"RBVLIN\x001"] {
        let read = load(&[old.as_slice(), &bytes[8..]].concat()).map(|_| ());
        assert_eq!(read, Err(CheckpointError::Version));
    }
    let mut random = SplitMix64::new(7);
    for trial in 0..300 {
        let mut damaged = bytes.clone();
        let at = if trial < 128 {
            trial
        } else {
            random.below(bytes.len())
        };
        damaged[at] ^= 1 << random.below(8);
        assert!(load(&damaged).is_err(), "byte {at}");
        let cut = random.below(bytes.len());
        assert!(load(&bytes[..cut]).is_err(), "{cut} bytes");
    }
}

#[test]
fn what_is_not_finite_is_named_and_nothing_is_taken_in() {
    let robot = robot(3, (3, 3));
    let n = robot.dof();
    let regressor = Regressor::new(&robot);
    let columns = choice(&regressor, 1);
    let mut reduction = Reduction::new(regressor, &columns, NONE).expect("valid");
    let data = Data::random(n, 100, 1);
    reduction.update(&data.part(0, 100, false)).expect("finite");
    let before = reduction.factor();
    for value in [f64::NAN, f64::INFINITY] {
        let mut bad = Data::random(n, 100, 2);
        bad.tau[57 * n + 1] = value;
        match reduction.update(&bad.part(0, 100, false)) {
            // The row of the array given, however many came before.
            Err(ReduceError::NotFinite { place, .. }) => {
                assert_eq!(place.to_string(), "tau[57, 1]");
            }
            other => panic!("{other:?}"),
        }
    }
    let mut bad = Data::random(n, 100, 2);
    bad.weights[3 * n + 1] = -1.0;
    match reduction.update(&bad.part(0, 100, true)) {
        Err(ReduceError::Weight { place, .. }) => assert_eq!(place.to_string(), "weights[3, 1]"),
        other => panic!("{other:?}"),
    }
    let mut samples = bad.part(0, 100, false);
    let weights = [1.0, 1.0, f64::NAN];
    samples.weights = Weights::Joints(&weights);
    match reduction.update(&samples) {
        Err(error @ ReduceError::NotFinite { .. }) => {
            assert!(error.to_string().starts_with("weights[2] is NaN"));
        }
        other => panic!("{other:?}"),
    }
    assert!(reduction.factor() == before);
}

#[test]
fn a_sample_whose_squares_overflow_is_named_and_nothing_is_taken_in() {
    let regressor = Regressor::new(&robot(3, (3, 3)));
    let n = regressor.independent();
    let columns = choice(&regressor, 1);
    // In a tile of its own, within a tile that fills later, and in a finished block.
    for (before, count, at) in [
        (0, 1, 0),
        (1000, 1, 0),
        (100, 700, 555),
        (0, 70_000, 69_999),
    ] {
        let mut reduction = Reduction::new(regressor.clone(), &columns, NONE).expect("valid");
        reduction
            .update(&Data::random(n, before, 1).part(0, before, false))
            .expect("finite");
        let kept = reduction.to_bytes(b"");
        let refused = |reduction: &mut Reduction, bad: &Data, place: &str| {
            let error = reduction.update(&bad.part(0, count, false));
            let error = error.expect_err("beyond floats");
            assert!(error.to_string().starts_with(place), "{error}");
            assert_eq!(error.row(), Some(at as u64));
            assert!(reduction.to_bytes(b"") == kept);
        };
        let mut bad = Data::random(n, count, 2);
        bad.tau[at * n + 1] = 1e160;
        refused(&mut reduction, &bad, &format!("tau[{at}, 1] is 1e160"));
        bad = Data::random(n, count, 2);
        bad.qd[at * n] = 1e120;
        refused(&mut reduction, &bad, &format!("qd[{at}, 0] is 1e120"));
        let good = Data::random(n, count, 2);
        reduction
            .update(&good.part(0, count, false))
            .expect("finite");
        let factor = reduction.factor();
        assert!(factor.packed().iter().all(|x| x.is_finite()));
    }
}

#[test]
fn factors_whose_squares_overflow_together_are_not_merged() {
    let regressor = Regressor::new(&robot(3, (3, 3)));
    let columns = choice(&regressor, 1);
    let mut data = Data::random(regressor.independent(), 100, 2);
    let new = || Reduction::new(regressor.clone(), &columns, NONE).expect("valid");
    let (mut first, mut second) = (new(), new());
    let largest = data.tau.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let norm = data.tau.iter().map(|x| x * x).sum::<f64>().sqrt();
    assert!(largest < norm);
    // Just within the range, and so not twice.
    data.tau.iter_mut().for_each(|x| *x *= 0.99e150 / norm);
    for reduction in [&mut first, &mut second] {
        reduction.update(&data.part(0, 100, false)).expect("finite");
    }
    let kept = first.to_bytes(b"");
    let before = first.factor();
    let merged = before.merge(&second.factor());
    assert!(merged.packed().iter().all(|x| x.is_finite()));
    assert_eq!(first.merge(&second), Err(ReduceError::MergeOverflow));
    assert!(first.to_bytes(b"") == kept);
}

#[test]
fn columns_of_zeros_are_told_from_dependent_ones() {
    let regressor = Regressor::new(&robot(3, (3, 3)));
    let mut data = Data::random(regressor.independent(), 500, 2);
    let columns = independent(&regressor, &data);
    let solved = |data: &Data, columns: &[usize], friction| {
        let mut reduction = Reduction::new(regressor.clone(), columns, friction).expect("valid");
        reduction.update(&data.part(0, 500, false)).expect("finite");
        reduction.factor().solve()
    };
    // At one speed, its sign is a multiple of it.
    data.qd.iter_mut().for_each(|x| *x = 2.0);
    let column = regressor.independent();
    let dependent = solved(&data, &[], SPEEDS);
    assert_eq!(dependent, Err(Unsolvable::Undetermined { column }));
    data.qd.iter_mut().for_each(|x| *x = 0.0);
    assert_eq!(
        solved(&data, &[], SPEEDS),
        Err(Unsolvable::Zero { column: 0 })
    );
    assert!(solved(&data, &columns[..1], NONE).is_ok());
}
