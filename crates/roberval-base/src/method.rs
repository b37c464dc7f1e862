use std::cell::OnceCell;

use roberval_linalg::{Matrix, Relations, Tolerance, equilibrate, qrii, unscale_relations};
use roberval_mechanism::Mechanism;
use roberval_regressor::Model;
use roberval_scalar::SplitMix64;

use crate::engine::{Finding, Judgement, complement};
use crate::literal::{Literal, literal};
use crate::observation::check_size;
use crate::result::Classes;
use crate::{
    BaseError, BaseParameters, Choice, Diagnosis, Engine, ExactNumber, NullspaceDecision,
    Observation, Samples, decide_exactly, decide_precisely, nullspace_rank, observe,
};

/// Samples are never fewer than this: a subtree's own columns (at most 11 a link) are
/// seen by no more rows than its joints give.
const FEWEST_SAMPLES: usize = 24;

/// What the analysis is asked to do.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Options {
    /// The linear model.
    pub model: Model,
    /// The route to rank, choice and relations.
    pub engine: Engine,
    /// Which parameters to keep.
    pub choice: Choice,
    /// When a number counts as zero.
    pub tolerance: Tolerance,
    /// Names the random samples.
    pub seed: u64,
    /// Rows r of W; by default at least twice its columns.
    pub rows: Option<usize>,
}

/// The base inertial parameters of a mechanism (Gautier 1991).
///
/// # Errors
/// [`BaseError`] for wrong options or a failed factorisation. A doubtful rank is not an
/// error: see [`BaseParameters::diagnosis`].
pub fn base_parameters(
    mechanism: &Mechanism,
    options: &Options,
) -> Result<BaseParameters, BaseError> {
    let samples = random_samples(mechanism, options)?;
    base_parameters_at(mechanism, options, &samples).map_err(|error| match (error, options.rows) {
        // A sample gives n rows: what was asked for is what the user knows.
        (BaseError::TooFewRows { columns, .. }, Some(rows)) => {
            BaseError::TooFewRows { rows, columns }
        }
        (error, _) => error,
    })
}

/// The samples that [`base_parameters`] takes.
pub(crate) fn random_samples(
    mechanism: &Mechanism,
    options: &Options,
) -> Result<Samples, BaseError> {
    let columns = mechanism.parameters().len();
    let count = sample_count(mechanism, options.model, options.rows, 2 * columns)?;
    Ok(Samples::draw(mechanism, count, options.seed)?)
}

/// [`base_parameters`] at samples of one's own, such as [`crate::scale`] finds;
/// `options.rows` plays no part.
///
/// # Errors
/// Those of [`base_parameters`]; [`BaseError::Regressor`] if the samples do not fit the
/// robot.
pub fn base_parameters_at(
    mechanism: &Mechanism,
    options: &Options,
    samples: &Samples,
) -> Result<BaseParameters, BaseError> {
    base_parameters_with(mechanism, options, samples, &Facts::default())
}

/// What does not depend on model and engine, found once.
#[derive(Default)]
pub(crate) struct Facts {
    literal: OnceCell<Option<Literal>>,
    nullspace: OnceCell<NullspaceDecision>,
}

impl Facts {
    /// What the file as written gives; `rank` is that of the mechanism.
    fn literal(
        &self,
        mechanism: &Mechanism,
        options: &Options,
        rank: usize,
    ) -> Result<Option<Literal>, BaseError> {
        if let Some(known) = self.literal.get() {
            return Ok(known.clone());
        }
        let found = literal(mechanism, options.model, rank, options.seed)?;
        Ok(self.literal.get_or_init(|| found).clone())
    }

    /// The parameter nullspace algorithm's answer (of the opened tree, if there are loops).
    fn nullspace(&self, mechanism: &Mechanism, seed: u64) -> Result<&NullspaceDecision, BaseError> {
        if let Some(known) = self.nullspace.get() {
            return Ok(known);
        }
        let found = nullspace_rank(mechanism, seed)?;
        Ok(self.nullspace.get_or_init(|| found))
    }
}

