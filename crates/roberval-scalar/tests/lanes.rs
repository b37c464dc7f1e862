//! Lanes of every width that this processor has, against exact references.

use std::f64::consts::FRAC_PI_2;
use std::ops::Range;

use num_rational::BigRational;
use num_traits::Zero;
use roberval_scalar::{DoubleDouble, LINE, Lanes, LinearInPi, SplitMix64, Task, Width, dispatch};

/// The bound that the documentation of `Lanes::sin_cos` states.
const ULPS: f64 = 1.0;

const RANDOM_ANGLES: usize = 20_000;

fn widths() -> impl Iterator<Item = Width> {
    Width::ALL.into_iter().filter(|width| width.is_available())
}

/// Sines and cosines of as many numbers as divide by all widths: of each register alone, which
/// two together must give, too.
struct SinCos<'a>(&'a [f64]);

impl Task for SinCos<'_> {
    type Output = Vec<(f64, f64)>;

    #[inline(always)]
    fn run<V: Lanes>(self) -> Self::Output {
        let numbers = |(sin, cos): (V, V)| {
            let (mut sines, mut cosines) = ([0.0; 8], [0.0; 8]);
            sin.store(&mut sines);
            cos.store(&mut cosines);
            (0..V::COUNT).map(move |lane| (sines[lane], cosines[lane]))
        };
        let mut out = Vec::new();
        for x in self.0.chunks_exact(V::COUNT) {
            let [alone] = V::sin_cos([V::load(x)]);
            out.extend(numbers(alone));
        }
        let bits = |(sin, cos): (f64, f64)| (sin.to_bits(), cos.to_bits());
        for (x, alone) in (self.0.windows(2 * V::COUNT)).zip(out.windows(2 * V::COUNT)) {
            let (first, second) = x.split_at(V::COUNT);
            let both = V::sin_cos([V::load(first), V::load(second)]);
            let both = both.into_iter().flat_map(numbers);
            assert!(both.zip(alone).all(|(a, &b)| bits(a) == bits(b)));
        }
        out
    }
}

fn exact(x: f64) -> [DoubleDouble; 2] {
    let angle = LinearInPi {
        rational: BigRational::from_float(x).expect("finite"),
        half_turns: BigRational::zero(),
    };
    let (cos, sin) = DoubleDouble::cos_sin(&angle);
    [sin, cos]
}

fn ulps(found: f64, expected: DoubleDouble) -> f64 {
    let nearest = expected.to_f64().abs();
    let ulp = f64::from_bits(nearest.to_bits() + 1) - nearest;
    ((DoubleDouble::from(found) - expected).to_f64() / ulp).abs()
}

#[test]
fn sines_and_cosines_are_within_an_ulp_up_to_100() {
    let mut random = SplitMix64::new(1);
    let mut angles: Vec<f64> = (0..RANDOM_ANGLES)
        .map(|_| random.uniform(-100.0, 100.0))
        .collect();
    // The nearest doubles to multiples of a right angle, and small angles.
    angles.extend((-64..64).map(|k| f64::from(k) * FRAC_PI_2));
    angles.extend((0..64).map(|k| 0.3 * 0.5_f64.powi(k)));
    let expected: Vec<_> = angles.iter().map(|&x| exact(x)).collect();
    for width in widths() {
        let found = dispatch(width, SinCos(&angles));
        assert_eq!(found.len(), angles.len());
        let mut worst: f64 = 0.0;
        for ((x, found), expected) in angles.iter().zip(&found).zip(&expected) {
            for (found, expected) in [(found.0, expected[0]), (found.1, expected[1])] {
                let error = ulps(found, expected);
                assert!(error <= ULPS, "{width:?} at {x}: {error} ulp");
                worst = worst.max(error);
            }
        }
        println!("{width:?}: {worst} ulp");
    }
}

#[test]
fn any_angle_is_handled_and_leaves_its_neighbours_alone() {
    let angles = [
        1.0,
        1e300,
        -0.0,
        f64::INFINITY,
        2e5,
        f64::NAN,
        99_999.9,
        -3.0,
    ];
    for width in widths() {
        let found = dispatch(width, SinCos(&angles));
        for (lane, (x, found)) in angles.iter().zip(&found).enumerate() {
            let alone = dispatch(width, SinCos(&[*x; 8]))[lane % width.lanes()];
            let bits = |(s, c): (f64, f64)| (s.to_bits(), c.to_bits());
            assert_eq!(bits(*found), bits(alone), "{width:?} at {x}");
            assert_eq!(found.0.is_nan(), !x.is_finite(), "{width:?} at {x}");
            if x.abs() > 1e5 && x.is_finite() {
                assert_eq!(*found, x.sin_cos(), "{width:?} at {x}");
            }
        }
    }
}

