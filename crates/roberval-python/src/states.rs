//! Joint states and output arrays.

use numpy::{
    PyArrayDyn, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use roberval_base::Samples;
use roberval_regressor::{RegressorError, States};

use crate::calls::detached;
use crate::errors::raise;

/// Numbers that one block of samples writes before Ctrl-C is looked at: some ms.
const BLOCK: usize = 1 << 20;

/// A copy of N joint states: Python's threads may change the arrays while we compute.
pub struct OwnedStates {
    q: Vec<f64>,
    qd: Vec<f64>,
    qdd: Vec<f64>,
    /// Coordinates of q, and of qd and qdd.
    positions: usize,
    dof: usize,
}

impl OwnedStates {
    pub fn copy(
        q: &PyReadonlyArray2<'_, f64>,
        qd: &PyReadonlyArray2<'_, f64>,
        qdd: &PyReadonlyArray2<'_, f64>,
    ) -> PyResult<Self> {
        Ok(Self {
            positions: q.shape()[1],
            dof: qd.shape()[1],
            q: q.to_vec()?,
            qd: qd.to_vec()?,
            qdd: qdd.to_vec()?,
        })
    }

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

    /// Calls `fill` for block after block of samples with the GIL released, each with
    /// its part of `out` (`size` numbers a sample), and answers Ctrl-C in between.
    pub fn fill_blocks(
        &self,
        py: Python<'_>,
        size: usize,
        out: &Bound<'_, PyArrayDyn<f64>>,
        fill: impl Fn(States<'_>, &mut [f64]) -> Result<(), RegressorError> + Sync,
    ) -> PyResult<()> {
        let mut out = out
            .try_readwrite()
            .map_err(|e| raise(py, "ArrayError", &format!("out cannot be written: {e}")))?;
        let out = out.as_slice_mut()?;
        let samples = (BLOCK / size.max(1)).max(1);
        let count = self.q.len() / self.positions.max(1);
        for first in (0..count).step_by(samples) {
            let last = (first + samples).min(count);
            let states = self.part(first, last);
            let out = &mut out[first * size..last * size];
            detached(py, || fill(states, out).map_err(|e| shift(e, first)))?;
            py.check_signals()?;
        }
        Ok(())
    }

    fn part(&self, first: usize, last: usize) -> States<'_> {
        let range = first * self.dof..last * self.dof;
        States {
            q: &self.q[first * self.positions..last * self.positions],
            qd: &self.qd[range.clone()],
            qdd: &self.qdd[range],
        }
    }
}

/// A fault of a block, with the sample counted from the beginning.
fn shift(mut error: RegressorError, first: usize) -> RegressorError {
    if let RegressorError::NotFinite { sample, .. } = &mut error {
        *sample += first;
    }
    error
}

/// A copy of a vector such as X.
pub fn vector(x: &PyReadonlyArray1<'_, f64>) -> PyResult<Vec<f64>> {
    Ok(x.to_vec()?)
}
