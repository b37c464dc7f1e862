//! Batches: the recursion over lanes of samples.

use std::any::Any;
use std::fmt;
use std::mem;
use std::sync::Mutex;

use roberval_mechanism::ParameterSpace;
use roberval_scalar::{Lanes, MAX_LANES, Task};

use crate::packed::{Export, Packed};
use crate::tile::Tile;
use crate::{
    DynamicsWorkspace, EnergyWorkspace, Model, Sink, States, Torques, Tree, dynamics, energy,
};

/// A state that is not finite is in the tile that begins with this sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct BadTile(pub usize);

/// Working memory of a batch.
pub(crate) struct Work<V> {
    tile: Tile<V>,
    dynamics: DynamicsWorkspace<V>,
    energy: EnergyWorkspace<V>,
    /// The packed numbers of a tile and a zero.
    stage: Vec<V>,
    /// The rows of a tile.
    rows: Vec<f64>,
}

impl<V: Lanes> Work<V> {
    #[inline(always)]
    pub(crate) fn new(tree: &Tree<f64>) -> Self {
        Self {
            tile: Tile::new(tree),
            dynamics: DynamicsWorkspace::new(tree),
            energy: EnergyWorkspace::new(tree),
            stage: Vec::new(),
            rows: Vec::new(),
        }
    }

    /// Runs the recursion on the tile that begins with this sample.
    #[inline(always)]
    pub(crate) fn run(
        &mut self,
        tree: &Tree<f64>,
        model: Model,
        states: &States<'_>,
        first: usize,
        sink: &mut impl Sink<V>,
    ) -> Result<(), BadTile> {
        if !self.tile.load(tree, model, states, first) {
            return Err(BadTile(first));
        }
        match model {
            Model::D | Model::D0 => dynamics(tree, &self.tile.motion, &mut self.dynamics, sink),
            Model::H => energy(tree, &self.tile.motion, &mut self.energy, sink),
        }
        Ok(())
    }
}

/// Working memory between calls, of whichever lanes were in use.
#[derive(Default)]
pub(crate) struct Pool(Mutex<Vec<Box<dyn Any + Send>>>);

impl Pool {
    /// Working memory made by an earlier call, if none other has it.
    pub(crate) fn take<W: Any>(&self) -> Option<Box<W>> {
        let mut free = self.0.lock().ok()?;
        let at = free.iter().position(|work| work.is::<W>())?;
        free.swap_remove(at).downcast().ok()
    }

    pub(crate) fn give<W: Any + Send>(&self, work: Box<W>) {
        if let Ok(mut free) = self.0.lock() {
            free.push(work);
        }
    }
}

impl Clone for Pool {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl fmt::Debug for Pool {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Pool")
    }
}

/// Rows of all samples into `out`, sample after sample.
pub(crate) struct FillRows<'a> {
    pub pool: &'a Pool,
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
        let (tree, export) = (self.tree, self.export);
        let mut work = match self.pool.take::<Work<V>>() {
            Some(work) => work,
            None => Box::new(Work::new(tree)),
        };
        let (mut stage, mut rows) = (mem::take(&mut work.stage), mem::take(&mut work.rows));
        stage.resize(stage.len().max(export.slots() + 1), V::lift(0.0));
        stage[export.slots()] = V::lift(0.0);
        let length = export.len();
        let whole = V::COUNT * length;
        for first in (0..self.samples).step_by(V::COUNT) {
            let mut sink = Packed::new(&mut stage[..export.slots()]);
            work.run(tree, self.model, &self.states, first, &mut sink)?;
            let count = whole.min((self.samples - first) * length);
            let out = &mut self.out[first * length..][..count];
            if count == whole && !self.stream {
                export.write(&stage, out);
                continue;
            }
            rows.resize(whole, 0.0);
            export.write(&stage, &mut rows);
            if self.stream {
                V::stream(&rows[..count], out);
            } else {
                out.copy_from_slice(&rows[..count]);
            }
        }
        (work.stage, work.rows) = (stage, rows);
        self.pool.give(work);
        Ok(())
    }
}

/// Packed tiles of all samples.
pub(crate) struct FillPacked<'a> {
    pub pool: &'a Pool,
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
        let tree = self.tree;
        let mut work = match self.pool.take::<Work<V>>() {
            Some(work) => work,
            None => Box::new(Work::new(tree)),
        };
        let mut rows = mem::take(&mut work.rows);
        rows.resize(
            if self.stream {
                V::COUNT * self.slots
            } else {
                0
            },
            0.0,
        );
        let firsts = (0..self.samples).step_by(V::COUNT);
        let outs = self.out.chunks_exact_mut(V::COUNT * self.slots);
        for (first, out) in firsts.zip(outs) {
            let to = if self.stream {
                &mut rows[..]
            } else {
                &mut *out
            };
            work.run(
                tree,
                self.model,
                &self.states,
                first,
                &mut PackedNumbers(to),
            )?;
            if self.stream {
                V::stream(&rows, out);
            }
        }
        work.rows = rows;
        self.pool.give(work);
        Ok(())
    }
}

/// Torques of all samples: the rows times X.
pub(crate) struct FillTorques<'a> {
    pub pool: &'a Pool,
    pub tree: &'a Tree<f64>,
    pub space: &'a ParameterSpace,
    pub states: States<'a>,
    pub x: &'a [f64],
    pub out: &'a mut [f64],
}

impl Task for FillTorques<'_> {
    type Output = Result<(), BadTile>;

    #[inline(always)]
    fn run<V: Lanes>(self) -> Self::Output {
        let (tree, n) = (self.tree, self.tree.dof);
        let mut work = match self.pool.take::<Work<V>>() {
            Some(work) => work,
            None => Box::new(Work::new(tree)),
        };
        let mut torques = mem::take(&mut work.stage);
        torques.resize(n.max(torques.len()), V::lift(0.0));
        for (tile, out) in self.out.chunks_mut(V::COUNT * n).enumerate() {
            torques[..n].fill(V::lift(0.0));
            let mut sink = Torques {
                space: self.space,
                x: self.x,
                torques: &mut torques[..n],
            };
            work.run(tree, Model::D, &self.states, tile * V::COUNT, &mut sink)?;
            for (j, torque) in torques[..n].iter().enumerate() {
                let mut lanes = [0.0; MAX_LANES];
                torque.store(&mut lanes);
                for (row, torque) in out.chunks_exact_mut(n).zip(lanes) {
                    row[j] = torque;
                }
            }
        }
        work.stage = torques;
        self.pool.give(work);
        Ok(())
    }
}

/// Writes slot after slot into plain numbers.
struct PackedNumbers<'a>(&'a mut [f64]);

impl<V: Lanes> Sink<V> for PackedNumbers<'_> {
    #[inline(always)]
    fn link(&mut self, _: usize, _: usize, columns: [V; 10]) {
        let (next, rest) = mem::take(&mut self.0).split_at_mut(10 * V::COUNT);
        for (column, next) in columns.into_iter().zip(next.chunks_exact_mut(V::COUNT)) {
            column.store(next);
        }
        self.0 = rest;
    }

    #[inline(always)]
    fn rotor(&mut self, _: usize, _: usize, value: V) {
        let (next, rest) = mem::take(&mut self.0).split_at_mut(V::COUNT);
        value.store(next);
        self.0 = rest;
    }
}
