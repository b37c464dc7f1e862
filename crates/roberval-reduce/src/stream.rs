//! The accumulator: samples in, R factor out, in memory that does not grow with them.

use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use roberval_regressor::{Expanded, NoValue, Regressor, RegressorError, States};
use roberval_scalar::dispatch;

use crate::factor::Factor;
use crate::plan::{Friction, Plan};
use crate::tiles::{Absorb, Control, Measured, Merge};

/// Samples: joint states, torques and what each row counts. All row-major, N x n.
#[derive(Debug, Clone, Copy)]
pub struct Samples<'a> {
    /// q, qd, qdd.
    pub states: States<'a>,
    /// Joint torques, N m (N for prismatic joints).
    pub tau: &'a [f64],
    /// Each row's weight: a row and its torque are multiplied by the weight's square root.
    pub weights: Weights<'a>,
}

/// How much rows count.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Weights<'a> {
    /// All the same.
    Equal,
    /// One weight a joint: n numbers.
    Joints(&'a [f64]),
    /// One weight a row: N x n numbers.
    Rows(&'a [f64]),
}

/// What is wrong with samples.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ReduceError {
    /// An array has the wrong number of entries.
    #[error(
        "{array} has {found} entries, expected {expected} ({samples} samples x {joints} coordinates)"
    )]
    Length {
        /// Which array.
        array: &'static str,
        /// Entries expected.
        expected: usize,
        /// Entries found.
        found: usize,
        /// Samples N, from the length of q.
        samples: usize,
        /// Coordinates of a sample.
        joints: usize,
    },
    /// An entry is NaN or infinite.
    #[error("{array}[{sample}, {joint}] is {value}: samples must be finite numbers")]
    NotFinite {
        /// Which array.
        array: &'static str,
        /// Row, from 0, counted from the first sample of this accumulator.
        sample: u64,
        /// Column, from 0.
        joint: usize,
        /// What was found.
        value: f64,
    },
    /// A weight is negative.
    #[error("weights[{place}] is {value}: a weight cannot be negative")]
    Weight {
        /// Joint, or sample and joint, from 0.
        place: String,
        /// What was found.
        value: f64,
    },
    /// The attitude of a floating base is none.
    #[error(
        "q[{sample}, 3:7] has length {length}: the attitude of a floating base must be a quaternion (x, y, z, w) of length 1"
    )]
    Quaternion {
        /// Row, from 0, counted from the first sample of this accumulator.
        sample: u64,
        /// Its length.
        length: f64,
    },
    /// The constraints have no value at a state.
    #[error("sample {sample}: {error}")]
    NoValue {
        /// Row, from 0, counted from the first sample of this accumulator.
        sample: u64,
        /// What has no value.
        error: NoValue,
    },
    /// The caller stopped it.
    #[error("stopped: no sample was taken in")]
    Stopped,
    /// A column was asked for that is not there, or twice.
    #[error("column {column} of {count} is asked for twice or not there")]
    Column {
        /// The column.
        column: usize,
        /// How many the robot has.
        count: usize,
    },
}

/// Least squares in one pass: blocks of samples are annihilated against triangular factors
/// (TSQR), so that memory is O(P^2) and the result backward stable.
///
/// The result depends on the samples and their order alone, bit by bit, not on how they
/// are cut into calls, nor on the number of threads, nor on how many lanes the processor
/// has (as long as it fuses products and sums).
#[derive(Debug, Clone)]
pub struct Reduction {
    pub(crate) regressor: Regressor,
    pub(crate) plan: Plan,
    pub(crate) choice: Vec<usize>,
    pub(crate) friction: Friction,
    pub(crate) threads: usize,
    /// The leaves' factors of 2^k blocks at place k (empty where there are none).
    pub(crate) levels: Vec<Vec<f64>>,
    /// The leaves' factors of the unfinished block, and how many tiles it has.
    pub(crate) block: Vec<f64>,
    pub(crate) tiles: usize,
    /// Samples of the unfinished tile: q, qd, qdd, tau and the roots of weights.
    pub(crate) rest: [Vec<f64>; 5],
    pub(crate) samples: u64,
    /// What was merged from other accumulators.
    pub(crate) merged: Option<Factor>,
}