#[test]
fn fused_lanes_of_all_widths_give_the_same_bits() {
    let mut random = SplitMix64::new(2);
    let angles: Vec<f64> = (0..800).map(|_| random.uniform(-9.0, 9.0)).collect();
    let fused: Vec<_> = widths()
        .filter(|width| *width != Width::Plain)
        .map(|width| dispatch(width, SinCos(&angles)))
        .collect();
    assert!(fused.windows(2).all(|pair| pair[0] == pair[1]));
}

/// What the other operations give on pairs of numbers, each with the other.
struct Operations<'a>([&'a [f64]; 2]);

impl Task for Operations<'_> {
    type Output = Vec<[f64; 11]>;

    #[inline(always)]
    fn run<V: Lanes>(self) -> Self::Output {
        let mut out = Vec::new();
        let [x, y] = self.0.map(|numbers| numbers.chunks_exact(V::COUNT));
        for (x, y) in x.zip(y) {
            let (x, y) = (V::load(x), V::load(y));
            let zero = if x.is_zero() { 1.0 } else { 0.0 };
            let results = [
                x + y,
                x - y,
                x * y,
                -x,
                x.divide(y),
                x.sqrt(),
                x.with_sign_of(y),
                x.where_nonzero(y),
                x.neg_mul_add(y, y),
                -(x.mul_add(y, y)),
                V::lift(zero),
            ]
            .map(|result| {
                let mut lanes = [0.0; 8];
                result.store(&mut lanes);
                lanes
            });
            out.extend((0..V::COUNT).map(|lane| results.map(|lanes| lanes[lane])));
        }
        out
    }
}

#[test]
fn operations_of_lanes_are_those_of_floats_to_the_sign_of_zero() {
    let numbers = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        f64::MIN_POSITIVE / 4.0,
        f64::INFINITY,
        -f64::INFINITY,
        f64::NAN,
    ];
    // Compilers have made sums of negatives of the negative of a fused sum.
    let opposite = |x: f64| f64::from_bits(std::hint::black_box(x).to_bits() ^ (1 << 63));
    // A NaN's sign and payload are the processor's.
    let bits = |x: f64| if x.is_nan() { u64::MAX } else { x.to_bits() };
    for (x, y) in numbers.iter().flat_map(|x| numbers.map(|y| (*x, y))) {
        let expected = [
            x + y,
            x - y,
            x * y,
            -x,
            x / y,
            x.sqrt(),
            x.copysign(y),
            if y == 0.0 { 0.0 } else { x },
            (-x).mul_add(y, y),
            opposite(x.mul_add(y, y)),
            f64::from(x == 0.0),
        ]
        .map(bits);
        for width in widths().filter(|width| *width > Width::Plain) {
            for found in dispatch(width, Operations([&[x; 8], &[y; 8]])) {
                assert_eq!(found.map(bits), expected, "{width:?} of {x} and {y}");
            }
        }
    }
}

#[test]
fn lanes_are_zero_if_each_is() {
    for (at, other) in (0..8).flat_map(|at| [1.0, f64::NAN].map(|other| (at, other))) {
        let mut numbers = [0.0; 8];
        numbers[at] = other;
        for width in widths() {
            let found = dispatch(width, Operations([&numbers, &numbers]));
            let flags = found.iter().map(|of| of[10] == 1.0);
            let expected = (0..8).map(|k| k / width.lanes() != at / width.lanes());
            assert!(flags.eq(expected), "{width:?}: {other} at {at}");
        }
    }
}

#[test]
fn the_widest_lanes_are_those_that_the_processor_is_known_to_have() {
    if cfg!(target_arch = "aarch64") {
        assert!(Width::Two.is_available() && Width::narrow() == Width::One);
        assert!(!Width::Four.is_available() && !Width::Eight.is_available());
    } else {
        assert!(!Width::Two.is_available());
    }
    if std::env::var_os("ROBERVAL_LANES").is_none() {
        assert_eq!(Some(Width::best()), widths().last());
    }
}

/// Takes an 8 x 8 table apart in blocks and puts its transpose together.
struct Transpose<'a>(&'a [f64]);

