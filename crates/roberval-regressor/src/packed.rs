//! The nonzeros of the regressor, packed: what the lanes compute.

use std::collections::BTreeMap;
use std::iter;
use std::ops::Range;

use roberval_mechanism::ParameterSpace;
use roberval_scalar::{LINE, Lanes};

use crate::past::write_past;
use crate::{
    DynamicsWorkspace, EnergyWorkspace, Model, Nonzero, Sink, Transmission, Tree, dynamics, energy,
};

/// Which entry of a sample's rows each packed number is.
///
/// Samples come in tiles of as many as there are lanes; a tile is one block of numbers
/// `[slot][lane]`. The slots are, link by link, on each row of the path from the base to
/// the link its columns XX to M, then its Ia on its own row. Entries without a slot
/// are zero for every state.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PackedLayout {
    /// Row and column of each slot.
    entries: Vec<(usize, usize)>,
    /// What the recursion gives at a time; nothing where slots are computed from those of the
    /// tree.
    groups: Vec<Group>,
}

/// Columns that the recursion gives at a time, some of which have slots.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Group {
    row: usize,
    columns: Range<usize>,
}

impl PackedLayout {
    pub(crate) fn new(tree: &Tree<f64>, space: &ParameterSpace, model: Model) -> Self {
        let mut sink = Entries {
            space,
            entries: Vec::new(),
            groups: Vec::new(),
        };
        let still = vec![crate::JointMotion::prismatic(0.0, 0.0, 0.0); tree.bodies.len()];
        match model {
            Model::D | Model::D0 => {
                dynamics(tree, &still, &mut DynamicsWorkspace::new(tree), &mut sink);
            }
            Model::H => energy(tree, &still, &mut EnergyWorkspace::new(tree), &mut sink),
        }
        Self {
            entries: sink.entries,
            groups: sink.groups,
        }
    }

    /// Row and column of each slot.
    #[must_use]
    pub fn entries(&self) -> &[(usize, usize)] {
        &self.entries
    }

    /// Row and column of all that the recursion gives, zeros of every state with it; of what is
    /// computed from it, the slots'.
    pub(crate) fn given(&self) -> Vec<(usize, usize)> {
        if self.groups.is_empty() {
            return self.entries.clone();
        }
        let of = |group: &Group| {
            let row = group.row;
            group.columns.clone().map(move |column| (row, column))
        };
        self.groups.iter().flat_map(of).collect()
    }

    /// Numbers that N samples take: whole tiles, the last one filled up with samples at
    /// rest.
    #[must_use]
    pub fn len(&self, samples: usize, lanes: usize) -> usize {
        samples.next_multiple_of(lanes) * self.entries.len()
    }

    /// Whether there is no slot at all.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }
}

/// The packed numbers of the independent joints' rows, G' times those of all joints.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Projection {
    /// For each slot, which value of G meets which slot of the tree.
    terms: Vec<Vec<(u32, u32)>>,
    /// The same for the torques: which value of G meets which joint's.
    torques: Vec<Vec<(u32, u32)>>,
    from_slots: usize,
    g_width: usize,
}

impl Projection {
    /// The projection of a tree's layout by a transmission of this pattern, and where its
    /// numbers belong.
    pub(crate) fn new(
        layout: &PackedLayout,
        space: &ParameterSpace,
        g: &Transmission<f64>,
        (joints, independent): (usize, usize),
    ) -> (Self, PackedLayout) {
        let mut starts = vec![0];
        for row in 0..joints {
            starts.push(starts[row] + g.row(row).count());
        }
        let mut torques = vec![Vec::new(); independent];
        for row in 0..joints {
            for (k, (place, _)) in g.row(row).enumerate() {
                torques[place].push(((starts[row] + k) as u32, row as u32));
            }
        }
        // Link by link and row by row, as those of the tree.
        let mut slots: BTreeMap<(usize, usize, usize), Vec<(u32, u32)>> = BTreeMap::new();
        let key = |place, column: usize| (space.ids()[column].link, place, column);
        for (row, column) in layout.given() {
            for (place, _) in g.row(row) {
                slots.entry(key(place, column)).or_default();
            }
        }
        for (slot, &(row, column)) in layout.entries.iter().enumerate() {
            for (k, (place, _)) in g.row(row).enumerate() {
                let terms = slots.entry(key(place, column)).or_default();
                terms.push(((starts[row] + k) as u32, slot as u32));
            }
        }
        let entries = slots.keys().map(|&(_, row, column)| (row, column));
        let projected = PackedLayout {
            entries: entries.collect(),
            groups: Vec::new(),
        };
        let projection = Self {
            terms: slots.into_values().collect(),
            torques,
            from_slots: layout.entries.len(),
            g_width: g.values().len(),
        };
        (projection, projected)
    }

