use roberval_linalg::{Matrix, Relations, Tolerance, equilibrate, unscale_relations};
use roberval_mechanism::Mechanism;
use roberval_regressor::Model;
use roberval_scalar::SplitMix64;

use crate::engine::{Finding, complement};
use crate::observation::check_size;
use crate::result::{Classes, Diagnosis};
use crate::{BaseError, BaseParameters, Choice, Engine, Observation, Samples, observe};

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
    let space = mechanism.parameters();
    let count = sample_count(mechanism, options.model, options.rows, 2 * space.len())?;
    let samples = Samples::draw(mechanism, count, options.seed);
    base_parameters_at(mechanism, options, &samples)
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
    let space = mechanism.parameters();
    let observation = observe(mechanism, options.model, samples)?;
    let no_effect = observation.without_effect();
    let order = options.choice.order(&space, &observation.with_effect())?;
    let w = observation.w.select_columns(&order);
    check_rows(&w)?;
    let finding = decide(&w, options)?;
    let (base, regrouped, beta) = in_column_order(&order, &finding);
    let classes = classify(&base, &beta, options.seed);
    let fresh = residual_at_fresh_samples(mechanism, options, &base, &regrouped, &beta)?;
    let diagnosis = Diagnosis::of(&finding.decision, &order, &space, fresh);
    Ok(BaseParameters::new(
        mechanism,
        options,
        observation.w.rows(),
        Classes {
            no_effect,
            base,
            regrouped,
            unchanged: classes.0,
            regrouped_into: classes.1,
        },
        beta,
        diagnosis,
    ))
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
    let each = model.rows(mechanism.dof());
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
    let (base, rows) = sorted(order, &finding.kept);
    let (regrouped, columns) = sorted(order, &deleted);
    let beta = &finding.relations.beta;
    let beta = Matrix::from_fn(base.len(), regrouped.len(), |i, j| {
        beta[(rows[i], columns[j])]
    });
    (base, regrouped, beta)
}

/// The robot's columns at `positions`, ascending, and where each stood in `positions`.
fn sorted(order: &[usize], positions: &[usize]) -> (Vec<usize>, Vec<usize>) {
    let mut pairs: Vec<(usize, usize)> = positions
        .iter()
        .enumerate()
        .map(|(place, &p)| (order[p], place))
        .collect();
    pairs.sort_unstable();
    pairs.into_iter().unzip()
}

/// Base columns that stay as they are and those that others regroup into, by the
/// paper's quick test K = beta N with random N, confirmed on the row.
fn classify(base: &[usize], beta: &Matrix, seed: u64) -> (Vec<usize>, Vec<usize>) {
    let mut random = SplitMix64::new(!seed);
    let n: Vec<f64> = (0..beta.cols()).map(|_| random.uniform(0.5, 1.0)).collect();
    let row_is_zero = |i: usize| (0..beta.cols()).all(|j| beta[(i, j)] == 0.0);
    let k_is_zero = |i: usize| (0..beta.cols()).map(|j| beta[(i, j)] * n[j]).sum::<f64>() == 0.0;
    let (mut unchanged, mut regrouped_into) = (Vec::new(), Vec::new());
    for (i, &column) in base.iter().enumerate() {
        if k_is_zero(i) && row_is_zero(i) {
            unchanged.push(column);
        } else {
            regrouped_into.push(column);
        }
    }
    (unchanged, regrouped_into)
}

/// The largest |W2 - W1 beta| at samples that decided nothing, relative to the column.
fn residual_at_fresh_samples(
    mechanism: &Mechanism,
    options: &Options,
    base: &[usize],
    regrouped: &[usize],
    beta: &Matrix,
) -> Result<f64, BaseError> {
    let samples = Samples::draw(mechanism, FEWEST_SAMPLES, options.seed.wrapping_add(0x5eed));
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
