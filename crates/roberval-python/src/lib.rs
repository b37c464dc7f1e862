//! The Python binding of roberval: take, check, call with the GIL released, convert.
//!
//! Python sees this module as `roberval._core`. Everything a user calls is in the Python
//! package, which makes the arrays plain before they come here.

mod answer;
mod calls;
mod command;
mod conventions;
mod errors;
mod memory;
mod options;
mod reduce;
mod robot;
mod samples;
mod scaling;
mod states;
mod symbols;
mod turns;

use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;

#[pymodule(gil_used = false)]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    // The first array and the first borrow import more of NumPy, and panic where Ctrl-C comes
    // in between: not in a call.
    drop(PyArray1::<f64>::zeros(module.py(), 1, false).readonly());
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<robot::Robot>()?;
    module.add_class::<robot::Columns>()?;
    module.add_class::<answer::Answer>()?;
    module.add_class::<answer::Comparison>()?;
    module.add_class::<reduce::Accumulator>()?;
    module.add_class::<samples::CsvSamples>()?;
    module.add_class::<scaling::Scaling>()?;
    module.add_class::<symbols::Symbolic>()?;
    module.add_function(wrap_pyfunction!(robot::catalogue, module)?)?;
    module.add_function(wrap_pyfunction!(robot::clean_file, module)?)?;
    module.add_function(wrap_pyfunction!(conventions::lint, module)?)?;
    module.add_function(wrap_pyfunction!(conventions::conventions, module)?)?;
    module.add_function(wrap_pyfunction!(conventions::convert, module)?)?;
    module.add_function(wrap_pyfunction!(command::read_instead, module)?)?;
    module.add_function(wrap_pyfunction!(command::reduce_arguments, module)?)?;
    module.add_function(wrap_pyfunction!(samples::sample_columns, module)?)?;
    module.add_function(wrap_pyfunction!(command::run_cli, module)?)
}
