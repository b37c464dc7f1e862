//! From samples to annihilated tiles.

use std::sync::atomic::{AtomicBool, Ordering};

use roberval_regressor::{DynamicsWorkspace, Model, Sink, States, Tile, Tree, dynamics};
use roberval_scalar::{Lanes, Task};

use crate::annihilate::annihilate;
use crate::plan::Plan;

/// Samples with what was measured and how much it counts.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Measured<'a> {
    pub states: States<'a>,
    /// tau, N x n.
    pub tau: &'a [f64],
    /// The factor of each row, N x n; one for all rows if empty.
    pub weights: &'a [f64],
}

impl<'a> Measured<'a> {
    /// The samples `from..to`.
    pub(crate) fn part(&self, from: usize, to: usize, n: usize) -> Self {
        let cut = |x: &'a [f64]| {
            if x.is_empty() {
                x
            } else {
                &x[from * n..to * n]
            }
        };
        Self {
            states: States {
                q: cut(self.states.q),
                qd: cut(self.states.qd),
                qdd: cut(self.states.qdd),
            },
            tau: cut(self.tau),
            weights: cut(self.weights),
        }
    }
}

/// Annihilates whole tiles of samples against the lane factors `r`, one after the other.
pub(crate) struct Absorb<'a> {
    pub plan: &'a Plan,
    pub tree: &'a Tree<f64>,
    pub samples: Measured<'a>,
    /// Lane numbers of all segments' factors.
    pub r: &'a mut [f64],
    /// Give up when this is set.
    pub stop: &'a AtomicBool,
}

impl Task for Absorb<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes>(self) {
        let (plan, n) = (self.plan, self.tree.dof);
        let mut r = to_lanes::<V>(self.r);
        let mut tile = vec![V::lift(0.0); plan.tile + 1 + plan.groups];
        let mut work = (Tile::<V>::new(self.tree), DynamicsWorkspace::new(self.tree));
        let size = plan.groups * V::COUNT;
        for first in (0..self.samples.tau.len() / n).step_by(size) {
            if self.stop.load(Ordering::Relaxed) {
                return;
            }
            for group in 0..plan.groups {
                let samples =
                    self.samples
                        .part(first + group * V::COUNT, first + (group + 1) * V::COUNT, n);
                fill(plan, self.tree, &samples, group, &mut work, &mut tile);
            }
            let (mut r, mut tile) = (&mut r[..], &mut tile[..]);
            for segment in &plan.layout.segments {
                let (own_r, other_r) = std::mem::take(&mut r).split_at_mut(segment.factor());
                let (own, others) = std::mem::take(&mut tile).split_at_mut(segment.tile());
                annihilate(segment, own_r, own);
                (r, tile) = (other_r, others);
            }
        }
        from_lanes(&r, self.r);
    }
}

/// One group of samples into the tile.
#[inline(always)]
fn fill<V: Lanes>(
    plan: &Plan,
    tree: &Tree<f64>,
    samples: &Measured<'_>,
    group: usize,
    work: &mut (Tile<V>, DynamicsWorkspace<V>),
    out: &mut [V],
) {
    let (tile, workspace) = work;
    tile.load(tree, Model::D, &samples.states, 0);
    let mut sink = TileRows {
        plan,
        pair: 0,
        rotor: 0,
        group,
        tile: &mut *out,
    };
    dynamics(tree, &tile.motion, workspace, &mut sink);
    let (n, one) = (tree.dof, V::lift(1.0));
    for j in 0..n {
        let column = Gather { n, j };
        let velocity = column.take::<V>(samples.states.qd);
        let sign = one.with_sign_of(velocity).where_nonzero(velocity);
        let [viscous, coulomb, offset] = plan.friction[j];
        out[viscous as usize + group] = velocity;
        out[coulomb as usize + group] = sign;
        out[offset as usize + group] = one;
        out[plan.right[j] as usize + group] = column.take::<V>(samples.tau);
    }
    if samples.weights.is_empty() {
        return;
    }
    for j in 0..n {
        let weight = Gather { n, j }.take::<V>(samples.weights);
        for &target in &plan.rows[j] {
            let entry = &mut out[target as usize + group];
            *entry = *entry * weight;
        }
    }
}

/// Column j of a table of n columns, a row a lane.
struct Gather {
    n: usize,
    j: usize,
}

impl Gather {
    #[inline(always)]
    fn take<V: Lanes>(&self, from: &[f64]) -> V {
        let mut numbers = [0.0; roberval_scalar::MAX_LANES];
        for (x, row) in numbers
            .iter_mut()
            .zip(from.chunks_exact(self.n))
            .take(V::COUNT)
        {
            *x = row[self.j];
        }
        V::load(&numbers)
    }
}

/// Writes the recursion's columns to their places in the tile.
struct TileRows<'a, V> {
    plan: &'a Plan,
    pair: usize,
    rotor: usize,
    group: usize,
    tile: &'a mut [V],
}

impl<V: Lanes> Sink<V> for TileRows<'_, V> {
    #[inline(always)]
    fn link(&mut self, _: usize, _: usize, columns: [V; 10]) {
        let targets = &self.plan.links[self.pair];
        for (target, column) in targets.iter().zip(columns) {
            self.tile[*target as usize + self.group] = column;
        }
        self.pair += 1;
    }

    #[inline(always)]
    fn rotor(&mut self, _: usize, _: usize, value: V) {
        let target = self.plan.rotors[self.rotor];
        self.tile[target as usize + self.group] = value;
        self.rotor += 1;
    }
}

/// Merges the lane factors `later` into `r`, segment by segment and lane by lane.
pub(crate) struct Merge<'a> {
    pub plan: &'a Plan,
    pub r: &'a mut [f64],
    pub later: &'a [f64],
}

impl Task for Merge<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes>(self) {
        let mut all = to_lanes::<V>(self.r);
        let later = to_lanes::<V>(self.later);
        let (mut r, mut later) = (&mut all[..], &later[..]);
        let mut tile = Vec::new();
        for (segment, triangle) in self.plan.layout.segments.iter().zip(&self.plan.triangles) {
            let (own, others) = std::mem::take(&mut r).split_at_mut(segment.factor());
            let (rows, rest) = later.split_at(segment.factor());
            tile.clear();
            tile.resize(triangle.tile(), V::lift(0.0));
            spread(triangle, rows, &mut tile);
            annihilate(triangle, own, &mut tile);
            (r, later) = (others, rest);
        }
        from_lanes(&all, self.r);
    }
}

/// A packed triangle as the columns of a tile.
#[inline(always)]
pub(crate) fn spread<V: Lanes>(triangle: &crate::layout::Segment, rows: &[V], tile: &mut [V]) {
    for (column, shape) in triangle.columns.iter().enumerate() {
        for row in 0..=column {
            tile[shape.offset + row] = rows[triangle.row(row) + column - row];
        }
    }
}

#[inline(always)]
pub(crate) fn to_lanes<V: Lanes>(numbers: &[f64]) -> Vec<V> {
    numbers.chunks_exact(V::COUNT).map(V::load).collect()
}

#[inline(always)]
pub(crate) fn from_lanes<V: Lanes>(lanes: &[V], numbers: &mut [f64]) {
    for (x, to) in lanes.iter().zip(numbers.chunks_exact_mut(V::COUNT)) {
        x.store(to);
    }
}
