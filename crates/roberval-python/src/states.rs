//! Joint states and output arrays.

use std::sync::{Mutex, PoisonError};

use numpy::{
    BorrowError, PyArrayDyn, PyArrayMethods, PyReadonlyArray1, PyReadonlyArrayDyn,
    PyReadwriteArrayDyn, PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use roberval_base::Samples;
use roberval_regressor::{RegressorError, STREAM_BYTES, States};

use crate::calls::{answer, caught, detached};
use crate::errors::raise;
use crate::memory::{self, Plain, Writer};

/// Samples that one thread takes at a time: whole tiles, whole stretches of samples whose
/// loops are closed one after the other.
const PIECE: usize = 512;

/// Numbers written before Ctrl-C is looked at: some ms.
const BLOCK: usize = 1 << 21;

/// Samples read at a time: their states stay in the cache.
const WAVE: usize = 1 << 14;

/// The same where each sample takes microseconds: loops that have to be closed.
const SLOW_WAVE: usize = 1 << 10;

/// Numbers that are not worth a second thread.
const SMALL: usize = 1 << 17;

/// Numbers of joint states that are not worth giving Python to other threads, nor the copy
/// which this takes: a tenth of a millisecond.
const QUICK: usize = 1 << 13;

/// Joint states of Python, one or N, about which nothing has to be converted or complained of.
pub struct PlainStates<'a, 'py> {
    q: Plain<'a, 'py>,
    qd: Plain<'a, 'py>,
    qdd: Plain<'a, 'py>,
}

/// The same, borrowed.
pub struct StateArrays<'py> {
    pub q: PyReadonlyArrayDyn<'py, f64>,
    pub qd: PyReadonlyArrayDyn<'py, f64>,
    pub qdd: PyReadonlyArrayDyn<'py, f64>,
}

/// A copy of joint states: Python's threads may change the arrays while we compute.
#[derive(Default)]
pub struct OwnedStates {
    q: Vec<f64>,
    qd: Vec<f64>,
    qdd: Vec<f64>,
    /// Coordinates of q, and of qd and qdd.
    positions: usize,
    dof: usize,
}

/// What a call fills.
pub struct Target<'a, 'py> {
    pub out: Plain<'a, 'py>,
    /// Looks at all of `out` before anything is written.
    pub check: &'a dyn Fn(&[f64]) -> Result<(), RegressorError>,
    /// Numbers of one sample.
    pub size: usize,
    /// Samples that stand together: 1 for rows, as many as lanes for tiles.
    pub tile: usize,
    /// Whether joints follow from others.
    pub slow: bool,
    /// All cores if none is given.
    pub threads: Option<usize>,
}

/// A plain array of these dimensions: of floats, in C order.
fn plain<'a, 'py>(
    array: &'a Bound<'py, PyAny>,
    shape: impl Fn(&[usize]) -> bool,
) -> Option<Plain<'a, 'py>> {
    let array = array.cast_exact::<PyArrayDyn<f64>>().ok()?;
    (memory::is_plain(array) && shape(array.shape())).then_some(array)
}

/// The array that is to be filled, if it is one of this shape.
pub fn output<'a, 'py>(out: &'a Bound<'py, PyAny>, shape: &[usize]) -> Option<Plain<'a, 'py>> {
    plain(out, |found| found == shape)
}

/// A vector of so many finite numbers, if it is a plain array.
pub fn finite(x: &Bound<'_, PyAny>, count: usize) -> Option<Vec<f64>> {
    let x = plain(x, |found| found == [count])?.try_readonly().ok()?;
    let x = x.as_slice().ok()?.to_vec();
    x.iter().all(|x| x.is_finite()).then_some(x)
}

impl<'a, 'py> PlainStates<'a, 'py> {
    /// The states, if the arrays are plain and fit.
    pub fn of(
        [q, qd, qdd]: [&'a Bound<'py, PyAny>; 3],
        positions: usize,
        dof: usize,
    ) -> Option<Self> {
        let q = plain(q, |shape| {
            shape.len() <= 2 && shape.last() == Some(&positions)
        })?;
        let lead = &q.shape()[..q.ndim() - 1];
        let moving = |x| plain(x, |shape| shape.split_last() == Some((&dof, lead)));
        let (qd, qdd) = (moving(qd)?, moving(qdd)?);
        Some(Self { q, qd, qdd })
    }

    /// What stands before the coordinates in the shape of q.
    pub fn lead(&self) -> &[usize] {
        &self.q.shape()[..self.q.ndim() - 1]
    }