/// Blocks that wait for being merged, for each thread.
const WAITING: usize = 2;

impl Reduction {
    /// An accumulator for some columns of the dynamic model, in the order given, and for
    /// friction.
    ///
    /// # Errors
    /// [`ReduceError`] for columns that are not there.
    pub fn new(
        regressor: Regressor,
        columns: &[usize],
        friction: Friction,
    ) -> Result<Self, ReduceError> {
        let count = regressor.parameters().len();
        let mut seen = vec![false; count];
        for &column in columns {
            if column >= count || std::mem::replace(&mut seen[column], true) {
                return Err(ReduceError::Column { column, count });
            }
        }
        let plan = Plan::new(&regressor, columns, friction);
        Ok(Self {
            block: vec![0.0; plan.factor()],
            regressor,
            plan,
            choice: columns.to_vec(),
            friction,
            threads: std::thread::available_parallelism().map_or(1, NonZeroUsize::get),
            levels: Vec::new(),
            tiles: 0,
            rest: Default::default(),
            samples: 0,
            merged: None,
        })
    }

    /// The same on so many threads (all cores by default).
    #[must_use]
    pub fn with_threads(mut self, threads: usize) -> Self {
        self.threads = threads.max(1);
        self
    }

    /// Samples that are worth one update: a block for each thread, or for one thread
    /// [`Reduction::brief`] ones.
    #[must_use]
    pub fn wave(&self) -> usize {
        match self.threads {
            1 => self.brief(),
            threads => threads * self.plan.block() * self.plan.samples(),
        }
    }

    /// Samples that one thread takes in within some ms, all arrays together staying in the
    /// cache: no reason to look at Ctrl-C meanwhile.
    #[must_use]
    pub fn brief(&self) -> usize {
        /// About 1 MB with all arrays of seven joints.
        const CACHED: usize = 1 << 12;
        /// Entries of W, of which the processor needs 0.2 to 0.6 ns each.
        const ENTRIES: usize = 1 << 24;
        let samples = ENTRIES / (self.dof() * (self.plan.columns + 1));
        samples
            .clamp(1, CACHED)
            .next_multiple_of(self.plan.samples())
    }

    /// Number of rows of a sample: the independent joints, and six for a base that floats.
    #[must_use]
    pub fn dof(&self) -> usize {
        self.plan.n()
    }

    /// The columns of the robot, then those of friction.
    #[must_use]
    pub fn columns(&self) -> (&[usize], Friction) {
        (&self.choice, self.friction)
    }

    /// Samples taken in.
    #[must_use]
    pub fn samples(&self) -> u64 {
        self.samples + self.merged.as_ref().map_or(0, Factor::samples)
    }

    /// Takes in samples, all or, after an error, none.
    ///
    /// # Errors
    /// [`ReduceError`] names what is not a finite number or has the wrong length.
    pub fn update(&mut self, samples: &Samples<'_>) -> Result<(), ReduceError> {
        if self.regressor.expansion().is_some() {
            // A state at which loops cannot be closed shows only on the way.
            return self.update_until(samples, &AtomicBool::new(false));
        }
        self.take_in(samples, &AtomicBool::new(false))
    }

    /// As [`Reduction::update`], but gives up soon after `stop` is set: nothing is taken in
    /// then.
    ///
    /// # Errors
    /// [`ReduceError::Stopped`], and those of [`Reduction::update`].
    pub fn update_until(
        &mut self,
        samples: &Samples<'_>,
        stop: &AtomicBool,
    ) -> Result<(), ReduceError> {
        let before = self.clone();
        let mut done = self.take_in(samples, stop);
        if done.is_ok() && stop.load(Ordering::Relaxed) {
            done = Err(ReduceError::Stopped);
        }
        if done.is_err() {
            *self = before;
        }
        done
    }

