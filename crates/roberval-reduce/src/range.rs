//! Numbers whose squares floats can hold: R is kept within them, so that it is never NaN.

use std::sync::atomic::{AtomicBool, Ordering};

use roberval_regressor::{Model, States};

use crate::samples::{ReduceError, Samples};
use crate::stream::Reduction;

/// Entries of factors are no larger: the squares of a column, of all the factors that are
/// merged into one, sum up to less than 1e308.
const LARGEST: f64 = 1e150;

/// Samples without a number beyond this have rows of W far within [`LARGEST`], where loops
/// and couples have no part in it.
const HARMLESS: f64 = 1e20;

/// Samples whose rows are looked at together.
const PIECE: usize = 64;

/// Whether numbers of a factor are beyond the range, or NaN.
pub(crate) fn beyond(factor: &[f64]) -> bool {
    any_above(factor, LARGEST)
}

/// Whether the rows of samples could be beyond the range.
pub(crate) fn suspicious(values: &[f64]) -> bool {
    any_above(values, HARMLESS)
}

fn any_above(values: &[f64], limit: f64) -> bool {
    // NaN is not within, either.
    let mut within = [true; 8];
    let (eights, rest) = values.as_chunks::<8>();
    for eight in eights {
        for (within, x) in within.iter_mut().zip(eight) {
            *within &= x.abs() <= limit;
        }
    }
    within.contains(&false) || !rest.iter().all(|x| x.abs() <= limit)
}

impl Reduction {
    /// The error that names the sample with the largest entry in its rows of `[W tau]`.
    pub(crate) fn overflow(&self, samples: &Samples<'_>, stop: &AtomicBool) -> ReduceError {
        let [positions, n] = self.plan.widths;
        let count = samples.tau.len() / n;
        let roots = samples.weights.roots(count);
        let (mut worst, mut most) = (0, -1.0);
        let mut w = vec![0.0; PIECE * n * self.choice.len()];
        for first in (0..count).step_by(PIECE) {
            if stop.load(Ordering::Relaxed) {
                return ReduceError::Stopped;
            }
            let last = count.min(first + PIECE);
            let States { q, qd, qdd } = samples.states;
            let states = States {
                q: &q[first * positions..last * positions],
                qd: &qd[first * n..last * n],
                qdd: &qdd[first * n..last * n],
            };
            let w = &mut w[..(last - first) * n * self.choice.len()];
            // States without a value are another error's.
            let _ = self
                .regressor
                .fill_columns(Model::D, &self.choice, states, w);
            for row in first * n..last * n {
                let of_row = &w[(row - first * n) * self.choice.len()..][..self.choice.len()];
                let others = [samples.tau[row], qd[row]];
                let entries = of_row.iter().chain(&others).map(|x| size(*x));
                let largest = entries.fold(0.0, f64::max) * roots.get(row).unwrap_or(&1.0);
                if largest > most {
                    (worst, most) = (row / n, largest);
                }
            }
        }
        let columns = samples.columns(self.plan.widths);
        let mut largest = columns[0].largest(worst);
        for column in &columns[1..] {
            let other = column.largest(worst);
            if other.1.abs() > largest.1.abs() {
                largest = other;
            }
        }
        let (place, value) = largest;
        ReduceError::Overflow { place, value }
    }
}

/// How large an entry is, NaN being what overflowed.
fn size(x: f64) -> f64 {
    if x.is_nan() { f64::INFINITY } else { x.abs() }
}
