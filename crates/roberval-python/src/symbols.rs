//! Relations in symbols and generated code, as Python reads them.

use std::str::FromStr;

use pyo3::prelude::*;
use roberval_base::{BaseParameters, Choice, Model, robot_sha256};
use roberval_code::{Code, Language, Request, What};
use roberval_mechanism::Mechanism;
use roberval_symbolic::{Naming, Route, SymbolicOptions, SymbolicRelations, symbolic_relations};
use roberval_tables::{self as tables};

use crate::calls::interruptible;
use crate::errors::raise;
use crate::options::rendering;

/// The relations of a robot in symbols.
#[pyclass(frozen, module = "roberval._core")]
pub struct Symbolic {
    answer: SymbolicRelations,
}

impl Symbolic {
    /// Finds them with the choice of an answer.
    pub fn of(py: Python<'_>, answer: &BaseParameters, all: bool) -> PyResult<Self> {
        let order = match answer.choice {
            Choice::Paper => None,
            _ => answer.decision.as_ref().map(|d| d.order.clone()),
        };
        let options = SymbolicOptions {
            model: answer.model,
            naming: naming(all),
            order,
            seed: answer.seed,
            ..SymbolicOptions::default()
        };
        Self::found(py, answer.mechanism.clone(), options)
    }

    /// Finds those of the closed-form rules alone.
    pub fn by_rules(py: Python<'_>, mechanism: &Mechanism, all: bool) -> PyResult<Self> {
        let options = SymbolicOptions {
            route: Route::RulesAlone,
            naming: naming(all),
            ..SymbolicOptions::default()
        };
        Self::found(py, mechanism.clone(), options)
    }

    fn found(py: Python<'_>, mechanism: Mechanism, options: SymbolicOptions) -> PyResult<Self> {
        let answer = interruptible(py, move || symbolic_relations(&mechanism, &options))?;
        Ok(Self { answer })
    }
}

fn naming(all: bool) -> Naming {
    match all {
        true => Naming::All,
        false => Naming::Auto,
    }
}

#[pymethods]
impl Symbolic {
    fn render(&self, py: Python<'_>, format: &str) -> PyResult<String> {
        let format = rendering(py, format)?;
        Ok(tables::symbolic(&self.answer, format))
    }

    /// A Python module for SymPy.
    fn sympy(&self) -> String {
        tables::sympy(&self.answer)
    }
}

/// Text, function name, joints, parameters, shape and counts of generated code, whether
/// it takes G, and how many numbers q and qd have.
pub type CodeRow = (
    String,
    String,
    Vec<String>,
    Vec<String>,
    Vec<usize>,
    [usize; 3],
    [usize; 3],
    bool,
    (usize, usize),
);

/// The code of an answer's robot.
pub fn code(
    py: Python<'_>,
    answer: &BaseParameters,
    (language, what): (&str, &str),
    standard: bool,
    friction: bool,
) -> PyResult<CodeRow> {
    let refuse = |error: String| raise(py, "OptionError", &error);
    let language = Language::from_str(language).map_err(|e| refuse(e.to_string()))?;
    let what = What::from_str(what).map_err(|e| refuse(e.to_string()))?;
    let all: Vec<usize> = (0..answer.parameters.len()).collect();
    let request = Request {
        what,
        columns: if standard { &all } else { &answer.base },
        // Of torques at rest or of other models more than of the dynamic model has none.
        no_effect: match answer.model {
            Model::D => &answer.no_effect,
            _ => &[],
        },
        friction,
    };
    let code = Code::new(&answer.mechanism, &request).map_err(|e| refuse(e.to_string()))?;
    let hash = robot_sha256(&answer.mechanism).map_err(|e| refuse(e.to_string()))?;
    let count = |c: roberval_code::Count| [c.mul, c.add, c.trig];
    let text = py.detach(|| code.text(language, &hash));
    Ok((
        text,
        code.function(),
        code.joints.iter().map(|(name, _)| name.clone()).collect(),
        code.parameters.clone(),
        code.shape(),
        count(code.count()),
        count(code.count_once()),
        code.takes_transmission(),
        (code.positions(), code.velocities()),
    ))
}
