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

/// What a batch writes.
#[derive(Clone, Copy)]
pub(crate) enum Form<'a> {
    /// Rows, sample after sample.
    Rows(&'a Export),
    /// Packed tiles of so many slots.
    Packed(usize),
}

/// All samples' numbers into `out`.
pub(crate) struct Fill<'a> {
    pub pool: &'a Pool,
    pub tree: &'a Tree<f64>,
    pub model: Model,
    pub states: States<'a>,
    pub form: Form<'a>,
    pub out: &'a mut [f64],
    /// Write past the cache.
    pub stream: bool,
}

impl Task for Fill<'_> {
    type Output = Result<(), BadTile>;

    #[inline(always)]
    fn run<V: Lanes>(self) -> Self::Output {
        let tree = self.tree;
        let mut work = match self.pool.take::<Work<V>>() {
            Some(work) => work,
            None => Box::new(Work::new(tree)),
        };
        let (slots, length) = match self.form {
            Form::Rows(export) => (export.slots(), export.len()),
            Form::Packed(slots) => (slots, slots),
        };
        let (mut stage, mut rows) = (mem::take(&mut work.stage), mem::take(&mut work.rows));
        stage.resize(stage.len().max(slots + 1), V::lift(0.0));
        stage[slots] = V::lift(0.0);
        let whole = V::COUNT * length;
        rows.resize(rows.len().max(whole), 0.0);
        for (tile, out) in self.out.chunks_mut(whole).enumerate() {
            let direct = out.len() == whole && !self.stream;
            let to = if direct {
                &mut *out
            } else {
                &mut rows[..whole]
            };
            let packed = match self.form {
                Form::Rows(_) => V::numbers(&mut stage[..slots]),
                Form::Packed(_) => &mut *to,
            };
            let mut sink = Packed::new(packed);
            work.run(tree, self.model, &self.states, tile * V::COUNT, &mut sink)?;
            if let Form::Rows(export) = self.form {
                export.write(&stage, to);
            }
            if self.stream {
                V::stream(&rows[..out.len()], out);
            } else if !direct {
                out.copy_from_slice(&rows[..out.len()]);
            }
        }
        (work.stage, work.rows) = (stage, rows);
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
