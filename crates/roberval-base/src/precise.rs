//! Rank, choice and relations in pairs of doubles: for mechanisms whose constraints have
//! no points in a prime field that are easy to find (implicit loops, nonlinear couples).
//!
//! High-precision floats, not an exact decision: what is zero shows as 1e-25 and less, what
//! is not as 1e-6 and more, and a tolerance between the two decides. The gap is reported.

mod diagnosis;
mod staircase;

use num_integer::Integer;
use roberval_mechanism::Mechanism;
use roberval_regressor::Model;
use roberval_scalar::DoubleDouble;

pub use diagnosis::Precision;
use staircase::Staircase;

use crate::exact::columns_of_w;
use crate::observation::observation_rows;
use crate::{BaseError, Samples};

/// Columns whose rest is at or below this part of them are dependent, and columns whose
/// entries are at or below this part of what they would be if nothing cancelled have no
/// effect: pairs of doubles leave 1e-27 of either, and no robot has 1e-12.
const TOLERANCE: f64 = 1e-18;

/// Fewest samples: a subtree's own columns are seen by no more rows than its joints give.
const FEWEST_SAMPLES: usize = 24;

/// What pairs of doubles decide.
#[derive(Debug, Clone, PartialEq)]
pub struct PreciseDecision {
    /// All columns in the order asked for: a column is kept exactly when it is
    /// independent of those before it.
    pub order: Vec<usize>,
    /// Columns without effect, ascending.
    pub no_effect: Vec<usize>,
    /// Independent columns, in the order asked for.
    pub kept: Vec<usize>,
    /// The other columns with an effect, in the order asked for.
    pub deleted: Vec<usize>,
    /// beta, kept x deleted, rounded to doubles; entries that are dust are 0.
    pub beta: Vec<Vec<f64>>,
    /// What counts as zero, relative to the column.
    pub tolerance: f64,
    /// The smallest that counts as not zero; `None` if nothing does.
    pub smallest_kept: Option<f64>,
    /// The largest that counts as zero; `None` if nothing does.
    pub largest_dropped: Option<f64>,
    /// The samples used.
    pub samples: usize,
    /// Configurations of loops that were redrawn, being singular or out of reach.
    pub redrawn: usize,
    /// Their seed.
    pub seed: u64,
}

impl PreciseDecision {
    /// The smallest kept over the largest dropped value; `None` if nothing is on one side.
    #[must_use]
    pub fn gap(&self) -> Option<f64> {
        Some(self.smallest_kept? / self.largest_dropped.filter(|x| *x > 0.0)?)
    }
}

/// Rank, choice and relations of a mechanism in pairs of doubles, keeping the first
/// independent columns of `order` (a permutation of all columns).
///
/// # Errors
/// [`BaseError`] if a number of the description has no value, or the mechanism cannot be
/// sampled.
pub fn decide_precisely(
    mechanism: &Mechanism,
    model: Model,
    order: &[usize],
    seed: u64,
) -> Result<PreciseDecision, BaseError> {
    let each = model.rows(mechanism.independent());
    let count = Integer::div_ceil(&(3 * order.len()), &(2 * each)).max(FEWEST_SAMPLES) + 1;
    let samples = Samples::draw(mechanism, count, seed)?;
    let mut columns = columns_of_w::<DoubleDouble>(mechanism, model, &samples)?;
    let sizes = observation_rows(mechanism, model, &samples)?.largest_magnitudes();
    let mut zeros = Vec::new();
    // Columns are scaled by powers of two, those without effect by 0.
    let mut scales = vec![0.0; columns.len()];
    for ((values, size), scale) in columns.iter_mut().zip(&sizes).zip(&mut scales) {
        let entry = values.iter().fold(0.0_f64, |m, x| m.max(x.to_f64().abs()));
        if entry > TOLERANCE * size {
            *scale = (-entry.log2().round()).exp2();
            let factor = DoubleDouble::from(*scale);
            values.iter_mut().for_each(|x| *x = *x * factor);
        } else if entry > 0.0 {
            zeros.push(entry / size);
        }
    }
    let effect: Vec<usize> = order.iter().copied().filter(|&c| scales[c] > 0.0).collect();
    let staircase = Staircase::of(effect.iter().map(|&c| &columns[c][..]), TOLERANCE);
    let at = |places: &[usize]| places.iter().map(|&i| effect[i]).collect::<Vec<_>>();
    let (kept, deleted) = (at(&staircase.kept), at(&staircase.deleted));
    let mut beta = staircase.relations();
    for (row, &i) in beta.iter_mut().zip(&kept) {
        for (x, &j) in row.iter_mut().zip(&deleted) {
            *x *= scales[i] / scales[j];
        }
    }
    let dropped = zeros.into_iter().chain(staircase.largest_dropped);
    Ok(PreciseDecision {
        order: order.to_vec(),
        no_effect: (0..columns.len()).filter(|&c| scales[c] == 0.0).collect(),
        kept,
        deleted,
        beta,
        tolerance: TOLERANCE,
        smallest_kept: staircase.smallest_kept,
        largest_dropped: dropped.reduce(f64::max),
        samples: count,
        redrawn: samples.redrawn,
        seed,
    })
}
