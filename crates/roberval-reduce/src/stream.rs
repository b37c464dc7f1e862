//! The accumulator: samples in, R factor out, in memory that does not grow with them.

use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use roberval_regressor::{Regressor, States};
use roberval_scalar::dispatch;

use crate::factor::Factor;
use crate::plan::{Friction, Plan};
use crate::range::{beyond, suspicious};
use crate::samples::{ReduceError, Samples};
use crate::tiles::{Absorb, Control, Measured, Merge};

/// Least squares in one pass: blocks of samples are annihilated against triangular factors
/// (TSQR), so that memory is O(P^2) and the result backward stable.
///
/// The result depends on the samples and their order alone, bit by bit, not on how they
/// are cut into calls, nor on the number of threads, nor on how many lanes the processor
/// has (as long as it fuses products and sums).
///
/// A clone shares what it does not change: it costs next to nothing.
#[derive(Debug, Clone)]
pub struct Reduction {
    pub(crate) regressor: Arc<Regressor>,
    pub(crate) plan: Arc<Plan>,
    pub(crate) choice: Arc<[usize]>,
    pub(crate) friction: Friction,
    pub(crate) threads: usize,
    /// The leaves' factors of 2^k blocks at place k (empty where there are none).
    pub(crate) levels: Vec<Arc<Vec<f64>>>,
    /// The leaves' factors of the unfinished block, and how many tiles it has.
    pub(crate) block: Arc<Vec<f64>>,
    pub(crate) tiles: usize,
    /// Samples of the unfinished tile: q, qd, qdd, tau and the roots of weights.
    pub(crate) rest: [Vec<f64>; 5],
    pub(crate) samples: u64,
    /// What was merged from other accumulators.
    pub(crate) merged: Option<Arc<Factor>>,
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
            block: Arc::new(vec![0.0; plan.factor()]),
            regressor: Arc::new(regressor),
            plan: Arc::new(plan),
            choice: columns.into(),
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
        self.samples + self.merged.as_ref().map_or(0, |factor| factor.samples())
    }

    /// Takes in samples, all or, after an error, none.
    ///
    /// # Errors
    /// [`ReduceError`] names what is not a finite number, has the wrong length or is so large
    /// that R would not be finite.
    pub fn update(&mut self, samples: &Samples<'_>) -> Result<(), ReduceError> {
        let mut next = self.clone();
        next.take_in(samples, &AtomicBool::new(false))?;
        *self = next;
        Ok(())
    }

    /// As [`Reduction::update`] for a clone, which is of no use after an error: it may have
    /// taken in some of the samples. Gives up soon after `stop` is set.
    ///
    /// # Errors
    /// [`ReduceError::Stopped`], and those of [`Reduction::update`].
    pub fn take_in(&mut self, samples: &Samples<'_>, stop: &AtomicBool) -> Result<(), ReduceError> {
        let (n, widths) = (self.dof(), self.plan.widths);
        let count = samples.check(&self.regressor, widths)?;
        let weights = samples.weights.roots(count);
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
        if stop.load(Ordering::Relaxed) {
            return Err(ReduceError::Stopped);
        }
        let beyond = control.beyond.into_inner();
        let fault = control.fault.into_inner();
        match fault.unwrap_or_else(PoisonError::into_inner) {
            // What is held had a value when it came.
            Some((sample, error)) => Err(ReduceError::NoValue {
                sample: sample.saturating_sub(all.start),
                error,
            }),
            None if beyond => Err(self.overflow(samples, stop)),
            None => Ok(()),
        }
    }

    /// Finds out whether the constraints have a value at the samples held, and whether R
    /// will be finite with them.
    fn try_rest(&self, control: &Control<'_>) {
        let expands = self.regressor.expansion().is_some();
        if !self.rest[3].is_empty() && (expands || self.rest.iter().any(|x| suspicious(x))) {
            let mut r = vec![0.0; self.plan.factor()];
            self.reduce_rest(&mut r, control);
            control.watch(&r);
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
            let factors = self.blocks(wave, piece, control);
            if control.ends() {
                // Nobody wants the result; merging takes longer than Ctrl-C may.
                return;
            }
            for r in factors {
                self.push(r, control);
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
        let mut block = Arc::unwrap_or_clone(std::mem::take(&mut self.block));
        self.reduce(samples, &mut block, control);
        self.tiles += tiles;
        if self.tiles == self.plan.block() {
            self.tiles = 0;
            self.push(block, control);
            block = vec![0.0; self.plan.factor()];
        }
        control.watch(&block);
        self.block = Arc::new(block);
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
    fn push(&mut self, mut r: Vec<f64>, control: &Control<'_>) {
        let mut level = 0;
        loop {
            if level == self.levels.len() {
                self.levels.push(Arc::default());
            }
            let earlier = std::mem::take(&mut self.levels[level]);
            if earlier.is_empty() {
                control.watch(&r);
                self.levels[level] = Arc::new(r);
                return;
            }
            r = self.merged_lanes(Arc::unwrap_or_clone(earlier), &r);
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
            (Some(merged), 0) => Factor::clone(merged),
            (Some(merged), _) => merged.merge(&own),
            (None, _) => own,
        }
    }

    fn own_factor(&self) -> Factor {
        if self.samples == 0 {
            return Factor::empty(self.plan.columns);
        }
        let mut r = Vec::clone(&self.block);
        if !self.rest[3].is_empty() {
            let go_on = AtomicBool::new(false);
            self.reduce_rest(&mut r, &Control::new(&go_on));
        }
        for level in self.levels.iter().filter(|level| !level.is_empty()) {
            r = self.merged_lanes(Vec::clone(level), &r);
        }
        Factor::of_lanes(&self.plan, &r, self.samples)
    }

    /// The unfinished tile, filled up with the last sample, which then counts nothing.
    fn reduce_rest(&self, r: &mut [f64], control: &Control<'_>) {
        let n = self.dof();
        let held = self.rest[3].len() / n;
        let mut rest = self.rest.clone();
        rest[4].resize(held * n, 1.0);
        for array in &mut rest[..4] {
            let last = array[array.len() - array.len() / held..].to_vec();
            array.extend(last.repeat(self.plan.samples() - held));
        }
        rest[4].resize(rest[3].len(), 0.0);
        let start = self.samples() - held as u64;
        self.reduce(&measured(&rest, start), r, control);
    }

    /// Takes in what another accumulator for the same columns has taken in, after the
    /// samples here.
    ///
    /// # Errors
    /// [`ReduceError::MergeOverflow`]; nothing is taken in then.
    ///
    /// # Panics
    /// If the other has not as many columns.
    pub fn merge(&mut self, other: &Self) -> Result<(), ReduceError> {
        self.merge_factor(&other.factor())
    }

    /// Takes in a factor of the same columns.
    ///
    /// # Errors
    /// [`ReduceError::MergeOverflow`]; nothing is taken in then.
    ///
    /// # Panics
    /// If it has not as many columns.
    pub fn merge_factor(&mut self, other: &Factor) -> Result<(), ReduceError> {
        let merged = match self.samples() {
            0 => other.clone(),
            _ => self.factor().merge(other),
        };
        if beyond(merged.packed()) {
            return Err(ReduceError::MergeOverflow);
        }
        self.levels.clear();
        self.block = Arc::new(vec![0.0; self.plan.factor()]);
        self.tiles = 0;
        self.rest = Default::default();
        self.samples = 0;
        self.merged = Some(Arc::new(merged));
        Ok(())
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
