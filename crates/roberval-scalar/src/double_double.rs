//! Numbers of about 104 bits: the sum of two doubles (Dekker 1971).

mod series;
#[cfg(test)]
mod tests;
mod trigonometry;

use std::ops::{Add, Div, Mul, Neg, Sub};

use num_rational::BigRational;
use num_traits::Zero;

use crate::{Scalar, nearest_double};

/// `high + low`, with `|low|` at most half a unit in the last place of `high`.
///
/// Sums, products, quotients and square roots have relative errors of a few 2^-104, as
/// long as nothing overflows or underflows (factors below 2^996).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DoubleDouble {
    high: f64,
    low: f64,
}

impl DoubleDouble {
    /// 0
    pub const ZERO: Self = Self {
        high: 0.0,
        low: 0.0,
    };
    /// 1
    pub const ONE: Self = Self {
        high: 1.0,
        low: 0.0,
    };

    /// The double nearest to it.
    #[must_use]
    pub fn to_f64(self) -> f64 {
        self.high
    }

    /// What [`DoubleDouble::to_f64`] leaves out.
    #[must_use]
    pub fn low(self) -> f64 {
        self.low
    }

    /// Exactly its value.
    ///
    /// # Panics
    /// If it is not finite.
    #[must_use]
    pub fn to_rational(self) -> BigRational {
        let exact = |x| BigRational::from_float(x).expect("a finite number");
        exact(self.high) + exact(self.low)
    }

    /// The nearest pair of doubles: the double nearest to x, and that nearest to the rest.
    #[must_use]
    pub fn nearest(x: &BigRational) -> Self {
        let high = nearest_double(x);
        let rest = BigRational::from_float(high).map_or_else(BigRational::zero, |h| x - h);
        Self {
            high,
            low: nearest_double(&rest),
        }
    }

    /// |x|
    #[must_use]
    pub fn abs(self) -> Self {
        if self.high < 0.0 { -self } else { self }
    }

    /// The square root; not a number for negative numbers.
    #[must_use]
    pub fn sqrt(self) -> Self {
        if self.high == 0.0 {
            return Self::ZERO;
        }
        // One step of Newton's iteration doubles the 53 bits of the first root.
        let root = self.high.sqrt();
        let rest = self - exact_product(root, root);
        exact_sum_ordered(root, rest.high / (2.0 * root))
    }

    /// The exact value of a double.
    #[must_use]
    pub const fn from_f64(x: f64) -> Self {
        Self { high: x, low: 0.0 }
    }
}

impl From<f64> for DoubleDouble {
    fn from(x: f64) -> Self {
        Self::from_f64(x)
    }
}

impl Scalar for DoubleDouble {}

/// `a + b` exactly (Knuth's two-sum).
#[inline(always)]
fn exact_sum(a: f64, b: f64) -> DoubleDouble {
    let high = a + b;
    let b_seen = high - a;
    let low = (a - (high - b_seen)) + (b - b_seen);
    DoubleDouble { high, low }
}

/// `a + b` exactly, if `|a| >= |b|` (Dekker's fast two-sum).
#[inline(always)]
fn exact_sum_ordered(a: f64, b: f64) -> DoubleDouble {
    let high = a + b;
    DoubleDouble {
        high,
        low: b - (high - a),
    }
}

/// `a b` exactly: by the fused operation where the processor is known to have it. Where
/// it is not, `mul_add` would be a slow library call; [`split_product`] gives the same
/// bits.
#[inline(always)]
fn exact_product(a: f64, b: f64) -> DoubleDouble {
    if cfg!(any(target_feature = "fma", target_arch = "aarch64")) {
        fused_product(a, b)
    } else {
        split_product(a, b)
    }
}

#[inline(always)]
fn fused_product(a: f64, b: f64) -> DoubleDouble {
    let high = a * b;
    DoubleDouble {
        high,
        low: a.mul_add(b, -high),
    }
}

/// Dekker's product of halves of 26 bits.
#[inline(always)]
fn split_product(a: f64, b: f64) -> DoubleDouble {
    let high = a * b;
    let ((a1, a2), (b1, b2)) = (halves(a), halves(b));
    let low = ((a1 * b1 - high) + a1 * b2 + a2 * b1) + a2 * b2;
    DoubleDouble { high, low }
}

/// Veltkamp's splitting into two numbers of at most 26 bits.
#[inline(always)]
fn halves(a: f64) -> (f64, f64) {
    let shifted = a * 134_217_729.0; // 2^27 + 1
    let upper = shifted - (shifted - a);
    (upper, a - upper)
}

impl Add for DoubleDouble {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let high = exact_sum(self.high, other.high);
        let low = exact_sum(self.low, other.low);
        let sum = exact_sum_ordered(high.high, high.low + low.high);
        exact_sum_ordered(sum.high, sum.low + low.low)
    }
}

impl Sub for DoubleDouble {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Neg for DoubleDouble {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self {
            high: -self.high,
            low: -self.low,
        }
    }
}

impl Mul for DoubleDouble {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let product = exact_product(self.high, other.high);
        let cross = self.high * other.low + self.low * other.high;
        exact_sum_ordered(product.high, product.low + cross)
    }
}

impl Div for DoubleDouble {
    type Output = Self;
    /// Long division in three digits of 53 bits each.
    fn div(self, other: Self) -> Self {
        let digit = |rest: Self| Self::from(rest.high / other.high);
        let first = digit(self);
        let rest = self - other * first;
        let second = digit(rest);
        let third = digit(rest - other * second);
        first + second + third
    }
}