    fn take_in(&mut self, samples: &Samples<'_>, stop: &AtomicBool) -> Result<(), ReduceError> {
        let (n, widths) = (self.dof(), self.plan.widths);
        let count = self.check(samples)?;
        let weights = roots(&samples.weights, count);
        let weighted = !weights.is_empty() || !self.rest[4].is_empty();
        let control = Control::new(stop);
        let all = Measured {
            states: samples.states,
            tau: samples.tau,
            weights: &weights,
            start: self.samples(),
        };
        let per_tile = self.plan.samples();
        let mut done = 0;
        let held = self.rest[3].len() / n;
        if held > 0 || count < per_tile {
            done = count.min(per_tile - held);
            self.hold(&all.part(0, done, widths), weighted);
        }
        if self.rest[3].len() == per_tile * n {
            let rest = std::mem::take(&mut self.rest);
            self.absorb(&measured(&rest, all.start - held as u64), &control);
        }
        let whole = (count - done) / per_tile * per_tile;
        self.absorb(&all.part(done, done + whole, widths), &control);
        self.hold(&all.part(done + whole, count, widths), !weights.is_empty());
        self.samples += count as u64;
        self.try_rest(&control);
        let fault = control.fault.into_inner();
        match fault.unwrap_or_else(PoisonError::into_inner) {
            Some((sample, error)) => Err(ReduceError::NoValue { sample, error }),
            None => Ok(()),
        }
    }

    /// Finds out whether the constraints have a value at the samples held.
    fn try_rest(&self, control: &Control<'_>) {
        let held = self.rest[3].len() / self.dof();
        let Some(expansion) = self.regressor.expansion().filter(|_| held > 0) else {
            return;
        };
        let start = self.samples() - held as u64;
        let states = measured(&self.rest, start).states;
        let tree = self.regressor.tree();
        let tried = Expanded::default().fill(tree, expansion, states, 0..held, false);
        if let Err((sample, error)) = tried {
            control.report(start + sample as u64, error);
        }
    }

    /// Keeps samples for the next tile.
    fn hold(&mut self, samples: &Measured<'_>, weighted: bool) {
        let Measured {
            states,
            tau,
            weights,
            ..
        } = samples;
        if weighted {
            // Samples held without weights count once.
            let held = self.rest[3].len();
            self.rest[4].resize(held, 1.0);
            self.rest[4].extend(weights.iter());
            self.rest[4].resize(held + tau.len(), 1.0);
        }
        let arrays = [states.q, states.qd, states.qdd, tau];
        for (rest, array) in self.rest.iter_mut().zip(arrays) {
            rest.extend(array);
        }
    }

    /// Whole tiles: the unfinished block first, then blocks side by side.
    fn absorb(&mut self, samples: &Measured<'_>, control: &Control<'_>) {
        let (n, per_tile, block) = (self.dof(), self.plan.samples(), self.plan.block());
        let tiles = samples.tau.len() / n / per_tile;
        let widths = self.plan.widths;
        let part = |from: usize, to: usize| samples.part(from * per_tile, to * per_tile, widths);
        let mut done = 0;
        if self.tiles > 0 || tiles < block {
            done = tiles.min(block - self.tiles);
            self.run(&part(0, done), control);
        }
        while done + block <= tiles {
            let wave = ((tiles - done) / block).min(WAITING * self.threads);
            let piece = |k: usize| part(done + k * block, done + (k + 1) * block);
            for r in self.blocks(wave, piece, control) {
                self.push(r);
            }
            done += wave * block;
        }
        self.run(&part(done, tiles), control);
    }

    /// Tiles of the unfinished block.
    fn run(&mut self, samples: &Measured<'_>, control: &Control<'_>) {
        let (n, per_tile) = (self.dof(), self.plan.samples());
        let tiles = samples.tau.len() / n / per_tile;
        if tiles == 0 {
            return;
        }
        let mut block = std::mem::take(&mut self.block);
        self.reduce(samples, &mut block, control);
        self.block = block;
        self.tiles += tiles;
        if self.tiles == self.plan.block() {
            let r = std::mem::replace(&mut self.block, vec![0.0; self.plan.factor()]);
            self.tiles = 0;
            self.push(r);
        }
    }

