//! Rows past the cache, straight from the registers: whole lines of it.

use std::ops::Range;

use roberval_scalar::{LINE, Lanes, MAX_LANES};

/// Tiles of fewer numbers go through a buffer, which is faster: much of them is between whole
/// lines (measured with rows of 6 to 400 numbers, 8 lanes and 4).
pub(crate) const FEW: usize = 1280;

// Rows of the others have a line at least, which is what `borders` takes for granted.
const _: () = assert!(FEW >= LINE * MAX_LANES);

/// Writes the samples of a full tile, whose rows have a line at least; `stage` has a zero after
/// its slots. Lines without a source in these ranges are zero for every state: left alone if they
/// are so already.
#[inline(always)]
pub(crate) fn write_past<V: Lanes>(
    stage: &mut [V],
    (sources, filled): (&[u32], &[Range<usize>]),
    out: &mut [f64],
    cleared: bool,
) {
    let length = sources.len();
    let whole = length / LINE;
    let mut done = 1;
    for range in filled {
        let blocks = range.start / LINE..range.end.div_ceil(LINE);
        if !cleared {
            zeros::<V>(out, length, done..blocks.start);
        }
        done = blocks.end + 1;
        V::stream_transposed(stage, (sources, blocks), out, length);
    }
    if !cleared {
        zeros::<V>(out, length, done..whole);
    }
    borders(stage, sources, out);
}

/// Copies numbers, past the cache or into it.
#[inline(always)]
pub(crate) fn copy<V: Lanes>(numbers: &[f64], out: &mut [f64], past: bool) {
    if !past {
        return out.copy_from_slice(numbers);
    }
    let head = out
        .as_ptr()
        .align_offset(size_of::<f64>() * LINE)
        .min(out.len());
    let (first, lines) = out.split_at_mut(head);
    first.copy_from_slice(&numbers[..head]);
    V::stream(&numbers[head..], lines);
}

/// Zeros in these lines of every row.
#[inline(always)]
fn zeros<V: Lanes>(out: &mut [f64], length: usize, lines: Range<usize>) {
    if lines.is_empty() {
        return;
    }
    for s in 0..V::COUNT {
        let first = line(out, s * length, lines.start);
        V::stream_zeros(&mut out[first..][..lines.len() * LINE]);
    }
}

/// What is behind the last whole line of each row and before line 1 of the next: number by
/// number.
#[inline(always)]
fn borders<V: Lanes>(stage: &mut [V], sources: &[u32], out: &mut [f64]) {
    let length = sources.len();
    let numbers = V::numbers(stage);
    let number = |s: usize, at: usize| numbers[sources[at] as usize * V::COUNT + s];
    let mut start = 0;
    for s in 0..=V::COUNT {
        let row = s * length;
        let last = s == V::COUNT;
        let end = if last { row } else { line(out, row, 1) };
        let behind = (start..row).map(|at| number(s - 1, at + length - row));
        let before = (row..end).map(|at| number(s, at - row));
        // Less than two lines behind, one line before.
        let mut border = [0.0; 3 * LINE];
        for (x, number) in border.iter_mut().zip(behind.chain(before)) {
            *x = number;
        }
        V::stream(&border[..end - start], &mut out[start..end]);
        start = line(out, row, length / LINE);
    }
}

/// Where a line of a row begins: line 0 has the row's first number.
#[inline(always)]
fn line(out: &[f64], row: usize, line: usize) -> usize {
    let shift = (out.as_ptr().addr() / size_of::<f64>() + row) % LINE;
    row + line * LINE - shift
}
