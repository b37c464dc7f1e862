//! A robot: its description and its regressor.

use std::sync::Arc;

use numpy::{PyArray1, PyReadonlyArrayDyn};
use pyo3::prelude::*;
use roberval_base::{base_parameters, base_parameters_at, compare};
use roberval_formats::{
    self as formats, FormatError, UrdfOptions, load_with, parse_toml, parse_urdf, to_toml, to_urdf,
};
use roberval_mechanism::{Couple, Mechanism, RobotDescription, SourceFormat};
use roberval_regressor::{Model, Regressor, RegressorError, States, Writing};
use roberval_tables as tables;

use crate::answer::{Answer, Comparison};
use crate::calls::{detached, interruptible};
use crate::errors::IntoPython;
use crate::options::{self, OptionArguments, Reading, rendering};
use crate::scaling::{self, Scaling, ScalingArguments};
use crate::states::{PlainStates, StateArrays, Target, finite, output};
use crate::symbols::Symbolic;

/// A robot, immutable.
#[pyclass(frozen, module = "roberval._core")]
pub struct Robot {
    /// A URDF's text, for pickling; robot TOML can be written anew.
    urdf: Option<String>,
    /// Shared with the threads of long calls.
    mechanism: Arc<Mechanism>,
    regressor: Regressor,
    /// The X of the robot file.
    standard: Option<Vec<f64>>,
}

/// A choice of columns, made ready.
#[pyclass(frozen, module = "roberval._core")]
pub struct Columns(roberval_regressor::Columns);

/// Name, joint name, antecedent, kind, active, rotor of a link.
type CoupleRow = (String, Vec<(String, String)>, String, Option<String>);

type LinkRow = (
    String,
    Option<String>,
    Option<String>,
    &'static str,
    bool,
    bool,
);

/// Rotation (rows) and origin on the antecedent, and the joint's axis.
type Placement = ([[f64; 3]; 3], [f64; 3], [f64; 3]);

#[pymethods]
impl Robot {
    /// A built-in robot by name, or a robot file.
    #[staticmethod]
    fn load(py: Python<'_>, path_or_name: &str, reading: Reading) -> PyResult<Self> {
        let options = UrdfOptions {
            keep_fixed: reading.keep_fixed,
            floating: reading.floating,
        };
        let description = detached(py, || load_with(path_or_name, options))?;
        let urdf = match description.format {
            SourceFormat::Mdh | SourceFormat::Placed => None,
            SourceFormat::Urdf => Some(std::fs::read_to_string(path_or_name)?),
        };
        Self::of(py, description, urdf, &reading)
    }

    /// A robot from the text of a robot TOML.
    #[staticmethod]
    fn from_toml(py: Python<'_>, text: &str, source: &str, reading: Reading) -> PyResult<Self> {
        let description = detached(py, || parse_toml(text, source))?;
        Self::of(py, description, None, &reading)
    }

    /// As `from_toml` for a text that no user has seen: errors without line numbers.
    #[staticmethod]
    fn from_rows(py: Python<'_>, text: &str, source: &str, reading: Reading) -> PyResult<Self> {
        let description = detached(py, || {
            parse_toml(text, source).map_err(|error| FormatError {
                position: None,
                ..error
            })
        })?;
        Self::of(py, description, None, &reading)
    }

    /// A robot from the text of a URDF.
    #[staticmethod]
    fn from_urdf(py: Python<'_>, text: &str, source: &str, reading: Reading) -> PyResult<Self> {
        let options = UrdfOptions {
            keep_fixed: reading.keep_fixed,
            floating: reading.floating,
        };
        let description = detached(py, || parse_urdf(text, source, options))?;
        Self::of(py, description, Some(text.to_owned()), &reading)
    }

    /// The robot as written, or with its rounded numbers set right.
    fn to_toml(&self, py: Python<'_>, cleaned: bool) -> PyResult<String> {
        let description = if cleaned {
            &self.mechanism.description
        } else {
            self.written()
        };
        to_toml(description).map_err(|error| error.into_python(py))
    }

