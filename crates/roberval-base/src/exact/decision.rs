//! Two fields, one answer.

use roberval_mechanism::Mechanism;
use roberval_regressor::{AngleOrder, Model, NoValue, NotInField};

use super::coefficients::coefficients;
use super::number::ExactNumber;
use super::rounded::round_open_entries;
use super::run::{Run, run};
use crate::SampleError;

/// Fields asked at most before two must have agreed: a disagreement has a probability
/// of about 1e-15, so that a second one is a bug.
const MOST_FIELDS: u64 = 4;

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
    /// Loops that are given implicitly.
    #[error("loops given by their cut joints are not decided exactly: use the engine \"precise\"")]
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
    if mechanism.assembly.is_some() {
        return Err(ExactError::Loops);
    }
    let angles = AngleOrder::of(mechanism);
    let field = |k: u64| {
        run(
            mechanism,
            model,
            order,
            angles,
            seed.wrapping_mul(1000).wrapping_add(k),
            1,
        )
    };
    let [first, second] = agreeing_runs(field)?;
    let failure = |r: &Run| r.kept.len() as f64 * r.degree as f64 / r.p as f64;
    let mut beta = coefficients(&first, &second, angles, |seed, conjugate| {
        run(mechanism, model, order, angles, seed, conjugate)
    })?;
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
        failure_probability: failure(&first) * failure(&second),
        primes: vec![first.p, second.p],
        seeds: vec![first.seed, second.seed],
        samples: vec![first.samples, second.samples],
        no_effect: first.no_effect,
        kept: first.kept,
        deleted: first.deleted,
        generic: first.generic,
        beta,
        rounding_error,
    })
}

/// The structural rank alone: the larger of two fields' ranks.
///
/// # Errors
/// [`ExactError`] if a number of the description has no place in a prime field.
pub(crate) fn structural_rank(
    mechanism: &Mechanism,
    model: Model,
    seed: u64,
) -> Result<usize, ExactError> {
    if mechanism.assembly.is_some() {
        return Err(ExactError::Loops);
    }
    let angles = AngleOrder::of(mechanism);
    let order: Vec<usize> = (0..mechanism.parameters().len()).collect();
    let rank = |seed: u64| run(mechanism, model, &order, angles, seed, 1).map(|r| r.kept.len());
    Ok(rank(seed)?.max(rank(seed.wrapping_add(1))?))
}

/// Two runs that agree; the rank is never overestimated, so that the larger wins.
fn agreeing_runs(field: impl Fn(u64) -> Result<Run, NotInField>) -> Result<[Run; 2], ExactError> {
    let mut runs: Vec<Run> = Vec::new();
    for k in 0..MOST_FIELDS {
        let new = field(k)?;
        let best = runs.iter().map(|r| r.kept.len()).max().unwrap_or(0);
        let same = |r: &Run| r.kept == new.kept && r.no_effect == new.no_effect;
        if new.kept.len() >= best
            && let Some(at) = runs.iter().position(same)
        {
            return Ok([runs.swap_remove(at), new]);
        }
        runs.push(new);
    }
    Err(ExactError::Disagreement {
        ranks: runs.iter().map(|r| r.kept.len()).collect(),
    })
}