impl Task for Transpose<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn run<V: Lanes>(self) -> Self::Output {
        let mut out = vec![0.0; 64];
        let sources: Vec<u32> = (0..8).collect();
        for i in (0..8).step_by(V::COUNT) {
            V::load_transposed(&self.0[8 * i..], 8, 8 / V::COUNT, |k, block| {
                let j = k * V::COUNT;
                // Lane vectors are columns: written as rows they are the transpose.
                for (k, column) in block.iter().enumerate() {
                    column.store(&mut out[8 * (j + k) + i..]);
                }
                let mut back = vec![0.0; 64];
                V::store_transposed(block, &sources[..V::COUNT], &mut back, 8);
                for s in 0..V::COUNT {
                    let there = &self.0[8 * (i + s) + j..][..V::COUNT];
                    assert_eq!(&back[8 * s..][..V::COUNT], there);
                }
            });
        }
        out
    }
}

#[test]
fn blocks_are_transposed_and_back() {
    let table: Vec<f64> = (0..64).map(f64::from).collect();
    for width in widths() {
        let out = dispatch(width, Transpose(&table));
        for (at, x) in out.iter().enumerate() {
            assert_eq!(*x, table[at % 8 * 8 + at / 8], "{width:?}");
        }
    }
}

/// Whether all of an 8 x 8 table is found to be finite.
struct Finite<'a>(&'a [f64]);

impl Task for Finite<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<V: Lanes>(self) -> bool {
        let mut none = V::lift(0.0);
        for i in (0..8).step_by(V::COUNT) {
            none = none + V::load_transposed(&self.0[8 * i..], 8, 8 / V::COUNT, |_, _| {});
        }
        none.is_zero()
    }
}

#[test]
fn transposing_finds_any_number_that_is_not_finite() {
    for width in widths() {
        let table: Vec<f64> = (0..64).map(|k| f64::from(k) - 31.5).collect();
        assert!(dispatch(width, Finite(&table)), "{width:?}");
        for (at, other) in (0..64).flat_map(|at| [f64::INFINITY, f64::NAN].map(|x| (at, x))) {
            let mut table = table.clone();
            table[at] = other;
            assert!(
                !dispatch(width, Finite(&table)),
                "{width:?}: {other} at {at}"
            );
        }
    }
}

/// Slots of which number l is l more than a hundred times the slot; the last one is zero.
fn stage<V: Lanes>() -> Vec<V> {
    let slot =
        |k| Vec::from_iter((0..8).map(|l| if k == 15 { 0.0 } else { f64::from(100 * k + l) }));
    (0..16).map(|k| V::load(&slot(k))).collect()
}

/// Rows from slots: all numbers, or the lines past the cache of those of some blocks.
struct Rows<'a> {
    sources: &'a [u32],
    blocks: Option<Range<usize>>,
    to: &'a mut [f64],
    stride: usize,
}

impl Task for Rows<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes>(self) {
        let stage = stage::<V>();
        match self.blocks {
            None => V::store_transposed(&stage, self.sources, self.to, self.stride),
            Some(blocks) => {
                V::stream_transposed(&stage, (self.sources, blocks), self.to, self.stride);
                V::fence();
            }
        }
    }
}

#[test]
fn rows_have_their_numbers_and_no_others_are_touched() {
    for width in widths() {
        for (length, stride) in (0..40).flat_map(|n| [(n, n), (n, n + 3)]) {
            let sources = Vec::from_iter((0..length as u32).map(|k| 7 * k % 16));
            let mut out = vec![-1.0; 8 * stride + 1];
            dispatch(
                width,
                Rows {
                    sources: &sources,
                    blocks: None,
                    to: &mut out,
                    stride,
                },
            );
            for (at, x) in out.iter().enumerate() {
                let (s, k) = (at / stride.max(1), at % stride.max(1));
                let expected = match sources.get(k) {
                    Some(15) if s < width.lanes() => 0.0,
                    Some(slot) if s < width.lanes() => f64::from(100 * slot) + s as f64,
                    _ => -1.0,
                };
                assert_eq!(*x, expected, "{width:?}: {length} numbers, {stride} apart");
            }
        }
    }
}