    /// Number of values of G.
    pub(crate) fn g_width(&self) -> usize {
        self.g_width
    }

    /// Number of slots of the tree.
    pub(crate) fn tree_slots(&self) -> usize {
        self.from_slots
    }

    #[inline(always)]
    pub(crate) fn apply<V: Lanes>(&self, g: &[V], from: &[V], to: &mut [V]) {
        sums(&self.terms, g, from, to);
    }

    #[inline(always)]
    pub(crate) fn apply_to_torques<V: Lanes>(&self, g: &[V], from: &[V], to: &mut [V]) {
        sums(&self.torques, g, from, to);
    }
}

#[inline(always)]
fn sums<V: Lanes>(terms: &[Vec<(u32, u32)>], g: &[V], from: &[V], to: &mut [V]) {
    for (to, terms) in to.iter_mut().zip(terms) {
        let mut sum = V::lift(0.0);
        for &(value, slot) in terms {
            sum = g[value as usize].mul_add(from[slot as usize], sum);
        }
        *to = sum;
    }
}

/// Records where the recursion's numbers belong.
struct Entries<'a> {
    space: &'a ParameterSpace,
    entries: Vec<(usize, usize)>,
    groups: Vec<Group>,
}

impl Entries<'_> {
    fn add(&mut self, row: usize, columns: Range<usize>, nonzero: impl Fn(usize) -> bool) {
        let first = columns.start;
        let nonzero = columns.clone().filter(|column| nonzero(column - first));
        self.entries.extend(nonzero.map(|column| (row, column)));
        self.groups.push(Group { row, columns });
    }
}

impl Sink<f64> for Entries<'_> {
    fn link(&mut self, link: usize, row: usize, _: [f64; 10], nonzero: Nonzero) {
        let first = self.space.first_column(link);
        self.add(row, first..first + 10, |k| nonzero.has(k));
    }

    fn rotor(&mut self, link: usize, row: usize, _: f64) {
        let column = self.space.first_column(link) + 10;
        self.add(row, column..column + 1, |_| true);
    }
}

/// Writes slot after slot.
pub(crate) struct Packed<'a> {
    rest: &'a mut [f64],
}

impl<'a> Packed<'a> {
    #[inline(always)]
    pub(crate) fn new(slots: &'a mut [f64]) -> Self {
        Self { rest: slots }
    }

    #[inline(always)]
    fn next(&mut self, count: usize) -> &mut [f64] {
        let (next, rest) = std::mem::take(&mut self.rest).split_at_mut(count);
        self.rest = rest;
        next
    }
}

impl<V: Lanes> Sink<V> for Packed<'_> {
    #[inline(always)]
    fn link(&mut self, _: usize, _: usize, columns: [V; 10], nonzero: Nonzero) {
        let slots = self.next(nonzero.count() * V::COUNT);
        let mut slots = slots.chunks_exact_mut(V::COUNT);
        nonzero.each(|k| {
            if let Some(slot) = slots.next() {
                columns[k].store(slot);
            }
        });
    }

    #[inline(always)]
    fn rotor(&mut self, _: usize, _: usize, value: V) {
        value.store(self.next(V::COUNT));
    }
}

/// Writes each group of slots at its place in the rows of a single sample.
pub(crate) struct InPlace<'a> {
    places: std::slice::Iter<'a, u32>,
    row: &'a mut [f64],
}

