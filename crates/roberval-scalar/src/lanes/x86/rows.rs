//! From samples side by side in a register to samples one after the other in memory, and back.
//!
//! Loads put the parts of rows together: that is no work for the units that move numbers
//! between registers, of which a transpose has too much. The loops are functions of their own:
//! amid the recursion they would have none of its registers left.

use std::arch::x86_64::*;

use super::{F64x4, F64x8};

/// The transpose of 8 rows.
///
/// # Safety
///
/// There are 8 numbers in each row.
#[inline(always)]
pub(super) unsafe fn transposed8(row: impl Fn(usize) -> *const f64) -> [F64x8; 8] {
    // SAFETY: the caller's; for the instructions see the module above.
    unsafe {
        let mut columns = [F64x8(_mm512_setzero_pd()); 8];
        for (half, columns) in columns.chunks_exact_mut(4).enumerate() {
            let load = |k| _mm256_loadu_pd(row(k).add(4 * half));
            // Rows k and k + 4 side by side; then pairs of rows, and pairs of pairs.
            let pair = |k| _mm512_insertf64x4::<1>(_mm512_castpd256_pd512(load(k)), load(k + 4));
            let (r0, r1, r2, r3) = (pair(0), pair(1), pair(2), pair(3));
            let (a0, a1) = (_mm512_unpacklo_pd(r0, r1), _mm512_unpackhi_pd(r0, r1));
            let (a2, a3) = (_mm512_unpacklo_pd(r2, r3), _mm512_unpackhi_pd(r2, r3));
            let low = |a, b| _mm512_mask_permutex_pd::<0b01_00_01_00>(a, 0b1100_1100, b);
            let high = |a, b| _mm512_mask_permutex_pd::<0b11_10_11_10>(b, 0b0011_0011, a);
            columns[0] = F64x8(low(a0, a2));
            columns[1] = F64x8(low(a1, a3));
            columns[2] = F64x8(high(a0, a2));
            columns[3] = F64x8(high(a1, a3));
        }
        columns
    }
}

/// The transpose of 4 rows.
///
/// # Safety
///
/// There are 4 numbers in each row.
#[inline(always)]
pub(super) unsafe fn transposed4(row: impl Fn(usize) -> *const f64) -> [F64x4; 4] {
    // SAFETY: the caller's; for the instructions see the module above.
    unsafe {
        let mut columns = [F64x4(_mm256_setzero_pd()); 4];
        for (half, columns) in columns.chunks_exact_mut(2).enumerate() {
            let load = |k| _mm_loadu_pd(row(k).add(2 * half));
            // Rows k and k + 2 side by side; then pairs of rows.
            let pair = |k| _mm256_insertf128_pd::<1>(_mm256_castpd128_pd256(load(k)), load(k + 2));
            let (even, odd) = (pair(0), pair(1));
            columns[0] = F64x4(_mm256_unpacklo_pd(even, odd));
            columns[1] = F64x4(_mm256_unpackhi_pd(even, odd));
        }
        columns
    }
}

/// The last `count` numbers of `a`, less than 8, then the first of `b`.
#[inline(always)]
fn then8(a: F64x8, b: F64x8, count: usize) -> F64x8 {
    static PLACES: [i64; 16] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];
    let places = &PLACES[8 - count % 8..][..8];
    // SAFETY: there are 8 places; for the instructions see the module above.
    unsafe {
        let places = _mm512_loadu_epi64(places.as_ptr());
        F64x8(_mm512_permutex2var_pd(a.0, places, b.0))
    }
}

/// The last `count` numbers of `a`, less than 4, then the first of `b`.
#[inline(always)]
fn then4(a: F64x4, b: F64x4, count: usize) -> F64x4 {
    /// Added to the places of `b`: halves of numbers, as there is no such instruction for whole.
    const B: i32 = i32::MIN;
    static PLACES: [[i32; 8]; 2] = [
        [0, 1, 2, 3, 4, 5, 6, 7],
        [B, B + 1, B + 2, B + 3, B + 4, B + 5, B + 6, B + 7],
    ];
    let places = &PLACES.as_flattened()[8 - 2 * (count % 4)..][..8];
    // SAFETY: there are 8 places; for the instructions see the module above.
    unsafe {
        let places = _mm256_loadu_si256(places.as_ptr().cast());
        let moved = |x| _mm256_castps_pd(_mm256_permutevar8x32_ps(_mm256_castpd_ps(x), places));
        let of_b = _mm256_castsi256_pd(places);
        F64x4(_mm256_blendv_pd(moved(a.0), moved(b.0), of_b))
    }
}

