//! Batches: the recursion over lanes of samples.

use roberval_scalar::{Lanes, Task};

use crate::packed::{Export, Packed};
use crate::tile::Tile;
use crate::{DynamicsWorkspace, EnergyWorkspace, Model, Sink, States, Tree, dynamics, energy};

/// A state that is not finite is in the tile that begins with this sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct BadTile(pub usize);

/// Working memory of one model.
pub(crate) enum Workspace<V> {
    Dynamics(DynamicsWorkspace<V>),
    Energy(EnergyWorkspace<V>),
}

impl<V: Lanes> Workspace<V> {
    #[inline(always)]
    pub(crate) fn new(tree: &Tree<f64>, model: Model) -> Self {
        match model {
            Model::D | Model::D0 => Self::Dynamics(DynamicsWorkspace::new(tree)),
            Model::H => Self::Energy(EnergyWorkspace::new(tree)),
        }
    }

    #[inline(always)]
    pub(crate) fn run(&mut self, tree: &Tree<f64>, tile: &Tile<V>, sink: &mut impl Sink<V>) {
        match self {
            Self::Dynamics(workspace) => dynamics(tree, &tile.motion, workspace, sink),
            Self::Energy(workspace) => energy(tree, &tile.motion, workspace, sink),
        }
    }
}

/// Rows of all samples into `out`, sample after sample.
pub(crate) struct FillRows<'a> {
    pub tree: &'a Tree<f64>,
    pub model: Model,
    pub states: States<'a>,
    pub samples: usize,
    pub export: &'a Export,
    pub out: &'a mut [f64],
    /// Write past the cache.
    pub stream: bool,
}

impl Task for FillRows<'_> {
    type Output = Result<(), BadTile>;

    #[inline(always)]
    fn run<V: Lanes>(self) -> Self::Output {
        let mut tile = Tile::<V>::new(self.tree);
        let mut workspace = Workspace::new(self.tree, self.model);
        let mut stage = vec![V::lift(0.0); self.export.slots() + 1];
        let length = self.export.len();
        let whole = V::COUNT * length;
        let mut rows = Vec::new();
        for first in (0..self.samples).step_by(V::COUNT) {
            if !tile.load(self.model, &self.states, first) {
                return Err(BadTile(first));
            }
            tile.set_motion(self.tree);
            let slots = &mut stage[..self.export.slots()];
            workspace.run(self.tree, &tile, &mut Packed::new(slots));
            let count = whole.min((self.samples - first) * length);
            let out = &mut self.out[first * length..][..count];
            if count == whole && !self.stream {
                self.export.write(&stage, out);
                continue;
            }
            rows.resize(whole, 0.0);
            self.export.write(&stage, &mut rows);
            if self.stream {
                V::stream(&rows[..count], out);
            } else {
                out.copy_from_slice(&rows[..count]);
            }
        }
        Ok(())
    }
}

/// Packed tiles of all samples.
pub(crate) struct FillPacked<'a> {
    pub tree: &'a Tree<f64>,
    pub model: Model,
    pub states: States<'a>,
    pub samples: usize,
    pub slots: usize,
    pub out: &'a mut [f64],
    /// Write past the cache.
    pub stream: bool,
}

impl Task for FillPacked<'_> {
    type Output = Result<(), BadTile>;

    #[inline(always)]
    fn run<V: Lanes>(self) -> Self::Output {
        let mut tile = Tile::<V>::new(self.tree);
        let mut workspace = Workspace::new(self.tree, self.model);
        let mut stage = vec![V::lift(0.0); self.slots];
        let mut numbers = vec![
            0.0;
            if self.stream {
                V::COUNT * self.slots
            } else {
                0
            }
        ];
        let firsts = (0..self.samples).step_by(V::COUNT);
        let outs = self.out.chunks_exact_mut(V::COUNT * self.slots);
        for (first, out) in firsts.zip(outs) {
            if !tile.load(self.model, &self.states, first) {
                return Err(BadTile(first));
            }
            tile.set_motion(self.tree);
            if self.stream {
                workspace.run(self.tree, &tile, &mut Packed::new(&mut stage));
                for (x, numbers) in stage.iter().zip(numbers.chunks_exact_mut(V::COUNT)) {
                    x.store(numbers);
                }
                V::stream(&numbers, out);
            } else {
                workspace.run(self.tree, &tile, &mut PackedNumbers(out));
            }
        }
        Ok(())
    }
}

/// Writes slot after slot into plain numbers.
struct PackedNumbers<'a>(&'a mut [f64]);

impl<V: Lanes> Sink<V> for PackedNumbers<'_> {
    #[inline(always)]
    fn link(&mut self, _: usize, _: usize, columns: [V; 10]) {
        let (next, rest) = std::mem::take(&mut self.0).split_at_mut(10 * V::COUNT);
        for (column, next) in columns.into_iter().zip(next.chunks_exact_mut(V::COUNT)) {
            column.store(next);
        }
        self.0 = rest;
    }

    #[inline(always)]
    fn rotor(&mut self, _: usize, _: usize, value: V) {
        let (next, rest) = std::mem::take(&mut self.0).split_at_mut(V::COUNT);
        value.store(next);
        self.0 = rest;
    }
}
