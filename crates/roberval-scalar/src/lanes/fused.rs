//! One lane with the arithmetic of the wider ones.
//!
//! Unsafe only where lanes are taken for the numbers that they are, and for one instruction.
#![allow(unsafe_code)]

use std::ops::{Add, Mul, Neg, Sub};

use super::Lanes;
use super::trigonometry::{self, Quadrants};
use crate::{Lift, Scalar};

/// One float whose products and sums are fused: the bits of the wider lanes.
#[derive(Debug, Clone, Copy)]
#[repr(transparent)]
pub(super) struct Fused(f64);

impl Add for Fused {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

impl Sub for Fused {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(self.0 - other.0)
    }
}

impl Mul for Fused {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(self.0 * other.0)
    }
}

impl Neg for Fused {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(negative(self.0))
    }
}

#[cfg(not(target_arch = "aarch64"))]
#[inline(always)]
fn negative(x: f64) -> f64 {
    -x
}

/// LLVM makes `fnmadd` of -(a b + c), which is (-a) b - c: 0 where a b + c is, not -0 as of
/// wider lanes. So it must not see what is done here.
#[cfg(target_arch = "aarch64")]
#[inline(always)]
fn negative(mut x: f64) -> f64 {
    // SAFETY: one instruction on a register, which every processor has.
    unsafe {
        std::arch::asm!("fneg {0:d}, {0:d}", inout(vreg) x, options(pure, nomem, nostack, preserves_flags));
    }
    x
}

impl Scalar for Fused {
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        Self(self.0.mul_add(b.0, c.0))
    }

    #[inline(always)]
    fn neg_mul_add(self, b: Self, c: Self) -> Self {
        Self((-self.0).mul_add(b.0, c.0))
    }
}

impl Lift<f64> for Fused {
    #[inline(always)]
    fn lift(constant: f64) -> Self {
        Self(constant)
    }
}

impl Lanes for Fused {
    const COUNT: usize = 1;

    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        Self(from[0])
    }

    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        to[0] = self.0;
    }

    #[inline(always)]
    fn numbers(lanes: &mut [Self]) -> &mut [f64] {
        let count = lanes.len() * Self::COUNT;
        // SAFETY: a lane type is COUNT floats and nothing else.
        unsafe { std::slice::from_raw_parts_mut(lanes.as_mut_ptr().cast(), count) }
    }

    #[inline(always)]
    fn divide(self, by: Self) -> Self {
        Self(self.0 / by.0)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt())
    }

    #[inline(always)]
    fn with_sign_of(self, sign: Self) -> Self {
        Self(self.0.copysign(sign.0))
    }

    #[inline(always)]
    fn where_nonzero(self, test: Self) -> Self {
        Self(self.0.where_nonzero(test.0))
    }

    #[inline(always)]
    fn is_zero(self) -> bool {
        self.0 == 0.0
    }

    #[inline(always)]
    fn sin_cos<const N: usize>(x: [Self; N]) -> [(Self, Self); N] {
        trigonometry::sin_cos(x)
    }
}

impl Quadrants for Fused {
    #[inline(always)]
    fn all_within<const N: usize>(x: [Self; N], bound: f64) -> bool {
        x.iter().all(|x| x.0.abs() <= bound)
    }

    #[inline(always)]
    fn turn(rounded: Self, sin: Self, cos: Self) -> (Self, Self) {
        let turns = rounded.0.to_bits();
        let (s, c) = if turns & 1 == 0 {
            (sin.0, cos.0)
        } else {
            (cos.0, sin.0)
        };
        let signed = |x: f64, turns: u64| Self(f64::from_bits(x.to_bits() ^ ((turns & 2) << 62)));
        (signed(s, turns), signed(c, turns.wrapping_add(1)))
    }
}
