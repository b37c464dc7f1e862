//! Batches: the recursion over lanes of samples.

use std::any::Any;
use std::fmt;
use std::marker::PhantomData;
use std::mem;
use std::sync::Mutex;

use roberval_mechanism::ParameterSpace;
use roberval_scalar::{Lanes, MAX_LANES, Task};

use crate::inverse_dynamics::{Load, inverse_dynamics, set_inertias};
use crate::packed::{Export, InPlace, Packed, Projection};
use crate::past::{FEW, copy};
use crate::tile::Tile;
use crate::tree_states::{Expanded, TreeStates};
use crate::{
    DynamicsWorkspace, EnergyWorkspace, Expansion, Model, NoValue, Sink, States, Tree, Writing,
    dynamics, energy,
};

/// Why a batch has no rows.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Fault {
    /// A state that is not finite is in the tile that begins with this sample.
    Tile(usize),
    /// The constraints have no value at a sample.
    NoValue(usize, NoValue),
}

/// Samples after which loops are closed from the first configuration anew: rows then depend
/// on where their sample stands, not on how work is shared out.
pub(crate) const STRETCH: usize = 64;

/// What a batch is made of.
#[derive(Clone, Copy)]
pub(crate) struct Robot<'a> {
    pub tree: &'a Tree<f64>,
    pub expansion: Option<&'a Expansion<f64>>,
    pub projection: Option<&'a Projection>,
}

impl Robot<'_> {
    /// The states of all joints: of all samples, or of the k-th stretch of them.
    fn states<'s>(
        &self,
        states: States<'s>,
        k: usize,
        model: Model,
        expanded: &'s mut Expanded,
    ) -> Result<TreeStates<'s>, Fault> {
        let Some(expansion) = self.expansion else {
            return Ok(TreeStates::of(states));
        };
        let samples = k * STRETCH..(k + 1) * STRETCH;
        expanded
            .fill(self.tree, expansion, states, samples, model)
            .map_err(|(sample, error)| Fault::NoValue(sample, error))?;
        Ok(expanded.states())
    }
}

/// Working memory of a batch.
pub(crate) struct Work<V> {
    tile: Tile<V>,
    dynamics: DynamicsWorkspace<V>,
    energy: EnergyWorkspace<V>,
    /// The packed numbers of a tile and a zero: of all joints, and of the independent ones.
    stage: Vec<V>,
    projected: Vec<V>,
    /// The bodies' loads, for torques.
    loads: Vec<Load<V>>,
    /// The rows of a tile that is not full, and of those that are short.
    rows: Vec<f64>,
    /// States of a stretch of samples.
    expanded: Expanded,
}

impl<V: Lanes> Work<V> {
    #[inline(always)]
    pub(crate) fn new(robot: Robot<'_>) -> Self {
        let tree = robot.tree;
        Self {
            tile: Tile::new(tree, robot.projection.map_or(0, Projection::g_width)),
            dynamics: DynamicsWorkspace::new(tree),
            energy: EnergyWorkspace::new(tree),
            stage: Vec::new(),
            projected: Vec::new(),
            loads: Vec::new(),
            rows: Vec::new(),
            expanded: Expanded::default(),
        }
    }

    /// The values of G in the tile that ran last.
    #[inline(always)]
    pub(crate) fn g(&self) -> &[V] {
        &self.tile.g
    }

    /// Runs the recursion on the tile that begins with this sample.
    #[inline(always)]
    pub(crate) fn run(
        &mut self,
        tree: &Tree<f64>,
        model: Model,
        states: &TreeStates<'_>,
        first: usize,
        sink: &mut impl Sink<V>,
    ) -> Result<(), Fault> {
        self.load(tree, model, states, first)?;
        match model {
            Model::D | Model::D0 => {
                if let Some(base) = &self.tile.base {
                    self.dynamics.move_base(tree, base);
                }
                dynamics(tree, self.tile.motion(), &mut self.dynamics, sink);
            }
            Model::H => {
                if let Some(base) = &self.tile.base {
                    self.energy.move_base(tree, base);
                }
                energy(tree, self.tile.motion(), &mut self.energy, sink);
            }
        }
        Ok(())
    }

