//! Calls into Rust: the GIL released, panics caught, Ctrl-C answered.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread::Builder;
use std::time::Duration;

use pyo3::prelude::*;
use roberval_scalar::cancellable;

use crate::errors::{IntoPython, raise};

/// How often a long call looks at Ctrl-C.
pub const SIGNALS: Duration = Duration::from_millis(20);

/// The result of work whose panics were caught.
pub type Caught<T, E> = Result<Result<T, E>, Box<dyn Any + Send>>;

/// Runs `work` with the GIL released; a panic becomes an `InternalError`.
pub fn detached<T, E>(py: Python<'_>, work: impl FnOnce() -> Result<T, E> + Send) -> PyResult<T>
where
    T: Send,
    E: IntoPython + Send,
{
    let caught = py.detach(|| caught(work));
    answer(py, caught)
}

/// Runs `work` with its panics caught: see [`answer`].
pub fn caught<T, E>(work: impl FnOnce() -> Result<T, E>) -> Caught<T, E> {
    catch_unwind(AssertUnwindSafe(work))
}

/// As [`detached`] for work of seconds, on a thread of its own: Ctrl-C gives Python back
/// at once, and the thread stops at its next cancellation point.
pub fn interruptible<T, E>(
    py: Python<'_>,
    work: impl FnOnce() -> Result<T, E> + Send + 'static,
) -> PyResult<T>
where
    T: Send + 'static,
    E: IntoPython + Send + 'static,
{
    let (sender, mut receiver) = channel();
    let stop = Arc::new(AtomicBool::new(false));
    let stopped = Arc::clone(&stop);
    Builder::new().name("roberval".to_owned()).spawn(move || {
        let work = || caught(|| cancellable(&stopped, work));
        if let Some(ended) = work().map(Result::ok).transpose() {
            // Nobody is left to receive after Ctrl-C.
            let _ = sender.send(ended);
        }
    })?;
    let _stop = SetOnDrop(stop);
    loop {
        let waited = py.detach(move || {
            let received = receiver.recv_timeout(SIGNALS);
            (receiver, received)
        });
        receiver = waited.0;
        match waited.1 {
            Ok(caught) => return answer(py, caught),
            Err(RecvTimeoutError::Timeout) => py.check_signals()?,
            Err(RecvTimeoutError::Disconnected) => {
                return Err(raise(py, "InternalError", "the computing thread ended"));
            }
        }
    }
}

/// A flag that is set when this goes: however the waiting ends.
struct SetOnDrop(Arc<AtomicBool>);

impl Drop for SetOnDrop {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// The result of work, or an `InternalError` for its panic.
pub fn answer<T, E: IntoPython>(py: Python<'_>, caught: Caught<T, E>) -> PyResult<T> {
    let panic = match caught {
        Ok(result) => return result.map_err(|error| error.into_python(py)),
        Err(panic) => panic,
    };
    let text = panic
        .downcast_ref::<String>()
        .map(String::as_str)
        .or_else(|| panic.downcast_ref::<&str>().copied())
        .unwrap_or("no message");
    let message = format!("this is a bug of roberval: {text}");
    Err(raise(py, "InternalError", &message))
}
