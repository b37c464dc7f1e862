//! The search for one piece of W: COBYLA from the best of many random states.
//!
//! The paper takes Powell's conjugate directions (VA04), which no maintained crate
//! offers without a C compiler. COBYLA is Powell's own later method for the same
//! problem, without derivatives, in pure Rust. On the PUMA's h both reach S = 80 to 100,
//! COBYLA with half the evaluations. Its linear algebra grows with the cube of the
//! variables, so that it is given a dozen at a time: at 19 joints 15 times faster than
//! all at once, with the same S.

use std::cell::RefCell;
use std::ops::ControlFlow;

use cobyla::{Func, RhoBeg, StopTols};
use roberval_mechanism::Mechanism;
use roberval_regressor::{Model, Regressor, States};
use roberval_scalar::SplitMix64;

use super::{Range, ScalingOptions, ScalingProgress};
use crate::observation::row_weights;
use crate::sample::Reaches;
use crate::{BaseError, Samples};

/// Random states that show what size the entries of an even piece have.
const PILOTS: usize = 2000;
/// How many of them, the most even ones, are believed.
const BELIEVED: usize = 50;
/// Variables handed to COBYLA at a time.
const TOGETHER: usize = 12;
/// Evaluations that COBYLA may take for them; it mostly stops by itself at 100.
const EVALUATIONS: usize = 150;
/// COBYLA's first step, in units of the range drawn from.
const FIRST_STEP: f64 = 0.1;
/// Steps and gains below this end a search: S is not wanted to better than a percent.
const PRECISION: f64 = 1e-3;
/// How far a variable may leave the range [-1, 1] drawn from.
const BOUND: f64 = 4.0;

/// The state of the robot, (q, qd, qdd) of each coordinate of the velocity, in units of
/// what random samples reach.
type State = Vec<[f64; 3]>;

/// A state and the decades by which its worst entry misses the common size.
struct Candidate {
    state: State,
    miss: f64,
}

pub(super) struct Search<'a> {
    piece: Piece<'a>,
    options: &'a ScalingOptions,
    random: SplitMix64,
    /// The logarithm of the size that all entries are to have.
    common: f64,
    /// Pieces of W.
    pieces: usize,
}

impl<'a> Search<'a> {
    pub fn new(
        mechanism: &Mechanism,
        options: &'a ScalingOptions,
        pattern: &'a [bool],
        count: usize,
    ) -> Result<Self, BaseError> {
        let mut random = SplitMix64::new(options.seed);
        let mut piece = Piece::new(mechanism, options.model, pattern);
        let mut pieces = count;
        if options.model == Model::H {
            piece.set_reference(&mut random)?;
            pieces -= 1;
        }
        let common = common_size(&mut piece, &mut random);
        Ok(Self {
            piece,
            options,
            random,
            common,
            pieces,
        })
    }

    /// A search for each piece, then again for whichever is worst.
    pub fn run(
        mut self,
        progress: &mut impl FnMut(ScalingProgress) -> ControlFlow<()>,
    ) -> Result<Samples, BaseError> {
        let most = self
            .pieces
            .saturating_mul(self.options.rounds.saturating_add(1));
        let good = self.options.target.log10() / 2.0;
        let mut found: Vec<Candidate> = Vec::with_capacity(self.pieces);
        for done in 0..most {
            if progress(ScalingProgress { done, most }).is_break() {
                return Err(BaseError::Stopped { done, most });
            }
            if done < self.pieces {
                found.push(self.search());
                continue;
            }
            let worst = found.iter_mut().max_by(|a, b| a.miss.total_cmp(&b.miss));
            let Some(worst) = worst.filter(|worst| worst.miss > good) else {
                break;
            };
            let again = self.search();
            if again.miss < worst.miss {
                *worst = again;
            }
        }
        Ok(self.piece.samples(found.iter().map(|c| &c.state)))
    }

    /// One search: the best of the random starts, improved a dozen variables at a time.
    fn search(&mut self) -> Candidate {
        let mut best = self.start();
        for _ in 1..self.options.starts {
            let start = self.start();
            if start.miss < best.miss {
                best = start;
            }
        }
        let mut variables = self.piece.variables.clone();
        shuffle(&mut variables, &mut self.random);
        let shares = variables.len().div_ceil(TOGETHER);
        for share in variables.chunks(variables.len().div_ceil(shares)) {
            let improved = self.improve(&best.state, share);
            if improved.miss < best.miss {
                best = improved;
            }
        }
        best
    }

    fn start(&mut self) -> Candidate {
        let state = self.piece.draw(&mut self.random);
        let miss = self.piece.miss(&state, self.common);
        Candidate { state, miss }
    }

