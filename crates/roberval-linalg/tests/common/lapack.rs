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

/// Type `kind` in a `rows` x `cols` version.
pub fn case(kind: usize, rows: usize, cols: usize, rng: &mut Rng) -> Case {
    let least = rows.min(cols);
    let geometric = |cond: f64| -> Vec<f64> {
        (0..least)
            .map(|i| cond.powf(-(i as f64) / (least.max(2) - 1) as f64))
            .collect()
    };
    let one_small = |cond: f64| -> Vec<f64> {
        (0..least)
            .map(|i| if i + 1 == least { 1.0 / cond } else { 1.0 })
            .collect()
    };
    let known = |name, sigma: Vec<f64>, rng: &mut Rng| {
        let w = with_singular_values(rows, cols, &sigma, rng);
        Case {
            name,
            w,
            sigma: Some(sigma),
        }
    };
    let masked = |name, zero: &dyn Fn(usize, usize) -> bool, rng: &mut Rng| {
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
    };
    let half = cols / 2;
    match kind {
        0 => Case {
            name: "q3 zero",
            w: Matrix::zeros(rows, cols),
            sigma: Some(vec![0.0; least]),
        },
        1 => known("q3 one small", one_small(COND_HARD.sqrt()), rng),
        2 => known("q3 geometric", geometric(COND_HARD.sqrt()), rng),
        // LAPACK fixes these columns in front; without that switch a heavy weight does it.
        3 => weighted(
            "q3 first half heavy",
            &|j| j < half,
            known("", geometric(1e4), rng),
        ),
        4 => weighted(
            "q3 last half heavy",
            &|j| j >= half,
            known("", geometric(1e4), rng),
        ),
        5 => weighted(
            "q3 every second heavy",
            &|j| j % 2 == 1,
            known("", geometric(1e4), rng),
        ),
        6 => Case {
            name: "3rk zero",
            w: Matrix::zeros(rows, cols),
            sigma: Some(vec![0.0; least]),
        },
        7 => masked("3rk diagonal", &|i, j| i != j, rng),
        8 => masked("3rk upper", &|i, j| i > j, rng),
        9 => masked("3rk lower", &|i, j| i < j, rng),
        10 => masked("3rk first column 0", &|_, j| j == 0, rng),
        11 => masked("3rk last column 0", &|_, j| j + 1 == cols, rng),
        12 => masked("3rk middle column 0", &|_, j| j == half, rng),
        13 => masked("3rk first half 0", &|_, j| j < half, rng),
        14 => masked("3rk last half 0", &|_, j| j >= half, rng),
        15 => masked(
            "3rk middle half 0",
            &|_, j| j >= cols / 4 && j < cols / 4 + half,
            rng,
        ),
        16 => masked("3rk odd columns 0", &|_, j| j % 2 == 0, rng),
        17 => masked("3rk even columns 0", &|_, j| j % 2 == 1, rng),
        18 => known("3rk cond 2", geometric(2.0), rng),
        19 => known("3rk cond sqrt(.1/eps)", geometric(COND_HARD.sqrt()), rng),
        20 => known("3rk cond .1/eps", geometric(COND_HARD), rng),
        21 => known("3rk one small .1/eps", one_small(COND_HARD), rng),
        22 => known(
            "3rk one large .1/eps",
            (0..least)
                .map(|i| if i == 0 { 1.0 } else { 1.0 / COND_HARD })
                .collect(),
            rng,
        ),
        23 => scaled("3rk near underflow", TINY, known("", geometric(2.0), rng)),
        24 => scaled("3rk near overflow", HUGE, known("", geometric(2.0), rng)),
        _ => unreachable!("types are 0..{TYPES}"),
    }
}

fn weighted(name: &'static str, heavy: &dyn Fn(usize) -> bool, case: Case) -> Case {
    let w = Matrix::from_fn(case.w.rows(), case.w.cols(), |i, j| {
        case.w[(i, j)] * if heavy(j) { 1000.0 } else { 1.0 }
    });
    Case {
        name,
        w,
        sigma: None,
    }
}

fn scaled(name: &'static str, factor: f64, case: Case) -> Case {
    let w = Matrix::from_fn(case.w.rows(), case.w.cols(), |i, j| factor * case.w[(i, j)]);
    let sigma = case
        .sigma
        .map(|sigma| sigma.into_iter().map(|s| factor * s).collect());
    Case { name, w, sigma }
}
