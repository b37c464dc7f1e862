//! Lanes of x86-64: AVX-512, AVX2, and one fused float.
//!
//! Unsafe because the instructions are not on every processor. The types are private and
//! [`dispatch`] hands them out only after asking the processor. Pointers stay within slices that
//! are checked before.
#![allow(unsafe_code)]

mod rows;

use std::arch::is_x86_feature_detected as has;
use std::arch::x86_64::*;
use std::ops::Range;
use std::sync::atomic::{AtomicU8, Ordering};

use super::arithmetic::arithmetic;
use super::fused::Fused;
use super::trigonometry::{self, Quadrants};
use super::{Lanes, Task, Width};
use crate::{LINE, Lift, Scalar};

pub(super) fn available(width: Width) -> bool {
    /// A bit a width, and one above them once the processor was asked: each question is several.
    /// No lock: a child process may have been forked while another thread was here.
    static KNOWN: AtomicU8 = AtomicU8::new(0);
    const ASKED: u8 = 1 << Width::ALL.len();
    let mut known = KNOWN.load(Ordering::Relaxed);
    if known == 0 {
        let bits = Width::ALL.map(|width| u8::from(has_all(width)) << width as u8);
        known = bits.iter().fold(ASKED, |known, bit| known | bit);
        KNOWN.store(known, Ordering::Relaxed);
    }
    known >> width as u8 & 1 == 1
}

fn has_all(width: Width) -> bool {
    let fused = has!("avx2") && has!("fma");
    match width {
        Width::Plain => true,
        Width::One | Width::Four => fused,
        Width::Two => false,
        Width::Eight => fused && has!("avx512f") && has!("avx512dq") && has!("avx512vl"),
    }
}

pub(super) fn dispatch<T: Task>(width: Width, task: T) -> T::Output {
    match width {
        // SAFETY: the processor has the features.
        Width::Eight if available(Width::Eight) => unsafe { eight::run(task) },
        Width::Four if available(Width::Four) => unsafe { four::run(task) },
        Width::One if available(Width::Eight) => unsafe { one_of_32::run(task) },
        Width::One if available(Width::One) => unsafe { one::run(task) },
        // In one place: each makes a copy of the task.
        _ => task.run::<f64>(),
    }
}

pub(super) fn dispatch_one<T: Task>(task: T) -> T::Output {
    if available(Width::One) {
        // SAFETY: the processor has the features (previous line).
        unsafe { one::run(task) }
    } else {
        task.run::<f64>()
    }
}

// A module each: rustc shares its work out by modules, and each of these is minutes of it.
mod eight {
    #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma")]
    pub(super) fn run<T: super::Task>(task: T) -> T::Output {
        task.run::<super::F64x8>()
    }
}

mod four {
    #[target_feature(enable = "avx2,fma")]
    pub(super) fn run<T: super::Task>(task: T) -> T::Output {
        task.run::<super::F64x4>()
    }
}

/// One lane with the registers of AVX-512, twice as many: a sixth faster.
mod one_of_32 {
    #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma")]
    pub(super) fn run<T: super::Task>(task: T) -> T::Output {
        task.run::<super::Fused>()
    }
}

mod one {
    #[target_feature(enable = "avx2,fma")]
    pub(super) fn run<T: super::Task>(task: T) -> T::Output {
        task.run::<super::Fused>()
    }
}

macro_rules! neg8 {
    ($x:expr) => {
        _mm512_xor_pd($x, _mm512_set1_pd(-0.0))
    };
}
macro_rules! fma8 {
    ($a:expr, $b:expr, $c:expr) => {
        _mm512_fmadd_pd($a, $b, $c)
    };
}
macro_rules! fnma8 {
    ($a:expr, $b:expr, $c:expr) => {
        _mm512_fnmadd_pd($a, $b, $c)
    };
}

arithmetic!(
    F64x8,
    __m512d,
    8,
    _mm512_add_pd,
    _mm512_sub_pd,
    _mm512_mul_pd,
    neg8,
    fma8,
    fnma8,
    _mm512_set1_pd
);