    /// Loads the tile that begins with this sample.
    #[inline(always)]
    fn load(
        &mut self,
        tree: &Tree<f64>,
        model: Model,
        states: &TreeStates<'_>,
        first: usize,
    ) -> Result<(), Fault> {
        match self.tile.load(tree, model, states, first) {
            true => Ok(()),
            false => Err(Fault::Tile(first)),
        }
    }

    /// Torques of all joints in the tile that begins with this sample.
    #[inline(always)]
    fn torques(
        &mut self,
        tree: &Tree<f64>,
        states: &TreeStates<'_>,
        first: usize,
        torques: &mut [V],
    ) -> Result<(), Fault> {
        self.load(tree, Model::D, states, first)?;
        if let Some(base) = &self.tile.base {
            self.dynamics.move_base(tree, base);
        }
        let (workspace, loads) = (&mut self.dynamics, &mut self.loads);
        inverse_dynamics(tree, self.tile.motion(), workspace, loads, torques);
        Ok(())
    }
}

/// Working memory between calls, of whichever lanes were in use.
#[derive(Default)]
pub(crate) struct Pool(Mutex<Vec<Box<dyn Any + Send>>>);

impl Pool {
    /// Working memory made by an earlier call, if none other has it.
    pub(crate) fn take<W: Any>(&self) -> Option<Box<W>> {
        // Not waiting: a child process may have been forked while another thread was here.
        let mut free = self.0.try_lock().ok()?;
        let at = free.iter().position(|work| work.is::<W>())?;
        free.swap_remove(at).downcast().ok()
    }

    pub(crate) fn give<W: Any + Send>(&self, work: Box<W>) {
        if let Ok(mut free) = self.0.try_lock() {
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

impl Form<'_> {
    /// Slots of a tile, and numbers that each sample takes.
    fn sizes(self) -> (usize, usize) {
        match self {
            Self::Rows(export) => (export.slots(), export.len()),
            Self::Packed(slots) => (slots, slots),
        }
    }
}

/// All samples' numbers into `out`.
pub(crate) struct Fill<'a> {
    pub pool: &'a Pool,
    pub robot: Robot<'a>,
    pub model: Model,
    pub states: States<'a>,
    pub form: Form<'a>,
    pub out: &'a mut [f64],
    pub writing: Writing,
}

impl Task for Fill<'_> {
    type Output = Result<(), Fault>;

    #[inline(always)]
    fn run<V: Lanes>(self) -> Self::Output {
        let _fence = self.writing.past_cache.then_some(Fence::<V>(PhantomData));
        self.tiles::<V>()
    }
}

/// Ends what was written past the cache, even where a panic ends the writing.
struct Fence<V: Lanes>(PhantomData<V>);

impl<V: Lanes> Drop for Fence<V> {
    #[inline(always)]
    fn drop(&mut self) {
        V::fence();
    }
}

impl Fill<'_> {
    /// Tile after tile.
    #[inline(always)]
    fn tiles<V: Lanes>(self) -> Result<(), Fault> {
        let Self { robot, model, .. } = self;
        let mut work = match self.pool.take::<Work<V>>() {
            Some(work) => work,
            None => Box::new(Work::new(robot)),
        };
        let (_, length) = self.form.sizes();
        let mut expanded = mem::take(&mut work.expanded);
        let whole = stretch(robot, self.out.len(), length);
        for (k, out) in self.out.chunks_mut(whole).enumerate() {
            let states = robot.states(self.states, k, model, &mut expanded)?;
            write(
                robot,
                model,
                &states,
                &mut work,
                (self.form, self.writing),
                out,
            )?;
        }
        work.expanded = expanded;
        self.pool.give(work);
        Ok(())
    }
}

