use std::ops::{Add, Mul, Neg, Sub};

/// What the recursion from joint states to regressor columns may do with a number.
///
/// No division, no comparison and no trigonometry: cosines and sines come in from
/// outside, so that the same source runs over floats, lanes of floats, a prime field
/// or an expression recorder. There is no `zero()` or `one()` either: a number of a
/// prime field knows its field only from its neighbours, so the constants are handed
/// in with the model.
pub trait Scalar:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    /// `self * b + c`. Not fused on plain floats: without the processor feature a fused
    /// multiply-add is a library call, ten times slower than the two operations.
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        self * b + c
    }

    /// `c - self * b`.
    #[inline(always)]
    fn neg_mul_add(self, b: Self, c: Self) -> Self {
        c - self * b
    }
}

impl Scalar for f64 {}

/// A scalar that takes the robot's constants, stored as `C`: the same number, or each
/// lane of several.
pub trait Lift<C>: Scalar {
    /// The constant as this scalar.
    fn lift(constant: C) -> Self;
}

impl<T: Scalar> Lift<T> for T {
    #[inline(always)]
    fn lift(constant: T) -> Self {
        constant
    }
}
