//! Numbers with so many digits that geometry which is all but singular can be solved.

use std::ops::{Add, Div, Mul, Neg, Sub};

use num_bigint::{BigInt, BigUint, Sign};
use num_rational::BigRational;
use num_traits::{One, Zero};

use crate::fixed_point::{GUARD_BITS, fixed, quarters, reduced, series, times_pi, turned};
use crate::written::{OfLinear, cos_sin_of_expr, of_expr};
use crate::{LinearInPi, Quantity, Real, Scalar, nearest_double};

#[cfg(test)]
mod tests;

/// Digits of 64 bits in all, and behind the point.
const DIGITS: usize = 10;
const BEHIND: usize = 7;

/// Bits behind the point.
const BITS: u64 = 64 * BEHIND as u64;

/// Newton's steps to an angle, each of which triples the digits of a double.
const ANGLE_STEPS: usize = 3;

/// A number with 192 binary digits before and 448 behind the point.
///
/// Sums are exact, products and quotients right to the last digit. Numbers beyond 2^191
/// wrap around, a quotient by zero is 0, and of doubles that are not finite nothing is
/// kept: what is computed of such numbers must be confirmed by other means.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Wide {
    /// Two's complement, the lowest digit first.
    digits: [u64; DIGITS],
}

impl Wide {
    /// 0
    pub const ZERO: Self = Self {
        digits: [0; DIGITS],
    };

    /// The smallest number above 0, doubled `exponent` times.
    #[must_use]
    pub fn units(exponent: u64) -> Self {
        Self::of_big(&(BigInt::one() << exponent))
    }

    /// |x|
    #[must_use]
    pub fn abs(self) -> Self {
        if self.is_negative() { -self } else { self }
    }

    /// Whether this is exactly 0.
    #[must_use]
    pub fn is_zero(&self) -> bool {
        self.digits == Self::ZERO.digits
    }

    /// Whether this is larger than another number, both at least 0.
    #[must_use]
    pub fn exceeds(&self, other: &Self) -> bool {
        self.digits.iter().rev().gt(other.digits.iter().rev())
    }

    fn is_negative(&self) -> bool {
        self.digits[DIGITS - 1] >> 63 == 1
    }

    /// `x 2^-448`.
    fn of_big(x: &BigInt) -> Self {
        let mut digits = [0; DIGITS];
        for (digit, x) in digits.iter_mut().zip(x.iter_u64_digits()) {
            *digit = x;
        }
        let magnitude = Self { digits };
        if x.sign() == Sign::Minus {
            -magnitude
        } else {
            magnitude
        }
    }

    /// `x 2^448`.
    fn to_big(self) -> BigInt {
        let halves = self.abs().digits;
        let halves = halves.iter().flat_map(|d| [*d as u32, (*d >> 32) as u32]);
        let sign = if self.is_negative() {
            Sign::Minus
        } else {
            Sign::Plus
        };
        BigInt::from_biguint(sign, BigUint::new(halves.collect()))
    }
}

impl From<f64> for Wide {
    fn from(x: f64) -> Self {
        let exact = BigRational::from_float(x).unwrap_or_else(BigRational::zero);
        Self::of_big(&fixed(&exact, BITS))
    }
}

impl Scalar for Wide {}

impl Add for Wide {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let mut digits = self.digits;
        let mut carry = false;
        for (a, b) in digits.iter_mut().zip(other.digits) {
            let (sum, first) = a.overflowing_add(b);
            let (sum, second) = sum.overflowing_add(u64::from(carry));
            (*a, carry) = (sum, first || second);
        }
        Self { digits }
    }
}

impl Sub for Wide {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Neg for Wide {
    type Output = Self;
    fn neg(self) -> Self {
        let mut digits = self.digits;
        let mut carry = true;
        for digit in &mut digits {
            (*digit, carry) = (!*digit).overflowing_add(u64::from(carry));
        }
        Self { digits }
    }
}

impl Mul for Wide {
    type Output = Self;
    /// By rows, as in school; the digits beyond the last are cut off.
    fn mul(self, other: Self) -> Self {
        let (a, b) = (self.abs().digits, other.abs().digits);
        let used = |x: &[u64; DIGITS]| DIGITS - x.iter().rev().take_while(|d| **d == 0).count();
        let (m, n) = (used(&a), used(&b));
        let mut product = [0_u64; 2 * DIGITS];
        for (i, &x) in a[..m].iter().enumerate() {
            let mut carry = 0_u128;
            for (sum, &y) in product[i..].iter_mut().zip(&b[..n]) {
                let next = u128::from(x) * u128::from(y) + u128::from(*sum) + carry;
                (*sum, carry) = (next as u64, next >> 64);
            }
            product[i + n] = carry as u64;
        }
        let mut digits = [0; DIGITS];
        digits.copy_from_slice(&product[BEHIND..BEHIND + DIGITS]);
        let magnitude = Self { digits };
        if self.is_negative() == other.is_negative() {
            magnitude
        } else {
            -magnitude
        }
    }
}

impl Div for Wide {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        if other.is_zero() {
            return Self::ZERO;
        }
        Self::of_big(&((self.to_big() << BITS) / other.to_big()))
    }
}

impl Real for Wide {
    fn of_quantity(quantity: &Quantity, constants: &[(String, Quantity)]) -> Option<Self> {
        of_expr(&quantity.expr, constants)
    }

    fn cos_sin_of_quantity(
        angle: &Quantity,
        constants: &[(String, Quantity)],
    ) -> Option<(Self, Self)> {
        cos_sin_of_expr(&angle.expr, constants)
    }

    fn to_f64(self) -> f64 {
        nearest_double(&self.to_rational())
    }

    fn cos_sin(self) -> (Self, Self) {
        Self::cos_sin_of_linear(&LinearInPi {
            rational: self.to_rational(),
            half_turns: BigRational::zero(),
        })
    }

    fn sqrt(self) -> Self {
        if self.is_negative() {
            return Self::ZERO;
        }
        Self::of_big(&(self.to_big() << BITS).sqrt())
    }

    fn atan2(self, x: Self) -> Self {
        let mut angle = Self::from(f64::atan2(self.to_f64(), x.to_f64()));
        let size = (x * x + self * self).sqrt();
        for _ in 0..ANGLE_STEPS {
            let (cos, sin) = angle.cos_sin();
            angle = angle + (self * cos - x * sin) / size;
        }
        angle
    }
}

impl OfLinear for Wide {
    fn of_linear(x: &LinearInPi) -> Self {
        Self::of_big(&(fixed(&x.rational, BITS) + times_pi(x, BITS)))
    }

    fn cos_sin_of_linear(angle: &LinearInPi) -> (Self, Self) {
        let (whole, rest) = quarters(angle);
        let one = BigInt::one() << BITS;
        let (more, (cos, sin)) = if rest.rational.is_zero() && rest.half_turns.is_zero() {
            (BigInt::zero(), (one, BigInt::zero()))
        } else {
            let bits = BITS + GUARD_BITS;
            let (more, x) = reduced(&rest, bits);
            let of = |first: u64| series(&x, first, bits) >> GUARD_BITS;
            (more, (of(0), of(1)))
        };
        let (cos, sin) = turned(&(whole + more), (cos, sin));
        (Self::of_big(&cos), Self::of_big(&sin))
    }

    fn to_rational(self) -> BigRational {
        BigRational::new(self.to_big(), BigInt::one() << BITS)
    }
}
