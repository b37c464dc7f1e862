use roberval_linalg::Tolerance;
use roberval_mechanism::Mechanism;
use roberval_regressor::Model;

use crate::method::{Facts, base_parameters_with, random_samples};
use crate::{BaseError, BaseParameters, Choice, Engine, Options};

/// Two routes' coefficients are the same if they differ by less than this, relative to
/// the largest: far above rounding (1e-12), far below any length of a robot.
const SAME_BETA: f64 = 1e-8;

/// One model analysed by one engine.
#[derive(Debug, Clone)]
pub struct Route {
    /// What this route found.
    pub answer: BaseParameters,
    /// Whether it has the first route's no-effect, base and regrouped columns.
    pub same_columns: bool,
    /// Largest difference to the first route's beta, relative to its largest entry;
    /// infinite if the columns differ.
    pub beta_difference: f64,
}

/// All models by all engines.
#[derive(Debug, Clone)]
pub struct Comparison {
    /// The routes, model by model.
    pub routes: Vec<Route>,
    /// The routes that gave no answer, and why: nearly singular robots do this.
    pub failures: Vec<Failure>,
    /// Whether all give one answer, and none is in doubt.
    pub agree: bool,
}

/// A route without an answer.
#[derive(Debug, Clone)]
pub struct Failure {
    /// The model.
    pub model: Model,
    /// The engine.
    pub engine: Engine,
    /// Why.
    pub error: BaseError,
}

/// Runs all models and engines on the same seed and tells whether they agree.
///
/// # Errors
/// Those of [`crate::base_parameters`], but for failed factorisations: these are told in the result.
pub fn compare(
    mechanism: &Mechanism,
    choice: &Choice,
    tolerance: Tolerance,
    seed: u64,
) -> Result<Comparison, BaseError> {
    let mut routes: Vec<Route> = Vec::new();
    let mut failures = Vec::new();
    let facts = Facts::default();
    for model in Model::ALL {
        for engine in engines(mechanism) {
            let options = Options {
                model,
                engine,
                choice: choice.clone(),
                tolerance,
                seed,
                rows: None,
            };
            let samples = random_samples(mechanism, &options)?;
            let answer = match base_parameters_with(mechanism, &options, &samples, &facts) {
                Ok(answer) => answer,
                Err(error @ BaseError::Linalg(_)) => {
                    failures.push(Failure {
                        model,
                        engine,
                        error,
                    });
                    continue;
                }
                Err(error) => return Err(error),
            };
            let first = routes.first().map_or(&answer, |r| &r.answer);
            let same_columns = same_columns(first, &answer);
            let beta_difference = if same_columns {
                beta_difference(first, &answer)
            } else {
                f64::INFINITY
            };
            routes.push(Route {
                answer,
                same_columns,
                beta_difference,
            });
        }
    }
    let same = |r: &Route| r.same_columns && r.beta_difference <= SAME_BETA;
    let agree = failures.is_empty() && routes.iter().all(|r| same(r) && r.answer.diagnosis.clear);
    Ok(Comparison {
        routes,
        failures,
        agree,
    })
}

/// The engines that differ for this mechanism: the exact one, or else pairs of doubles.
fn engines(mechanism: &Mechanism) -> Vec<Engine> {
    let skipped = if mechanism.is_affine() {
        Engine::Precise
    } else {
        Engine::Exact
    };
    let all = Engine::ALL.into_iter();
    all.filter(|engine| *engine != skipped).collect()
}

fn same_columns(a: &BaseParameters, b: &BaseParameters) -> bool {
    a.no_effect == b.no_effect && a.base == b.base && a.regrouped == b.regrouped
}

fn beta_difference(a: &BaseParameters, b: &BaseParameters) -> f64 {
    let pairs = a.beta.as_slice().iter().zip(b.beta.as_slice());
    let difference = pairs.fold(0.0_f64, |m, (x, y)| m.max((x - y).abs()));
    if difference == 0.0 {
        0.0
    } else {
        difference / a.beta.max_abs()
    }
}
