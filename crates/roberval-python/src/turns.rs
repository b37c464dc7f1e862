//! Threads that change an object one after the other.

use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, ThreadId};
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::calls::SIGNALS;

/// The threads that want to change an object, in the order in which they came.
#[derive(Debug, Default)]
pub struct Turns {
    queue: Mutex<VecDeque<ThreadId>>,
    left: Condvar,
}

impl Turns {
    fn queue(&self) -> MutexGuard<'_, VecDeque<ThreadId>> {
        self.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A place in the queue, which ends with this.
pub struct Turn(Arc<Turns>);

impl Turn {
    /// The turn of this thread. Others have the GIL while it waits, and Ctrl-C ends the
    /// waiting.
    ///
    /// # Errors
    /// What Ctrl-C raises, and `RuntimeError` in a signal handler that would wait for the
    /// very call that it interrupts.
    pub fn of(turns: Arc<Turns>, py: Python<'_>) -> PyResult<Self> {
        let mut queue = turns.queue();
        if queue.contains(&thread::current().id()) {
            let what = "this accumulator is being changed by the call that a signal interrupted: \
                        change another one";
            return Err(PyRuntimeError::new_err(what));
        }
        queue.push_back(thread::current().id());
        drop(queue);
        let turn = Self(turns);
        while !turn.has_come(Duration::ZERO) && !py.detach(|| turn.has_come(SIGNALS)) {
            py.check_signals()?;
        }
        Ok(turn)
    }

    /// Whether it has come, or comes within some time.
    fn has_come(&self, within: Duration) -> bool {
        let me = thread::current().id();
        let not_yet = |queue: &mut VecDeque<ThreadId>| queue.front() != Some(&me);
        let waited = self
            .0
            .left
            .wait_timeout_while(self.0.queue(), within, not_yet);
        let (_queue, waited) = waited.unwrap_or_else(PoisonError::into_inner);
        !waited.timed_out()
    }
}

impl Drop for Turn {
    fn drop(&mut self) {
        let me = thread::current().id();
        self.0.queue().retain(|thread| *thread != me);
        self.0.left.notify_all();
    }
}
