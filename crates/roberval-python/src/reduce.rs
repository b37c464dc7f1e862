//! Streaming least squares.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use numpy::{
    PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use roberval_reduce::{CheckpointError, Friction, ReduceError, Reduction, Samples, Weights};
use roberval_regressor::States;

use crate::calls::{SIGNALS, answer, detached};
use crate::errors::{IntoPython, raise};
use crate::robot::Robot;
use crate::turns::{Turn, Turns};

/// An accumulator. Threads change it in turn, each a clone that then takes its place as a
/// whole: whoever looks meanwhile, a forked process too, sees it as it was before.
#[pyclass(frozen, module = "roberval._core")]
pub struct Accumulator(Mutex<Shared>);

/// Locked for moments and with the GIL held, so that no fork of Python's finds it locked.
struct Shared {
    state: Arc<Reduction>,
    turns: Arc<Turns>,
    /// The process in which the threads of `turns` run.
    process: u32,
}

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

    /// Accumulator and note of a checkpoint.
    #[staticmethod]
    #[pyo3(signature = (bytes, robot, threads=None))]
    fn from_bytes<'py>(
        py: Python<'py>,
        bytes: &[u8],
        robot: &Robot,
        threads: Option<usize>,
    ) -> PyResult<(Self, Bound<'py, PyBytes>)> {
        let regressor = robot.float_regressor().clone();
        let (read, note) = detached(py, || Reduction::from_bytes(bytes, regressor))?;
        Ok((Self::of(read, threads), PyBytes::new(py, &note)))
    }

    #[pyo3(signature = (note=None))]
    fn to_bytes<'py>(&self, py: Python<'py>, note: Option<&[u8]>) -> Bound<'py, PyBytes> {
        let state = self.state(py);
        let bytes = py.detach(|| state.to_bytes(note.unwrap_or_default()));
        PyBytes::new(py, &bytes)
    }

    fn copy(&self, py: Python<'_>) -> Self {
        Self::of(Reduction::clone(&self.state(py)), None)
    }

    /// A digest of the robot.
    #[getter]
    fn identity<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.state(py).identity())
    }

    /// The robot's columns and which friction there is.
    #[getter]
    fn columns(&self, py: Python<'_>) -> (Vec<usize>, [bool; 3]) {
        let state = self.state(py);
        let (columns, f) = state.columns();
        (columns.to_vec(), [f.viscous, f.coulomb, f.offset])
    }

    #[getter]
    fn samples(&self, py: Python<'_>) -> u64 {
        self.state(py).samples()
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
        let _turn = self.turn(py)?;
        let mut next = Reduction::clone(&self.state(py));
        let (wave, brief) = (next.wave(), next.brief());
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
            if last - first <= brief {
                detached(py, || {
                    let done = next.take_in(&samples, &AtomicBool::new(false));
                    done.map_err(|error| error.after(first))
                })?;
            } else {
                long_update(py, &mut next, &samples, first)?;
            }
            py.check_signals()?;
        }
        self.shared(py).state = Arc::new(next);
        Ok(())
    }

    fn merge(&self, py: Python<'_>, other: &Self) -> PyResult<()> {
        let other = other.state(py);
        let _turn = self.turn(py)?;
        let mut next = Reduction::clone(&self.state(py));
        detached(py, || next.merge(&other))?;
        self.shared(py).state = Arc::new(next);
        Ok(())
    }

    /// The (P+1) x (P+1) triangle of `[W tau]`.
    fn factor<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let state = self.state(py);
        let factor = py.detach(|| state.factor());
        let size = factor.columns() + 1;
        let rows: Vec<Vec<f64>> = (0..size)
            .map(|i| (0..size).map(|j| factor.entry(i, j)).collect())
            .collect();
        Ok(PyArray2::from_vec2(py, &rows)?)
    }

    /// The coefficients, or the first column that is not determined.
    fn solve<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray1<f64>>, PyErr> {
        let state = self.state(py);
        let solved = py.detach(|| state.factor().solve());
        match solved {
            Ok(x) => Ok(PyArray1::from_vec(py, x)),
            Err(error) => Err(raise(py, "NumericalError", &error.to_string())),
        }
    }
}

impl Accumulator {
    fn of(reduction: Reduction, threads: Option<usize>) -> Self {
        let state = Arc::new(match threads {
            Some(threads) => reduction.with_threads(threads),
            None => reduction,
        });
        Self(Mutex::new(Shared {
            state,
            turns: Arc::default(),
            process: std::process::id(),
        }))
    }

    fn shared(&self, _with_the_gil: Python<'_>) -> MutexGuard<'_, Shared> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn state(&self, py: Python<'_>) -> Arc<Reduction> {
        Arc::clone(&self.shared(py).state)
    }

    /// Waits until no other thread changes this.
    fn turn(&self, py: Python<'_>) -> PyResult<Turn> {
        let mut shared = self.shared(py);
        if shared.process != std::process::id() {
            // The parent's threads do not run here, and never end their turns.
            shared.turns = Arc::default();
            shared.process = std::process::id();
        }
        let turns = Arc::clone(&shared.turns);
        drop(shared);
        Turn::of(turns, py)
    }
}

/// An update on a thread of its own, which Ctrl-C ends. Rows of errors are counted from
/// the one that is `first`.
fn long_update(
    py: Python<'_>,
    next: &mut Reduction,
    samples: &Samples<'_>,
    first: usize,
) -> PyResult<()> {
    let stop = AtomicBool::new(false);
    let mut interrupt = None;
    let done = py.detach(|| {
        std::thread::scope(|scope| {
            let (sender, receiver) = channel();
            let stop = &stop;
            scope.spawn(move || {
                let work = || {
                    let done = next.take_in(samples, stop);
                    done.map_err(|error| error.after(first))
                };
                // Whoever waits is there until this has been sent.
                let _ = sender.send(catch_unwind(AssertUnwindSafe(work)));
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
        (None, Some(result)) => answer(py, result),
        (None, None) => Err(raise(py, "InternalError", "this is a bug of roberval")),
    }
}

impl IntoPython for ReduceError {
    /// `ArrayError` with the attribute `row`.
    fn into_python(self, py: Python<'_>) -> PyErr {
        let class = match self {
            Self::Length { .. } => "ShapeError",
            Self::NotFinite { .. } | Self::Weight { .. } | Self::Quaternion { .. } => "ArrayError",
            Self::Overflow { .. } | Self::NoValue { .. } => "ArrayError",
            Self::MergeOverflow => "NumericalError",
            Self::Column { .. } => "OptionError",
            Self::Stopped => return pyo3::exceptions::PyKeyboardInterrupt::new_err(()),
        };
        let error = raise(py, class, &self.to_string());
        match self.row() {
            Some(row) => error.value(py).setattr("row", row).err().unwrap_or(error),
            None => error,
        }
    }
}

impl IntoPython for CheckpointError {
    fn into_python(self, py: Python<'_>) -> PyErr {
        raise(py, "CheckpointError", &self.to_string())
    }
}
