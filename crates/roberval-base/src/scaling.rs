//! Samples that scale W (Gautier 1991, "Scaling of W").
//!
//! S = max |W_ij| / min |W_ij| over the nonzero entries says how evenly a sample set
//! shows the parameters. As in the paper W is searched for piece by piece, one row of h
//! or the n rows of a sample of d or d0 at a time, each a small problem of its own.
//!
//! W is the matrix that decides the rank. For h that means energy differences; the
//! reference sample is a robot at rest, so that the entries are the paper's with the
//! zero of potential energy put at that posture.

mod search;

use std::ops::ControlFlow;

use roberval_linalg::{Matrix, Tolerance, qrii};
use roberval_mechanism::Mechanism;
use roberval_regressor::Model;

use crate::method::{check_rows, sample_count};
use crate::observation::{has_effect, observation_rows};
use crate::{BaseError, Samples, observe};
use search::Search;

/// How samples are searched for.
#[derive(Debug, Clone, PartialEq)]
pub struct ScalingOptions {
    /// The linear model.
    pub model: Model,
    /// Names the random starts.
    pub seed: u64,
    /// Rows of W; by default c, as in the paper, and at least 24 samples of d and d0.
    pub rows: Option<usize>,
    /// The S to stop at. A piece is good once all its entries are within sqrt(target) of
    /// a common size: the paper's "around 10" for a row, which makes "about 100" for W.
    pub target: f64,
    /// Random states that compete to start a search.
    pub starts: usize,
    /// How often, on average, a piece is searched again while the target is missed.
    pub rounds: usize,
    /// The weights l1 and l2 of J = l1 ||W||_F + l2 S.
    pub weights: [f64; 2],
}

impl Default for ScalingOptions {
    fn default() -> Self {
        Self {
            model: Model::H,
            seed: 0,
            rows: None,
            target: 100.0,
            starts: 300,
            rounds: 3,
            weights: [1.0, 1.0],
        }
    }
}

/// How well a sample set shows the parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grade {
    /// S = max |W_ij| / min |W_ij|, structural zeros aside.
    pub s: f64,
    /// ||W||_F.
    pub norm: f64,
    /// J = l1 ||W||_F + l2 S.
    pub j: f64,
    /// rank W = b by QRII.
    pub rank: usize,
    /// |T_bb| / |T_b+1,b+1|; `None` if nothing is left over.
    pub gap: Option<f64>,
}

/// Samples that scale W, and what they gain.
#[derive(Debug, Clone, PartialEq)]
pub struct Scaling {
    /// The linear model.
    pub model: Model,
    /// The samples; for h the first one is the reference.
    pub samples: Samples,
    /// The parameters with an effect: the c columns of `w`.
    pub columns: Vec<usize>,
    /// W at the samples, r x c.
    pub w: Matrix,
    /// S of each row alone.
    pub row_s: Vec<f64>,
    /// As many random samples with the same seed.
    pub before: Grade,
    /// The samples found. `after.s` is never above `before.s`.
    pub after: Grade,
}

/// How far a search has come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScalingProgress {
    /// Searches done.
    pub done: usize,
    /// Searches at most.
    pub most: usize,
}

/// Searches for samples that scale W; `progress` is asked before each small search
/// whether to go on.
///
/// It takes at most (1 + rounds) searches a piece, each of `starts` + 150 evaluations
/// for a dozen variables: a tenth of a second for the PUMA, seconds for 30 joints.
///
/// # Errors
/// [`BaseError::Stopped`] if `progress` breaks; [`BaseError::TooFewRows`] and
/// [`BaseError::TooManyRows`] for `rows`; [`BaseError::Linalg`] if QRII fails.
pub fn scale(
    mechanism: &Mechanism,
    options: &ScalingOptions,
    mut progress: impl FnMut(ScalingProgress) -> ControlFlow<()>,
) -> Result<Scaling, BaseError> {
    if mechanism.assembly.is_some() {
        return Err(BaseError::LoopsNotScaled);
    }
    let structure = Structure::of(mechanism, options)?;
    let c = structure.columns.len();
    let count = sample_count(mechanism, options.model, options.rows, c)?;
    let random = Samples::draw(mechanism, count, options.seed)?;
    let before = structure.evaluate(mechanism, options, random)?;
    let found = Search::new(mechanism, options, &structure.pattern, count)?.run(&mut progress)?;
    let after = structure.evaluate(mechanism, options, found)?;
    let best = if after.grade.s < before.grade.s {
        after
    } else {
        before.clone()
    };
    Ok(Scaling {
        model: options.model,
        samples: best.samples,
        columns: structure.columns,
        w: best.w,
        row_s: best.row_s,
        before: before.grade,
        after: best.grade,
    })
}