    /// The robot as a URDF.
    fn to_urdf(&self, py: Python<'_>) -> PyResult<String> {
        to_urdf(&self.mechanism).map_err(|error| error.into_python(py))
    }

    /// Format, text and name, from which the robot can be read again.
    fn state(&self, py: Python<'_>) -> PyResult<(&'static str, String, &str)> {
        let name = self.mechanism.name.as_str();
        Ok(match &self.urdf {
            Some(text) => ("urdf", text.clone(), name),
            None => ("toml", self.to_toml(py, false)?, name),
        })
    }

    /// Whether two robots are the same, literal by literal, as written and as understood.
    fn same(&self, other: &Self) -> bool {
        self.written() == other.written()
            && self.mechanism.description == other.mechanism.description
    }

    /// Numbers of the robot file that were set right, in sentences.
    #[getter]
    fn changes(&self) -> Vec<String> {
        let cleaning = self.mechanism.cleaning.iter();
        cleaning
            .flat_map(|c| c.cleaned.changes.iter().map(ToString::to_string))
            .collect()
    }

    /// Numbers that look rounded and were left alone, in sentences.
    #[getter]
    fn near_misses(&self) -> Vec<String> {
        let cleaning = self.mechanism.cleaning.iter();
        cleaning
            .flat_map(|c| c.cleaned.near_misses.iter().map(ToString::to_string))
            .collect()
    }

    fn render(&self, py: Python<'_>, format: &str) -> PyResult<String> {
        let format = rendering(py, format)?;
        Ok(tables::show(&self.mechanism, format))
    }

    #[getter]
    fn name(&self) -> &str {
        &self.mechanism.name
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.mechanism.description.warnings.clone()
    }

    #[getter]
    fn gravity(&self) -> [f64; 3] {
        self.mechanism.gravity.into()
    }

    /// Number of independent variables.
    #[getter]
    fn dof(&self) -> usize {
        self.regressor.independent()
    }

    /// Joint, the joints it follows with their multipliers, offset, expression.
    #[getter]
    fn couples(&self) -> Vec<CoupleRow> {
        let description = &self.mechanism.description;
        let label = |name: &str| {
            let link = description.links.iter().position(|l| l.name == name);
            link.map_or(name, |l| description.joint_label(l)).to_owned()
        };
        let row = |couple: &Couple| {
            let terms = couple.terms.iter();
            let terms = terms.map(|t| (label(&t.joint), t.multiplier.text.clone()));
            (
                label(&couple.joint),
                terms.collect(),
                couple.offset.text.clone(),
                couple.expression.as_ref().map(|e| e.text.clone()),
            )
        };
        description.couples.iter().map(row).collect()
    }

    #[getter]
    fn positions(&self) -> usize {
        self.regressor.positions()
    }

    /// The coordinates of q, of qd and the rows of d.
    #[getter]
    fn coordinates(&self) -> [Vec<String>; 3] {
        [
            self.mechanism.position_names(),
            self.mechanism.velocity_names(),
            self.mechanism.row_names(),
        ]
    }

    #[getter]
    fn links(&self) -> Vec<LinkRow> {
        let links = &self.mechanism.links;
        links
            .iter()
            .map(|link| {
                (
                    link.name.clone(),
                    link.joint_name.clone(),
                    link.antecedent.map(|a| links[a].name.clone()),
                    link.joint.name(),
                    link.active,
                    link.rotor,
                )
            })
            .collect()
    }

    /// Of each link: rotation (rows) and origin on its antecedent at joint variable 0, and
    /// the joint's axis in the link's frame.
    #[getter]
    fn placements(&self) -> Vec<Placement> {
        let links = self.mechanism.links.iter();
        links
            .map(|l| {
                let rows = l.rotation.transpose().into();
                (rows, l.origin.into(), l.axis.into())
            })
            .collect()
    }

