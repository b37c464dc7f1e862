//! The options of an analysis as Python writes them.

use pyo3::prelude::*;
use roberval_base::{Choice, Engine, Model, Options, PAPER_EPS_VAX, Tolerance};

use roberval_mechanism::{CleanMode, CleanPolicy, Mechanism, RobotDescription};
use roberval_scalar::Quantity;
use roberval_tables::Format;

use crate::errors::{IntoPython, raise};

/// When a number counts as zero: a ratio, or a rule by name.
#[derive(FromPyObject)]
enum ToleranceArgument {
    Ratio(f64),
    Name(String),
}

/// Model d, d0 or h.
pub fn model(py: Python<'_>, name: &str) -> PyResult<Model> {
    Model::ALL
        .into_iter()
        .find(|model| model.name() == name)
        .ok_or_else(|| refuse(py, "model", name, &Model::ALL.map(Model::name)))
}

fn engine(py: Python<'_>, name: &str) -> PyResult<Engine> {
    Engine::ALL
        .into_iter()
        .find(|engine| engine.name() == name)
        .ok_or_else(|| refuse(py, "engine", name, &Engine::ALL.map(Engine::name)))
}

/// The paper's choice unless another is named; lists to keep or drop mean `prefer`.
fn choice(
    py: Python<'_>,
    name: Option<&str>,
    keep: Vec<String>,
    drop: Vec<String>,
) -> PyResult<Choice> {
    let lists = !keep.is_empty() || !drop.is_empty();
    match name {
        None if lists => Ok(Choice::Prefer { keep, drop }),
        Some("prefer") => Ok(Choice::Prefer { keep, drop }),
        Some(name @ ("paper" | "pivoted")) if lists => {
            let message = format!("keep and drop go with choice \"prefer\", not with \"{name}\"");
            Err(raise(py, "OptionError", &message))
        }
        None | Some("paper") => Ok(Choice::Paper),
        Some("pivoted") => Ok(Choice::Pivoted),
        Some(other) => Err(refuse(py, "choice", other, &["paper", "pivoted", "prefer"])),
    }
}

fn tolerance(py: Python<'_>, argument: Option<ToleranceArgument>) -> PyResult<Tolerance> {
    match argument {
        None => Ok(Tolerance::default()),
        Some(ToleranceArgument::Ratio(dependent)) if dependent > 0.0 && dependent < 1.0 => {
            let Tolerance::Relative { independent, .. } = Tolerance::default() else {
                return Ok(Tolerance::default());
            };
            Ok(Tolerance::Relative {
                dependent,
                independent: independent.max(dependent),
            })
        }
        Some(ToleranceArgument::Ratio(other)) => {
            let message = format!("tolerance is {other}, expected a ratio between 0 and 1");
            Err(raise(py, "OptionError", &message))
        }
        Some(ToleranceArgument::Name(name)) => match name.as_str() {
            "paper" => Ok(Tolerance::Paper { eps: PAPER_EPS_VAX }),
            "paper-ieee" => Ok(Tolerance::Paper { eps: f64::EPSILON }),
            other => Err(refuse(py, "tolerance", other, &["paper", "paper-ieee"])),
        },
    }
}

/// How a robot file is read.
#[derive(Clone, FromPyObject)]
#[pyo3(from_item_all)]
pub struct Reading {
    pub keep_fixed: bool,
    pub floating: bool,
    rotors: bool,
    snap: String,
    gravity: Option<[String; 3]>,
}

impl Reading {
    /// The mechanism of a description: gravity put in, rounded numbers set right.
    pub fn mechanism(
        &self,
        py: Python<'_>,
        mut description: RobotDescription,
    ) -> PyResult<Mechanism> {
        if self.floating {
            description = description.with_floating_base();
        }
        if !self.rotors {
            description = description.without_rotors();
        }
        if let Some(gravity) = &self.gravity {
            for (place, text) in description.gravity.iter_mut().zip(gravity) {
                *place = Quantity::parse_number(text, &description.constants).map_err(|error| {
                    raise(py, "OptionError", &format!("gravity has {text:?}: {error}"))
                })?;
            }
        }
        let policy = policy(py, &self.snap)?;
        Mechanism::cleaned(&description, &policy).map_err(|error| error.into_python(py))
    }
}

/// How rounded numbers are treated.
pub fn policy(py: Python<'_>, name: &str) -> PyResult<CleanPolicy> {
    Ok(CleanPolicy {
        mode: snap(py, name)?,
        ..CleanPolicy::default()
    })
}

fn snap(py: Python<'_>, name: &str) -> PyResult<CleanMode> {
    match name {
        "default" => Ok(CleanMode::Default),
        "off" => Ok(CleanMode::Off),
        "aggressive" => Ok(CleanMode::Aggressive),
        other => Err(refuse(py, "snap", other, &["default", "off", "aggressive"])),
    }
}

/// Who a table is for.
pub fn rendering(py: Python<'_>, name: &str) -> PyResult<Format> {
    name.parse()
        .map_err(|_| refuse(py, "format", name, &Format::ALL.map(Format::name)))
}

/// All options of an analysis.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct OptionArguments {
    model: String,
    engine: Option<String>,
    choice: Option<String>,
    keep: Vec<String>,
    drop: Vec<String>,
    seed: u64,
    rows: Option<usize>,
    tolerance: Option<ToleranceArgument>,
}

impl OptionArguments {
    pub fn check(self, py: Python<'_>) -> PyResult<Options> {
        Ok(Options {
            model: model(py, &self.model)?,
            engine: match self.engine {
                None => Engine::default(),
                Some(name) => engine(py, &name)?,
            },
            choice: choice(py, self.choice.as_deref(), self.keep, self.drop)?,
            tolerance: tolerance(py, self.tolerance)?,
            seed: self.seed,
            rows: self.rows,
        })
    }
}

fn refuse(py: Python<'_>, what: &str, found: &str, allowed: &[&str]) -> PyErr {
    let allowed: Vec<String> = allowed.iter().map(|name| format!("{name:?}")).collect();
    let message = format!(
        "{what} is {found:?}, expected one of {}",
        allowed.join(", ")
    );
    raise(py, "OptionError", &message)
}
