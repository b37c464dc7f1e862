//! Lanes of 64-bit ARM, whose processors all have NEON and fused arithmetic.
//!
//! What the intrinsics need is in every such processor: unsafe are only those that take a
//! pointer, and the blocks around the others are there for x86, whose macro they share.
#![allow(unsafe_code, unused_unsafe)]

use std::arch::aarch64::*;

use super::arithmetic::arithmetic;
use super::fused::Fused;
use super::trigonometry::{self, Quadrants};
use super::{Lanes, Task, Width};
use crate::{Lift, Scalar};

pub(super) fn available(width: Width) -> bool {
    matches!(width, Width::Plain | Width::One | Width::Two)
}

pub(super) fn dispatch<T: Task>(width: Width, task: T) -> T::Output {
    match width {
        Width::Two => run::<F64x2, T>(task),
        Width::One => run::<Fused, T>(task),
        _ => run::<f64, T>(task),
    }
}

pub(super) fn dispatch_one<T: Task>(task: T) -> T::Output {
    run::<Fused, T>(task)
}

/// Each width is a function of its own, as on x86: all in one would share its registers' spills.
#[inline(never)]
fn run<V: Lanes, T: Task>(task: T) -> T::Output {
    task.run::<V>()
}

macro_rules! neg2 {
    ($x:expr) => {
        vnegq_f64($x)
    };
}
macro_rules! fma2 {
    ($a:expr, $b:expr, $c:expr) => {
        vfmaq_f64($c, $a, $b)
    };
}
macro_rules! fnma2 {
    ($a:expr, $b:expr, $c:expr) => {
        vfmsq_f64($c, $a, $b)
    };
}

arithmetic!(
    F64x2,
    float64x2_t,
    2,
    vaddq_f64,
    vsubq_f64,
    vmulq_f64,
    neg2,
    fma2,
    fnma2,
    vdupq_n_f64
);

impl Lanes for F64x2 {
    const COUNT: usize = 2;
    const REGISTERS: usize = 32;

    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        // SAFETY: the slice below is checked to have 2 numbers.
        Self(unsafe { vld1q_f64(from[..2].as_ptr()) })
    }

    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        // SAFETY: the slice below is checked to have 2 numbers.
        unsafe { vst1q_f64(to[..2].as_mut_ptr(), self.0) }
    }

    #[inline(always)]
    fn numbers(lanes: &mut [Self]) -> &mut [f64] {
        let count = lanes.len() * Self::COUNT;
        // SAFETY: a lane type is COUNT floats and nothing else.
        unsafe { std::slice::from_raw_parts_mut(lanes.as_mut_ptr().cast(), count) }
    }

    #[inline(always)]
    fn divide(self, by: Self) -> Self {
        // SAFETY: see the module.
        Self(unsafe { vdivq_f64(self.0, by.0) })
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: see the module.
        Self(unsafe { vsqrtq_f64(self.0) })
    }

    #[inline(always)]
    fn with_sign_of(self, sign: Self) -> Self {
        // SAFETY: see the module.
        Self(unsafe { vbslq_f64(vdupq_n_u64(1 << 63), sign.0, self.0) })
    }

    #[inline(always)]
    fn where_nonzero(self, test: Self) -> Self {
        // SAFETY: see the module.
        Self(unsafe { vbslq_f64(vceqzq_f64(test.0), vdupq_n_f64(0.0), self.0) })
    }

    #[inline(always)]
    fn is_zero(self) -> bool {
        Self::all_within([self], 0.0)
    }

    #[inline(always)]
    fn sin_cos<const N: usize>(x: [Self; N]) -> [(Self, Self); N] {
        trigonometry::sin_cos(x)
    }

    #[inline(always)]
    fn load_transposed(
        from: &[f64],
        stride: usize,
        blocks: usize,
        mut put: impl FnMut(usize, &[Self]),
    ) -> Self {
        let zero = Self::lift(0.0);
        let mut none = zero;
        for block in 0..blocks {
            let rows = [0, stride].map(|row| Self::load(&from[row + 2 * block..]));
            put(block, &transposed(rows));
            none = rows[1].mul_add(zero, rows[0].mul_add(zero, none));
        }
        none
    }

    #[inline(always)]
    fn store_transposed(stage: &[Self], sources: &[u32], to: &mut [f64], stride: usize) {
        let pairs = sources.chunks_exact(2);
        if let &[last] = pairs.remainder() {
            let mut numbers = [0.0; 2];
            stage[last as usize].store(&mut numbers);
            let at = sources.len() - 1;
            (to[at], to[stride + at]) = (numbers[0], numbers[1]);
        }
        for (k, pair) in pairs.enumerate() {
            let rows = transposed([stage[pair[0] as usize], stage[pair[1] as usize]]);
            rows[0].store(&mut to[2 * k..]);
            rows[1].store(&mut to[stride + 2 * k..]);
        }
    }
}

/// The transpose of 2 rows.
#[inline(always)]
fn transposed([a, b]: [F64x2; 2]) -> [F64x2; 2] {
    // SAFETY: see the module.
    unsafe { [F64x2(vzip1q_f64(a.0, b.0)), F64x2(vzip2q_f64(a.0, b.0))] }
}

impl Quadrants for F64x2 {
    #[inline(always)]
    fn all_within<const N: usize>(x: [Self; N], bound: f64) -> bool {
        // SAFETY: see the module.
        unsafe {
            let mut within = vdupq_n_u64(u64::MAX);
            for x in x {
                within = vandq_u64(within, vcleq_f64(vabsq_f64(x.0), vdupq_n_f64(bound)));
            }
            vgetq_lane_u64::<0>(within) & vgetq_lane_u64::<1>(within) == u64::MAX
        }
    }

    #[inline(always)]
    fn turn(rounded: Self, sin: Self, cos: Self) -> (Self, Self) {
        // SAFETY: see the module.
        unsafe {
            let turns = vreinterpretq_u64_f64(rounded.0);
            let (one, two) = (vdupq_n_u64(1), vdupq_n_u64(2));
            let odd = vtstq_u64(turns, one);
            let signed = |x, turns| {
                let sign = vshlq_n_u64::<62>(vandq_u64(turns, two));
                Self(vreinterpretq_f64_u64(veorq_u64(
                    vreinterpretq_u64_f64(x),
                    sign,
                )))
            };
            let s = vbslq_f64(odd, cos.0, sin.0);
            let c = vbslq_f64(odd, sin.0, cos.0);
            (signed(s, turns), signed(c, vaddq_u64(turns, one)))
        }
    }
}
