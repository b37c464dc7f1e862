use std::ops::Div;

use num_rational::BigRational;
use num_traits::Zero;

use crate::written::{OfLinear, cos_sin_of_expr, of_expr};
use crate::{DoubleDouble, LinearInPi, Quantity, Scalar};

/// Real numbers of some precision: what positions of joints that depend on others are
/// computed with. (The recursion itself needs only [`Scalar`].)
pub trait Real: Scalar + Div<Output = Self> + From<f64> {
    /// The value of a number as written; `None` where it has none (a division by zero, a
    /// root of a negative number).
    fn of_quantity(quantity: &Quantity, constants: &[(String, Quantity)]) -> Option<Self>;
    /// Cosine and sine of an angle as written; `None` where it has no value.
    fn cos_sin_of_quantity(
        angle: &Quantity,
        constants: &[(String, Quantity)],
    ) -> Option<(Self, Self)>;
    /// The nearest double.
    fn to_f64(self) -> f64;
    /// Cosine and sine. Not numbers unless the angle is finite.
    fn cos_sin(self) -> (Self, Self);
    /// The square root; not a number for negative numbers.
    fn sqrt(self) -> Self;
    /// The angle of the point (x, self), in (-pi, pi].
    fn atan2(self, x: Self) -> Self;
}

/// What expressions of joint variables are computed with: numbers, or what records them.
pub trait Analytic: Scalar + Div<Output = Self> {
    /// This number, beside another one: constants are not made from nothing (see
    /// [`Scalar`]).
    fn beside(self, x: f64) -> Self;
    /// Cosine and sine.
    fn cos_sin(self) -> (Self, Self);
    /// The square root.
    fn sqrt(self) -> Self;
    /// The angle of the point (x, self).
    fn atan2(self, x: Self) -> Self;
}

impl<T: Real> Analytic for T {
    fn beside(self, x: f64) -> Self {
        x.into()
    }

    fn cos_sin(self) -> (Self, Self) {
        Real::cos_sin(self)
    }

    fn sqrt(self) -> Self {
        Real::sqrt(self)
    }

    fn atan2(self, x: Self) -> Self {
        Real::atan2(self, x)
    }
}

impl Real for f64 {
    fn of_quantity(quantity: &Quantity, _: &[(String, Quantity)]) -> Option<Self> {
        Some(quantity.value)
    }

    fn cos_sin_of_quantity(angle: &Quantity, _: &[(String, Quantity)]) -> Option<(Self, Self)> {
        Some(Real::cos_sin(angle.value))
    }

    fn to_f64(self) -> f64 {
        self
    }

    fn cos_sin(self) -> (Self, Self) {
        let (sin, cos) = self.sin_cos();
        (cos, sin)
    }

    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }

    fn atan2(self, x: Self) -> Self {
        f64::atan2(self, x)
    }
}

impl OfLinear for DoubleDouble {
    fn of_linear(x: &LinearInPi) -> Self {
        Self::of_linear(x)
    }

    fn cos_sin_of_linear(angle: &LinearInPi) -> (Self, Self) {
        Self::cos_sin(angle)
    }

    fn to_rational(self) -> BigRational {
        Self::to_rational(self)
    }
}

impl Real for DoubleDouble {
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
        Self::to_f64(self)
    }

    fn cos_sin(self) -> (Self, Self) {
        if !self.to_f64().is_finite() {
            return (f64::NAN.into(), f64::NAN.into());
        }
        self.cos_sin_by_series().unwrap_or_else(|| {
            Self::cos_sin(&LinearInPi {
                rational: self.to_rational(),
                half_turns: BigRational::zero(),
            })
        })
    }

    fn sqrt(self) -> Self {
        Self::sqrt(self)
    }

    /// One Newton step from the doubles' angle: it doubles their 53 bits.
    fn atan2(self, x: Self) -> Self {
        let guess = Self::from(f64::atan2(self.to_f64(), Self::to_f64(x)));
        let (cos, sin) = Real::cos_sin(guess);
        let size = (x * x + self * self).sqrt();
        guess + (self * cos - x * sin) / size
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SplitMix64;

    #[test]
    fn cosine_and_sine_by_series_are_those_in_integers() {
        let mut random = SplitMix64::new(7);
        for k in 0..500 {
            let x = random.uniform(-1.0, 1.0) * [1.0, 10.0, 1e3, 1e-6][k % 4];
            let x = DoubleDouble::from(x) + DoubleDouble::from(x * random.uniform(-1e-17, 1e-17));
            let (cos, sin) = Real::cos_sin(x);
            let angle = LinearInPi {
                rational: x.to_rational(),
                half_turns: BigRational::zero(),
            };
            let (c, s) = DoubleDouble::cos_sin(&angle);
            // A few units of 2^-104, and what the reduction of many turns costs.
            let bound = 4e-31 * (1.0 + x.to_f64().abs() / 100.0);
            assert!((cos - c).abs().to_f64() < bound, "{x:?}");
            assert!((sin - s).abs().to_f64() < bound, "{x:?}");
        }
    }

    #[test]
    fn the_angle_of_a_point_in_pairs_has_its_cosine_and_sine() {
        let mut random = SplitMix64::new(1);
        for _ in 0..200 {
            let angle = DoubleDouble::from(random.uniform(-3.1, 3.1));
            let (cos, sin) = Real::cos_sin(angle);
            let size = DoubleDouble::from(random.uniform(0.1, 9.0));
            let again = Real::atan2(size * sin, size * cos);
            // A few units in the last place of 104 bits.
            assert!((again - angle).abs().to_f64() < 1e-30, "{angle:?}");
        }
    }
}