    /// Fills the target: few samples at once, many as [`StateArrays::fill`] does. False, and
    /// nothing done, if an array cannot be borrowed or the target is read-only.
    pub fn fill(
        &self,
        py: Python<'_>,
        target: &Target<'_, '_>,
        fill: impl Fn(States<'_>, &mut [f64], bool) -> Result<(), RegressorError> + Sync,
    ) -> PyResult<bool> {
        if !target.slow && self.qd.len() <= QUICK {
            let states = [self.q, self.qd, self.qdd];
            let filled = memory::at_once(states, target.out, |[q, qd, qdd], out| {
                let past_cache = size_of_val(out) > STREAM_BYTES;
                caught(|| {
                    (target.check)(out)?;
                    fill(States { q, qd, qdd }, out, past_cache)
                })
            });
            if let Some(filled) = filled {
                return answer(py, filled).map(|()| true);
            }
        }
        match self.borrowed() {
            Some(states) => states.fill(py, target, fill),
            None => Ok(false),
        }
    }

    fn borrowed(&self) -> Option<StateArrays<'py>> {
        Some(StateArrays {
            q: self.q.try_readonly().ok()?,
            qd: self.qd.try_readonly().ok()?,
            qdd: self.qdd.try_readonly().ok()?,
        })
    }
}