/// Numbers written at a time: of all samples, or of as many as are expanded at a time.
fn stretch(robot: Robot<'_>, all: usize, length: usize) -> usize {
    match robot.expansion {
        None => all.max(1),
        Some(_) => STRETCH * length.max(1),
    }
}

/// Tile after tile into `out`.
#[inline(always)]
fn write<V: Lanes>(
    robot: Robot<'_>,
    model: Model,
    states: &TreeStates<'_>,
    work: &mut Work<V>,
    (form, writing): (Form<'_>, Writing),
    out: &mut [f64],
) -> Result<(), Fault> {
    if let (1, Form::Rows(export)) = (V::COUNT, form)
        && let Some(places) = export.places()
    {
        let export = (export, places, writing.keep_zeros);
        return in_place(robot.tree, model, states, work, export, out);
    }
    let projection = robot.projection.filter(|_| model != Model::H);
    let (slots, length) = form.sizes();
    let past = writing.past_cache && V::STREAMS;
    let whole = V::COUNT * length;
    // Short rows and the last tile's, if it is not full, go through a buffer.
    let few = past && whole < FEW;
    let mut rows = mem::take(&mut work.rows);
    let buffered = few || !out.len().is_multiple_of(whole);
    if matches!(form, Form::Rows(_)) && buffered {
        rows.clear();
        rows.resize(whole, 0.0);
    }
    let mut stage = Stage::take(work, projection, slots);
    for (tile, out) in out.chunks_mut(whole).enumerate() {
        // Packed numbers of all joints are where they belong at once.
        let at_once = matches!(form, Form::Packed(_)) && projection.is_none() && !past;
        let numbers = if at_once { &mut *out } else { stage.numbers() };
        let mut sink = Packed::new(numbers);
        work.run(robot.tree, model, states, tile * V::COUNT, &mut sink)?;
        let stage = stage.rows(work.g());
        match form {
            Form::Packed(_) if at_once => (),
            Form::Packed(_) => copy::<V>(&V::numbers(stage)[..out.len()], out, past),
            Form::Rows(export) if V::COUNT == 1 => {
                export.write_one(V::numbers(stage), out, writing.keep_zeros);
            }
            Form::Rows(export) if few || out.len() < whole => {
                export.write(stage, &mut rows, true);
                copy::<V>(&rows[..out.len()], out, past);
            }
            Form::Rows(export) if past => export.write_past(stage, out, writing.keep_zeros),
            Form::Rows(export) => export.write(stage, out, writing.keep_zeros),
        }
    }
    work.rows = rows;
    stage.give(work);
    Ok(())
}

/// Row after row of one lane, each number where it belongs at once.
#[inline(always)]
fn in_place<V: Lanes>(
    tree: &Tree<f64>,
    model: Model,
    states: &TreeStates<'_>,
    work: &mut Work<V>,
    (export, places, keep_zeros): (&Export, &[u32], bool),
    out: &mut [f64],
) -> Result<(), Fault> {
    for (sample, rows) in out.chunks_exact_mut(export.len()).enumerate() {
        export.clear(rows, keep_zeros);
        let mut sink = InPlace::new(places, rows);
        work.run(tree, model, states, sample, &mut sink)?;
    }
    Ok(())
}

/// The packed numbers of a tile, and a zero after them.
struct Stage<'a, V> {
    projection: Option<&'a Projection>,
    /// Of all joints.
    tree: Vec<V>,
    /// Of the independent ones, where others follow them.
    rows: Vec<V>,
    /// Numbers of each, without the zero.
    of_tree: usize,
    of_rows: usize,
}

