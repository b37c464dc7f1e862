//! Base parameters and comparisons as Python reads them.

use numpy::{PyArray1, PyArray2, PyReadonlyArray1};
use pyo3::prelude::*;
use roberval_base::{self as base, BaseParameters, Blame, ExactNumber, Witness};

use roberval_tables as tables;

use crate::calls::detached;
use crate::options::rendering;
use crate::scaling::matrix;
use crate::states::vector;
use crate::symbols::{CodeRow, Symbolic, code};

/// The base parameters of a robot, immutable. Columns are numbers into the robot's labels.
#[pyclass(frozen, module = "roberval._core")]
pub struct Answer {
    answer: BaseParameters,
}

impl Answer {
    pub fn new(answer: BaseParameters) -> Self {
        Self { answer }
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
        matrix(py, &self.answer.beta)
    }

    /// beta without rounding, zeros as the fraction 0; None from the float engines.
    #[getter]
    fn beta_exact(&self) -> Option<Vec<Vec<Coefficient>>> {
        let beta = self.answer.beta_exact.as_ref()?;
        let row = |row: &Vec<ExactNumber>| row.iter().map(Coefficient::of).collect();
        Some(beta.iter().map(row).collect())
    }

    /// Rank, primes, seeds, failure probability and generic angles of the exact engine.
    #[getter]
    fn structure(&self) -> Option<StructureRow> {
        let s = self.answer.diagnosis.structure.clone()?;
        Some((s.rank, s.primes, s.seeds, s.failure_probability, s.generic))
    }

    /// Rank, tolerance, smallest kept and largest dropped value, samples and redrawn
    /// configurations of a decision in pairs of doubles.
    #[getter]
    fn precision(&self) -> Option<PrecisionRow> {
        let p = self.answer.diagnosis.precision.as_ref()?;
        let values = (p.smallest_kept, p.largest_dropped);
        Some((p.rank, p.tolerance, values, p.samples, p.redrawn))
    }

    /// Rank of the tree without constraints, and the columns that they remove.
    #[getter]
    fn opened(&self) -> Option<(usize, Vec<usize>)> {
        let opened = self.answer.diagnosis.opened()?;
        Some((opened.rank, opened.removed.clone()))
    }

    /// Engine, rank, gap, gap at the structural rank, spectrum and tolerance of each float
    /// engine.
    #[getter]
    fn witnesses(&self) -> Vec<WitnessRow> {
        let row = |w: &Witness| {
            let spectrum = w.spectrum.clone();
            let gaps = (w.gap, w.gap_at_structural);
            (
                w.engine.name(),
                w.rank,
                gaps.0,
                gaps.1,
                spectrum,
                w.tolerance,
            )
        };
        self.answer.diagnosis.witnesses.iter().map(row).collect()
    }

    /// What the file as written gives: rank, numbers to blame, near misses.
    #[getter]
    fn literal(&self) -> Option<LiteralRow> {
        let literal = self.answer.diagnosis.literal.as_ref()?;
        let rows = |blame: &[Blame]| blame.iter().map(|b| (b.what.clone(), b.rank)).collect();
        Some((
            literal.rank,
            rows(&literal.blame),
            rows(&literal.near_misses),
        ))
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

    /// The relations that are not trivial, in the field's notation.
    #[getter]
    fn relations(&self) -> Vec<String> {
        tables::relations(&self.answer)
    }

    fn render(&self, py: Python<'_>, format: &str) -> PyResult<String> {
        let format = rendering(py, format)?;
        Ok(tables::base(&self.answer, format))
    }

    /// The text of a certificate.
    fn certificate(&self, py: Python<'_>) -> PyResult<String> {
        detached(py, || self.answer.certificate())
    }

    /// The report: one HTML page.
    fn report(&self, py: Python<'_>) -> String {
        py.detach(|| tables::report(&self.answer))
    }

    /// The relations in symbols; all lengths get names, or only where none has.
    fn symbolic(&self, py: Python<'_>, all: bool) -> PyResult<Symbolic> {
        Symbolic::of(py, &self.answer, all)
    }

    /// Generated code: text, function, parameters, shape, operations a state and once.
    fn code(
        &self,
        py: Python<'_>,
        language: &str,
        what: &str,
        standard: bool,
        friction: bool,
    ) -> PyResult<CodeRow> {
        code(py, &self.answer, (language, what), standard, friction)
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

type WitnessRow = (&'static str, usize, Option<f64>, Option<f64>, Vec<f64>, f64);
type PrecisionRow = (usize, f64, (Option<f64>, Option<f64>), usize, usize);
type StructureRow = (usize, Vec<u64>, Vec<u64>, f64, Vec<String>);
type LiteralRow = (usize, Vec<(String, usize)>, Vec<(String, usize)>);

/// A coefficient as Python builds it: "363/1250", [(n, "r")] for sums of r sqrt(n), float.
#[derive(IntoPyObject)]
enum Coefficient {
    Rational(String),
    Surd(Vec<(u32, String)>),
    Rounded(f64),
}

impl Coefficient {
    fn of(number: &ExactNumber) -> Self {
        match number {
            ExactNumber::Rational(r) => Self::Rational(r.to_string()),
            ExactNumber::Surd(terms) => {
                Self::Surd(terms.iter().map(|(n, r)| (*n, r.to_string())).collect())
            }
            ExactNumber::Rounded(x) => Self::Rounded(*x),
        }
    }
}

/// All models by all engines.
#[pyclass(frozen, module = "roberval._core")]
pub struct Comparison {
    comparison: base::Comparison,
}

impl Comparison {
    pub fn new(comparison: base::Comparison) -> Self {
        Self { comparison }
    }
}

#[pymethods]
impl Comparison {
    #[getter]
    fn agree(&self) -> bool {
        self.comparison.agree
    }

    /// The answer, whether its columns are the first route's, and the difference of beta.
    #[getter]
    fn routes(&self) -> Vec<(Answer, bool, f64)> {
        let routes = self.comparison.routes.iter();
        routes
            .map(|route| {
                let answer = Answer::new(route.answer.clone());
                (answer, route.same_columns, route.beta_difference)
            })
            .collect()
    }

    /// Why the routes are not one clear answer; empty if they are.
    #[getter]
    fn doubts(&self) -> Vec<String> {
        tables::doubts(&self.comparison)
    }

    fn render(&self, py: Python<'_>, format: &str) -> PyResult<String> {
        let format = rendering(py, format)?;
        Ok(tables::compare(&self.comparison, format))
    }
}