/// Where the entries of W are not structural zeros.
struct Structure {
    /// The columns with an effect.
    columns: Vec<usize>,
    /// The places with an effect among the rows x C of one sample.
    pattern: Vec<bool>,
}

impl Structure {
    /// The structure seen by random samples, as [`crate::base_parameters`] sees it.
    fn of(mechanism: &Mechanism, options: &ScalingOptions) -> Result<Self, BaseError> {
        let model = options.model;
        let width = mechanism.parameters().len();
        let count = sample_count(mechanism, model, None, 2 * width)?;
        let samples = Samples::draw(mechanism, count, !options.seed)?;
        let rows = observation_rows(mechanism, model, &samples)?;
        let pattern: Vec<bool> = rows
            .effects(model.rows(mechanism.independent()) * width)
            .into_iter()
            .map(has_effect)
            .collect();
        let columns = (0..width)
            .filter(|&j| pattern.chunks_exact(width).any(|row| row[j]))
            .collect();
        Ok(Self { columns, pattern })
    }

    fn evaluate(
        &self,
        mechanism: &Mechanism,
        options: &ScalingOptions,
        samples: Samples,
    ) -> Result<Evaluated, BaseError> {
        let w = observe(mechanism, options.model, &samples)?.w;
        let ranges = self.row_ranges(&w);
        let all = ranges.iter().fold(Range::EMPTY, |all, row| all.with(*row));
        let w = w.select_columns(&self.columns);
        check_rows(&w)?;
        let decision = qrii(&w)?.decide(&Tolerance::default())?;
        let norm = w.as_slice().iter().map(|x| x * x).sum::<f64>().sqrt();
        let [l1, l2] = options.weights;
        Ok(Evaluated {
            samples,
            grade: Grade {
                s: all.ratio(),
                norm,
                j: l1 * norm + l2 * all.ratio(),
                rank: decision.rank,
                gap: decision.gap,
            },
            row_s: ranges.iter().map(|row| row.ratio()).collect(),
            w,
        })
    }

    /// The smallest and the largest nonzero |W_ij| of each row, structural zeros aside.
    fn row_ranges(&self, w: &Matrix) -> Vec<Range> {
        let patterns = self.pattern.chunks_exact(w.cols()).cycle();
        let range = |(i, pattern): (usize, &[bool])| {
            (0..w.cols())
                .filter(|&j| pattern[j] && w[(i, j)] != 0.0)
                .fold(Range::EMPTY, |range, j| range.with(Range::of(w[(i, j)])))
        };
        (0..w.rows()).zip(patterns).map(range).collect()
    }
}

/// A sample set, its W and its grade.
#[derive(Clone)]
struct Evaluated {
    samples: Samples,
    w: Matrix,
    row_s: Vec<f64>,
    grade: Grade,
}

/// The smallest and the largest size of some numbers.
#[derive(Debug, Clone, Copy)]
struct Range {
    low: f64,
    high: f64,
}

impl Range {
    const EMPTY: Self = Self {
        low: f64::INFINITY,
        high: 0.0,
    };

    fn of(x: f64) -> Self {
        Self {
            low: x.abs(),
            high: x.abs(),
        }
    }

    fn with(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }

    /// high / low, 1 if there are no numbers.
    fn ratio(self) -> f64 {
        if self.high == 0.0 {
            1.0
        } else {
            self.high / self.low
        }
    }
}