    fn reduce(&self, samples: &Measured<'_>, r: &mut [f64], control: &Control<'_>) {
        let task = Absorb {
            plan: &self.plan,
            regressor: &self.regressor,
            samples: *samples,
            r,
            control,
        };
        dispatch(self.plan.width, task);
    }

    /// The factors of whole blocks, in their order.
    fn blocks<'a>(
        &self,
        count: usize,
        samples: impl Fn(usize) -> Measured<'a> + Sync,
        control: &Control<'_>,
    ) -> Vec<Vec<f64>> {
        let done: Vec<Mutex<Vec<f64>>> = (0..count).map(|_| Mutex::default()).collect();
        let next = AtomicUsize::new(0);
        let work = || {
            loop {
                let k = next.fetch_add(1, Ordering::Relaxed);
                let Some(slot) = done.get(k) else { return };
                let mut r = vec![0.0; self.plan.factor()];
                self.reduce(&samples(k), &mut r, control);
                *slot.lock().unwrap_or_else(PoisonError::into_inner) = r;
            }
        };
        std::thread::scope(|scope| {
            for _ in 1..self.threads.min(count) {
                scope.spawn(work);
            }
            work();
        });
        done.into_iter()
            .map(|slot| slot.into_inner().unwrap_or_else(PoisonError::into_inner))
            .collect()
    }

    /// A binary counter: two factors of 2^k blocks make one of 2^(k+1).
    fn push(&mut self, mut r: Vec<f64>) {
        let mut level = 0;
        loop {
            if level == self.levels.len() {
                self.levels.push(Vec::new());
            }
            let earlier = std::mem::take(&mut self.levels[level]);
            if earlier.is_empty() {
                self.levels[level] = r;
                return;
            }
            r = self.merged_lanes(earlier, &r);
            level += 1;
        }
    }

    fn merged_lanes(&self, mut earlier: Vec<f64>, later: &[f64]) -> Vec<f64> {
        let task = Merge {
            plan: &self.plan,
            r: &mut earlier,
            later,
        };
        dispatch(self.plan.width, task);
        earlier
    }

    /// The factor of all samples so far. More samples may follow.
    #[must_use]
    pub fn factor(&self) -> Factor {
        let own = self.own_factor();
        match (&self.merged, self.samples) {
            (Some(merged), 0) => merged.clone(),
            (Some(merged), _) => merged.merge(&own),
            (None, _) => own,
        }
    }

    fn own_factor(&self) -> Factor {
        if self.samples == 0 {
            return Factor::empty(self.plan.columns);
        }
        let mut r = self.block.clone();
        if !self.rest[3].is_empty() {
            // The tile is filled up with the last sample, which then counts nothing.
            let n = self.dof();
            let held = self.rest[3].len() / n;
            let mut rest = self.rest.clone();
            rest[4].resize(held * n, 1.0);
            for array in &mut rest[..4] {
                let last = array[array.len() - array.len() / held..].to_vec();
                array.extend(last.repeat(self.plan.samples() - held));
            }
            rest[4].resize(rest[3].len(), 0.0);
            let go_on = AtomicBool::new(false);
            self.reduce(&measured(&rest, 0), &mut r, &Control::new(&go_on));
        }
        for level in self.levels.iter().filter(|level| !level.is_empty()) {
            r = self.merged_lanes(level.clone(), &r);
        }
        Factor::of_lanes(&self.plan, &r, self.samples)
    }

    /// Takes in what another accumulator for the same columns has taken in, after the
    /// samples here.
    ///
    /// # Panics
    /// If the other has not as many columns.
    pub fn merge(&mut self, other: &Self) {
        self.merge_factor(&other.factor());
    }

    /// Takes in a factor of the same columns.
    ///
    /// # Panics
    /// If it has not as many columns.
    pub fn merge_factor(&mut self, other: &Factor) {
        let merged = match self.samples() {
            0 => other.clone(),
            _ => self.factor().merge(other),
        };
        self.levels.clear();
        self.block.fill(0.0);
        self.tiles = 0;
        self.rest = Default::default();
        self.samples = 0;
        self.merged = Some(merged);
    }

    /// The number of samples, all arrays being of its length and finite.
    fn check(&self, samples: &Samples<'_>) -> Result<usize, ReduceError> {
        let [positions, joints] = self.plan.widths;
        let count = samples.states.q.len() / positions;
        let weights = match samples.weights {
            Weights::Equal => None,
            Weights::Joints(w) => Some((w, joints)),
            Weights::Rows(w) => Some((w, count * joints)),
        };
        let states = samples.states;
        let arrays = [
            ("q", states.q, positions),
            ("qd", states.qd, joints),
            ("qdd", states.qdd, joints),
            ("tau", samples.tau, joints),
        ];
        let arrays = arrays.map(|(array, values, width)| (array, values, count * width, width));
        let weights = weights.map(|(values, expected)| ("weights", values, expected, joints));
        for (array, values, expected, width) in arrays.into_iter().chain(weights) {
            let found = values.len();
            if found != expected {
                return Err(ReduceError::Length {
                    array,
                    expected,
                    found,
                    samples: count,
                    joints: width,
                });
            }
            if let Some(at) = not_finite(values) {
                return Err(ReduceError::NotFinite {
                    array,
                    sample: self.samples() + (at / width) as u64,
                    joint: at % width,
                    value: values[at],
                });
            }
        }
        if let Some((_, values, ..)) = weights
            && let Some(at) = values.iter().position(|w| *w < 0.0)
        {
            let sample = self.samples() + (at / joints) as u64;
            let place = match samples.weights {
                Weights::Rows(_) => format!("{sample}, {}", at % joints),
                _ => at.to_string(),
            };
            let value = values[at];
            return Err(ReduceError::Weight { place, value });
        }
        match self.regressor.check_attitudes(samples.states) {
            Err(RegressorError::Quaternion { sample, length }) => Err(ReduceError::Quaternion {
                sample: self.samples() + sample as u64,
                length,
            }),
            _ => Ok(count),
        }
    }
}

