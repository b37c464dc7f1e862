//! One run of the exact engine in one prime field.

use roberval_linalg::Echelon;
use roberval_mechanism::{Mechanism, ParameterSpace};
use roberval_regressor::{AngleOrder, ExactModel, Model, NotInField};
use roberval_scalar::{Fp, SplitMix64};

use super::field::in_some_field;

/// Samples in a row that must add nothing before the row space counts as complete.
const SILENT_SAMPLES: usize = 2;

/// What one field says. Columns are the robot's; those of `kept` and of `beta`'s rows
/// and columns are in the order they were asked for.
#[derive(Debug, Clone)]
pub struct Run {
    /// The prime.
    pub p: u64,
    /// The seed of all that was random.
    pub seed: u64,
    /// Samples taken until nothing was new.
    pub samples: usize,
    /// Columns that are zero (constant, for h) at every sample, ascending.
    pub no_effect: Vec<usize>,
    /// Independent columns.
    pub kept: Vec<usize>,
    /// The other columns with an effect.
    pub deleted: Vec<usize>,
    /// Residues of beta; nothing if they were not asked for.
    pub beta: Vec<Vec<u64>>,
    /// Angles that stood for generic ones.
    pub generic: Vec<String>,
    /// Whether all angles are multiples of 2 pi/n.
    pub algebraic: bool,
    /// Degree of a row's entries in the random values.
    pub degree: u64,
    /// Residue of the square root of 2 that the angles mean.
    pub sqrt2: u64,
    /// Residue of the square root of 3.
    pub sqrt3: u64,
    /// Whether lengths of the description have square roots.
    pub roots: bool,
}

/// How far to eliminate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Goal {
    /// Rank and choice.
    Choice,
    /// The relations, too.
    Relations,
}

/// Analyses the mechanism in a random prime field, keeping the first independent columns
/// of `order` (a permutation of all columns). Constant angles of finite order are taken
/// `conjugate` times (1, or a number that has no factor in common with that order): the
/// answer of a robot whose square roots have other signs.
pub(crate) fn run(
    mechanism: &Mechanism,
    model: Model,
    order: &[usize],
    angle_order: AngleOrder,
    seed: u64,
    conjugate: u64,
    goal: Goal,
) -> Result<Run, NotInField> {
    in_some_field(mechanism, angle_order, seed, conjugate, |exact, random| {
        exact.holds_constraints().map_err(NotInField::Loops)?;
        Ok(eliminate_to(
            mechanism, model, order, exact, seed, random, goal,
        ))
    })?
}

/// Analyses the robot of an exact model: [`Run`] in its field. `random` draws the states.
pub fn eliminate<'m>(
    mechanism: &Mechanism,
    model: Model,
    order: &[usize],
    exact: &ExactModel<'m>,
    seed: u64,
    random: &mut SplitMix64,
) -> Run {
    let goal = Goal::Relations;
    eliminate_to(mechanism, model, order, exact, seed, random, goal)
}

fn eliminate_to<'m>(
    mechanism: &Mechanism,
    model: Model,
    order: &[usize],
    exact: &ExactModel<'m>,
    seed: u64,
    random: &mut SplitMix64,
    goal: Goal,
) -> Run {
    let space: ParameterSpace = mechanism.parameters();
    let modulus = exact.modulus();
    let zero = modulus.integer(0);
    let mut rows = Rows {
        exact,
        work: exact.workspace(),
        model,
        values: vec![zero; model.rows(mechanism.independent()) * space.len()],
        reference: None,
    };
    let mut echelon = Echelon::new(modulus, order.len());
    let (samples, seen) = fill(&mut echelon, &mut rows, order, random);
    let kept = echelon.kept();
    let leads = |j: &usize| kept.binary_search(j).is_ok();
    let deleted = (0..order.len()).filter(|j| !leads(j) && seen[order[*j]]);
    let beta = match goal {
        Goal::Choice => Vec::new(),
        Goal::Relations => {
            let others = (0..order.len()).filter(|j| !leads(j));
            let effect: Vec<bool> = others.map(|j| seen[order[j]]).collect();
            let relations = echelon.relations();
            relations.iter().map(|r| with_effect(r, &effect)).collect()
        }
    };
    Run {
        p: modulus.p(),
        seed,
        samples,
        no_effect: (0..order.len()).filter(|&c| !seen[c]).collect(),
        deleted: deleted.map(|j| order[j]).collect(),
        kept: kept.iter().map(|&j| order[j]).collect(),
        beta,
        generic: exact.generic().to_vec(),
        algebraic: exact.is_algebraic(),
        degree: exact.degree(),
        sqrt2: exact.sqrt2().residue(),
        sqrt3: exact.sqrt3().residue(),
        roots: exact.has_roots(),
    }
}

/// Takes rows in until they have long brought nothing new: how many samples that took, and
/// which columns had an entry.
fn fill<'m>(
    echelon: &mut Echelon<'m>,
    rows: &mut Rows<'_, 'm>,
    order: &[usize],
    random: &mut SplitMix64,
) -> (usize, Vec<bool>) {
    let mut seen = vec![false; order.len()];
    let mut permuted = vec![rows.exact.modulus().integer(0); order.len()];
    let (mut samples, mut silent) = (0, 0);
    while silent < SILENT_SAMPLES {
        let before = echelon.rank();
        for row in rows.next(random).chunks_exact(order.len()) {
            for (j, &column) in order.iter().enumerate() {
                permuted[j] = row[column];
                seen[column] |= !row[column].is_zero();
            }
            echelon.insert(&permuted);
        }
        samples += 1;
        silent = if echelon.rank() == before {
            silent + 1
        } else {
            0
        };
    }
    (samples, seen)
}

fn with_effect(row: &[Fp<'_>], effect: &[bool]) -> Vec<u64> {
    let pairs = row.iter().zip(effect).filter(|(_, effect)| **effect);
    pairs.map(|(x, _)| x.residue()).collect()
}

/// Rows of the model at one random state after another; those of h are differences to
/// the first state's.
struct Rows<'a, 'm> {
    exact: &'a ExactModel<'m>,
    work: roberval_regressor::ExactWorkspace<'m>,
    model: Model,
    values: Vec<Fp<'m>>,
    reference: Option<Vec<Fp<'m>>>,
}

impl<'m> Rows<'_, 'm> {
    fn next(&mut self, random: &mut SplitMix64) -> &[Fp<'m>] {
        if self.model == Model::H && self.reference.is_none() {
            self.exact
                .fill(self.model, random, &mut self.work, &mut self.values);
            self.reference = Some(self.values.clone());
        }
        self.exact
            .fill(self.model, random, &mut self.work, &mut self.values);
        if let Some(reference) = &self.reference {
            for (x, reference) in self.values.iter_mut().zip(reference) {
                *x = *x - *reference;
            }
        }
        &self.values
    }
}