/// [`base_parameters_at`] with what is known already.
pub(crate) fn base_parameters_with(
    mechanism: &Mechanism,
    options: &Options,
    samples: &Samples,
    facts: &Facts,
) -> Result<BaseParameters, BaseError> {
    match options.engine {
        Engine::Exact if mechanism.is_affine() => {
            by_elimination(mechanism, options, samples, facts)
        }
        Engine::Exact | Engine::Precise => by_precision(mechanism, options, samples, facts),
        Engine::Qr | Engine::Qrii | Engine::Svd => by_factorisation(mechanism, options, samples),
    }
}

/// Gautier's three steps in floats.
fn by_factorisation(
    mechanism: &Mechanism,
    options: &Options,
    samples: &Samples,
) -> Result<BaseParameters, BaseError> {
    let space = mechanism.parameters();
    let observation = observe(mechanism, options.model, samples)?;
    let no_effect = observation.without_effect();
    let order = options.choice.order(&space, &observation.with_effect())?;
    let w = observation.w.select_columns(&order);
    check_rows(&w)?;
    let finding = decide(&w, options)?;
    let (base, regrouped, beta) = in_column_order(&order, &finding);
    let fresh = residual_at_fresh_samples(mechanism, options, &base, &regrouped, &beta)?;
    let judgement = &finding.judgement;
    let columns = judgement.columns.iter().map(|&i| order[i]).collect();
    let diagnosis = Diagnosis::of(
        &judgement.decision,
        columns,
        options.engine == Engine::Svd,
        &space,
        &observation.effects,
        fresh,
    );
    Ok(BaseParameters::new(
        mechanism,
        options,
        observation.w.rows(),
        Classes::of(no_effect, base, regrouped, &beta, options.seed),
        beta,
        None,
        diagnosis,
    ))
}

/// The same three steps without a tolerance, the float engines as witnesses.
fn by_elimination(
    mechanism: &Mechanism,
    options: &Options,
    samples: &Samples,
    facts: &Facts,
) -> Result<BaseParameters, BaseError> {
    let observation = observe(mechanism, options.model, samples)?;
    let decide = |order: &[usize]| {
        Ok(decide_exactly(
            mechanism,
            options.model,
            order,
            options.seed,
        )?)
    };
    let exact = in_order(mechanism, options, &observation, decide, |d| {
        [d.kept.clone(), d.deleted.clone(), d.no_effect.clone()]
    })?;
    let (base, rows) = sorted(&exact.kept);
    let (regrouped, columns) = sorted(&exact.deleted);
    let mut effect = [base.as_slice(), &regrouped].concat();
    effect.sort_unstable();
    let w = observation.w.select_columns(&effect);
    check_rows(&w)?;
    let beta_exact: Vec<Vec<ExactNumber>> = rows
        .iter()
        .map(|&i| columns.iter().map(|&j| exact.beta[i][j].clone()).collect())
        .collect();
    let beta = Matrix::from_fn(base.len(), regrouped.len(), |i, j| {
        beta_exact[i][j].to_f64()
    });
    let fresh = residual_at_fresh_samples(mechanism, options, &base, &regrouped, &beta)?;
    let witnesses = witnesses(&w, &effect, &options.tolerance)?;
    let literal = facts.literal(mechanism, options, base.len())?;
    let tree = facts.nullspace(mechanism, options.seed)?;
    let opened = mechanism.closure.is_some();
    let diagnosis = Diagnosis::structural(&exact, tree, opened, &witnesses, literal, fresh);
    Ok(BaseParameters::new(
        mechanism,
        options,
        observation.w.rows(),
        Classes::of(
            exact.no_effect.clone(),
            base,
            regrouped,
            &beta,
            options.seed,
        ),
        beta,
        Some((exact, beta_exact)),
        diagnosis,
    ))
}

