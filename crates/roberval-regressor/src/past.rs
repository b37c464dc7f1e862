//! Rows on their way past the cache, while others are computed.

use std::marker::PhantomData;
use std::mem;

use roberval_scalar::Lanes;

/// Rows that go past the cache some lines at a time: the memory takes them no faster, and is
/// idle where all come at once.
pub(crate) struct Past<'a, V> {
    from: &'a [f64],
    to: &'a mut [f64],
    /// Numbers at a time: whole lines.
    step: usize,
    lanes: PhantomData<V>,
}

impl<'a, V: Lanes> Past<'a, V> {
    /// The first of the rows, so many numbers at a time.
    #[inline(always)]
    fn new(rows: &'a [f64], to: &'a mut [f64], step: usize) -> Self {
        let head = to.as_ptr().align_offset(size_of::<V>()).min(to.len());
        let (from, _) = rows.split_at(to.len());
        let (to_head, to) = to.split_at_mut(head);
        let (from_head, from) = from.split_at(head);
        to_head.copy_from_slice(from_head);
        Self {
            from,
            to,
            step,
            lanes: PhantomData,
        }
    }

    /// Writes the next lines.
    #[inline(always)]
    pub(crate) fn step(&mut self) {
        if !self.to.is_empty() {
            self.write(self.step);
        }
    }

    /// Writes all that is left.
    #[inline(always)]
    pub(crate) fn finish(mut self) {
        self.write(self.to.len());
    }

    #[inline(always)]
    fn write(&mut self, most: usize) {
        let count = most.min(self.to.len());
        let (to, later) = mem::take(&mut self.to).split_at_mut(count);
        let (from, rest) = self.from.split_at(count);
        V::stream(from, to);
        (self.from, self.to) = (rest, later);
    }
}

/// Tiles of so few numbers stay in the nearest caches together with those of the next tile.
const NEAR: usize = 1 << 14;

/// Where the rows of a tile are written that cannot be written in their place: those that go
/// past the cache, and those of a last tile that is not full.
pub(crate) struct Buffer<'a, V: Lanes> {
    /// The rows of this tile, and of the one before.
    now: &'a mut [f64],
    before: &'a mut [f64],
    /// Where the rows of the tile before belong, if they have not gone yet.
    waiting: &'a mut [f64],
    stream: bool,
    /// Numbers that go past the cache at a time.
    step: usize,
    lanes: PhantomData<V>,
}

impl<'a, V: Lanes> Buffer<'a, V> {
    /// Room for tiles of `whole` numbers, `count` in all. Those that go past the cache do so in
    /// so many steps.
    pub(crate) fn new(
        rows: &'a mut Vec<f64>,
        [whole, count]: [usize; 2],
        stream: bool,
        steps: usize,
    ) -> Self {
        let two = if stream && whole <= NEAR { 2 } else { 1 };
        rows.resize(rows.len().max(two * whole), 0.0);
        let rows = &mut rows[..two * whole];
        if stream || !count.is_multiple_of(whole.max(1)) {
            rows.fill(0.0);
        }
        let (now, before) = rows.split_at_mut(whole);
        Self {
            now,
            before,
            waiting: &mut [],
            stream,
            step: whole.div_ceil(steps.max(1)).next_multiple_of(V::COUNT),
            lanes: PhantomData,
        }
    }

    /// Room for the rows of the next tile, and those that go past the cache meanwhile.
    #[inline(always)]
    pub(crate) fn next(&mut self) -> (&mut [f64], Past<'_, V>) {
        let past = Past::new(self.before, mem::take(&mut self.waiting), self.step);
        (self.now, past)
    }

    /// Takes the tile's rows to their place, or leaves that to the next tile.
    #[inline(always)]
    pub(crate) fn pass(&mut self, out: &'a mut [f64]) {
        if !self.stream {
            out.copy_from_slice(&self.now[..out.len()]);
        } else if self.before.is_empty() {
            Past::<V>::new(self.now, out, self.step).finish();
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