impl<'a> InPlace<'a> {
    /// What has no slot is zero already.
    #[inline(always)]
    pub(crate) fn new(places: &'a [u32], row: &'a mut [f64]) -> Self {
        Self {
            places: places.iter(),
            row,
        }
    }

    /// Where the next group's numbers belong.
    #[inline(always)]
    fn next(&mut self, count: usize) -> &mut [f64] {
        // There is a place for each group.
        let first = self.places.next().map_or(self.row.len(), |&at| at as usize);
        &mut self.row[first..first + count]
    }
}

impl<V: Lanes> Sink<V> for InPlace<'_> {
    #[inline(always)]
    fn link(&mut self, _: usize, _: usize, columns: [V; 10], nonzero: Nonzero) {
        let to = self.next(10);
        nonzero.each(|k| columns[k].store(&mut to[k..=k]));
    }

    #[inline(always)]
    fn rotor(&mut self, _: usize, _: usize, value: V) {
        value.store(self.next(1));
    }
}

/// Zeros some hundred numbers, whole lines of the cache at a time: a call of memset would take
/// longer than the arithmetic, and a store across two lines counts twice.
#[inline(always)]
fn clear(row: &mut [f64]) {
    // Hidden, or the loop becomes a call of memset.
    let zeros = [std::hint::black_box(0.0); LINE];
    let aligned = row.as_ptr().align_offset(size_of_val(&zeros));
    let aligned = aligned.min(row.len());
    // The ends, wherever they are; between them whole lines.
    match row.first_chunk_mut() {
        Some(head) => *head = zeros,
        None => return row.fill(zeros[0]),
    }
    if let Some(tail) = row.last_chunk_mut() {
        *tail = zeros;
    }
    for line in row[aligned..].chunks_exact_mut(LINE) {
        line.copy_from_slice(&zeros);
    }
}

/// From packed numbers to rows without gaps, all columns or some.
#[derive(Debug, Clone)]
pub(crate) struct Export {
    /// For each number of a sample's rows, its slot; for zeros the one after the last.
    sources: Vec<u32>,
    /// Where slots and numbers follow each other: slot, number and how many.
    runs: Vec<[usize; 3]>,
    /// The place of each group of columns, if each stays together.
    places: Option<Vec<u32>>,
    /// Pieces of `sources` that have a slot, as multiples of [`LINE`] numbers; the rest is zero.
    filled: Vec<Range<usize>>,
    /// Number of slots, and numbers of a row.
    slots: usize,
    width: usize,
}

impl Export {
    /// Rows of `width` numbers, column c at `place(c)`.
    pub(crate) fn new(
        layout: &PackedLayout,
        rows: usize,
        width: usize,
        place: impl Fn(usize) -> Option<usize>,
    ) -> Self {
        let slots = layout.entries.len();
        let together = |group: &Group| {
            let first = place(group.columns.start)?;
            let mut places = (first..).zip(group.columns.clone());
            let together = places.all(|(at, column)| place(column) == Some(at));
            together.then_some((group.row * width + first) as u32)
        };
        let places: Option<Vec<u32>> = layout.groups.iter().map(together).collect();
        let mut sources = vec![slots as u32; rows * width];
        for (slot, &(row, column)) in layout.entries.iter().enumerate() {
            if let Some(place) = place(column) {
                sources[row * width + place] = slot as u32;
            }
        }
        let mut filled: Vec<Range<usize>> = Vec::new();
        for (k, block) in sources.chunks(LINE).enumerate() {
            if block.iter().all(|&source| source as usize == slots) {
                continue;
            }
            let (first, end) = (k * LINE, k * LINE + block.len());
            match filled.last_mut() {
                Some(range) if range.end == first => range.end = end,
                _ => filled.push(first..end),
            }
        }
        Self {
            runs: runs(&sources, slots),
            places: places.filter(|places| !places.is_empty()),
            sources,
            filled,
            slots,
            width,
        }
    }