impl<'a, V: Lanes> Stage<'a, V> {
    /// Room for so many slots, in working memory.
    #[inline(always)]
    fn take(work: &mut Work<V>, projection: Option<&'a Projection>, slots: usize) -> Self {
        let of_tree = projection.map_or(slots, Projection::tree_slots);
        let (mut tree, mut rows) = (mem::take(&mut work.stage), mem::take(&mut work.projected));
        with_zero(&mut tree, of_tree);
        if projection.is_some() {
            with_zero(&mut rows, slots);
        }
        Self {
            projection,
            tree,
            rows,
            of_tree,
            of_rows: slots,
        }
    }

    /// Where the recursion's numbers go.
    #[inline(always)]
    fn numbers(&mut self) -> &mut [f64] {
        V::numbers(&mut self.tree[..self.of_tree])
    }

    /// The slots of the rows and a zero, once the recursion has run; with these values of G.
    #[inline(always)]
    fn rows(&mut self, g: &[V]) -> &mut [V] {
        let Some(projection) = self.projection else {
            return &mut self.tree;
        };
        projection.apply(g, &self.tree, &mut self.rows[..self.of_rows]);
        &mut self.rows
    }

    /// Gives the room back.
    fn give(self, work: &mut Work<V>) {
        (work.stage, work.projected) = (self.tree, self.rows);
    }
}

/// Makes room for so many slots and a zero after them.
fn with_zero<V: Lanes>(slots: &mut Vec<V>, count: usize) {
    slots.resize(slots.len().max(count + 1), V::lift(0.0));
    slots[count] = V::lift(0.0);
}

/// Torques of all samples.
pub(crate) struct FillTorques<'a> {
    pub pool: &'a Pool,
    pub robot: Robot<'a>,
    pub space: &'a ParameterSpace,
    /// Number of torques a sample.
    pub independent: usize,
    pub states: States<'a>,
    pub x: &'a [f64],
    pub out: &'a mut [f64],
}

impl Task for FillTorques<'_> {
    type Output = Result<(), Fault>;

    #[inline(always)]
    fn run<V: Lanes>(self) -> Self::Output {
        let (robot, m) = (self.robot, self.independent);
        let mut work = match self.pool.take::<Work<V>>() {
            Some(work) => work,
            None => Box::new(Work::new(robot)),
        };
        set_inertias(&mut work.loads, &work.dynamics, (self.space, self.x));
        let mut expanded = mem::take(&mut work.expanded);
        let whole = stretch(robot, self.out.len(), m);
        for (k, out) in self.out.chunks_mut(whole).enumerate() {
            let states = robot.states(self.states, k, Model::D, &mut expanded)?;
            torques(robot, m, &states, &mut work, out)?;
        }
        work.expanded = expanded;
        self.pool.give(work);
        Ok(())
    }
}

/// The torques of tile after tile.
#[inline(always)]
fn torques<V: Lanes>(
    robot: Robot<'_>,
    m: usize,
    states: &TreeStates<'_>,
    work: &mut Work<V>,
    out: &mut [f64],
) -> Result<(), Fault> {
    let n = robot.tree.dof;
    let zero = V::lift(0.0);
    let (mut of_joints, mut of_rows) = (mem::take(&mut work.stage), mem::take(&mut work.projected));
    of_joints.resize(n.max(of_joints.len()), zero);
    of_rows.resize(m.max(of_rows.len()), zero);
    for (tile, out) in out.chunks_mut(V::COUNT * m).enumerate() {
        work.torques(robot.tree, states, tile * V::COUNT, &mut of_joints[..n])?;
        let torques = match robot.projection {
            None => &of_joints[..n],
            Some(projection) => {
                projection.apply_to_torques(work.g(), &of_joints[..n], &mut of_rows[..m]);
                &of_rows[..m]
            }
        };
        for (j, torque) in torques.iter().enumerate() {
            let mut lanes = [0.0; MAX_LANES];
            torque.store(&mut lanes);
            for (row, torque) in out.chunks_exact_mut(m).zip(lanes) {
                row[j] = torque;
            }
        }
    }
    (work.stage, work.projected) = (of_joints, of_rows);
    Ok(())
}