macro_rules! neg4 {
    ($x:expr) => {
        _mm256_xor_pd($x, _mm256_set1_pd(-0.0))
    };
}
macro_rules! fma4 {
    ($a:expr, $b:expr, $c:expr) => {
        _mm256_fmadd_pd($a, $b, $c)
    };
}
macro_rules! fnma4 {
    ($a:expr, $b:expr, $c:expr) => {
        _mm256_fnmadd_pd($a, $b, $c)
    };
}

arithmetic!(
    F64x4,
    __m256d,
    4,
    _mm256_add_pd,
    _mm256_sub_pd,
    _mm256_mul_pd,
    neg4,
    fma4,
    fnma4,
    _mm256_set1_pd
);

/// The lanes of a register, given what the processor calls its instructions.
macro_rules! lanes {
    ($name:ident: $count:literal lanes, $registers:literal registers,
     $load:ident, $store:ident, $stream:ident, $divide:ident, $sqrt:ident,
     $signed:ident, $where_nonzero:ident, $transposed:ident, $module:ident) => {
        impl Lanes for $name {
            const COUNT: usize = $count;
            const REGISTERS: usize = $registers;
            const STREAMS: bool = true;

            #[inline(always)]
            fn load(from: &[f64]) -> Self {
                // SAFETY: the slice is checked to have COUNT numbers.
                Self(unsafe { $load(from[..$count].as_ptr()) })
            }

            #[inline(always)]
            fn store(self, to: &mut [f64]) {
                // SAFETY: the slice is checked to have COUNT numbers.
                unsafe { $store(to[..$count].as_mut_ptr(), self.0) }
            }

            #[inline(always)]
            fn numbers(lanes: &mut [Self]) -> &mut [f64] {
                let count = lanes.len() * $count;
                // SAFETY: a lane type is COUNT floats and nothing else.
                unsafe { std::slice::from_raw_parts_mut(lanes.as_mut_ptr().cast(), count) }
            }

            #[inline(always)]
            fn divide(self, by: Self) -> Self {
                // SAFETY: see the module.
                Self(unsafe { $divide(self.0, by.0) })
            }

            #[inline(always)]
            fn sqrt(self) -> Self {
                // SAFETY: see the module.
                Self(unsafe { $sqrt(self.0) })
            }

            #[inline(always)]
            fn with_sign_of(self, sign: Self) -> Self {
                // SAFETY: see the module.
                Self(unsafe { $signed!(self.0, sign.0) })
            }

            #[inline(always)]
            fn where_nonzero(self, test: Self) -> Self {
                // SAFETY: see the module.
                Self(unsafe { $where_nonzero!(self.0, test.0) })
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
                check_rows::<Self>(blocks.saturating_mul($count), from, stride);
                let mut none = [Self::lift(0.0); 2];
                for block in 0..blocks {
                    let row = |s| from.as_ptr().wrapping_add(s * stride + block * $count);
                    // SAFETY: the rows have as many numbers as these blocks (checked).
                    let columns = unsafe { rows::$transposed(row) };
                    put(block, &columns);
                    for (k, column) in columns.into_iter().enumerate() {
                        none[k % 2] = column.mul_add(Self::lift(0.0), none[k % 2]);
                    }
                }
                none[0] + none[1]
            }

            #[inline(always)]
            fn store_transposed(stage: &[Self], sources: &[u32], to: &mut [f64], stride: usize) {
                check_rows::<Self>(sources.len(), to, stride);
                check_sources(stage, sources);
                // SAFETY: what is read and written is there (checked); see the module.
                unsafe { rows::$module::store(stage, sources, to.as_mut_ptr(), stride) }
            }

            #[inline(always)]
            fn stream_transposed(
                stage: &[Self],
                (sources, blocks): (&[u32], Range<usize>),
                to: &mut [f64],
                stride: usize,
            ) {
                check_rows::<Self>(sources.len(), to, stride);
                let end = sources.len().min(blocks.end.saturating_mul(LINE));
                check_sources(stage, &sources[blocks.start * LINE..end]);
                // SAFETY: what is read and written is there (checked); see the module.
                unsafe { rows::$module::stream(stage, (sources, blocks), to.as_mut_ptr(), stride) }
            }

            #[inline(always)]
            fn clear(to: &mut [f64]) {
                let count = to.len();
                if count < MEMSET_IS_SLOW {
                    return to.fill(0.0);
                }
                // Hidden, or the loop becomes a call of memset.
                let zero = std::hint::black_box(Self::lift(0.0));
                // The ends, wherever they are; between them whole lines.
                zero.store(to);
                zero.store(&mut to[count - $count..]);
                for line in aligned(to, 8 * $count).1.chunks_exact_mut($count) {
                    zero.store(line);
                }
            }

            #[inline(always)]
            fn stream(from: &[f64], to: &mut [f64]) {
                assert_eq!(from.len(), to.len(), "a number for each place");
                if to.as_ptr().align_offset(8 * $count) != 0 {
                    return to.copy_from_slice(from);
                }
                let mut lines = to.chunks_exact_mut($count);
                let mut from_lines = from.chunks_exact($count);
                for (line, from) in lines.by_ref().zip(from_lines.by_ref()) {
                    // SAFETY: `line` is aligned and has COUNT numbers.
                    unsafe { $stream(line.as_mut_ptr(), Self::load(from).0) }
                }
                let rest = from_lines.remainder();
                for (to, from) in lines.into_remainder().iter_mut().zip(rest) {
                    *to = *from;
                }
            }

            #[inline(always)]
            fn stream_zeros(to: &mut [f64]) {
                if to.as_ptr().align_offset(8 * $count) != 0 {
                    return to.fill(0.0);
                }
                let mut lines = to.chunks_exact_mut($count);
                for line in lines.by_ref() {
                    // SAFETY: `line` is aligned and has COUNT numbers.
                    unsafe { $stream(line.as_mut_ptr(), Self::lift(0.0).0) }
                }
                lines.into_remainder().fill(0.0);
            }

            #[inline(always)]
            fn fence() {
                // SAFETY: a fence touches nothing.
                unsafe { _mm_sfence() }
            }
        }
    };
}

