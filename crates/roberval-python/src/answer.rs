//! Base parameters and comparisons as Python reads them.

use std::sync::Arc;

use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1};
use pyo3::prelude::*;
use roberval_base::{self as base, BaseParameters};

use crate::errors::detached;
use crate::states::vector;

/// The base parameters of a robot, immutable. Columns are numbers into the robot's labels.
#[pyclass(frozen, module = "roberval._core")]
pub struct Answer {
    answer: Arc<BaseParameters>,
}

impl Answer {
    pub fn new(answer: BaseParameters) -> Self {
        Self {
            answer: Arc::new(answer),
        }
    }
}

#[pymethods]
impl Answer {
    #[getter]
    fn model(&self) -> &'static str {
        self.answer.model.name()
    }

    #[getter]
    fn engine(&self) -> &'static str {
        self.answer.engine.name()
    }

    #[getter]
    fn choice(&self) -> &'static str {
        self.answer.choice.name()
    }

    #[getter]
    fn seed(&self) -> u64 {
        self.answer.seed
    }

    #[getter]
    fn rows(&self) -> usize {
        self.answer.rows
    }

    #[getter]
    fn no_effect(&self) -> Vec<usize> {
        self.answer.no_effect.clone()
    }

    #[getter]
    fn base(&self) -> Vec<usize> {
        self.answer.base.clone()
    }

    #[getter]
    fn regrouped(&self) -> Vec<usize> {
        self.answer.regrouped.clone()
    }

    #[getter]
    fn unchanged(&self) -> Vec<usize> {
        self.answer.unchanged.clone()
    }

    #[getter]
    fn regrouped_into(&self) -> Vec<usize> {
        self.answer.regrouped_into.clone()
    }

    /// beta, b x (c - b).
    fn beta<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let beta = &self.answer.beta;
        let rows = (0..beta.rows()).flat_map(|i| (0..beta.cols()).map(move |j| beta[(i, j)]));
        PyArray1::from_iter(py, rows).reshape([beta.rows(), beta.cols()])
    }

    #[getter]
    fn clear(&self) -> bool {
        self.answer.diagnosis.clear
    }

    fn spectrum<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.answer.diagnosis.spectrum)
    }

    #[getter]
    fn spectrum_columns(&self) -> Vec<usize> {
        self.answer.diagnosis.spectrum_columns.clone()
    }

    #[getter]
    fn tolerance(&self) -> f64 {
        self.answer.diagnosis.tolerance
    }

    #[getter]
    fn gap(&self) -> Option<f64> {
        self.answer.diagnosis.gap
    }

    #[getter]
    fn residual(&self) -> f64 {
        self.answer.diagnosis.residual
    }

    #[getter]
    fn messages(&self) -> Vec<String> {
        self.answer.diagnosis.messages.clone()
    }

    /// XR1 = X1 + beta (X2 - XR2).
    fn regrouped_values<'py>(
        &self,
        py: Python<'py>,
        x: PyReadonlyArray1<'py, f64>,
        xr2: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let (x, xr2) = (vector(&x)?, vector(&xr2)?);
        let values = detached(py, || self.answer.regrouped_values(&x, &xr2))?;
        Ok(PyArray1::from_vec(py, values))
    }

    /// XM = V1 V1' X.
    fn minimum_norm<'py>(
        &self,
        py: Python<'py>,
        x: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let x = vector(&x)?;
        let values = detached(py, || self.answer.minimum_norm(&x))?;
        Ok(PyArray1::from_vec(py, values))
    }
}

/// All models by all engines.
#[pyclass(frozen, module = "roberval._core")]
pub struct Comparison {
    agree: bool,
    routes: Vec<(Arc<BaseParameters>, bool, f64)>,
}

impl Comparison {
    pub fn new(comparison: base::Comparison) -> Self {
        let routes = comparison.routes.into_iter();
        Self {
            agree: comparison.agree,
            routes: routes
                .map(|r| (Arc::new(r.answer), r.same_columns, r.beta_difference))
                .collect(),
        }
    }
}

#[pymethods]
impl Comparison {
    #[getter]
    fn agree(&self) -> bool {
        self.agree
    }

    /// The answer, whether its columns are the first route's, and the difference of beta.
    #[getter]
    fn routes(&self) -> Vec<(Answer, bool, f64)> {
        self.routes
            .iter()
            .map(|(answer, same, difference)| {
                let answer = Arc::clone(answer);
                (Answer { answer }, *same, *difference)
            })
            .collect()
    }
}