/// The same in pairs of doubles, the float engines as witnesses.
fn by_precision(
    mechanism: &Mechanism,
    options: &Options,
    samples: &Samples,
    facts: &Facts,
) -> Result<BaseParameters, BaseError> {
    let options = &Options {
        engine: Engine::Precise,
        ..options.clone()
    };
    let observation = observe(mechanism, options.model, samples)?;
    let decide = |order: &[usize]| decide_precisely(mechanism, options.model, order, options.seed);
    let precise = in_order(mechanism, options, &observation, decide, |d| {
        [d.kept.clone(), d.deleted.clone(), d.no_effect.clone()]
    })?;
    let (base, rows) = sorted(&precise.kept);
    let (regrouped, columns) = sorted(&precise.deleted);
    let mut effect = [base.as_slice(), &regrouped].concat();
    effect.sort_unstable();
    let w = observation.w.select_columns(&effect);
    check_rows(&w)?;
    let beta = Matrix::from_fn(base.len(), regrouped.len(), |i, j| {
        precise.beta[rows[i]][columns[j]]
    });
    let fresh = residual_at_fresh_samples(mechanism, options, &base, &regrouped, &beta)?;
    let witnesses = witnesses(&w, &effect, &options.tolerance)?;
    let literal = facts.literal(mechanism, options, base.len())?;
    let opened = mechanism.closure.is_some();
    let tree = opened.then(|| facts.nullspace(mechanism, options.seed));
    let tree = tree.transpose()?;
    let diagnosis = Diagnosis::precise(&precise, tree, &witnesses, literal, fresh);
    let no_effect = precise.no_effect;
    Ok(BaseParameters::new(
        mechanism,
        options,
        observation.w.rows(),
        Classes::of(no_effect, base, regrouped, &beta, options.seed),
        beta,
        None,
        diagnosis,
    ))
}

/// A decision in the order of the user's choice. QRII's own columns, which only floats
/// know, are put first and confirmed. `parts` gives a decision's kept, deleted and
/// effectless columns.
fn in_order<D>(
    mechanism: &Mechanism,
    options: &Options,
    observation: &Observation,
    decide: impl Fn(&[usize]) -> Result<D, BaseError>,
    parts: impl Fn(&D) -> [Vec<usize>; 3],
) -> Result<D, BaseError> {
    let space = mechanism.parameters();
    let all: Vec<usize> = (0..space.len()).collect();
    let order = options.choice.order(&space, &all)?;
    let decision = decide(&order)?;
    if options.choice != Choice::Pivoted {
        return Ok(decision);
    }
    let [kept, deleted, no_effect] = parts(&decision);
    let mut effect = [kept, deleted].concat();
    effect.sort_unstable();
    let w = equilibrate(&observation.w.select_columns(&effect)).0;
    let mut order: Vec<usize> = qrii(&w)?.permutation.iter().map(|&i| effect[i]).collect();
    order.extend(&no_effect);
    decide(&order)
}

/// What the float engines make of W, whose columns are the robot's `columns`: QRII first,
/// whose spectrum is shown.
fn witnesses(
    w: &Matrix,
    columns: &[usize],
    tolerance: &Tolerance,
) -> Result<Vec<(Engine, Judgement)>, BaseError> {
    let scaled = match tolerance {
        Tolerance::Paper { .. } => w.clone(),
        Tolerance::Relative { .. } => equilibrate(w).0,
    };
    [Engine::Qrii, Engine::Svd, Engine::Qr]
        .into_iter()
        .map(|engine| {
            let mut judgement = engine.rank(&scaled, tolerance)?;
            judgement.columns.iter_mut().for_each(|c| *c = columns[*c]);
            Ok((engine, judgement))
        })
        .collect()
}

/// The samples that give W `rows` rows, or by default at least `at_least`.
pub(crate) fn sample_count(
    mechanism: &Mechanism,
    model: Model,
    rows: Option<usize>,
    at_least: usize,
) -> Result<usize, BaseError> {
    let wanted = rows.unwrap_or(at_least);
    check_size(wanted, mechanism.parameters().len())?;
    let each = model.rows(mechanism.independent());
    Ok(match (rows, model) {
        (_, Model::H) => wanted + 1, // the first sample is the reference
        (None, _) => wanted.div_ceil(each).max(FEWEST_SAMPLES),
        (Some(_), _) => wanted.div_ceil(each),
    })
}

pub(crate) fn check_rows(w: &Matrix) -> Result<(), BaseError> {
    if w.rows() < w.cols() {
        return Err(BaseError::TooFewRows {
            rows: w.rows(),
            columns: w.cols(),
        });
    }
    Ok(())
}