macro_rules! signed8 {
    ($x:expr, $sign:expr) => {{
        let mask = _mm512_set1_pd(-0.0);
        _mm512_or_pd(_mm512_andnot_pd(mask, $x), _mm512_and_pd(mask, $sign))
    }};
}
macro_rules! where_nonzero8 {
    ($x:expr, $test:expr) => {{
        let nonzero = _mm512_cmp_pd_mask::<_CMP_NEQ_UQ>($test, _mm512_setzero_pd());
        _mm512_maskz_mov_pd(nonzero, $x)
    }};
}

lanes!(
    F64x8: 8 lanes, 32 registers,
    _mm512_loadu_pd,
    _mm512_storeu_pd,
    _mm512_stream_pd,
    _mm512_div_pd,
    _mm512_sqrt_pd,
    signed8,
    where_nonzero8,
    transposed8,
    eight
);

macro_rules! signed4 {
    ($x:expr, $sign:expr) => {{
        let mask = _mm256_set1_pd(-0.0);
        _mm256_or_pd(_mm256_andnot_pd(mask, $x), _mm256_and_pd(mask, $sign))
    }};
}
macro_rules! where_nonzero4 {
    ($x:expr, $test:expr) => {{
        let nonzero = _mm256_cmp_pd::<_CMP_NEQ_UQ>($test, _mm256_setzero_pd());
        _mm256_and_pd(nonzero, $x)
    }};
}

lanes!(
    F64x4: 4 lanes, 16 registers,
    _mm256_loadu_pd,
    _mm256_storeu_pd,
    _mm256_stream_pd,
    _mm256_div_pd,
    _mm256_sqrt_pd,
    signed4,
    where_nonzero4,
    transposed4,
    four
);

