use std::ops::{Add, Mul, Neg, Sub};

use crate::Scalar;

/// The size a number would have if nothing cancelled: `|a| + |b|` for sums and
/// differences, `|a| |b|` for products.
///
/// Running a recursion over `Magnitude` gives, entry by entry, the scale of its
/// rounding error: a float result below a small multiple of eps times its magnitude is
/// noise. That is how a structural zero is told from a small number without a tolerance
/// that depends on the robot's units.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd, Default)]
pub struct Magnitude(f64);

impl Magnitude {
    /// The magnitude of a number.
    #[must_use]
    pub fn of(x: f64) -> Self {
        Self(x.abs())
    }

    /// The magnitude as a float, never negative.
    #[must_use]
    pub fn value(self) -> f64 {
        self.0
    }
}

impl Add for Magnitude {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

impl Sub for Magnitude {
    type Output = Self;
    /// A difference is as large as a sum when its terms' signs are unknown.
    #[inline(always)]
    #[allow(clippy::suspicious_arithmetic_impl)]
    fn sub(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

impl Mul for Magnitude {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(self.0 * other.0)
    }
}

impl Neg for Magnitude {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self
    }
}

impl Scalar for Magnitude {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_magnitude_bounds_every_sign_of_its_terms() {
        let (a, b) = (Magnitude::of(-3.0), Magnitude::of(2.0));
        assert_eq!((a - b).value(), 5.0);
        assert_eq!((-a * b).value(), 6.0);
    }
}
