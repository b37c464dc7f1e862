//! Values of `r + s pi`, their cosines and sines: computed in integers with a binary
//! point far enough to the right, then rounded.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Zero};

use super::DoubleDouble;
use crate::LinearInPi;
use crate::fixed_point::{GUARD_BITS, fixed, quarters, reduced, series, times_pi, turned};

/// Correct bits asked of a result before it is rounded to a pair of doubles.
const CORRECT_BITS: u64 = 128;

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
        let (mut quarters, rest) = quarters(angle);
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
        turned(&quarters, (cos, sin))
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
