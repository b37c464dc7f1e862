//! Two fields, one answer.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{ToPrimitive, Zero};
use roberval_linalg::{chinese_remainder, rational_from_residue};
use roberval_mechanism::Mechanism;
use roberval_regressor::{AngleOrder, Model, NotInField};

use super::number::ExactNumber;
use super::run::{Run, run};
use super::surd::surds;

/// Fields asked at most before two must have agreed: a disagreement has a probability
/// of about 1e-15, so that a second one is a bug.
const MOST_FIELDS: u64 = 4;

/// Fields whose residues are joined at most to find a fraction: 8 times 62 bits hold the
/// products of lengths with 15 digits.
const MOST_JOINED: usize = 8;

/// The structural answer, decided without a tolerance.
#[derive(Debug, Clone)]
pub struct ExactDecision {
    /// Columns without effect, ascending.
    pub no_effect: Vec<usize>,
    /// Independent columns, in the order asked for.
    pub kept: Vec<usize>,
    /// The other columns with an effect, in the order asked for.
    pub deleted: Vec<usize>,
    /// beta, kept x deleted.
    pub beta: Vec<Vec<ExactNumber>>,
    /// The primes of the fields that agreed.
    pub primes: Vec<u64>,
    /// The seeds of their random values.
    pub seeds: Vec<u64>,
    /// The samples each field took until nothing was new.
    pub samples: Vec<usize>,
    /// Angles that have no exact rotation and stood for generic ones, as written.
    pub generic: Vec<String>,
    /// An upper bound of the probability that the rank is too low.
    pub failure_probability: f64,
}

/// Why the exact engine has no answer.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ExactError {
    /// A number of the robot has no place in any of many fields.
    #[error("{0}; give it as a decimal number instead")]
    NotInField(#[from] NotInField),
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
    let angles = AngleOrder::of(&mechanism.description);
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
    let beta = coefficients(mechanism, model, order, angles, &first, &second)?;
    Ok(ExactDecision {
        failure_probability: failure(&first) * failure(&second),
        primes: vec![first.p, second.p],
        seeds: vec![first.seed, second.seed],
        samples: vec![first.samples, second.samples],
        no_effect: first.no_effect,
        kept: first.kept,
        deleted: first.deleted,
        generic: first.generic,
        beta,
    })
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

/// beta from its residues: fractions first, then sums with square roots; what is neither
/// is left to the floats.
fn coefficients(
    mechanism: &Mechanism,
    model: Model,
    order: &[usize],
    angles: AngleOrder,
    first: &Run,
    second: &Run,
) -> Result<Vec<Vec<ExactNumber>>, ExactError> {
    let mut open = Vec::new();
    let mut beta: Vec<Vec<ExactNumber>> = Vec::with_capacity(first.kept.len());
    for (i, (row1, row2)) in first.beta.iter().zip(&second.beta).enumerate() {
        let mut row = Vec::with_capacity(row1.len());
        for (j, (&a1, &a2)) in row1.iter().zip(row2).enumerate() {
            let found = fraction_of_one(a1, first.p).filter(|x| is_residue(x, a2, second.p));
            if found.is_none() {
                open.push((i, j));
            }
            row.push(found.map_or(ExactNumber::Rounded(f64::NAN), ExactNumber::Rational));
        }
        beta.push(row);
    }
    if first.generic.is_empty() && !open.is_empty() {
        open = long_fractions(
            mechanism, model, order, angles, first, second, open, &mut beta,
        )?;
    }
    if first.generic.is_empty() && !open.is_empty() {
        surds(mechanism, model, order, angles, first, &open, &mut beta)?;
    }
    Ok(beta)
}

fn fraction_of_one(residue: u64, p: u64) -> Option<BigRational> {
    if residue == 0 {
        return Some(BigRational::zero());
    }
    rational_from_residue(&residue.into(), &p.into())
}

/// Whether `x = residue (mod p)`.
pub(super) fn is_residue(x: &BigRational, residue: u64, p: u64) -> bool {
    let p = BigInt::from(p);
    ((x.numer() - x.denom() * BigInt::from(residue)) % p).is_zero()
}

/// Fractions too long for one prime: residues of more and more fields are joined until
/// the next field confirms the fraction. Returns what is still open.
#[allow(clippy::too_many_arguments)]
fn long_fractions(
    mechanism: &Mechanism,
    model: Model,
    order: &[usize],
    angles: AngleOrder,
    first: &Run,
    second: &Run,
    mut open: Vec<(usize, usize)>,
    beta: &mut [Vec<ExactNumber>],
) -> Result<Vec<(usize, usize)>, ExactError> {
    let mut joined = Joined::of(first, &open);
    joined.add(second, &open);
    for k in 2..MOST_JOINED {
        let next = run(
            mechanism,
            model,
            order,
            angles,
            first.seed.wrapping_add(7919 * k as u64),
            1,
        )?;
        if next.kept != first.kept {
            continue;
        }
        let before = open.len();
        open.retain(|&(i, j)| {
            let guess = rational_from_residue(&joined.residues[i][j], &joined.modulus);
            let Some(x) = guess.filter(|x| is_residue(x, next.beta[i][j], next.p)) else {
                return true;
            };
            beta[i][j] = ExactNumber::Rational(x);
            false
        });
        // Entries that are fractions turn up together: all have lengths of similar digits.
        if open.is_empty() || (k > 2 && open.len() == before && before < joined.entries) {
            break;
        }
        joined.add(&next, &open);
    }
    Ok(open)
}

/// Residues modulo a product of primes.
struct Joined {
    modulus: BigInt,
    residues: Vec<Vec<BigInt>>,
    entries: usize,
}

impl Joined {
    fn of(run: &Run, open: &[(usize, usize)]) -> Self {
        Self {
            modulus: run.p.into(),
            residues: run
                .beta
                .iter()
                .map(|row| row.iter().map(|&x| x.into()).collect())
                .collect(),
            entries: open.len(),
        }
    }

    fn add(&mut self, run: &Run, open: &[(usize, usize)]) {
        let p = BigInt::from(run.p);
        if (&self.modulus % &p).to_u64() == Some(0) {
            return;
        }
        for &(i, j) in open {
            let old = &self.residues[i][j];
            self.residues[i][j] = chinese_remainder(old, &self.modulus, &run.beta[i][j].into(), &p);
        }
        self.modulus *= p;
    }
}