impl StateArrays<'_> {
    fn widths(&self) -> (usize, usize) {
        let of = |x: &PyReadonlyArrayDyn<'_, f64>| x.shape().last().copied();
        (of(&self.q).unwrap_or(0), of(&self.qd).unwrap_or(0))
    }

    /// The samples `first..last` into `to`.
    fn copy(&self, first: usize, last: usize, to: &mut OwnedStates) -> PyResult<()> {
        (to.positions, to.dof) = self.widths();
        let arrays = [
            (&self.q, &mut to.q, to.positions),
            (&self.qd, &mut to.qd, to.dof),
            (&self.qdd, &mut to.qdd, to.dof),
        ];
        for (from, to, width) in arrays {
            to.clear();
            to.extend_from_slice(&from.as_slice()?[first * width..last * width]);
        }
        Ok(())
    }

    /// All samples.
    pub fn all(&self) -> PyResult<OwnedStates> {
        let mut all = OwnedStates::default();
        self.copy(0, self.count(), &mut all)?;
        Ok(all)
    }

    fn count(&self) -> usize {
        let (positions, _) = self.widths();
        self.q.len() / positions.max(1)
    }

    /// Calls `fill` for piece after piece of samples with the GIL released, on several
    /// threads if there are many, each with its part of the target and told whether to
    /// write past the cache. Answers Ctrl-C in between. False, and nothing done, if the
    /// target is read-only.
    fn fill(
        self,
        py: Python<'_>,
        target: &Target<'_, '_>,
        fill: impl Fn(States<'_>, &mut [f64], bool) -> Result<(), RegressorError> + Sync,
    ) -> PyResult<bool> {
        match target.out.try_readwrite() {
            Err(BorrowError::NotWriteable) => Ok(false),
            Ok(mut out) => {
                let each = |first, last, to: &mut OwnedStates| self.copy(first, last, to);
                waves(py, target, self.count(), &mut out, each, fill)?;
                Ok(true)
            }
            Err(_) => self.fill_copied(py, target, fill),
        }
    }

    /// As `fill` where the states are in the memory of the target: all are copied first.
    fn fill_copied(
        self,
        py: Python<'_>,
        target: &Target<'_, '_>,
        fill: impl Fn(States<'_>, &mut [f64], bool) -> Result<(), RegressorError> + Sync,
    ) -> PyResult<bool> {
        let (all, count) = (self.all()?, self.count());
        drop(self);
        let mut out = target
            .out
            .try_readwrite()
            .map_err(|e| raise(py, "ArrayError", &format!("out cannot be written: {e}")))?;
        let each = |first, last, to: &mut OwnedStates| {
            *to = all.cut(first, last);
            Ok(())
        };
        waves(py, target, count, &mut out, each, fill)?;
        Ok(true)
    }
}

/// Wave after wave of samples that `read` copies.
fn waves(
    py: Python<'_>,
    target: &Target<'_, '_>,
    count: usize,
    out: &mut PyReadwriteArrayDyn<'_, f64>,
    read: impl Fn(usize, usize, &mut OwnedStates) -> PyResult<()>,
    fill: impl Fn(States<'_>, &mut [f64], bool) -> Result<(), RegressorError> + Sync,
) -> PyResult<()> {
    let out = out.as_slice_mut()?;
    let _writer = Writer::begin();
    let mut scratch = OwnedStates::default();
    answer(py, caught(|| (target.check)(out)))?;
    let past_cache = size_of_val(out) > STREAM_BYTES;
    let size = target.size.max(1);
    let threads = threads_for(target.threads, out.len()).min(count.div_ceil(PIECE).max(1));
    let most = if target.slow { SLOW_WAVE } else { WAVE };
    let whole = (BLOCK / size).min(most).max(1) * threads;
    let wave = whole.next_multiple_of(PIECE);
    for first in (0..count).step_by(wave) {
        let last = (first + wave).min(count);
        let end = (last.next_multiple_of(target.tile) * size).min(out.len());
        let out = &mut out[first * size..end];
        read(first, last, &mut scratch)?;
        let (states, fill) = (&scratch, &fill);
        detached(py, || {
            let filled = match threads {
                1 => fill(states.all(), out, past_cache),
                _ => states.fill_pieces(threads, out, size, &|s, o| fill(s, o, past_cache)),
            };
            filled.map_err(|e| shift(e, first))
        })?;
        py.check_signals()?;
    }
    Ok(())
}

/// The threads for so many numbers.
fn threads_for(asked: Option<usize>, numbers: usize) -> usize {
    if numbers < SMALL {
        return 1;
    }
    let cores = || std::thread::available_parallelism().map_or(1, Into::into);
    asked.unwrap_or_else(cores)
}

impl OwnedStates {
    /// The states as samples for an analysis.
    pub fn into_samples(self) -> Samples {
        Samples {
            redrawn: 0,
            count: self.q.len() / self.positions.max(1),
            q: self.q,
            qd: self.qd,
            qdd: self.qdd,
        }
    }

    pub fn all(&self) -> States<'_> {
        States {
            q: &self.q,
            qd: &self.qd,
            qdd: &self.qdd,
        }
    }

    fn cut(&self, first: usize, last: usize) -> Self {
        let states = self.part(first, last);
        Self {
            q: states.q.to_vec(),
            qd: states.qd.to_vec(),
            qdd: states.qdd.to_vec(),
            ..*self
        }
    }

    fn part(&self, first: usize, last: usize) -> States<'_> {
        let range = first * self.dof..last * self.dof;
        States {
            q: &self.q[first * self.positions..last * self.positions],
            qd: &self.qd[range.clone()],
            qdd: &self.qdd[range],
        }
    }

    /// Piece after piece on the next free thread. Threads end with the call: there are none
    /// that a forked process could miss.
    fn fill_pieces(
        &self,
        threads: usize,
        out: &mut [f64],
        size: usize,
        fill: &(impl Fn(States<'_>, &mut [f64]) -> Result<(), RegressorError> + Sync),
    ) -> Result<(), RegressorError> {
        let count = self.q.len() / self.positions.max(1);
        let pieces = Mutex::new(out.chunks_mut(PIECE * size).enumerate());
        let fault: Mutex<Option<(usize, RegressorError)>> = Mutex::new(None);
        let work = || {
            loop {
                let next = pieces.lock().unwrap_or_else(PoisonError::into_inner).next();
                let Some((piece, out)) = next else { return };
                let (first, last) = (piece * PIECE, ((piece + 1) * PIECE).min(count));
                let Err(error) = fill(self.part(first, last), out) else {
                    continue;
                };
                let mut fault = fault.lock().unwrap_or_else(PoisonError::into_inner);
                if fault.as_ref().is_none_or(|(earlier, _)| piece < *earlier) {
                    *fault = Some((piece, shift(error, first)));
                }
            }
        };
        std::thread::scope(|scope| {
            for _ in 1..threads {
                scope.spawn(work);
            }
            work();
        });
        let fault = fault.into_inner().unwrap_or_else(PoisonError::into_inner);
        fault.map_or(Ok(()), |(_, error)| Err(error))
    }
}

/// A fault of a part, with the sample counted from the beginning.
fn shift(mut error: RegressorError, first: usize) -> RegressorError {
    match &mut error {
        RegressorError::NotFinite { sample, .. }
        | RegressorError::Quaternion { sample, .. }
        | RegressorError::NotZero { sample, .. }
        | RegressorError::NoValue { sample, .. } => *sample += first,
        RegressorError::Length { .. } => {}
    }
    error
}

/// A copy of a vector such as X.
pub fn vector(x: &PyReadonlyArray1<'_, f64>) -> PyResult<Vec<f64>> {
    Ok(x.to_vec()?)
}
