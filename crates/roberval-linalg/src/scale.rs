//! Scaling by powers of two, which is exact, and norms that neither overflow nor underflow.

use std::f64::consts::SQRT_2;

use crate::{LinalgError, Matrix};

/// Sums of squares between these two are safe from underflow and overflow (sqrt of the smallest
/// normal double over eps, and its mirror).
const SAFE_SQUARES: std::ops::Range<f64> = 1e-290..1e290;

/// Columns scaled by powers of two so that every norm lies in [1/sqrt2, sqrt2). Zero columns stay.
///
/// Returns the scaled matrix and the exponents: column j of it is `2^e[j]` times column j of `w`.
/// Exact, but for entries so far below their column's norm that they leave the range of doubles.
/// Relations found on the scaled matrix go back with [`unscale_relations`].
pub fn equilibrate(w: &Matrix) -> (Matrix, Vec<i32>) {
    let mut scaled = w.clone();
    let exponents = (0..w.cols())
        .map(|j| {
            let (fraction, exponent) = norm_parts(w.col(j));
            if fraction == 0.0 || !fraction.is_finite() {
                return 0;
            }
            let up = -exponent - i32::from(fraction >= SQRT_2);
            scale_slice(scaled.col_mut(j), up);
            up
        })
        .collect();
    (scaled, exponents)
}

/// The relations of the unscaled matrix: with `W2 D2 = W1 D1 beta_s`, `beta = D1 beta_s D2^-1`,
/// `D = diag(2^e)`. `beta_s` is `kept.len()` x `deleted.len()`; error bounds transform alike.
///
/// # Errors
/// [`LinalgError::Shape`] if `beta_s` has another shape, or a column has no exponent.
pub fn unscale_relations(
    beta_s: &Matrix,
    exponents: &[i32],
    kept: &[usize],
    deleted: &[usize],
) -> Result<Matrix, LinalgError> {
    let columns = kept.iter().chain(deleted).max().map_or(0, |&j| j + 1);
    if beta_s.rows() != kept.len() || beta_s.cols() != deleted.len() || columns > exponents.len() {
        return Err(LinalgError::Shape {
            what: "scaled relations",
            expected: format!("{} x {} and {columns} exponents", kept.len(), deleted.len()),
            found: format!(
                "{} x {} and {}",
                beta_s.rows(),
                beta_s.cols(),
                exponents.len()
            ),
        });
    }
    Ok(Matrix::from_fn(kept.len(), deleted.len(), |i, j| {
        times_power_of_two(beta_s[(i, j)], exponents[kept[i]] - exponents[deleted[j]])
    }))
}

/// The whole matrix times `2^k` so that its largest magnitude lies in [1/2, 1), and k.
/// Squares and sums are then far from overflow.
pub(crate) fn scale_globally(w: &Matrix) -> (Matrix, i32) {
    let largest = w.max_abs();
    let mut scaled = w.clone();
    if largest == 0.0 || !largest.is_finite() {
        return (scaled, 0);
    }
    let up = -exponent_of(largest) - 1;
    scale_slice(scaled.as_mut_slice(), up);
    (scaled, up)
}

/// `x * 2^exponent` in every entry.
pub(crate) fn scale_slice(x: &mut [f64], exponent: i32) {
    if exponent != 0 {
        x.iter_mut()
            .for_each(|x| *x = times_power_of_two(*x, exponent));
    }
}

/// `x * 2^exponent`, rounded only where the result is subnormal, infinite only where it overflows.
pub(crate) fn times_power_of_two(x: f64, exponent: i32) -> f64 {
    const STEP: i32 = 1000;
    let (mut x, mut left) = (x, exponent.clamp(-3 * STEP, 3 * STEP));
    while left != 0 {
        let step = left.clamp(-STEP, STEP);
        x *= power_of_two(step);
        left -= step;
    }
    x
}

/// `2^k` for -1022 <= k <= 1023.
fn power_of_two(k: i32) -> f64 {
    f64::from_bits(((k + 1023) as u64) << 52)
}

/// The k with `2^k <= |x| < 2^(k+1)`; x finite and not 0.
fn exponent_of(x: f64) -> i32 {
    let biased = |x: f64| ((x.to_bits() >> 52) & 0x7ff) as i32;
    match biased(x) {
        0 => biased(x * power_of_two(200)) - 1023 - 200,
        biased => biased - 1023,
    }
}

/// The 2-norm of `x` as `fraction * 2^exponent`, fraction in [1, 2); (0, 0) for a zero vector.
/// With a NaN or an infinity the fraction is not finite.
pub(crate) fn norm_parts(x: &[f64]) -> (f64, i32) {
    let squares: f64 = dot(x, x);
    let (norm, shift) = if SAFE_SQUARES.contains(&squares) {
        (squares.sqrt(), 0)
    } else {
        let largest = largest_magnitude(x);
        if largest == 0.0 || !largest.is_finite() {
            return (largest, 0);
        }
        let shift = exponent_of(largest);
        let squares: f64 = x
            .iter()
            .map(|&x| times_power_of_two(x, -shift))
            .map(|x| x * x)
            .sum();
        (squares.sqrt(), shift)
    };
    let exponent = exponent_of(norm);
    (times_power_of_two(norm, -exponent), exponent + shift)
}

/// The 2-norm of `x`; infinite only if the norm itself is above the largest double.
pub(crate) fn norm(x: &[f64]) -> f64 {
    let squares = dot(x, x);
    if SAFE_SQUARES.contains(&squares) {
        return squares.sqrt();
    }
    let (fraction, exponent) = norm_parts(x);
    times_power_of_two(fraction, exponent)
}

/// The largest magnitude; NaN if there is one.
pub(crate) fn largest_magnitude(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |largest: f64, x| {
        if x.is_nan() || largest.is_nan() {
            f64::NAN
        } else {
            largest.max(x.abs())
        }
    })
}

/// The inner product. Eight running sums: a fixed order of additions that a compiler can vectorise.
pub(crate) fn dot(x: &[f64], y: &[f64]) -> f64 {
    debug_assert_eq!(x.len(), y.len());
    let mut sums = [0.0; 8];
    let (xs, ys) = (x.chunks_exact(8), y.chunks_exact(8));
    let tail: f64 = xs
        .remainder()
        .iter()
        .zip(ys.remainder())
        .map(|(&x, &y)| x * y)
        .sum();
    for (x, y) in xs.zip(ys) {
        for k in 0..8 {
            sums[k] += x[k] * y[k];
        }
    }
    ((sums[0] + sums[4]) + (sums[1] + sums[5])) + ((sums[2] + sums[6]) + (sums[3] + sums[7])) + tail
}

/// `y += factor * x`.
pub(crate) fn add_multiple(y: &mut [f64], factor: f64, x: &[f64]) {
    for (y, &x) in y.iter_mut().zip(x) {
        *y += factor * x;
    }
}
