//! Streaming least squares.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use numpy::{
    PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use roberval_reduce::{CheckpointError, Friction, ReduceError, Reduction, Samples, Weights};
use roberval_regressor::States;

use crate::calls::detached;
use crate::errors::{IntoPython, raise};
use crate::robot::Robot;

/// How often a long update looks at Ctrl-C.
const SIGNALS: Duration = Duration::from_millis(40);

/// An accumulator. Calls from several threads wait for each other.
#[pyclass(frozen, module = "roberval._core")]
pub struct Accumulator(Mutex<Reduction>);

#[pymethods]
impl Accumulator {
    #[staticmethod]
    #[pyo3(signature = (robot, columns, friction, threads=None))]
    fn new(
        py: Python<'_>,
        robot: &Robot,
        columns: Vec<usize>,
        friction: [bool; 3],
        threads: Option<usize>,
    ) -> PyResult<Self> {
        let [viscous, coulomb, offset] = friction;
        let friction = Friction {
            viscous,
            coulomb,
            offset,
        };
        let regressor = robot.float_regressor().clone();
        let new = detached(py, || Reduction::new(regressor, &columns, friction))?;
        Ok(Self::of(new, threads))
    }

    /// Columns, friction and accumulator of a checkpoint.
    #[staticmethod]
    #[pyo3(signature = (bytes, robot, threads=None))]
    fn from_bytes(
        py: Python<'_>,
        bytes: &[u8],
        robot: &Robot,
        threads: Option<usize>,
    ) -> PyResult<Self> {
        let regressor = robot.float_regressor().clone();
        let read = detached(py, || Reduction::from_bytes(bytes, regressor))?;
        Ok(Self::of(read, threads))
    }

    fn to_bytes<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        let bytes = py.detach(|| self.lock().to_bytes());
        PyBytes::new(py, &bytes)
    }

    fn copy(&self, py: Python<'_>) -> Self {
        py.detach(|| Self(Mutex::new(self.lock().clone())))
    }

    /// The robot's columns and which friction there is.
    #[getter]
    fn columns(&self, py: Python<'_>) -> (Vec<usize>, [bool; 3]) {
        py.detach(|| {
            let inner = self.lock();
            let (columns, f) = inner.columns();
            (columns.to_vec(), [f.viscous, f.coulomb, f.offset])
        })
    }

    #[getter]
    fn samples(&self, py: Python<'_>) -> u64 {
        py.detach(|| self.lock().samples())
    }

    /// Takes samples in, all or none.
    #[pyo3(signature = (q, qd, qdd, tau, joint_weights=None, row_weights=None))]
    #[allow(clippy::too_many_arguments)] // the signature is Python's
    fn update(
        &self,
        py: Python<'_>,
        q: PyReadonlyArray2<'_, f64>,
        qd: PyReadonlyArray2<'_, f64>,
        qdd: PyReadonlyArray2<'_, f64>,
        tau: PyReadonlyArray2<'_, f64>,
        joint_weights: Option<PyReadonlyArray1<'_, f64>>,
        row_weights: Option<PyReadonlyArray2<'_, f64>>,
    ) -> PyResult<()> {
        let [count, n] = [qd.shape()[0], qd.shape()[1]];
        let nq = q.shape()[1];
        let joints = joint_weights.map(|w| w.to_vec()).transpose()?;
        let arrays = [(&q, nq), (&qd, n), (&qdd, n), (&tau, n)];
        // More than one wave: an error in a later one undoes the earlier ones.
        let (wave, brief) = py.detach(|| {
            let inner = self.lock();
            (inner.wave(), inner.brief())
        });
        let before = (count > wave).then(|| py.detach(|| self.lock().clone()));
        let mut copies: [Vec<f64>; 5] = Default::default();
        for first in (0..count.max(1)).step_by(wave) {
            let last = (first + wave).min(count);
            // Python's threads may change the arrays while we compute.
            for (copy, (array, width)) in copies.iter_mut().zip(arrays) {
                copy.clear();
                copy.extend_from_slice(&array.as_slice()?[first * width..last * width]);
            }
            if let Some(rows) = &row_weights {
                copies[4].clear();
                copies[4].extend_from_slice(&rows.as_slice()?[first * n..last * n]);
            }
            let [q, qd, qdd, tau, rows] = &copies;
            let samples = Samples {
                states: States { q, qd, qdd },
                tau,
                weights: match (&joints, &row_weights) {
                    (Some(joints), _) => Weights::Joints(joints),
                    (_, Some(_)) => Weights::Rows(rows),
                    _ => Weights::Equal,
                },
            };
            let done = if last - first <= brief {
                detached(py, || self.lock().update(&samples))
            } else {
                self.long_update(py, &samples)
            };
            if let Err(error) = done.and_then(|()| py.check_signals()) {
                if let Some(before) = before {
                    *self.lock() = before;
                }
                return Err(error);
            }
        }
        Ok(())
    }

    fn merge(&self, py: Python<'_>, other: &Self) -> PyResult<()> {
        let factor = py.detach(|| other.lock().factor());
        detached(py, || {
            self.lock().merge_factor(&factor);
            Ok::<_, ReduceError>(())
        })
    }

    /// The (P+1) x (P+1) triangle of `[W tau]`.
    fn factor<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let factor = py.detach(|| self.lock().factor());
        let size = factor.columns() + 1;
        let rows: Vec<Vec<f64>> = (0..size)
            .map(|i| (0..size).map(|j| factor.entry(i, j)).collect())
            .collect();
        Ok(PyArray2::from_vec2(py, &rows)?)
    }

    /// The coefficients, or the first column that is not determined.
    fn solve<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray1<f64>>, PyErr> {
        let solved = py.detach(|| self.lock().factor().solve());
        match solved {
            Ok(x) => Ok(PyArray1::from_vec(py, x)),
            Err(error) => Err(raise(py, "NumericalError", &error.to_string())),
        }
    }
}