/// Rank, choice and relations of W. The paper's tolerance judges W as it is; ours judges
/// it with columns scaled by powers of two, structural zeros being out already.
fn decide(w: &Matrix, options: &Options) -> Result<Finding, BaseError> {
    let pivoted = options.choice == Choice::Pivoted;
    let mut finding = match options.tolerance {
        Tolerance::Paper { .. } => options.engine.analyse(w, &options.tolerance, pivoted)?,
        Tolerance::Relative { .. } => {
            let (scaled, exponents) = equilibrate(w);
            let finding = options
                .engine
                .analyse(&scaled, &options.tolerance, pivoted)?;
            let deleted = complement(&finding.kept, w.cols());
            let back = |m: &Matrix| unscale_relations(m, &exponents, &finding.kept, &deleted);
            let relations = Relations {
                beta: back(&finding.relations.beta)?,
                bound: back(&finding.relations.bound)?,
            };
            Finding {
                relations,
                ..finding
            }
        }
    };
    finding.relations.clean();
    Ok(finding)
}

/// Kept and deleted columns as the robot numbers them, ascending, and beta to match.
fn in_column_order(order: &[usize], finding: &Finding) -> (Vec<usize>, Vec<usize>, Matrix) {
    let deleted = complement(&finding.kept, order.len());
    let at = |positions: &[usize]| positions.iter().map(|&p| order[p]).collect::<Vec<_>>();
    let (base, rows) = sorted(&at(&finding.kept));
    let (regrouped, columns) = sorted(&at(&deleted));
    let beta = &finding.relations.beta;
    let beta = Matrix::from_fn(base.len(), regrouped.len(), |i, j| {
        beta[(rows[i], columns[j])]
    });
    (base, regrouped, beta)
}

/// Columns ascending, and where each stood.
fn sorted(columns: &[usize]) -> (Vec<usize>, Vec<usize>) {
    let mut pairs: Vec<(usize, usize)> = columns.iter().copied().zip(0..).collect();
    pairs.sort_unstable();
    pairs.into_iter().unzip()
}

impl Classes {
    /// Base columns that stay as they are and those that others regroup into, by the
    /// paper's quick test K = beta N with random N, confirmed on the row.
    fn of(
        no_effect: Vec<usize>,
        base: Vec<usize>,
        regrouped: Vec<usize>,
        beta: &Matrix,
        seed: u64,
    ) -> Self {
        let mut random = SplitMix64::new(!seed);
        let n: Vec<f64> = (0..beta.cols()).map(|_| random.uniform(0.5, 1.0)).collect();
        let k = |i: usize| (0..beta.cols()).map(|j| beta[(i, j)] * n[j]).sum::<f64>();
        let row_is_zero = |i: usize| (0..beta.cols()).all(|j| beta[(i, j)] == 0.0);
        let (unchanged, regrouped_into): (Vec<usize>, Vec<usize>) =
            (0..base.len()).partition(|&i| k(i) == 0.0 && row_is_zero(i));
        Self {
            unchanged: unchanged.iter().map(|&i| base[i]).collect(),
            regrouped_into: regrouped_into.iter().map(|&i| base[i]).collect(),
            no_effect,
            base,
            regrouped,
        }
    }
}

/// The largest |W2 - W1 beta| at samples that decided nothing, relative to the column.
fn residual_at_fresh_samples(
    mechanism: &Mechanism,
    options: &Options,
    base: &[usize],
    regrouped: &[usize],
    beta: &Matrix,
) -> Result<f64, BaseError> {
    let samples = Samples::draw(mechanism, FEWEST_SAMPLES, options.seed.wrapping_add(0x5eed))?;
    let Observation { w, .. } = observe(mechanism, options.model, &samples)?;
    let (w1, w2) = (w.select_columns(base), w.select_columns(regrouped));
    let explained = w1.matmul(beta)?;
    let worst = (0..w2.cols()).map(|j| {
        let norm = w2.col(j).iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let miss = w2.col(j).iter().zip(explained.col(j));
        let miss = miss.fold(0.0_f64, |m, (x, y)| m.max((x - y).abs()));
        if miss == 0.0 { 0.0 } else { miss / norm }
    });
    Ok(worst.fold(0.0, f64::max))
}
