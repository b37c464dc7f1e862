//! From samples to annihilated tiles.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use roberval_regressor::{
    Expanded, Model, NoValue, Regressor, Slots, States, TileRows, TreeStates,
};
use roberval_scalar::{Lanes, MAX_LANES, Task};

use crate::annihilate::annihilate;
use crate::plan::{LEAVES, Plan};
use crate::range::beyond;

/// Samples with what was measured and how much it counts.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Measured<'a> {
    pub states: States<'a>,
    /// tau, N x n.
    pub tau: &'a [f64],
    /// The factor of each row, N x n; one for all rows if empty.
    pub weights: &'a [f64],
    /// How many samples the accumulator had before.
    pub start: u64,
}

impl<'a> Measured<'a> {
    /// The samples `from..to` of a robot with so many coordinates of q and rows.
    pub(crate) fn part(&self, from: usize, to: usize, [positions, n]: [usize; 2]) -> Self {
        let cut = |x: &'a [f64], width: usize| {
            if x.is_empty() {
                x
            } else {
                &x[from * width..to * width]
            }
        };
        Self {
            states: States {
                q: cut(self.states.q, positions),
                qd: cut(self.states.qd, n),
                qdd: cut(self.states.qdd, n),
            },
            tau: cut(self.tau, n),
            weights: cut(self.weights, n),
            start: self.start + from as u64,
        }
    }
}

/// What ends the work before its time.
#[derive(Debug)]
pub(crate) struct Control<'a> {
    /// The caller wants it.
    pub stop: &'a AtomicBool,
    /// The constraints have no value at this sample, the first one found.
    pub fault: Mutex<Option<(u64, NoValue)>>,
    /// Squares in factors overflow.
    pub beyond: AtomicBool,
    faulty: AtomicBool,
}

impl<'a> Control<'a> {
    pub(crate) fn new(stop: &'a AtomicBool) -> Self {
        Self {
            stop,
            fault: Mutex::default(),
            beyond: AtomicBool::new(false),
            faulty: AtomicBool::new(false),
        }
    }

    pub(crate) fn ends(&self) -> bool {
        self.stop.load(Ordering::Relaxed) || self.faulty.load(Ordering::Relaxed)
    }

    /// Looks at a factor's numbers.
    pub(crate) fn watch(&self, factor: &[f64]) {
        self.beyond.fetch_or(beyond(factor), Ordering::Relaxed);
    }

    pub(crate) fn report(&self, sample: u64, error: NoValue) {
        let mut fault = self.fault.lock().unwrap_or_else(PoisonError::into_inner);
        if fault.as_ref().is_none_or(|(earlier, _)| sample < *earlier) {
            *fault = Some((sample, error));
        }
        self.faulty.store(true, Ordering::Relaxed);
    }
}

/// Annihilates whole tiles of samples against the factors `r` of all leaves, one tile after
/// the other.
pub(crate) struct Absorb<'a> {
    pub plan: &'a Plan,
    pub regressor: &'a Regressor,
    pub samples: Measured<'a>,
    /// The leaves' numbers of all segments' factors.
    pub r: &'a mut [f64],
    pub control: &'a Control<'a>,
}

impl Task for Absorb<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes>(self) {
        let (plan, regressor) = (self.plan, self.regressor);
        let mut tile = vec![V::lift(0.0); plan.tile + 1];
        let mut rows = TileRows::<V>::new(regressor);
        let mut expanded = Expanded::default();
        let size = plan.samples();
        // Narrow lanes take the leaves in turn: the same numbers on every processor.
        for leaf in (0..LEAVES).step_by(V::COUNT) {
            let mut r = to_lanes::<V>(self.r, leaf);
            for first in (0..self.samples.tau.len() / plan.n()).step_by(size) {
                if self.control.ends() {
                    return;
                }
                let samples = self.samples.part(first, first + size, plan.widths);
                let states = match regressor.expansion() {
                    None => TreeStates::of(samples.states),
                    Some(expansion) => {
                        let done = expanded.fill(
                            regressor.tree(),
                            expansion,
                            samples.states,
                            0..size,
                            Model::D,
                        );
                        if let Err((sample, error)) = done {
                            return self.control.report(samples.start + sample as u64, error);
                        }
                        expanded.states()
                    }
                };
                if plan.holes {
                    tile.fill(V::lift(0.0));
                }
                for group in 0..plan.groups {
                    let at = group * LEAVES + leaf;
                    let mut to = TileRowsOf {
                        slots: plan.slots(group),
                        tile: &mut tile,
                    };
                    rows.run(regressor, &states, at, &mut to);
                    fill(plan, &samples, at, group, &mut tile);
                }
                annihilate_all(plan, &mut r, &mut tile);
            }
            from_lanes(&r, self.r, leaf);
        }
    }
}

/// A tile's segments against their factors.
#[inline(always)]
fn annihilate_all<V: Lanes>(plan: &Plan, mut r: &mut [V], mut tile: &mut [V]) {
    for segment in &plan.layout.segments {
        let (own_r, other_r) = std::mem::take(&mut r).split_at_mut(segment.factor());
        let (own, others) = std::mem::take(&mut tile).split_at_mut(segment.tile());
        annihilate(segment, own_r, own);
        (r, tile) = (other_r, others);
    }
}