impl Accumulator {
    fn of(reduction: Reduction, threads: Option<usize>) -> Self {
        Self(Mutex::new(match threads {
            Some(threads) => reduction.with_threads(threads),
            None => reduction,
        }))
    }

    fn lock(&self) -> MutexGuard<'_, Reduction> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// An update on a thread of its own; Ctrl-C ends it and nothing is taken in.
    fn long_update(&self, py: Python<'_>, samples: &Samples<'_>) -> PyResult<()> {
        let stop = AtomicBool::new(false);
        let mut interrupt = None;
        let done = py.detach(|| {
            std::thread::scope(|scope| {
                let (sender, receiver) = channel();
                let stop = &stop;
                scope.spawn(move || {
                    let result = self.lock().update_until(samples, stop);
                    // Whoever waits is there until this has been sent.
                    let _ = sender.send(result);
                });
                loop {
                    match receiver.recv_timeout(SIGNALS) {
                        Ok(result) => return Some(result),
                        Err(RecvTimeoutError::Disconnected) => return None,
                        Err(RecvTimeoutError::Timeout) => {}
                    }
                    if let Err(error) = Python::attach(|py| py.check_signals()) {
                        interrupt = Some(error);
                        stop.store(true, Ordering::Relaxed);
                    }
                }
            })
        });
        match (interrupt, done) {
            (Some(interrupt), _) => Err(interrupt),
            (None, Some(result)) => result.map_err(|error| error.into_python(py)),
            (None, None) => Err(raise(py, "InternalError", "this is a bug of roberval")),
        }
    }
}

impl IntoPython for ReduceError {
    fn into_python(self, py: Python<'_>) -> PyErr {
        let class = match self {
            Self::Length { .. } => "ShapeError",
            Self::NotFinite { .. } | Self::Weight { .. } | Self::Quaternion { .. } => "ArrayError",
            Self::NoValue { .. } => "ArrayError",
            Self::Column { .. } => "OptionError",
            Self::Stopped => return pyo3::exceptions::PyKeyboardInterrupt::new_err(()),
        };
        raise(py, class, &self.to_string())
    }
}

impl IntoPython for CheckpointError {
    fn into_python(self, py: Python<'_>) -> PyErr {
        raise(py, "CheckpointError", &self.to_string())
    }
}