#[test]
fn lines_past_the_cache_are_those_of_the_blocks_wherever_rows_begin() {
    for width in widths() {
        let count = width.lanes();
        for (length, first) in (0..7 * LINE).flat_map(|n| (0..LINE).map(move |f| (n, f))) {
            let sources = Vec::from_iter((0..length as u32).map(|k| 7 * k % 16));
            let whole = length / LINE;
            for blocks in (0..=whole).flat_map(|a| (a..=whole).map(move |b| a..b)) {
                let mut memory = vec![-1.0; count * length + 2 * LINE];
                let start = memory.as_ptr().align_offset(8 * LINE) + first;
                let to = &mut memory[start..start + count * length];
                dispatch(
                    width,
                    Rows {
                        sources: &sources,
                        blocks: Some(blocks.clone()),
                        to,
                        stride: length,
                    },
                );
                let mut expected = vec![-1.0; memory.len()];
                for s in 0..count {
                    let row = start + s * length;
                    let shift = (first + s * length) % LINE;
                    for line in blocks.start.max(1)..whole.min(blocks.end + 1) {
                        for at in line * LINE - shift..(line + 1) * LINE - shift {
                            let slot = sources[at];
                            let zero = slot == 15 || !blocks.contains(&(at / LINE));
                            expected[row + at] = if zero {
                                0.0
                            } else {
                                f64::from(100 * slot) + s as f64
                            };
                        }
                    }
                }
                assert_eq!(
                    memory, expected,
                    "{width:?}: {length} numbers from {first} on, {blocks:?}"
                );
            }
        }
    }
}

struct Copy<'a>(&'a [f64], &'a mut [f64]);

impl Task for Copy<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes>(self) {
        V::stream(self.0, self.1);
        V::fence();
    }
}

struct Zeros<'a>(&'a mut [f64]);

impl Task for Zeros<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes>(self) {
        V::stream_zeros(self.0);
        V::fence();
    }
}

#[test]
fn streams_write_every_number_and_no_other_at_any_alignment() {
    let numbers: Vec<f64> = (0..100).map(f64::from).collect();
    let zeros = vec![0.0; 100];
    for width in widths() {
        for (from, to, count) in [(0, 0, 100), (1, 3, 61), (5, 2, 7), (0, 7, 0), (3, 1, 64)] {
            let written = |expected: &[f64], write: &dyn Fn(&mut [f64])| {
                let mut out = vec![-1.0; 120];
                write(&mut out[to..to + count]);
                assert_eq!(out[to..to + count], *expected);
                let mut others = out[..to].iter().chain(&out[to + count..]);
                assert!(others.all(|x| *x == -1.0));
            };
            let numbers = &numbers[from..from + count];
            written(numbers, &|out| dispatch(width, Copy(numbers, out)));
            written(&zeros[..count], &|out| dispatch(width, Zeros(out)));
        }
    }
}

/// Calls with slices that are too short, which must not be read or written.
struct TooShort;

impl Task for TooShort {
    type Output = usize;

    #[inline(always)]
    fn run<V: Lanes>(self) -> usize {
        let (numbers, mut out) = ([0.0; 64], [0.0; 64]);
        let (stage, sources) = ([V::lift(1.0); 2], [0; 16]);
        let mut refused = 0;
        let mut refuses = |call: &mut dyn FnMut()| {
            let caught = std::panic::catch_unwind(std::panic::AssertUnwindSafe(call));
            assert!(caught.is_err(), "{} lanes: call {refused}", V::COUNT);
            refused += 1;
        };
        let blocks = 16 / V::COUNT;
        for stride in [6, usize::MAX, usize::MAX / 2 + 1] {
            // The last row of 16 numbers lacks one at least.
            let rows = stride.saturating_mul(V::COUNT - 1);
            let short = rows.saturating_add(15).min(out.len());
            refuses(&mut || {
                V::load_transposed(&numbers[..short], stride, blocks, |_, _| {});
            });
            refuses(&mut || V::store_transposed(&stage, &sources, &mut out[..short], stride));
            refuses(&mut || {
                V::stream_transposed(&stage, (&sources, 0..2), &mut out[..short], stride);
            });
        }
        // A slot that is not there.
        let sources = [[0; 15].as_slice(), &[2]].concat();
        refuses(&mut || V::store_transposed(&stage, &sources, &mut out, 6));
        refuses(&mut || V::stream_transposed(&stage, (&sources, 0..2), &mut out, 6));
        refused
    }
}

#[test]
fn rows_and_slots_that_are_not_there_are_refused() {
    let wide = widths().filter(|width| width.lanes() > 2);
    for width in wide {
        assert_eq!(dispatch(width, TooShort), 11, "{width:?}");
    }
}