/// Friction, torques and weights of one group of samples, those from `at` on.
#[inline(always)]
fn fill<V: Lanes>(plan: &Plan, samples: &Measured<'_>, at: usize, group: usize, out: &mut [V]) {
    let (n, one) = (plan.n(), V::lift(1.0));
    let mut columns = [V::lift(0.0); MAX_LANES];
    for first in (0..n).step_by(V::COUNT) {
        let joints = first..n.min(first + V::COUNT);
        transpose(samples.tau, n, [at, first], &mut columns);
        for (place, torque) in plan.right[joints.clone()].iter().zip(&columns) {
            out[place.of(group)] = *torque;
        }
        if plan.rubs {
            transpose(samples.states.qd, n, [at, first], &mut columns);
            for (places, &velocity) in plan.friction[joints].iter().zip(&columns) {
                let [viscous, coulomb, offset] = places;
                out[viscous.of(group)] = velocity;
                out[coulomb.of(group)] = one.with_sign_of(velocity).where_nonzero(velocity);
                out[offset.of(group)] = one;
            }
        }
    }
    if samples.weights.is_empty() {
        return;
    }
    for first in (0..n).step_by(V::COUNT) {
        transpose(samples.weights, n, [at, first], &mut columns);
        for (row, &weight) in plan.rows[first..].iter().zip(&columns[..V::COUNT]) {
            for place in row {
                let entry = &mut out[place.of(group)];
                *entry = *entry * weight;
            }
        }
    }
}

/// As many columns as there are lanes, from the one `first` on, of a table of n columns, a
/// row a lane, from row `at` on. Columns that are not there are anything.
#[inline(always)]
fn transpose<V: Lanes>(table: &[f64], n: usize, [at, first]: [usize; 2], to: &mut [V; MAX_LANES]) {
    let from = &table[at * n + first..];
    if from.len() >= (V::COUNT - 1) * n + V::COUNT {
        V::load_transposed(from, n, 1, |_, columns| {
            to[..V::COUNT].copy_from_slice(columns)
        });
        return;
    }
    // A whole block would read beyond the table's end.
    for (j, to) in to.iter_mut().enumerate().take(n - first) {
        let mut column = [0.0; MAX_LANES];
        for (s, x) in column.iter_mut().enumerate().take(V::COUNT) {
            *x = from[s * n + j];
        }
        *to = V::load(&column);
    }
}

/// Writes packed numbers to their places in the tile.
struct TileRowsOf<'a, V> {
    slots: &'a [u32],
    tile: &'a mut [V],
}

impl<V: Lanes> Slots<V> for TileRowsOf<'_, V> {
    #[inline(always)]
    fn put(&mut self, first: usize, numbers: &[V]) {
        let targets = &self.slots[first..first + numbers.len()];
        for (target, x) in targets.iter().zip(numbers) {
            self.tile[*target as usize] = *x;
        }
    }
}

/// Merges the factors `later` into `r`, segment by segment and leaf by leaf.
pub(crate) struct Merge<'a> {
    pub plan: &'a Plan,
    pub r: &'a mut [f64],
    pub later: &'a [f64],
}

impl Task for Merge<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes>(self) {
        let segments = self.plan.layout.segments.iter().zip(&self.plan.triangles);
        let mut tile = Vec::new();
        for leaf in (0..LEAVES).step_by(V::COUNT) {
            let mut all = to_lanes::<V>(self.r, leaf);
            let later = to_lanes::<V>(self.later, leaf);
            let (mut r, mut later) = (&mut all[..], &later[..]);
            for (segment, triangle) in segments.clone() {
                let (own, others) = std::mem::take(&mut r).split_at_mut(segment.factor());
                let (rows, rest) = later.split_at(segment.factor());
                tile.clear();
                tile.resize(triangle.tile(), V::lift(0.0));
                spread(triangle, rows, &mut tile);
                annihilate(triangle, own, &mut tile);
                (r, later) = (others, rest);
            }
            from_lanes(&all, self.r, leaf);
        }
    }
}

/// A packed triangle as the columns of a tile.
#[inline(always)]
pub(crate) fn spread<V: Lanes>(triangle: &crate::layout::Segment, rows: &[V], tile: &mut [V]) {
    for (column, shape) in triangle.columns.iter().enumerate() {
        for row in 0..=column {
            tile[shape.offset + row * shape.stride] = rows[triangle.row(row) + column - row];
        }
    }
}

/// As many leaves as there are lanes, from this one on.
#[inline(always)]
pub(crate) fn to_lanes<V: Lanes>(numbers: &[f64], leaf: usize) -> Vec<V> {
    let mut lanes = Vec::with_capacity(numbers.len() / LEAVES);
    for leaves in numbers.chunks_exact(LEAVES) {
        lanes.push(V::load(&leaves[leaf..]));
    }
    lanes
}

#[inline(always)]
pub(crate) fn from_lanes<V: Lanes>(lanes: &[V], numbers: &mut [f64], leaf: usize) {
    for (x, leaves) in lanes.iter().zip(numbers.chunks_exact_mut(LEAVES)) {
        x.store(&mut leaves[leaf..]);
    }
}