    /// Numbers of one sample.
    pub(crate) fn len(&self) -> usize {
        self.sources.len()
    }

    /// Sample, row and column of a number of samples' rows.
    pub(crate) fn place(&self, at: usize) -> [usize; 3] {
        let (length, width) = (self.len(), self.width);
        [at / length, at % length / width, at % width]
    }

    /// Where rows have a number that is zero for every state: a look at both ends of each gap
    /// between numbers, in the first and the last sample.
    #[inline(always)]
    pub(crate) fn not_zero(&self, out: &[f64]) -> Option<usize> {
        let length = self.len();
        let last = out.len().checked_div(length)?.checked_sub(1)?;
        (0..=last).step_by(last.max(1)).find_map(|sample| {
            let first = sample * length;
            let ends = self.filled.iter().map(|range| range.end);
            let starts = self.filled.iter().map(|range| range.start);
            let gaps = iter::once(0).chain(ends).zip(starts.chain([length]));
            let mut gaps = gaps.filter(|(start, end)| start < end);
            gaps.find_map(|(start, end)| {
                let mut places = [first + start, first + end - 1].into_iter();
                // Not -0, either, which is not what would be written.
                places.find(|&at| out[at].to_bits() != 0)
            })
        })
    }

    /// Where each group of columns belongs, if each stays together.
    pub(crate) fn places(&self) -> Option<&[u32]> {
        self.places.as_deref()
    }

    /// Number of slots, the zero's not counted.
    pub(crate) fn slots(&self) -> usize {
        self.slots
    }

    /// Zeros a single sample, or what of it is not zero in every state.
    #[inline(always)]
    pub(crate) fn clear(&self, out: &mut [f64], cleared: bool) {
        if !cleared {
            return clear(out);
        }
        for range in &self.filled {
            clear(&mut out[range.clone()]);
        }
    }

    /// Writes a single sample from its packed numbers.
    #[inline(always)]
    pub(crate) fn write_one(&self, numbers: &[f64], out: &mut [f64], cleared: bool) {
        self.clear(out, cleared);
        for &[slot, at, count] in &self.runs {
            let (from, to) = (&numbers[slot..slot + count], &mut out[at..at + count]);
            for (from, to) in from.iter().zip(to) {
                *to = *from;
            }
        }
    }

    /// Writes the samples of a full tile, one after the other. `stage` has a zero after its
    /// slots; what is zero for every state is left alone if it is so already.
    #[inline(always)]
    pub(crate) fn write<V: Lanes>(&self, stage: &[V], out: &mut [f64], cleared: bool) {
        let length = self.len();
        let mut done = 0;
        for range in &self.filled {
            if !cleared {
                zero::<V>(out, length, done..range.start);
            }
            let sources = &self.sources[range.clone()];
            V::store_transposed(stage, sources, &mut out[range.start..], length);
            done = range.end;
        }
        if !cleared {
            zero::<V>(out, length, done..length);
        }
    }

    /// The same past the cache.
    #[inline(always)]
    pub(crate) fn write_past<V: Lanes>(&self, stage: &mut [V], out: &mut [f64], cleared: bool) {
        write_past(stage, (&self.sources, &self.filled), out, cleared);
    }
}

/// Pieces of the sources in which slots follow each other.
fn runs(sources: &[u32], slots: usize) -> Vec<[usize; 3]> {
    let mut runs: Vec<[usize; 3]> = Vec::new();
    for (at, &slot) in sources.iter().enumerate() {
        let slot = slot as usize;
        match runs.last_mut() {
            _ if slot == slots => {}
            Some([first, from, count]) if (*first + *count, *from + *count) == (slot, at) => {
                *count += 1;
            }
            _ => runs.push([slot, at, 1]),
        }
    }
    runs
}

/// Writes zeros at these places of every sample.
#[inline(always)]
fn zero<V: Lanes>(out: &mut [f64], length: usize, range: Range<usize>) {
    if range.is_empty() {
        return;
    }
    for s in 0..V::COUNT {
        V::clear(&mut out[s * length..][range.clone()]);
    }
}
