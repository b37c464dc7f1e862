//! Orders of the parameters, and what is wrong in robot files.

use pyo3::prelude::*;
use roberval_formats as formats;
use roberval_mechanism::Convention;

use crate::calls::detached;
use crate::errors::raise;

/// File, line, column, severity, rule, what, remedy, all of it in a line.
type FindingRow = (
    String,
    Option<u32>,
    Option<u32>,
    &'static str,
    String,
    String,
    String,
    String,
);

/// What is wrong or suspicious in a robot file.
#[pyfunction]
pub fn lint(py: Python<'_>, path_or_name: &str) -> PyResult<Vec<FindingRow>> {
    let findings = detached(py, || formats::lint(path_or_name))?;
    let row = |f: formats::Finding| {
        let text = f.to_string();
        let place = (f.position.map(|p| p.line), f.position.map(|p| p.column));
        let (severity, rule) = (f.severity.name(), f.rule.name());
        (
            f.file, place.0, place.1, severity, rule, f.what, f.remedy, text,
        )
    };
    Ok(findings.into_iter().map(row).collect())
}

/// Name, columns and place of each convention.
#[pyfunction]
pub fn conventions() -> Vec<(&'static str, Vec<&'static str>, &'static str)> {
    let entry = |c: Convention| (c.name(), c.columns().to_vec(), c.place());
    Convention::ALL.map(entry).to_vec()
}

/// A row of one convention's numbers as the paper's ten parameters, or the other way.
/// None where there are no such numbers.
#[pyfunction]
pub fn convert(
    py: Python<'_>,
    convention: &str,
    to_paper: bool,
    numbers: Vec<f64>,
) -> PyResult<Option<Vec<f64>>> {
    let found = Convention::ALL.into_iter().find(|c| c.name() == convention);
    let Some(convention) = found else {
        let names = Convention::ALL
            .map(|c| format!("{:?}", c.name()))
            .join(", ");
        let message = format!("order is {convention:?}, expected one of {names}");
        return Err(raise(py, "OptionError", &message));
    };
    Ok(if to_paper {
        convention.to_paper(&numbers).map(|ten| ten.to_vec())
    } else {
        let ten: Option<[f64; 10]> = numbers.try_into().ok();
        ten.and_then(|ten| convention.of_paper(&ten))
    })
}
