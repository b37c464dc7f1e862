//! Two fields, one answer.

use roberval_mechanism::Mechanism;
use roberval_regressor::{AngleOrder, Model, NoValue, NotInField};

use super::coefficients::coefficients;
use super::number::ExactNumber;
use super::rounded::round_open_entries;
use super::run::{Goal, Run, run};
use crate::SampleError;

/// Fields asked at most before two must have agreed: a disagreement has a probability
/// of about 1e-15 (1e-6, where angles have many digits), so that a second one is a bug.
const MOST_FIELDS: u64 = 5;

/// A rank that is too low with this probability is none. Two fields suffice, but for dozens
/// of angles with six decimals and more.
const IMPROBABLE: f64 = 1e-15;

/// The structural answer, decided without a tolerance.
#[derive(Debug, Clone)]
pub struct ExactDecision {
    /// All columns in the order asked for: a column is kept exactly when it is
    /// independent of those before it.
    pub order: Vec<usize>,
    /// Columns without effect, ascending.
    pub no_effect: Vec<usize>,
    /// Independent columns, in the order asked for.
    pub kept: Vec<usize>,
    /// The other columns with an effect, in the order asked for.
    pub deleted: Vec<usize>,
    /// beta, kept x deleted.
    pub beta: Vec<Vec<ExactNumber>>,
    /// The largest relative error that a coefficient without an exact form may have had
    /// before it was rounded: 0 if all have one; else about 1e-28. Infinite or large if
    /// the kept columns are not independent after all, which takes angles that stand for
    /// generic ones and are not.
    pub rounding_error: f64,
    /// The primes of the fields that agreed.
    pub primes: Vec<u64>,
    /// The seeds of their random values.
    pub seeds: Vec<u64>,
    /// The samples each field took until nothing was new.
    pub samples: Vec<usize>,
    /// Angles without a common unit, for which independent generic ones stood, as written.
    pub generic: Vec<String>,
    /// The order n of the rotation whose powers are the robot's rational angles: the
    /// primes are -1 modulo n.
    pub angle_order: u64,
    /// An upper bound of the degree of a row's entries in the random values.
    pub degree: u64,
    /// An upper bound of the probability that the rank is too low.
    pub failure_probability: f64,
}

/// Why the exact engine has no answer.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ExactError {
    /// A number of the robot has no place in any of many fields.
    #[error("{0}; give it as a decimal number instead")]
    NotInField(#[from] NotInField),
    /// The constraints have no value at a random state.
    #[error(transparent)]
    NoValue(#[from] NoValue),
    /// Loops without configurations to sample.
    #[error(transparent)]
    Samples(#[from] SampleError),
    /// Loops that are given implicitly, and couples by expressions.
    #[error(
        "loops given by their cut joints and couples by expressions are not decided exactly: use the engine \"precise\""
    )]
    Loops,
    /// Fields disagree again and again.
    #[error("prime fields disagree about the rank ({ranks:?}): please report this robot")]
    Disagreement {
        /// The ranks found.
        ranks: Vec<usize>,
    },
}

/// Rank, choice and relations of a mechanism, keeping the first independent columns of
/// `order` (a permutation of all columns).
///
/// # Errors
/// [`ExactError`] if a number of the description has no place in a prime field.
pub fn decide_exactly(
    mechanism: &Mechanism,
    model: Model,
    order: &[usize],
    seed: u64,
) -> Result<ExactDecision, ExactError> {
    if !mechanism.is_affine() {
        return Err(ExactError::Loops);
    }
    let angles = AngleOrder::of(mechanism);
    let field = |seed: u64, conjugate: u64| {
        let goal = Goal::Relations;
        run(mechanism, model, order, angles, seed, conjugate, goal)
    };
    let mut runs = agreeing_runs(|k| field(field_seed(seed, k), 1))?;
    let mut beta = coefficients(&runs[0], &runs[1], angles, field)?;
    let (primes, seeds) = runs.iter().map(|r| (r.p, r.seed)).unzip();
    let samples = runs.iter().map(|r| r.samples).collect();
    let failure_probability = failure_probability(&runs);
    let first = runs.swap_remove(0);
    let rounding_error = round_open_entries(
        mechanism,
        model,
        &first.kept,
        &first.deleted,
        &mut beta,
        seed,
    )?;
    Ok(ExactDecision {
        order: order.to_vec(),
        angle_order: angles.get(),
        degree: first.degree,
        failure_probability,
        primes,
        seeds,
        samples,
        no_effect: first.no_effect,
        kept: first.kept,
        deleted: first.deleted,
        generic: first.generic,
        beta,
        rounding_error,
    })
}

/// Rank and choice alone, without relations: the kept columns, as [`decide_exactly`] finds
/// them.
///
/// # Errors
/// [`ExactError`] if a number of the description has no place in a prime field.
pub fn choose_exactly(
    mechanism: &Mechanism,
    model: Model,
    order: &[usize],
    seed: u64,
) -> Result<Vec<usize>, ExactError> {
    if !mechanism.is_affine() {
        return Err(ExactError::Loops);
    }
    let angles = AngleOrder::of(mechanism);
    let field = |k: u64| {
        let seed = field_seed(seed, k);
        run(mechanism, model, order, angles, seed, 1, Goal::Choice)
    };
    agreeing_runs(field).map(|mut runs| runs.swap_remove(0).kept)
}

/// The seed of the k-th field.
fn field_seed(seed: u64, k: u64) -> u64 {
    seed.wrapping_mul(1000).wrapping_add(k)
}

/// Two or more runs that agree, as many as make a rank that is too low improbable. The rank
/// is never overestimated, so that the largest wins.
fn agreeing_runs(field: impl Fn(u64) -> Result<Run, NotInField>) -> Result<Vec<Run>, ExactError> {
    let mut runs: Vec<Run> = Vec::new();
    for k in 0..MOST_FIELDS {
        runs.push(field(k)?);
        let best = runs.iter().max_by_key(|r| r.kept.len());
        let agreed: Vec<Run> = runs
            .iter()
            .filter(|r| best.is_some_and(|b| r.kept == b.kept && r.no_effect == b.no_effect))
            .cloned()
            .collect();
        let last = k + 1 == MOST_FIELDS;
        if agreed.len() >= 2 && (last || failure_probability(&agreed) <= IMPROBABLE) {
            return Ok(agreed);
        }
    }
    Err(ExactError::Disagreement {
        ranks: runs.iter().map(|r| r.kept.len()).collect(),
    })
}

/// A bound of the probability that all of these missed rank (Schwartz and Zippel).
fn failure_probability(runs: &[Run]) -> f64 {
    let of = |r: &Run| r.kept.len() as f64 * r.degree as f64 / r.p as f64;
    runs.iter().map(of).product()
}
