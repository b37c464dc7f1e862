//! Several samples at a time: lanes of floats, chosen by what the processor can do.
//!
//! A generic wheel must run anywhere, so the choice is made at run time, here and nowhere
//! else: [`dispatch`] calls a [`Task`] with the widest [`Lanes`] of this processor. The
//! lane types have no public name, so that nobody can use an instruction that is not there.

#[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
mod arithmetic;
#[cfg(target_arch = "aarch64")]
mod arm;
#[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
mod fused;
mod one;
#[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
mod trigonometry;
#[cfg(target_arch = "x86_64")]
mod x86;

use std::fmt::Debug;
use std::ops::Range;

use crate::Lift;

/// The most lanes that any processor has.
pub const MAX_LANES: usize = 8;

/// Numbers of a line of the cache.
pub const LINE: usize = 8;

/// Some floats side by side, on which every operation acts lane by lane.
///
/// A lane's result does not depend on its neighbours: a sample gives the same bits
/// whichever lane it is in and however many there are, as long as products and sums are
/// fused (all but [`Width::Plain`]).
pub trait Lanes: Lift<f64> + Debug + Send + Sync + 'static {
    /// How many floats.
    const COUNT: usize;

    /// How many of them the processor has registers for.
    const REGISTERS: usize = 16;

    /// Whether [`Lanes::stream`] goes past the cache: elsewhere it is a copy.
    const STREAMS: bool = false;

    /// The first `COUNT` numbers.
    fn load(from: &[f64]) -> Self;

    /// Into the first `COUNT` numbers.
    fn store(self, to: &mut [f64]);

    /// The numbers of lanes that lie side by side.
    fn numbers(lanes: &mut [Self]) -> &mut [f64];

    /// `self / by`.
    fn divide(self, by: Self) -> Self;

    /// The square root.
    fn sqrt(self) -> Self;

    /// `|self|` with the sign of `sign`.
    fn with_sign_of(self, sign: Self) -> Self;

    /// `self`, but 0 where `test` is 0.
    fn where_nonzero(self, test: Self) -> Self;

    /// Whether all lanes are 0, none of them NaN.
    fn is_zero(self) -> bool;

    /// Sine and cosine of each: within 1 ulp for |x| <= 100, any x; NaN for infinite x. Two
    /// together take less time than one after the other.
    fn sin_cos<const N: usize>(x: [Self; N]) -> [(Self, Self); N];

    /// Takes `COUNT` rows, `stride` apart, of so many blocks of `COUNT` numbers: `put(k, columns)`
    /// gets the columns of block k, a row a lane. Gives zeros, or NaN somewhere if not all these
    /// numbers are finite.
    fn load_transposed(
        from: &[f64],
        stride: usize,
        blocks: usize,
        mut put: impl FnMut(usize, &[Self]),
    ) -> Self {
        let zero = Self::lift(0.0);
        let mut none = zero;
        for block in 0..blocks {
            let mut columns = [zero; MAX_LANES];
            for (k, to) in columns.iter_mut().enumerate().take(Self::COUNT) {
                let mut column = [0.0; MAX_LANES];
                for (s, x) in column.iter_mut().enumerate().take(Self::COUNT) {
                    *x = from[s * stride + block * Self::COUNT + k];
                }
                *to = Self::load(&column);
                none = to.mul_add(zero, none);
            }
            put(block, &columns[..Self::COUNT]);
        }
        none
    }

    /// Into `COUNT` rows, `stride` apart: number k of row s is lane s of `stage[sources[k]]`.
    fn store_transposed(stage: &[Self], sources: &[u32], to: &mut [f64], stride: usize) {
        for (k, &source) in sources.iter().enumerate() {
            let mut column = [0.0; MAX_LANES];
            stage[source as usize].store(&mut column);
            for (s, x) in column.iter().enumerate().take(Self::COUNT) {
                to[s * stride + k] = *x;
            }
        }
    }

    /// Lines of those rows past the cache, for rows that are larger than it. Line 1 of a row is
    /// the first that is within it wherever rows begin, line l has numbers of blocks l - 1 and l
    /// (of [`LINE`] sources). Writes those of these blocks as far as line
    /// `sources.len() / LINE - 1`, zeros in place of other blocks.
    fn stream_transposed(
        stage: &[Self],
        (sources, blocks): (&[u32], Range<usize>),
        to: &mut [f64],
        stride: usize,
    ) {
        let whole = sources.len() / LINE;
        for s in 0..Self::COUNT {
            let row = &mut to[s * stride..];
            let shift = row.as_ptr().addr() / size_of::<f64>() % LINE;
            for line in blocks.start.max(1)..whole.min(blocks.end.saturating_add(1)) {
                for at in (line * LINE - shift..).take(LINE) {
                    let mut numbers = [0.0; MAX_LANES];
                    if blocks.contains(&(at / LINE)) {
                        stage[sources[at] as usize].store(&mut numbers);
                    }
                    row[at] = numbers[s];
                }
            }
        }
    }

    /// Zeros.
    fn clear(to: &mut [f64]) {
        to.fill(0.0);
    }

    /// Copies past the cache, for results that are larger than it, if `to` begins where lanes
    /// do (a multiple of their size). Call [`Lanes::fence`] at last.
    fn stream(from: &[f64], to: &mut [f64]) {
        to.copy_from_slice(from);
    }

    /// Zeros past the cache, in the same way.
    fn stream_zeros(to: &mut [f64]) {
        to.fill(0.0);
    }

    /// Ends what was written past the cache: before that nobody may look at it, this thread no more
    /// than others.
    fn fence() {}
}

