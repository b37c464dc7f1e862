//! The matrix types of LAPACK's tests of QR with column pivoting: six of dchkq3, nineteen of dchkqp3rk.

use super::{Rng, with_singular_values};
use roberval_linalg::Matrix;

/// A test matrix, and its singular values where they are known by construction.
pub struct Case {
    pub name: &'static str,
    pub w: Matrix,
    pub sigma: Option<Vec<f64>>,
}

/// Number of types that [`case`] knows.
pub const TYPES: usize = 25;

/// Condition numbers of the hard types: 0.1 / eps, and its square root.
const COND_HARD: f64 = 0.1 / f64::EPSILON;

/// Near underflow and near overflow, with room for the norm of the largest matrix.
const TINY: f64 = 1e-300;
const HUGE: f64 = 1e300;

/// Type `kind` in a `rows` x `cols` version: 0..6 of dchkq3, the others of dchkqp3rk.
pub fn case(kind: usize, rows: usize, cols: usize, rng: &mut Rng) -> Case {
    match kind {
        0..6 => of_dchkq3(kind, rows, cols, rng),
        6..18 => masked(kind, rows, cols, rng),
        _ => conditioned(kind, rows, cols, rng),
    }
}

fn of_dchkq3(kind: usize, rows: usize, cols: usize, rng: &mut Rng) -> Case {
    let (least, half) = (rows.min(cols), cols / 2);
    // LAPACK fixes these columns in front; without that switch a heavy weight does it.
    let heavy: (&'static str, &dyn Fn(usize) -> bool) = match kind {
        0 => return known("q3 zero", rows, cols, vec![0.0; least], rng),
        1 => {
            return known(
                "q3 one small",
                rows,
                cols,
                one_small(least, COND_HARD.sqrt()),
                rng,
            );
        }
        2 => {
            return known(
                "q3 geometric",
                rows,
                cols,
                geometric(least, COND_HARD.sqrt()),
                rng,
            );
        }
        3 => ("q3 first half heavy", &|j| j < half),
        4 => ("q3 last half heavy", &|j| j >= half),
        _ => ("q3 every second heavy", &|j| j % 2 == 1),
    };
    let plain = known(heavy.0, rows, cols, geometric(least, 1e4), rng).w;
    let weight = |j| if heavy.1(j) { 1000.0 } else { 1.0 };
    let w = Matrix::from_fn(rows, cols, |i, j| plain[(i, j)] * weight(j));
    Case {
        name: heavy.0,
        w,
        sigma: None,
    }
}

/// Random entries, some of them zero.
fn masked(kind: usize, rows: usize, cols: usize, rng: &mut Rng) -> Case {
    let half = cols / 2;
    let (name, zero): (_, &dyn Fn(usize, usize) -> bool) = match kind {
        6 => ("3rk zero", &|_, _| true),
        7 => ("3rk diagonal", &|i, j| i != j),
        8 => ("3rk upper", &|i, j| i > j),
        9 => ("3rk lower", &|i, j| i < j),
        10 => ("3rk first column 0", &|_, j| j == 0),
        11 => ("3rk last column 0", &|_, j| j + 1 == cols),
        12 => ("3rk middle column 0", &|_, j| j == half),
        13 => ("3rk first half 0", &|_, j| j < half),
        14 => ("3rk last half 0", &|_, j| j >= half),
        15 => ("3rk middle half 0", &|_, j| {
            j >= cols / 4 && j < cols / 4 + half
        }),
        16 => ("3rk odd columns 0", &|_, j| j % 2 == 0),
        _ => ("3rk even columns 0", &|_, j| j % 2 == 1),
    };
    let w = Matrix::from_fn(
        rows,
        cols,
        |i, j| if zero(i, j) { 0.0 } else { rng.uniform() },
    );
    Case {
        name,
        w,
        sigma: None,
    }
}

fn conditioned(kind: usize, rows: usize, cols: usize, rng: &mut Rng) -> Case {
    let least = rows.min(cols);
    let one_large = |i| if i == 0 { 1.0 } else { 1.0 / COND_HARD };
    let (name, sigma, unit) = match kind {
        18 => ("3rk cond 2", geometric(least, 2.0), 1.0),
        19 => (
            "3rk cond sqrt(.1/eps)",
            geometric(least, COND_HARD.sqrt()),
            1.0,
        ),
        20 => ("3rk cond .1/eps", geometric(least, COND_HARD), 1.0),
        21 => ("3rk one small .1/eps", one_small(least, COND_HARD), 1.0),
        22 => (
            "3rk one large .1/eps",
            (0..least).map(one_large).collect(),
            1.0,
        ),
        23 => ("3rk near underflow", geometric(least, 2.0), TINY),
        24 => ("3rk near overflow", geometric(least, 2.0), HUGE),
        _ => unreachable!("types are 0..{TYPES}"),
    };
    let plain = known(name, rows, cols, sigma, rng);
    let w = Matrix::from_fn(rows, cols, |i, j| unit * plain.w[(i, j)]);
    let sigma = plain
        .sigma
        .map(|sigma| sigma.into_iter().map(|s| unit * s).collect());
    Case { name, w, sigma }
}

fn geometric(least: usize, cond: f64) -> Vec<f64> {
    let steps = (least.max(2) - 1) as f64;
    (0..least).map(|i| cond.powf(-(i as f64) / steps)).collect()
}

fn one_small(least: usize, cond: f64) -> Vec<f64> {
    (0..least)
        .map(|i| if i + 1 == least { 1.0 / cond } else { 1.0 })
        .collect()
}

fn known(name: &'static str, rows: usize, cols: usize, sigma: Vec<f64>, rng: &mut Rng) -> Case {
    let w = with_singular_values(rows, cols, &sigma, rng);
    Case {
        name,
        w,
        sigma: Some(sigma),
    }
}
