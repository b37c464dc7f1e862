//! Stopping a long computation from another thread.

use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// The computation was stopped from outside.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the computation was stopped")]
pub struct Cancelled;

thread_local! {
    static STOP: RefCell<Option<Arc<AtomicBool>>> = const { RefCell::new(None) };
}

/// Runs `work` on this thread until it ends or `stop` becomes true: then its next
/// [`cancellation_point`] unwinds to here, past all that needs no more results.
///
/// # Errors
/// [`Cancelled`] if it was stopped.
///
/// # Panics
/// If `work` does.
pub fn cancellable<T>(stop: &Arc<AtomicBool>, work: impl FnOnce() -> T) -> Result<T, Cancelled> {
    let outer = STOP.replace(Some(Arc::clone(stop)));
    // What `work` was writing is dropped on the way here.
    let ended = catch_unwind(AssertUnwindSafe(work));
    STOP.set(outer);
    ended.or_else(|panic| match panic.downcast::<Cancelled>() {
        Ok(cancelled) => Err(*cancelled),
        Err(panic) => resume_unwind(panic),
    })
}

/// Where a long loop can be stopped: some nanoseconds.
#[inline]
pub fn cancellation_point() {
    let stopped = |stop: &Arc<AtomicBool>| stop.load(Ordering::Relaxed);
    if STOP.with_borrow(|stop| stop.as_ref().is_some_and(stopped)) {
        // Not `panic!`: nobody is to be told.
        resume_unwind(Box::new(Cancelled));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flag(set: bool) -> Arc<AtomicBool> {
        Arc::new(AtomicBool::new(set))
    }

    fn count(to: u32, stop_at: Option<u32>, stop: &AtomicBool) -> u32 {
        for k in 0..to {
            if Some(k) == stop_at {
                stop.store(true, Ordering::Relaxed);
            }
            cancellation_point();
        }
        to
    }

    #[test]
    fn work_ends_at_the_first_point_after_the_flag_is_set() {
        let stop = flag(false);
        assert_eq!(cancellable(&stop, || count(9, None, &stop)), Ok(9));
        assert_eq!(
            cancellable(&stop, || count(9, Some(3), &stop)),
            Err(Cancelled)
        );
        assert_eq!(cancellable(&stop, || 1), Ok(1), "nothing long");
        assert_eq!(count(9, None, &stop), 9, "outside nothing is stopped");
    }

    #[test]
    fn an_inner_scope_is_stopped_alone() {
        let (outer, inner) = (flag(false), flag(true));
        let work = || {
            let stopped = cancellable(&inner, || count(9, None, &inner));
            (stopped, count(5, None, &outer))
        };
        assert_eq!(cancellable(&outer, work), Ok((Err(Cancelled), 5)));
    }
}
