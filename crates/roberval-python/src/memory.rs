//! The memory of NumPy arrays for the microseconds in which no other code of Python runs.
//!
//! Borrowing four arrays from the register that extensions share takes 200 ns, as much as
//! one state of a robot. While the global lock is held and nothing of ours writes without it,
//! there is nobody to ask: what others do to arrays without the lock, no function of NumPy is
//! safe from.
#![allow(unsafe_code)]

use std::slice::{from_raw_parts, from_raw_parts_mut};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

use numpy::npyffi::NPY_ARRAY_WRITEABLE;
use numpy::{PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;

/// An array of floats that is contiguous and aligned.
pub type Plain<'a, 'py> = &'a Bound<'py, PyArrayDyn<f64>>;

/// Calls that write to arrays while other threads of Python run.
static WRITERS: AtomicUsize = AtomicUsize::new(0);

/// Says, while it lives, that arrays are written with the global lock released.
pub struct Writer(());

impl Writer {
    pub fn begin() -> Self {
        WRITERS.fetch_add(1, Ordering::Relaxed);
        Self(())
    }
}

impl Drop for Writer {
    fn drop(&mut self) {
        WRITERS.fetch_sub(1, Ordering::Relaxed);
    }
}

/// Calls `work`, which runs no code of Python, with the numbers of three arrays and with
/// those to write. None, and nothing done, where the arrays have to be borrowed: they
/// overlap, or others write, or there is no global lock.
pub fn at_once<T>(
    read: [Plain<'_, '_>; 3],
    out: Plain<'_, '_>,
    work: impl FnOnce([&[f64]; 3], &mut [f64]) -> T,
) -> Option<T> {
    let apart = read.iter().all(|array| disjoint(array, out));
    let alone = WRITERS.load(Ordering::Relaxed) == 0 && has_lock();
    // SAFETY: an array object lives as long as its reference.
    let writeable = unsafe { (*out.as_array_ptr()).fields.flags } & NPY_ARRAY_WRITEABLE != 0;
    let sound = |array: Plain<'_, '_>| is_plain(array) && !array.is_empty();
    if !(apart && alone && writeable && read.iter().all(|array| sound(array)) && sound(out)) {
        return None;
    }
    // SAFETY: the arrays are contiguous, aligned and not empty, so that each is `len` floats
    // from `data` on. The one to write is writeable and shares no byte with the others.
    // They live until the slices are gone: the global lock is held, `work` has no token to
    // release it with, and none of our calls writes without it. That others write to an array
    // in use without the lock is a race that NumPy forbids its users.
    let of = |array: Plain<'_, '_>| unsafe { from_raw_parts(array.data(), array.len()) };
    let to = unsafe { from_raw_parts_mut(out.data(), out.len()) };
    Some(work(read.map(of), to))
}

/// Whether an array is as [`Plain`] says.
pub fn is_plain(array: Plain<'_, '_>) -> bool {
    array.is_c_contiguous() && array.is_aligned()
}

/// Whether two contiguous arrays share no byte.
fn disjoint(a: Plain<'_, '_>, b: Plain<'_, '_>) -> bool {
    let ends = |x: Plain<'_, '_>| {
        let first = x.data() as usize;
        (first, first + size_of::<f64>() * x.len())
    };
    let ((a, past_a), (b, past_b)) = (ends(a), ends(b));
    past_a <= b || past_b <= a
}

/// Whether this Python is one with a global lock.
fn has_lock() -> bool {
    static LOCK: OnceLock<bool> = OnceLock::new();
    *LOCK.get_or_init(|| !Python::version_str().contains("free-threading"))
}
