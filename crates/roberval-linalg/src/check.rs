//! Residual and orthogonality of a factorisation, in LAPACK's units, from random probes.
//!
//! A probe x has independent entries of unit variance, so `norm(E x)` is about the Frobenius norm of E:
//! a wrong factor shows with a few products of O(r c) work instead of O(r c^2).

use crate::Matrix;
use crate::scale::norm;

/// A factorisation is trusted while its residual ratio `|A P - Q R| / (|A| max(r, c) eps)` and its
/// orthogonality ratio `|Q'Q - I| / (max(r, c) eps)` stay below this: LAPACK's own test bar.
pub const RATIO_BAR: f64 = 30.0;

const PROBES: u64 = 3;

/// The larger of the residual ratio of `a = left * right` and the orthogonality ratios of `orthogonal`;
/// infinite if one of them is not a number.
pub(crate) fn worst_ratio(
    a: &Matrix,
    left: &Matrix,
    right: &Matrix,
    orthogonal: &[&Matrix],
) -> f64 {
    let mut worst = 0.0;
    let mut note = |ratio: f64| {
        worst = if ratio <= worst {
            worst
        } else if ratio.is_nan() {
            f64::INFINITY
        } else {
            ratio
        }
    };
    let unit = a.rows().max(a.cols()).max(1) as f64 * f64::EPSILON;
    let size = a.frobenius_norm();
    for seed in 0..PROBES {
        let x = probe(a.cols(), seed);
        let residual = difference(&times(a, &x), &times(left, &times(right, &x)));
        note(if size == 0.0 {
            norm(&residual)
        } else {
            norm(&residual) / size / unit
        });
        for q in orthogonal {
            let x = probe(q.cols(), seed);
            let qx = times(q, &x);
            let gram: Vec<f64> = (0..q.cols())
                .map(|j| crate::scale::dot(q.col(j), &qx))
                .collect();
            note(norm(&difference(&gram, &x)) / unit / (q.cols().max(1) as f64).sqrt());
        }
    }
    worst
}

fn times(a: &Matrix, x: &[f64]) -> Vec<f64> {
    let mut y = vec![0.0; a.rows()];
    a.add_product(x, &mut y);
    y
}

fn difference(x: &[f64], y: &[f64]) -> Vec<f64> {
    x.iter().zip(y).map(|(x, y)| x - y).collect()
}

/// `n` numbers uniform in +-[0.5, 1.5) (variance 13/12), the same for every call.
fn probe(n: usize, seed: u64) -> Vec<f64> {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x6a09_e667_f3bc_c908;
    (0..n)
        .map(|_| {
            // SplitMix64.
            state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let z = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            let magnitude = 0.5 + (z >> 11) as f64 / (1_u64 << 53) as f64;
            if z & 1 == 0 { magnitude } else { -magnitude }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_product_that_holds_with_factors_that_are_not_orthogonal_is_flagged() {
        let q = Matrix::identity(6);
        let r = Matrix::from_fn(6, 6, |i, j| if i <= j { 1.0 / (1 + j) as f64 } else { 0.0 });
        assert_eq!(worst_ratio(&r, &q, &r, &[&q]), 0.0);
        let scaled = |a: &Matrix, by: f64| Matrix::from_fn(6, 6, |i, j| by * a[(i, j)]);
        let (doubled, halved) = (scaled(&q, 2.0), scaled(&r, 0.5));
        assert_eq!(worst_ratio(&r, &doubled, &halved, &[]), 0.0);
        assert!(worst_ratio(&r, &doubled, &halved, &[&doubled]) > RATIO_BAR);
    }
}