/// The square roots of the weights, row by row; nothing where all are equal.
fn roots(weights: &Weights<'_>, count: usize) -> Vec<f64> {
    match weights {
        Weights::Equal => Vec::new(),
        Weights::Rows(w) => w.iter().map(|w| w.sqrt()).collect(),
        Weights::Joints(w) => {
            let row: Vec<f64> = w.iter().map(|w| w.sqrt()).collect();
            row.repeat(count)
        }
    }
}

fn measured(arrays: &[Vec<f64>; 5], start: u64) -> Measured<'_> {
    let [q, qd, qdd, tau, weights] = arrays;
    Measured {
        states: States { q, qd, qdd },
        tau,
        weights,
        start,
    }
}

/// The first number that is not finite. Whole pieces are judged by one sum: zero times
/// anything but a finite number is NaN.
fn not_finite(values: &[f64]) -> Option<usize> {
    const PIECE: usize = 1024;
    for (piece, numbers) in values.chunks(PIECE).enumerate() {
        let mut sums = [0.0; 8];
        let mut whole = numbers.chunks_exact(8);
        for eight in whole.by_ref() {
            for (sum, x) in sums.iter_mut().zip(eight) {
                *sum += x * 0.0;
            }
        }
        let rest: f64 = whole.remainder().iter().map(|x| x * 0.0).sum();
        if sums.iter().sum::<f64>() + rest != 0.0 {
            let at = numbers.iter().position(|x| !x.is_finite());
            return at.map(|at| piece * PIECE + at);
        }
    }
    None
}