    /// COBYLA over some of the variables.
    fn improve(&mut self, state: &State, variables: &[(usize, usize)]) -> Candidate {
        let common = self.common;
        let with = |x: &[f64]| {
            let mut state = state.clone();
            for (&(joint, order), x) in variables.iter().zip(x) {
                state[joint][order] = *x;
            }
            state
        };
        let piece = RefCell::new(&mut self.piece);
        let miss = |x: &[f64], (): &mut ()| piece.borrow_mut().miss(&with(x), common);
        let x: Vec<f64> = variables.iter().map(|&(j, k)| state[j][k]).collect();
        let tolerances = StopTols {
            ftol_abs: PRECISION,
            xtol_abs: vec![PRECISION; x.len()],
            ..StopTols::default()
        };
        let result = cobyla::minimize(
            miss,
            &x,
            &vec![(-BOUND, BOUND); x.len()],
            &Vec::<&dyn Func<()>>::new(),
            (),
            EVALUATIONS,
            RhoBeg::All(FIRST_STEP),
            Some(tolerances),
        );
        // A failure (rounding in COBYLA's own model) still hands back its best point.
        let (Ok((_, x, _)) | Err((_, x, _))) = result;
        let state = with(&x);
        let miss = self.piece.miss(&state, common);
        Candidate { state, miss }
    }
}

/// The logarithm of the size about which the entries of an even piece lie: gravity's
/// entries have a size that no velocity changes, and it depends on the robot and its
/// units.
fn common_size(piece: &mut Piece<'_>, random: &mut SplitMix64) -> f64 {
    let mut pilots: Vec<(f64, f64)> = (0..PILOTS)
        .map(|_| {
            let state = piece.draw(random);
            let (low, high) = piece.decades(&state);
            (high - low, (high + low) / 2.0)
        })
        .collect();
    pilots.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let mut centres: Vec<f64> = pilots[..BELIEVED].iter().map(|p| p.1).collect();
    centres.sort_unstable_by(f64::total_cmp);
    centres[BELIEVED / 2]
}

fn shuffle<T>(list: &mut [T], random: &mut SplitMix64) {
    for i in 1..list.len() {
        list.swap(i, random.below(i + 1));
    }
}

/// The piece of W that one sample gives, as a function of the joints' state.
struct Piece<'a> {
    regressor: Regressor,
    model: Model,
    /// The places that are not structural zeros.
    pattern: &'a [bool],
    /// What the row of each joint is multiplied by.
    weights: Vec<f64>,
    reaches: Reaches,
    /// (joint, order of derivative) of all that the model depends on.
    variables: Vec<(usize, usize)>,
    /// The reference sample of h and its row.
    reference: Option<(State, Vec<f64>)>,
    rows: Vec<f64>,
}

impl<'a> Piece<'a> {
    fn new(mechanism: &Mechanism, model: Model, pattern: &'a [bool]) -> Self {
        let orders: &[usize] = match model {
            Model::D => &[0, 1, 2],
            Model::D0 => &[0, 2],
            Model::H => &[0, 1],
        };
        let joints = 0..mechanism.independent();
        Self {
            regressor: Regressor::new(mechanism),
            model,
            pattern,
            weights: match model {
                Model::H => vec![1.0],
                Model::D | Model::D0 => row_weights(mechanism),
            },
            reaches: Reaches::of(mechanism),
            variables: joints
                .flat_map(|joint| orders.iter().map(move |&order| (joint, order)))
                .collect(),
            reference: None,
            rows: vec![0.0; pattern.len()],
        }
    }

    /// Rows count from a random posture at rest.
    fn set_reference(&mut self, random: &mut SplitMix64) -> Result<(), BaseError> {
        let mut state = self.draw(random);
        for joint in &mut state {
            joint[1] = 0.0;
        }
        self.fill(&state)?;
        self.reference = Some((state, self.rows.clone()));
        Ok(())
    }

    fn draw(&self, random: &mut SplitMix64) -> State {
        let mut state = vec![[0.0; 3]; self.reaches.each.len()];
        for &(joint, order) in &self.variables {
            state[joint][order] = random.uniform(-1.0, 1.0);
        }
        state
    }

    /// The decades by which the worst entry misses the common size.
    fn miss(&mut self, state: &State, common: f64) -> f64 {
        let (low, high) = self.decades(state);
        (high - common).max(common - low)
    }

    /// The logarithms of the smallest and the largest entry, a zero counting as 1e-308.
    fn decades(&mut self, state: &State) -> (f64, f64) {
        if self.fill(state).is_err() {
            return (f64::MIN_POSITIVE.log10(), f64::MAX.log10());
        }
        let width = self.rows.len() / self.weights.len();
        let mut range = Range::EMPTY;
        for (place, &x) in self.rows.iter().enumerate() {
            if self.pattern[place] {
                let reference = self.reference.as_ref().map_or(0.0, |r| r.1[place]);
                range = range.with(Range::of((x - reference) * self.weights[place / width]));
            }
        }
        let log = |x: f64| x.clamp(f64::MIN_POSITIVE, f64::MAX).log10();
        (log(range.low), log(range.high))
    }

    fn fill(&mut self, state: &State) -> Result<(), BaseError> {
        let mut sample = Samples::with_capacity(state.len() + 1);
        sample.push(&self.reaches, state);
        let states: States<'_> = sample.states();
        Ok(self.regressor.fill(self.model, states, &mut self.rows)?)
    }

    /// The reference sample, if there is one, and the samples of some states.
    fn samples<'s>(&'s self, states: impl Iterator<Item = &'s State>) -> Samples {
        let mut samples = Samples::with_capacity(0);
        for state in self.reference.iter().map(|r| &r.0).chain(states) {
            samples.push(&self.reaches, state);
        }
        samples
    }
}
