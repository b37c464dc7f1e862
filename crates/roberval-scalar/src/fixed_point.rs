//! Cosines, sines and pi in integers with a binary point.

use num_bigint::BigInt;
use num_integer::Integer;
use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive};

use crate::LinearInPi;

/// Bits that sums of some hundred truncated terms may spoil.
pub(crate) const GUARD_BITS: u64 = 16;

/// Whole quarter turns of an angle, and what its exact form leaves without them.
pub(crate) fn quarters(angle: &LinearInPi) -> (BigInt, LinearInPi) {
    let quarters = (&angle.half_turns * BigInt::from(2)).round();
    let rest = LinearInPi {
        rational: angle.rational.clone(),
        half_turns: &angle.half_turns - &quarters / BigInt::from(2),
    };
    (quarters.to_integer(), rest)
}

/// Cosine and sine turned further by whole quarters of a turn.
pub(crate) fn turned<T: std::ops::Neg<Output = T>>(
    quarters: &BigInt,
    (cos, sin): (T, T),
) -> (T, T) {
    match quarters.mod_floor(&BigInt::from(4)).to_u8() {
        Some(0) => (cos, sin),
        Some(1) => (-sin, cos),
        Some(2) => (-cos, -sin),
        _ => (sin, -cos),
    }
}

/// `x 2^bits`, rounded down.
pub(crate) fn fixed(x: &BigRational, bits: u64) -> BigInt {
    (x.numer() << bits).div_floor(x.denom())
}

/// `s pi 2^bits`.
pub(crate) fn times_pi(x: &LinearInPi, bits: u64) -> BigInt {
    let more = x.half_turns.numer().bits() + GUARD_BITS;
    (x.half_turns.numer() * pi(bits + more)).div_floor(x.half_turns.denom()) >> more
}

/// `k` and `(angle - k pi/2) 2^bits`, of size at most pi/4.
pub(crate) fn reduced(angle: &LinearInPi, bits: u64) -> (BigInt, BigInt) {
    // k has about as many bits as the number of radians, and multiplies pi's error.
    let whole = angle.rational.to_integer().bits() + GUARD_BITS;
    let wide = bits + whole;
    let value = fixed(&angle.rational, wide) + times_pi(angle, wide);
    let half_pi = pi(wide) >> 1;
    let middle: BigInt = &half_pi >> 1;
    let k = (&value + middle).div_floor(&half_pi);
    let rest = value - &k * half_pi;
    (k, rest >> whole)
}

/// `x^first - x^(first+2)/(first+2)! ...` with first = 0 (cosine) or 1 (sine).
pub(crate) fn series(x: &BigInt, first: u64, bits: u64) -> BigInt {
    let square: BigInt = (x * x) >> bits;
    let mut term = if first == 0 {
        BigInt::one() << bits
    } else {
        x.clone()
    };
    let (mut sum, mut k) = (term.clone(), first);
    while term.magnitude().bits() > 1 {
        term = -((&term * &square) >> bits) / BigInt::from((k + 1) * (k + 2));
        sum += &term;
        k += 2;
    }
    sum
}

/// `pi 2^bits` by Machin's formula, pi = 16 atan(1/5) - 4 atan(1/239).
fn pi(bits: u64) -> BigInt {
    let wide = bits + GUARD_BITS;
    let value = inverse_tangent(5, wide) * 16 - inverse_tangent(239, wide) * 4;
    value >> GUARD_BITS
}

/// `atan(1/n) 2^bits`.
fn inverse_tangent(n: u64, bits: u64) -> BigInt {
    let mut power = (BigInt::one() << bits) / n;
    let (mut sum, mut k) = (power.clone(), 1_u64);
    while power.is_positive() {
        power /= n * n;
        k += 2;
        let term = &power / k;
        if k % 4 == 1 { sum += term } else { sum -= term }
    }
    sum
}
