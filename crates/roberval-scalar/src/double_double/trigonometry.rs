//! Values of `r + s pi`, their cosines and sines: computed in integers with a binary
//! point far enough to the right, then rounded.

use num_bigint::BigInt;
use num_integer::Integer;
use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};

use super::DoubleDouble;
use crate::LinearInPi;

/// Correct bits asked of a result before it is rounded to a pair of doubles.
const CORRECT_BITS: u64 = 128;

/// Bits that sums of some hundred truncated terms may spoil.
const GUARD_BITS: u64 = 16;

impl DoubleDouble {
    /// The value of `r + s pi`.
    #[must_use]
    pub fn of_linear(x: &LinearInPi) -> Self {
        match x.as_rational() {
            Some(rational) => Self::nearest(rational),
            None => with_correct_bits(|bits| fixed(&x.rational, bits) + times_pi(x, bits)),
        }
    }

    /// Cosine and sine of an angle, exact at multiples of pi/2.
    #[must_use]
    pub fn cos_sin(angle: &LinearInPi) -> (Self, Self) {
        let quarters = (&angle.half_turns * BigInt::from(2)).round();
        let rest = LinearInPi {
            rational: angle.rational.clone(),
            half_turns: &angle.half_turns - &quarters / BigInt::from(2),
        };
        let mut quarters = quarters.to_integer();
        let (cos, sin) = if rest.rational.is_zero() && rest.half_turns.is_zero() {
            (Self::ONE, Self::ZERO)
        } else {
            // The sine is as small as the reduced angle: its bits are the ones to count.
            let (more, sin) = {
                let mut more = BigInt::zero();
                let sin = with_correct_bits(|bits| {
                    let (k, x) = reduced(&rest, bits);
                    more = k;
                    series(&x, 1, bits)
                });
                (more, sin)
            };
            let bits = CORRECT_BITS + 2 * GUARD_BITS;
            let cos = to_double_double(&series(&reduced(&rest, bits).1, 0, bits), bits);
            quarters += more;
            (cos, sin)
        };
        match quarters.mod_floor(&BigInt::from(4)).to_u8() {
            Some(0) => (cos, sin),
            Some(1) => (-sin, cos),
            Some(2) => (-cos, -sin),
            _ => (sin, -cos),
        }
    }
}

/// Rounds `compute(bits) / 2^bits`, with `bits` so large that the value (not zero) has
/// enough correct ones.
fn with_correct_bits(mut compute: impl FnMut(u64) -> BigInt) -> DoubleDouble {
    let mut bits = CORRECT_BITS + 2 * GUARD_BITS;
    loop {
        let value = compute(bits);
        if value.bits() >= CORRECT_BITS + GUARD_BITS {
            return to_double_double(&value, bits);
        }
        bits += CORRECT_BITS + GUARD_BITS - value.bits();
    }
}

fn to_double_double(value: &BigInt, bits: u64) -> DoubleDouble {
    DoubleDouble::nearest(&BigRational::new(value.clone(), BigInt::one() << bits))
}

/// `x 2^bits`, rounded down.
fn fixed(x: &BigRational, bits: u64) -> BigInt {
    (x.numer() << bits).div_floor(x.denom())
}

/// `s pi 2^bits`.
fn times_pi(x: &LinearInPi, bits: u64) -> BigInt {
    let more = x.half_turns.numer().bits() + GUARD_BITS;
    (x.half_turns.numer() * pi(bits + more)).div_floor(x.half_turns.denom()) >> more
}

/// `k` and `(angle - k pi/2) 2^bits`, of size at most pi/4.
fn reduced(angle: &LinearInPi, bits: u64) -> (BigInt, BigInt) {
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
fn series(x: &BigInt, first: u64, bits: u64) -> BigInt {
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