impl Quadrants for F64x8 {
    #[inline(always)]
    fn all_within<const N: usize>(x: [Self; N], bound: f64) -> bool {
        let mut within = 0xff;
        for x in x {
            // SAFETY: see the module.
            within &= unsafe {
                let size = _mm512_abs_pd(x.0);
                _mm512_cmp_pd_mask::<_CMP_LE_OQ>(size, _mm512_set1_pd(bound))
            };
        }
        within == 0xff
    }

    #[inline(always)]
    fn turn(rounded: Self, sin: Self, cos: Self) -> (Self, Self) {
        // SAFETY: see the module.
        unsafe {
            let turns = _mm512_castpd_si512(rounded.0);
            let odd = _mm512_test_epi64_mask(turns, _mm512_set1_epi64(1));
            let two = _mm512_set1_epi64(2);
            let one = _mm512_set1_epi64(1);
            let sign = |turns| {
                let half = _mm512_and_si512(turns, two);
                _mm512_castsi512_pd(_mm512_slli_epi64::<62>(half))
            };
            let s = _mm512_mask_blend_pd(odd, sin.0, cos.0);
            let c = _mm512_mask_blend_pd(odd, cos.0, sin.0);
            (
                Self(_mm512_xor_pd(s, sign(turns))),
                Self(_mm512_xor_pd(c, sign(_mm512_add_epi64(turns, one)))),
            )
        }
    }
}

impl Quadrants for F64x4 {
    #[inline(always)]
    fn all_within<const N: usize>(x: [Self; N], bound: f64) -> bool {
        // SAFETY: see the module.
        unsafe {
            let mut within = _mm256_castsi256_pd(_mm256_set1_epi64x(-1));
            for x in x {
                let size = _mm256_andnot_pd(_mm256_set1_pd(-0.0), x.0);
                let fits = _mm256_cmp_pd::<_CMP_LE_OQ>(size, _mm256_set1_pd(bound));
                within = _mm256_and_pd(within, fits);
            }
            _mm256_movemask_pd(within) == 0xf
        }
    }

    #[inline(always)]
    fn turn(rounded: Self, sin: Self, cos: Self) -> (Self, Self) {
        // SAFETY: see the module.
        unsafe {
            let turns = _mm256_castpd_si256(rounded.0);
            let (one, two) = (_mm256_set1_epi64x(1), _mm256_set1_epi64x(2));
            // A blend looks at the sign bit alone.
            let odd = _mm256_castsi256_pd(_mm256_slli_epi64::<63>(turns));
            let sign = |turns| {
                let half = _mm256_and_si256(turns, two);
                _mm256_castsi256_pd(_mm256_slli_epi64::<62>(half))
            };
            let s = _mm256_blendv_pd(sin.0, cos.0, odd);
            let c = _mm256_blendv_pd(cos.0, sin.0, odd);
            (
                Self(_mm256_xor_pd(s, sign(turns))),
                Self(_mm256_xor_pd(c, sign(_mm256_add_epi64(turns, one)))),
            )
        }
    }
}

/// Panics where these numbers are not rows of such a length, `stride` apart.
#[inline(always)]
fn check_rows<V: Lanes>(length: usize, numbers: &[f64], stride: usize) {
    let last = stride.saturating_mul(V::COUNT - 1);
    let all = last.saturating_add(length);
    assert!(numbers.len() >= all, "as many rows as lanes");
}

/// Panics where a source is not there.
#[inline(always)]
fn check_sources<V: Lanes>(stage: &[V], sources: &[u32]) {
    let last = sources.iter().fold(0, |last, &source| source.max(last));
    let there = sources.is_empty() || (last as usize) < stage.len();
    assert!(there, "a slot for each number");
}

/// From so many numbers on memset fills by a microcoded instruction, which takes twice as
/// long in the second cache.
const MEMSET_IS_SLOW: usize = 80;

/// The numbers before the first multiple of `alignment` bytes, and the others.
fn aligned(to: &mut [f64], alignment: usize) -> (&mut [f64], &mut [f64]) {
    let before = to.as_ptr().align_offset(alignment).min(to.len());
    to.split_at_mut(before)
}
