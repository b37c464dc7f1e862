//! Logs: which column is which coordinate, and CSV files, some rows at a time.

use std::io::{self, Read};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use roberval_cli::states::{Columns, Fault, Table, Wanted, columns};

use crate::errors::raise;
use crate::robot::Robot;

/// What went wrong in Python while a file was read.
type Raised = Arc<Mutex<Option<PyErr>>>;

/// A CSV file of samples. Calls from several threads wait for each other.
#[pyclass(frozen, module = "roberval._core")]
pub struct CsvSamples {
    table: Mutex<Table<PythonFile>>,
    raised: Raised,
    /// Coordinates of each array.
    widths: Vec<usize>,
    source: String,
}

#[pymethods]
impl CsvSamples {
    /// Reads the header line of a binary file of Python, named `source` in messages.
    #[staticmethod]
    fn open(
        py: Python<'_>,
        robot: &Robot,
        file: Py<PyAny>,
        source: String,
        weights: bool,
    ) -> PyResult<Self> {
        let raised = Raised::default();
        let file = PythonFile {
            file,
            raised: Arc::clone(&raised),
        };
        let wanted = Wanted::samples(weights);
        let opened = py.detach(|| Table::open(file, robot.mechanism(), &wanted));
        let table = opened.map_err(|fault| told(py, &raised, &source, &fault))?;
        Ok(Self {
            widths: table.columns().of.iter().map(Vec::len).collect(),
            table: Mutex::new(table),
            raised,
            source,
        })
    }

    /// What the user should know of the columns.
    #[getter]
    fn note(&self, py: Python<'_>) -> Option<String> {
        py.detach(|| self.table().columns().note())
    }

    /// The next rows, at most so many: q, qd, qdd, tau (and w); none after the last.
    fn read<'py>(
        &self,
        py: Python<'py>,
        most: usize,
    ) -> PyResult<Option<Vec<Bound<'py, PyArray2<f64>>>>> {
        let mut arrays = vec![Vec::new(); self.widths.len()];
        let read = py.detach(|| self.table().read(most, &mut arrays));
        let count = read.map_err(|fault| told(py, &self.raised, &self.source, &fault))?;
        if count == 0 {
            return Ok(None);
        }
        let shaped = |(array, &width): (Vec<f64>, &usize)| {
            PyArray1::from_vec(py, array).reshape([count, width])
        };
        let arrays = arrays.into_iter().zip(&self.widths);
        arrays.map(shaped).collect::<PyResult<_>>().map(Some)
    }
}

impl CsvSamples {
    fn table(&self) -> MutexGuard<'_, Table<PythonFile>> {
        self.table.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The place of each array's coordinates among columns of these titles, and what the user should
/// know.
#[pyfunction]
pub fn sample_columns(
    py: Python<'_>,
    robot: &Robot,
    titles: Vec<String>,
    weights: bool,
) -> PyResult<(Vec<Vec<usize>>, Option<String>)> {
    let titles: Vec<&str> = titles.iter().map(String::as_str).collect();
    let found = columns(&titles, robot.mechanism(), &Wanted::samples(weights));
    let Columns { of, ignored } = found.map_err(|what| raise(py, "ShapeError", &what))?;
    let note = Columns {
        of: vec![],
        ignored,
    }
    .note();
    let places = of.into_iter().map(|array| array.into_iter().flatten());
    Ok((places.map(Iterator::collect).collect(), note))
}

/// What Python raised while it read, or what is wrong with what it read.
fn told(py: Python<'_>, raised: &Raised, source: &str, fault: &Fault) -> PyErr {
    let raised = raised.lock().unwrap_or_else(PoisonError::into_inner).take();
    let line = fault
        .line
        .map(|line| format!(":{line}"))
        .unwrap_or_default();
    raised.unwrap_or_else(|| {
        let message = format!("{source}{line}: {}", fault.what);
        raise(py, "ArrayError", &message)
    })
}

/// A file that Python has opened, and reads: Ctrl-C is answered while a pipe is silent.
struct PythonFile {
    file: Py<PyAny>,
    raised: Raised,
}

impl Read for PythonFile {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = Python::attach(|py| {
            let bytes = self.file.call_method1(py, "read", (buffer.len(),))?;
            let bytes = bytes.bind(py).cast::<PyBytes>()?.as_bytes();
            let count = bytes.len().min(buffer.len());
            buffer[..count].copy_from_slice(&bytes[..count]);
            Ok(count)
        });
        read.map_err(|error: PyErr| {
            *self.raised.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
            io::Error::other("Python raised an exception")
        })
    }
}