    /// The labels of the C columns.
    #[getter]
    fn labels(&self) -> Vec<String> {
        self.regressor.parameters().labels().to_vec()
    }

    /// For each column, whether the robot file gives its value.
    #[getter]
    fn known(&self) -> Vec<bool> {
        let ids = self.regressor.parameters().ids();
        ids.iter()
            .map(|id| self.mechanism.links[id.link].inertia[id.kind as usize].is_some())
            .collect()
    }

    /// X, C numbers; None where the file gives no value at all.
    fn standard_parameters<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        let x = self.standard.as_ref()?;
        Some(PyArray1::from_slice(py, x))
    }

    /// Some columns of a model, made ready for many calls.
    fn columns(&self, py: Python<'_>, model: &str, columns: Vec<usize>) -> PyResult<Columns> {
        let model = options::model(py, model)?;
        Ok(Columns(self.regressor.columns(model, &columns)))
    }

    /// Rows of d, d0 or h into `out`: all columns, or those made ready. False, and nothing
    /// done, if an array is not plain or does not fit (see `PlainStates::of`).
    #[allow(clippy::too_many_arguments)] // the signature is Python's
    fn regressor<'py>(
        &self,
        py: Python<'py>,
        model: &str,
        columns: Option<&Columns>,
        q: &Bound<'py, PyAny>,
        qd: &Bound<'py, PyAny>,
        qdd: &Bound<'py, PyAny>,
        out: &Bound<'py, PyAny>,
        threads: Option<usize>,
        keep_zeros: bool,
    ) -> PyResult<bool> {
        let model = options::model(py, model)?;
        let columns = columns.map(|columns| &columns.0);
        let all = self.regressor.parameters().len();
        let width = columns.map_or(all, |columns| columns.columns().len());
        let rows = model.rows(self.regressor.independent());
        let shape: &[usize] = match model {
            Model::D | Model::D0 => &[rows, width],
            Model::H => &[width],
        };
        let check = |out: &[f64]| match keep_zeros {
            true => self.regressor.check_zeros(model, columns, out),
            false => Ok(()),
        };
        let tiles = Tiles {
            check: &check,
            shape: |lead: &[usize]| [lead, shape].concat(),
            size: rows * width,
            lanes: 1,
            threads,
        };
        self.fill(py, [q, qd, qdd], out, tiles, |states, out, past_cache| {
            let regressor = &self.regressor;
            let writing = Writing {
                past_cache,
                keep_zeros,
            };
            regressor.fill_part(model, columns, states, out, writing)
        })
    }

    /// The nonzeros in tiles into `out`. False as for the regressor.
    #[allow(clippy::too_many_arguments)] // the signature is Python's
    fn packed<'py>(
        &self,
        py: Python<'py>,
        model: &str,
        q: &Bound<'py, PyAny>,
        qd: &Bound<'py, PyAny>,
        qdd: &Bound<'py, PyAny>,
        out: &Bound<'py, PyAny>,
        threads: Option<usize>,
    ) -> PyResult<bool> {
        let model = options::model(py, model)?;
        let slots = self.regressor.packed_layout(model).entries().len();
        let lanes = self.regressor.lanes();
        let tiles = Tiles {
            check: &|_| Ok(()),
            shape: |lead: &[usize]| {
                let samples: usize = lead.iter().product();
                vec![samples.div_ceil(lanes), slots, lanes]
            },
            size: slots,
            lanes,
            threads,
        };
        self.fill(py, [q, qd, qdd], out, tiles, |states, out, past_cache| {
            let regressor = &self.regressor;
            regressor.fill_packed_part(model, states, out, past_cache)
        })
    }

    /// Row and column of each packed number, and how many samples a tile has.
    fn packed_layout(&self, py: Python<'_>, model: &str) -> PyResult<(Vec<[usize; 2]>, usize)> {
        let layout = self.regressor.packed_layout(options::model(py, model)?);
        let entries = layout.entries().iter().map(|&(row, column)| [row, column]);
        Ok((entries.collect(), self.regressor.lanes()))
    }

    /// Gamma = d X into `out` (N x n), by default with the X of the robot file. False as for
    /// the regressor, and if there is no X or it is not finite.
    #[allow(clippy::too_many_arguments)] // the signature is Python's
    fn torques<'py>(
        &self,
        py: Python<'py>,
        x: Option<&Bound<'py, PyAny>>,
        q: &Bound<'py, PyAny>,
        qd: &Bound<'py, PyAny>,
        qdd: &Bound<'py, PyAny>,
        out: &Bound<'py, PyAny>,
        threads: Option<usize>,
    ) -> PyResult<bool> {
        let x = match x {
            Some(x) => finite(x, self.regressor.parameters().len()),
            None => self.standard.clone(),
        };
        let Some(x) = x else { return Ok(false) };
        let m = self.regressor.independent();
        let tiles = Tiles {
            check: &|_| Ok(()),
            shape: |lead: &[usize]| [lead, &[m]].concat(),
            size: m,
            lanes: 1,
            threads,
        };
        self.fill(py, [q, qd, qdd], out, tiles, |states, out, _| {
            self.regressor.torques(&x, states, out)
        })
    }

    /// The states of all joints of the tree, N x n numbers each.
    fn expand<'py>(
        &self,
        py: Python<'py>,
        q: PyReadonlyArrayDyn<'_, f64>,
        qd: PyReadonlyArrayDyn<'_, f64>,
        qdd: PyReadonlyArrayDyn<'_, f64>,
    ) -> PyResult<Vec<Bound<'py, PyArray1<f64>>>> {
        let samples = StateArrays { q, qd, qdd }.all()?.into_samples();
        let all = detached(py, || self.regressor.expand(samples.states()))?;
        Ok(all.into_iter().map(|x| PyArray1::from_vec(py, x)).collect())
    }

    /// The loops: their sides and the joint that was cut.
    #[getter]
    fn loops(&self) -> Vec<([String; 2], &'static str)> {
        let loops = self.mechanism.description.loops.iter();
        let side = |side: &Option<String>| side.clone().unwrap_or_else(|| "base".to_owned());
        loops
            .map(|l| (l.between.each_ref().map(side), l.cut.name()))
            .collect()
    }

    /// A closed configuration of all joints, which names the branch.
    #[getter]
    fn closed(&self) -> Option<Vec<f64>> {
        let assembly = self.mechanism.assembly.as_ref()?;
        Some(assembly.start.clone())
    }

    /// The base parameters, at random samples or at those given.
    #[pyo3(signature = (options, q=None, qd=None, qdd=None))]
    fn base_parameters(
        &self,
        py: Python<'_>,
        options: OptionArguments,
        q: Option<PyReadonlyArrayDyn<'_, f64>>,
        qd: Option<PyReadonlyArrayDyn<'_, f64>>,
        qdd: Option<PyReadonlyArrayDyn<'_, f64>>,
    ) -> PyResult<Answer> {
        let options = options.check(py)?;
        let mechanism = Arc::clone(&self.mechanism);
        let answer = match (q, qd, qdd) {
            (Some(q), Some(qd), Some(qdd)) => {
                let samples = StateArrays { q, qd, qdd }.all()?.into_samples();
                interruptible(py, move || {
                    base_parameters_at(&mechanism, &options, &samples)
                })?
            }
            _ => interruptible(py, move || base_parameters(&mechanism, &options))?,
        };
        Ok(Answer::new(answer))
    }

    /// Samples that scale W.
    fn scale(&self, py: Python<'_>, options: ScalingArguments) -> PyResult<Scaling> {
        scaling::search(py, &self.mechanism, options)
    }

    /// What the closed-form rules alone say, in symbols.
    fn rules(&self, py: Python<'_>, all: bool) -> PyResult<Symbolic> {
        Symbolic::by_rules(py, &self.mechanism, all)
    }

    /// All models by all engines.
    fn compare(&self, py: Python<'_>, options: OptionArguments) -> PyResult<Comparison> {
        let options = options.check(py)?;
        let mechanism = Arc::clone(&self.mechanism);
        interruptible(py, move || {
            compare(&mechanism, &options.choice, options.tolerance, options.seed)
        })
        .map(Comparison::new)
    }
}