/// The last `count` numbers of the line `a`, less than 8, then the first of `b`.
#[inline(always)]
fn line8([a]: [F64x8; 1], [b]: [F64x8; 1], count: usize) -> [F64x8; 1] {
    [then8(a, b, count)]
}

/// The same in halves.
#[inline(always)]
fn line4(a: [F64x4; 2], b: [F64x4; 2], count: usize) -> [F64x4; 2] {
    if count < 4 {
        [then4(a[1], b[0], count), then4(b[0], b[1], count)]
    } else {
        [then4(a[0], a[1], count), then4(a[1], b[0], count)]
    }
}

/// The loops for lanes of one width.
macro_rules! rows {
    ($module:ident: $features:literal, $name:ident, $count:literal lanes,
     $zero:ident, $store:ident, $stream:ident, $transposed:ident, $line:ident) => {
        pub(super) mod $module {
            use std::arch::x86_64::*;
            use std::ops::Range;

            use super::{$line, $name, $transposed};
            use crate::LINE;

            /// See `Lanes::store_transposed`.
            ///
            /// # Safety
            ///
            /// The processor has the features, `stage` the sources, and the rows are there.
            #[target_feature(enable = $features)]
            pub unsafe fn store(stage: &[$name], sources: &[u32], to: *mut f64, stride: usize) {
                let stage = stage.as_ptr().cast::<f64>();
                let blocks = sources.chunks_exact($count);
                let rest = blocks.remainder();
                // SAFETY: the caller's.
                unsafe {
                    for (block, sources) in blocks.enumerate() {
                        let row = |k: usize| stage.add($count * sources[k] as usize);
                        for (s, row) in $transposed(row).into_iter().enumerate() {
                            $store(to.add(s * stride + $count * block), row.0);
                        }
                    }
                    let to = to.add(sources.len() - rest.len());
                    for (k, &source) in rest.iter().enumerate() {
                        for s in 0..$count {
                            *to.add(s * stride + k) = *stage.add($count * source as usize + s);
                        }
                    }
                }
            }

            /// See `Lanes::stream_transposed`.
            ///
            /// # Safety
            ///
            /// The processor has the features, `stage` the sources, and the rows are there.
            #[target_feature(enable = $features)]
            pub unsafe fn stream(
                stage: &[$name],
                (sources, blocks): (&[u32], Range<usize>),
                to: *mut f64,
                stride: usize,
            ) {
                const PARTS: usize = LINE / $count;
                let stage = stage.as_ptr().cast::<f64>();
                let zero = [[$name($zero()); $count]; PARTS];
                let whole = sources.len() / LINE;
                let end = blocks.end.min(whole);
                let (mut rows, mut shifts) = ([to; $count], [0; $count]);
                for (s, (row, shift)) in rows.iter_mut().zip(&mut shifts).enumerate() {
                    *row = to.wrapping_add(s * stride);
                    *shift = row.addr() / size_of::<f64>() % LINE;
                    *row = row.wrapping_sub(*shift);
                }
                // A line's parts one after the other: half of one would go to memory alone.
                let put = |line: usize, before: &[_; PARTS], now: &[[$name; $count]; PARTS]| {
                    for (s, (row, shift)) in rows.iter().zip(shifts).enumerate() {
                        let of = |parts: &[[$name; $count]; PARTS]| parts.map(|part| part[s]);
                        for (part, numbers) in $line(of(before), of(now), shift).iter().enumerate()
                        {
                            // Line 0 of row 0 may begin before the array, where `add` is
                            // undefined.
                            let at = row.wrapping_add(LINE * line + $count * part);
                            // SAFETY: the line is aligned, and within its row (the caller's).
                            unsafe { $stream(at, numbers.0) }
                        }
                    }
                };
                let mut before = zero;
                for block in blocks.start..end {
                    let mut now = zero;
                    for (part, columns) in now.iter_mut().enumerate() {
                        let sources = &sources[LINE * block + $count * part..][..$count];
                        // SAFETY: the caller's.
                        *columns =
                            unsafe { $transposed(|k| stage.add($count * sources[k] as usize)) };
                    }
                    if block > 0 {
                        put(block, &before, &now);
                    }
                    before = now;
                }
                if (blocks.start.max(1)..whole).contains(&end) {
                    put(end, &before, &zero);
                }
            }
        }
    };
}

rows!(
    eight: "avx512f,avx512dq,avx512vl,avx2,fma", F64x8, 8 lanes,
    _mm512_setzero_pd, _mm512_storeu_pd, _mm512_stream_pd, transposed8, line8
);
rows!(
    four: "avx2,fma", F64x4, 4 lanes,
    _mm256_setzero_pd, _mm256_storeu_pd, _mm256_stream_pd, transposed4, line4
);
