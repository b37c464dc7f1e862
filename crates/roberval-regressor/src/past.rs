//! Rows on their way past the cache, while others are computed.

use std::marker::PhantomData;
use std::mem;
use std::ops::Range;

use roberval_scalar::Lanes;

/// The lines of a tile.
struct Lines {
    /// Those that are not zero for every state: numbers, from the first whole line on.
    filled: Vec<Range<usize>>,
    /// Numbers that go past the cache at a time: whole lines.
    step: usize,
    /// Leave the other lines alone: they are zero.
    keep_zeros: bool,
}

/// Rows that go past the cache some lines at a time: the memory takes them no faster, and is
/// idle where all come at once. Lines that are zero for every state are not read.
pub(crate) struct Past<'a, V> {
    from: &'a [f64],
    to: &'a mut [f64],
    lines: &'a Lines,
    /// Where the next line is, and what is filled from there on.
    at: usize,
    filled: &'a [Range<usize>],
    lanes: PhantomData<V>,
}

impl<'a, V: Lanes> Past<'a, V> {
    /// The first of the rows; where they begin and end amid a line these numbers at once.
    #[inline(always)]
    fn new(rows: &'a [f64], to: &'a mut [f64], lines: &'a Lines) -> Self {
        let (from, _) = rows.split_at(to.len());
        let (to_head, to) = to.split_at_mut(head::<V>(to));
        let (from_head, from) = from.split_at(to_head.len());
        let (to, to_tail) = to.split_at_mut(to.len() / V::COUNT * V::COUNT);
        let (from, from_tail) = from.split_at(to.len());
        to_head.copy_from_slice(from_head);
        to_tail.copy_from_slice(from_tail);
        Self {
            from,
            to,
            lines,
            at: 0,
            filled: &lines.filled,
            lanes: PhantomData,
        }
    }

    /// Writes the next lines.
    #[inline(always)]
    pub(crate) fn step(&mut self) {
        if self.at < self.to.len() {
            self.write(self.lines.step);
        }
    }

    /// Writes all that is left.
    #[inline(always)]
    pub(crate) fn finish(mut self) {
        self.write(self.to.len());
    }

    #[inline(always)]
    fn write(&mut self, most: usize) {
        let end = self.to.len().min(self.at + most);
        while self.at < end {
            let (filled, later) = match self.filled.split_first() {
                Some((filled, later)) => (filled.clone(), later),
                None => (end..end, self.filled),
            };
            let (start, stop) = (end.min(filled.start), end.min(filled.end));
            if self.at < start && !self.lines.keep_zeros {
                V::stream_zeros(&mut self.to[self.at..start]);
            }
            self.at = self.at.max(start);
            V::stream(&self.from[self.at..stop], &mut self.to[self.at..stop]);
            self.at = stop;
            if stop == filled.end {
                self.filled = later;
            }
        }
    }
}

/// Numbers before the first whole line.
#[inline(always)]
fn head<V>(rows: &[f64]) -> usize {
    rows.as_ptr().align_offset(size_of::<V>()).min(rows.len())
}

/// Tiles of which so few numbers are not always zero stay in the nearest caches together with
/// those of the next tile.
const NEAR: usize = 1 << 15;

/// Where the rows of a tile are written that cannot be written in their place: those that go
/// past the cache, and those of a last tile that is not full.
pub(crate) struct Buffer<'a, V: Lanes> {
    /// The rows of this tile, and of the one before.
    now: &'a mut [f64],
    before: &'a mut [f64],
    /// Where the rows of the tile before belong, if they have not gone yet.
    waiting: &'a mut [f64],
    lines: Lines,
    stream: bool,
    lanes: PhantomData<V>,
}

impl<'a, V: Lanes> Buffer<'a, V> {
    /// Room for the tiles of `out`, in which these numbers are not always zero. If they go past
    /// the cache then in so many steps.
    pub(crate) fn new(
        rows: &'a mut Vec<f64>,
        (whole, out): (usize, &[f64]),
        filled: impl Iterator<Item = Range<usize>>,
        (stream, keep_zeros, steps): (bool, bool, usize),
    ) -> Self {
        let lines = Lines {
            filled: match stream {
                true => lines::<V>(filled, head::<V>(out)),
                false => Vec::new(),
            },
            step: whole.div_ceil(steps.max(1)).next_multiple_of(V::COUNT),
            keep_zeros,
        };
        let read: usize = lines.filled.iter().map(Range::len).sum();
        let two = if stream && read <= NEAR { 2 } else { 1 };
        rows.resize(rows.len().max(two * whole), 0.0);
        let rows = &mut rows[..two * whole];
        if stream || !out.len().is_multiple_of(whole.max(1)) {
            rows.fill(0.0);
        }
        let (now, before) = rows.split_at_mut(whole);
        Self {
            now,
            before,
            waiting: &mut [],
            lines,
            stream,
            lanes: PhantomData,
        }
    }

    /// Room for the rows of the next tile, and those that go past the cache meanwhile.
    #[inline(always)]
    pub(crate) fn next(&mut self) -> (&mut [f64], Past<'_, V>) {
        let waiting = mem::take(&mut self.waiting);
        (self.now, Past::new(self.before, waiting, &self.lines))
    }

    /// Takes the tile's rows to their place, or leaves that to the next tile.
    #[inline(always)]
    pub(crate) fn pass(&mut self, out: &'a mut [f64]) {
        if !self.stream {
            out.copy_from_slice(&self.now[..out.len()]);
        } else if self.before.is_empty() {
            Past::<V>::new(self.now, out, &self.lines).finish();
        } else {
            mem::swap(&mut self.now, &mut self.before);
            self.waiting = out;
        }
    }

    /// Takes the last rows to their place.
    #[inline(always)]
    pub(crate) fn finish(mut self) {
        let (_, past) = self.next();
        past.finish();
    }
}

impl<V: Lanes> Drop for Buffer<'_, V> {
    /// Others see what went past the cache.
    #[inline(always)]
    fn drop(&mut self) {
        if self.stream {
            V::fence();
        }
    }
}

/// Zeros between lines that are read with them: so few are told apart no faster than read.
const GAP: usize = 64;

/// The lines that hold some of these numbers; the first whole line begins after `head`.
fn lines<V: Lanes>(filled: impl Iterator<Item = Range<usize>>, head: usize) -> Vec<Range<usize>> {
    let mut lines: Vec<Range<usize>> = Vec::new();
    for range in filled.filter(|range| range.end > head) {
        let first = range.start.saturating_sub(head) / V::COUNT * V::COUNT;
        let end = (range.end - head).next_multiple_of(V::COUNT);
        match lines.last_mut() {
            Some(last) if last.end + GAP >= first => last.end = last.end.max(end),
            _ => lines.push(first..end),
        }
    }
    lines
}
