//! Samples that scale W, as Python reads them.

use std::ops::ControlFlow;

use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use roberval_base::{self as base, Matrix, ScalingOptions, ScalingProgress, scale};
use roberval_mechanism::Mechanism;

use crate::calls::detached;
use crate::options::model;

/// The options of a search; what is None has the default of Rust.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct ScalingArguments {
    model: String,
    seed: u64,
    rows: Option<usize>,
    target: Option<f64>,
    starts: Option<usize>,
    rounds: Option<usize>,
    weights: Option<[f64; 2]>,
}

impl ScalingArguments {
    fn check(self, py: Python<'_>) -> PyResult<ScalingOptions> {
        let default = ScalingOptions::default();
        Ok(ScalingOptions {
            model: model(py, &self.model)?,
            seed: self.seed,
            rows: self.rows,
            target: self.target.unwrap_or(default.target),
            starts: self.starts.unwrap_or(default.starts),
            rounds: self.rounds.unwrap_or(default.rounds),
            weights: self.weights.unwrap_or(default.weights),
        })
    }
}

/// Searches with the GIL released; Ctrl-C is looked at before each small search.
pub fn search(
    py: Python<'_>,
    mechanism: &Mechanism,
    arguments: ScalingArguments,
) -> PyResult<Scaling> {
    let options = arguments.check(py)?;
    let mut signal = None;
    let result = detached(py, || {
        let progress = |_: ScalingProgress| match Python::attach(|py| py.check_signals()) {
            Ok(()) => ControlFlow::Continue(()),
            Err(error) => {
                signal = Some(error);
                ControlFlow::Break(())
            }
        };
        scale(mechanism, &options, progress)
    });
    match signal {
        Some(error) => Err(error),
        None => Ok(Scaling {
            positions: mechanism.positions(),
            dof: mechanism.independent(),
            scaling: result?,
        }),
    }
}

/// Samples, W at them and what they gain.
#[pyclass(frozen, module = "roberval._core")]
pub struct Scaling {
    positions: usize,
    dof: usize,
    scaling: base::Scaling,
}

/// S, ||W||_F, J, the rank by QRII and the gap.
type Grade = (f64, f64, f64, usize, Option<f64>);

#[pymethods]
impl Scaling {
    /// q, qd, qdd, each N x n (q of a floating robot N x (n + 1)).
    #[allow(clippy::type_complexity)] // three arrays
    fn samples<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(
        Bound<'py, PyArray2<f64>>,
        Bound<'py, PyArray2<f64>>,
        Bound<'py, PyArray2<f64>>,
    )> {
        let samples = &self.scaling.samples;
        let array = |values: &[f64], width: usize| {
            PyArray1::from_slice(py, values).reshape([samples.count, width])
        };
        Ok((
            array(&samples.q, self.positions)?,
            array(&samples.qd, self.dof)?,
            array(&samples.qdd, self.dof)?,
        ))
    }

    /// The c columns of W.
    #[getter]
    fn columns(&self) -> Vec<usize> {
        self.scaling.columns.clone()
    }

    /// W, r x c.
    fn w<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        matrix(py, &self.scaling.w)
    }

    /// S of each row alone.
    fn row_s<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.scaling.row_s)
    }

    #[getter]
    fn before(&self) -> Grade {
        grade(&self.scaling.before)
    }

    #[getter]
    fn after(&self) -> Grade {
        grade(&self.scaling.after)
    }
}

fn grade(grade: &base::Grade) -> Grade {
    (grade.s, grade.norm, grade.j, grade.rank, grade.gap)
}

/// A matrix as a C-ordered array.
pub fn matrix<'py>(py: Python<'py>, m: &Matrix) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let rows = (0..m.rows()).flat_map(|i| (0..m.cols()).map(move |j| m[(i, j)]));
    PyArray1::from_iter(py, rows).reshape([m.rows(), m.cols()])
}
