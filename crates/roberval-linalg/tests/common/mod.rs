//! Generators and measures shared by the tests, with their own arithmetic: nothing here calls the
//! crate's factorisations.
#![allow(dead_code)]

use roberval_linalg::Matrix;

pub mod lapack;
pub mod modular;

/// xoshiro-free and small: SplitMix64 with a fixed seed per test.
pub struct Rng(u64);

impl Rng {
    pub fn new(seed: u64) -> Self {
        Rng(seed)
    }

    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in [0, n).
    pub fn below(&mut self, n: u64) -> u64 {
        self.next() % n
    }

    /// Uniform in [-1, 1).
    pub fn uniform(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// Standard normal, Box and Muller.
    pub fn normal(&mut self) -> f64 {
        let (u, v) = (1.0 - self.uniform().abs(), self.uniform());
        (-2.0 * u.ln()).sqrt() * (std::f64::consts::PI * v).cos()
    }

    pub fn matrix(&mut self, rows: usize, cols: usize) -> Matrix {
        Matrix::from_fn(rows, cols, |_, _| self.uniform())
    }
}

/// `Q a` (or `a Q` for `right`) with Q a product of random reflections, orthogonal to rounding.
pub fn randomly_rotated(mut a: Matrix, right: bool, rng: &mut Rng) -> Matrix {
    if right {
        return randomly_rotated(a.transpose(), false, rng).transpose();
    }
    let n = a.rows();
    for p in 0..n {
        let v: Vec<f64> = (p..n).map(|_| rng.normal()).collect();
        let square: f64 = v.iter().map(|x| x * x).sum();
        for j in 0..a.cols() {
            let x = &mut a.col_mut(j)[p..];
            let factor = 2.0 * v.iter().zip(&*x).map(|(v, x)| v * x).sum::<f64>() / square;
            x.iter_mut().zip(&v).for_each(|(x, v)| *x -= factor * v);
        }
    }
    a
}

/// A `rows` x `cols` matrix with the given singular values.
pub fn with_singular_values(rows: usize, cols: usize, sigma: &[f64], rng: &mut Rng) -> Matrix {
    let diagonal = Matrix::from_fn(rows, cols, |i, j| if i == j { sigma[i] } else { 0.0 });
    randomly_rotated(randomly_rotated(diagonal, false, rng), true, rng)
}

/// LAPACK's 1-norm: the largest column sum.
pub fn norm1(a: &Matrix) -> f64 {
    (0..a.cols())
        .map(|j| a.col(j).iter().map(|x| x.abs()).sum())
        .fold(0.0, f64::max)
}

pub fn subtract(a: &Matrix, b: &Matrix) -> Matrix {
    assert_eq!((a.rows(), a.cols()), (b.rows(), b.cols()));
    Matrix::from_fn(a.rows(), a.cols(), |i, j| a[(i, j)] - b[(i, j)])
}

/// max(r, c) eps, the unit of LAPACK's ratios.
pub fn unit(a: &Matrix) -> f64 {
    a.rows().max(a.cols()).max(1) as f64 * f64::EPSILON
}

/// `|A'A - R'R| / (|A|_1 |A'|_1 max(r, c) eps)`: R is a triangle of A, whatever Q was.
pub fn gram_ratio(a: &Matrix, r: &Matrix) -> f64 {
    let difference = subtract(
        &a.transpose().matmul(a).unwrap(),
        &r.transpose().matmul(r).unwrap(),
    );
    let size = norm1(a) * norm1(&a.transpose());
    if size == 0.0 {
        norm1(&difference)
    } else {
        norm1(&difference) / size / unit(a)
    }
}

/// `|Q'Q - I| / (n eps)`.
pub fn orthogonality_ratio(q: &Matrix) -> f64 {
    let gram = q.transpose().matmul(q).unwrap();
    norm1(&subtract(&gram, &Matrix::identity(q.cols()))) / unit(q)
}

/// LAPACK's dqrt12: `|s - t| / (|t| max(r, c) eps)` in the 2-norm, the shorter list padded by zeros.
pub fn spectrum_ratio(s: &[f64], truth: &[f64], a: &Matrix) -> f64 {
    let at = |x: &[f64], i: usize| x.get(i).copied().unwrap_or(0.0);
    let scale = truth
        .iter()
        .copied()
        .fold(0.0, f64::max)
        .max(f64::MIN_POSITIVE);
    let norm = |f: &dyn Fn(usize) -> f64| {
        (0..s.len().max(truth.len()))
            .map(|i| (f(i) / scale).powi(2))
            .sum::<f64>()
            .sqrt()
    };
    let difference = norm(&|i| at(s, i) - at(truth, i));
    let size = norm(&|i| at(truth, i));
    if size == 0.0 {
        difference
    } else {
        difference / size / unit(a)
    }
}