/// How the numbers of a call lie in its target.
struct Tiles<'a, S> {
    /// Looks at all of the target before anything is written.
    check: &'a dyn Fn(&[f64]) -> Result<(), RegressorError>,
    /// The target's shape, from what stands before the coordinates in that of q.
    shape: S,
    /// Numbers of one sample.
    size: usize,
    /// Samples that stand together.
    lanes: usize,
    /// All cores if none is given.
    threads: Option<usize>,
}

impl Robot {
    /// Fills `out`, or does nothing and says so where an array is not plain or does not fit.
    fn fill<'py>(
        &self,
        py: Python<'py>,
        states: [&Bound<'py, PyAny>; 3],
        out: &Bound<'py, PyAny>,
        tiles: Tiles<'_, impl Fn(&[usize]) -> Vec<usize>>,
        fill: impl Fn(States<'_>, &mut [f64], bool) -> Result<(), RegressorError> + Sync,
    ) -> PyResult<bool> {
        let regressor = &self.regressor;
        let widths = (regressor.positions(), regressor.independent());
        let Some(states) = PlainStates::of(states, widths.0, widths.1) else {
            return Ok(false);
        };
        let Some(out) = output(out, &(tiles.shape)(states.lead())) else {
            return Ok(false);
        };
        let target = Target {
            out,
            check: tiles.check,
            size: tiles.size,
            tile: tiles.lanes,
            slow: regressor.expansion().is_some(),
            threads: tiles.threads,
        };
        states.fill(py, &target, fill)
    }

    fn of(
        py: Python<'_>,
        description: RobotDescription,
        urdf: Option<String>,
        reading: &Reading,
    ) -> PyResult<Self> {
        let mechanism = reading.mechanism(py, description)?;
        Ok(Self {
            urdf,
            regressor: Regressor::new(&mechanism),
            standard: mechanism.standard_parameters(),
            mechanism: Arc::new(mechanism),
        })
    }

    /// The robot as understood.
    pub fn mechanism(&self) -> &Mechanism {
        &self.mechanism
    }

    /// The regressor over floats.
    pub fn float_regressor(&self) -> &Regressor {
        &self.regressor
    }

    /// The description before anything was set right.
    fn written(&self) -> &RobotDescription {
        match &self.mechanism.cleaning {
            Some(cleaning) => &cleaning.written,
            None => &self.mechanism.description,
        }
    }
}

/// The text of a robot file with its rounded numbers set right; what was changed, and what
/// was left alone, in sentences.
#[pyfunction]
pub fn clean_file(
    py: Python<'_>,
    path_or_name: &str,
    snap: &str,
) -> PyResult<(String, Vec<String>, Vec<String>)> {
    let policy = options::policy(py, snap)?;
    let (text, changes, near) = detached(py, || formats::clean_file(path_or_name, &policy))?;
    let changed = changes.iter().filter(|change| !change.is_last_digit());
    Ok((
        text,
        changed.map(ToString::to_string).collect(),
        near.iter().map(ToString::to_string).collect(),
    ))
}

/// Name, title and source of each built-in robot.
#[pyfunction]
pub fn catalogue() -> Vec<(&'static str, &'static str, &'static str)> {
    roberval_formats::catalogue()
        .iter()
        .map(|entry| (entry.name, entry.title, entry.source))
        .collect()
}
