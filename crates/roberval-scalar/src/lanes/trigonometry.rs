//! Sine and cosine of lanes by fused polynomials.

use super::{Lanes, MAX_LANES};

/// Beyond this |x| the reduction below loses bits: the library's functions take over.
const LARGEST: f64 = 1e5;

/// Adding it rounds a small number to the nearest whole one: 1.5 * 2^52, whose lowest bits
/// then are that whole number.
const ROUNDER: f64 = 6_755_399_441_055_744.0;

/// pi/2 as a sum of three floats. The second has 32 bits, so that its multiples are exact.
const HALF_PI: [f64; 3] = [
    std::f64::consts::FRAC_PI_2,
    6.12323399538461e-17,
    3.5215598651832e-27,
];

/// `sin r = r + r^3 S(r^2)` for |r| <= pi/4 within 3.5e-18 (minimax, from the highest power).
const S: [f64; 6] = [
    1.589666646076181e-10,
    -2.5050755960591715e-08,
    2.75573136786604e-06,
    -0.0001984126982977115,
    0.00833333333332237,
    -0.16666666666666632,
];

/// `cos r = 1 - r^2/2 + r^4 C(r^2)` for |r| <= pi/4 within 4.7e-20.
const C: [f64; 6] = [
    -1.1359559302251504e-11,
    2.0875721623140268e-09,
    -2.755731434065483e-07,
    2.4801587289443465e-05,
    -0.0013888888888874064,
    0.0416666666666666,
];

/// What the reduction needs of the lanes' bits.
pub(super) trait Quadrants: Lanes {
    /// Whether all |x| are at most `bound` (no if one is NaN).
    fn all_within<const N: usize>(x: [Self; N], bound: f64) -> bool;

    /// Sine and cosine of an angle from those of its remainder: `rounded` is the number
    /// of quarter turns between them plus [`ROUNDER`].
    fn turn(rounded: Self, sin: Self, cos: Self) -> (Self, Self);
}

/// Sine and cosine of every lane.
#[inline(always)]
pub(super) fn sin_cos<V: Quadrants, const N: usize>(x: [V; N]) -> [(V, V); N] {
    let mut found = reduced(x);
    if !V::all_within(x, LARGEST) {
        for (found, x) in found.iter_mut().zip(x) {
            *found = by_library(x, *found);
        }
    }
    found
}

/// Sine and cosine where |x| <= [`LARGEST`], elsewhere anything. All angles take each step
/// together, so that none waits for another.
#[inline(always)]
fn reduced<V: Quadrants, const N: usize>(x: [V; N]) -> [(V, V); N] {
    let (mut rounded, mut r, mut tail, mut z) = (x, x, x, x);
    for k in 0..N {
        rounded[k] = x[k].mul_add(V::lift(std::f64::consts::FRAC_2_PI), V::lift(ROUNDER));
        (r[k], tail[k]) = remainder(x[k], rounded[k] - V::lift(ROUNDER));
        z[k] = r[k] * r[k];
    }
    let (s, c) = (polynomial(&S, z), polynomial(&C, z));
    let mut turned = [(V::lift(0.0), V::lift(0.0)); N];
    for k in 0..N {
        let (sin, cos) = of_remainder((r[k], tail[k]), z[k], (s[k], c[k]));
        turned[k] = V::turn(rounded[k], sin, cos);
    }
    turned
}

/// An angle less so many quarter turns, and what the rounding of that loses; nothing where it
/// is small by cancellation.
#[inline(always)]
fn remainder<V: Lanes>(x: V, turns: V) -> (V, V) {
    // Exact: both terms are multiples of 2^-53, and the difference is below 1.
    let exact = turns.neg_mul_add(V::lift(HALF_PI[0]), x);
    let r = turns.neg_mul_add(V::lift(HALF_PI[1]), exact);
    let lost = turns.neg_mul_add(V::lift(HALF_PI[1]), exact - r);
    (r, turns.neg_mul_add(V::lift(HALF_PI[2]), lost))
}

/// Sine and cosine of `r + tail` in [-pi/4, pi/4], given z = r^2, S(z) and C(z).
#[inline(always)]
fn of_remainder<V: Lanes>((r, tail): (V, V), z: V, (s, c): (V, V)) -> (V, V) {
    let (one, half) = (V::lift(1.0), V::lift(0.5));
    // sin(r + t) = sin r + t cos r, cos(r + t) = cos r - t sin r.
    let flat = z * half;
    let leading = one - flat;
    let sin = r + (r * z).mul_add(s, tail * leading);
    let rest = (one - leading) - flat;
    let cos = leading + (z * z).mul_add(c, r.neg_mul_add(tail, rest));
    (sin, cos)
}

/// A polynomial by Horner's rule.
#[inline(always)]
fn polynomial<V: Lanes, const N: usize>(c: &[f64; 6], z: [V; N]) -> [V; N] {
    let mut sums = [V::lift(c[0]); N];
    for &c in &c[1..] {
        for (sum, z) in sums.iter_mut().zip(z) {
            *sum = sum.mul_add(z, V::lift(c));
        }
    }
    sums
}

/// Large angles, infinities and NaN anew, lane by lane; the others stay as they are.
#[cold]
#[inline(never)]
fn by_library<V: Lanes>(x: V, (sin, cos): (V, V)) -> (V, V) {
    let [mut angles, mut sines, mut cosines] = [[0.0; MAX_LANES]; 3];
    x.store(&mut angles);
    sin.store(&mut sines);
    cos.store(&mut cosines);
    for (lane, x) in angles.into_iter().enumerate() {
        if x.abs() > LARGEST || x.is_nan() {
            (sines[lane], cosines[lane]) = x.sin_cos();
        }
    }
    (V::load(&sines), V::load(&cosines))
}