/// Work that is written for any lanes.
pub trait Task {
    /// What comes out.
    type Output;

    /// Does it. Mark this and all that it calls `#[inline(always)]`: what is not inlined
    /// is compiled without the processor's features.
    fn run<V: Lanes>(self) -> Self::Output;
}

/// The lanes that a processor has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Width {
    /// One float, products and sums rounded apart.
    Plain,
    /// One float, fused.
    One,
    /// Two floats: NEON.
    Two,
    /// Four floats: AVX2.
    Four,
    /// Eight floats: AVX-512.
    Eight,
}

impl Width {
    /// All widths, the narrowest first.
    pub const ALL: [Self; 5] = [Self::Plain, Self::One, Self::Two, Self::Four, Self::Eight];

    /// How many floats.
    #[must_use]
    pub fn lanes(self) -> usize {
        [1, 1, 2, 4, 8][self as usize]
    }

    /// Whether this processor has it.
    #[must_use]
    pub fn is_available(self) -> bool {
        self == Self::Plain || available(self)
    }

    /// The widest of this processor, or as wide as the environment variable
    /// `ROBERVAL_LANES` allows (0 means plain floats): to compare processors on one.
    #[must_use]
    pub fn best() -> Self {
        let allowed = std::env::var("ROBERVAL_LANES").ok();
        let allowed = allowed.and_then(|lanes| lanes.trim().parse::<usize>().ok());
        let fits = |width: &Self| match allowed {
            Some(0) => *width == Self::Plain,
            Some(lanes) => width.lanes() <= lanes,
            None => true,
        };
        let mut widths = Self::ALL.into_iter().rev();
        let widest = widths.find(|width| width.is_available() && fits(width));
        widest.unwrap_or(Self::Plain)
    }

    /// One lane with the arithmetic of [`Width::best`]: for single samples.
    #[must_use]
    pub fn narrow() -> Self {
        if Self::One.is_available() {
            Self::One
        } else {
            Self::Plain
        }
    }
}

/// Does the work with lanes of this width, or with plain floats where this processor does
/// not have it.
pub fn dispatch<T: Task>(width: Width, task: T) -> T::Output {
    #[cfg(target_arch = "x86_64")]
    return x86::dispatch(width, task);
    #[cfg(target_arch = "aarch64")]
    return arm::dispatch(width, task);
    #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
    return task.run::<f64>();
}

/// Does the work with one lane of the arithmetic of [`Width::best`]: for what is done
/// rarely, which need not be compiled for every width.
pub fn dispatch_one<T: Task>(task: T) -> T::Output {
    #[cfg(target_arch = "x86_64")]
    return x86::dispatch_one(task);
    #[cfg(target_arch = "aarch64")]
    return arm::dispatch_one(task);
    #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
    return task.run::<f64>();
}

fn available(width: Width) -> bool {
    #[cfg(target_arch = "x86_64")]
    return x86::available(width);
    #[cfg(target_arch = "aarch64")]
    return arm::available(width);
    #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
    return false;
}
