//! Samples as they are given, and what can be wrong with them.

use std::fmt;

use roberval_regressor::{NoValue, Regressor, RegressorError, States};

/// Samples: joint states, torques and what each row counts. All row-major, N x n.
#[derive(Debug, Clone, Copy)]
pub struct Samples<'a> {
    /// q, qd, qdd.
    pub states: States<'a>,
    /// Joint torques, N m (N for prismatic joints).
    pub tau: &'a [f64],
    /// Each row's weight: a row and its torque are multiplied by the weight's square root.
    pub weights: Weights<'a>,
}

/// How much rows count.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Weights<'a> {
    /// All the same.
    Equal,
    /// One weight a joint: n numbers.
    Joints(&'a [f64]),
    /// One weight a row: N x n numbers.
    Rows(&'a [f64]),
}

/// Where a number stands in the arrays given: `qd[3, 0]`, or `weights[2]` of one a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Place {
    /// Which array.
    pub array: &'static str,
    /// Row, from 0, if the array has one for each sample.
    pub sample: Option<u64>,
    /// Column, from 0.
    pub joint: usize,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { array, joint, .. } = self;
        match self.sample {
            Some(sample) => write!(f, "{array}[{sample}, {joint}]"),
            None => write!(f, "{array}[{joint}]"),
        }
    }
}

/// What is wrong with samples. Rows are those of the arrays given.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ReduceError {
    /// An array has the wrong number of entries.
    #[error(
        "{array} has {found} entries, expected {expected} ({samples} samples x {joints} coordinates)"
    )]
    Length {
        /// Which array.
        array: &'static str,
        /// Entries expected.
        expected: usize,
        /// Entries found.
        found: usize,
        /// Samples N, from the length of q.
        samples: usize,
        /// Coordinates of a sample.
        joints: usize,
    },
    /// An entry is NaN or infinite.
    #[error("{place} is {value}: samples must be finite numbers")]
    NotFinite {
        /// Where.
        place: Place,
        /// What was found.
        value: f64,
    },
    /// A weight is negative.
    #[error("{place} is {value}: a weight cannot be negative")]
    Weight {
        /// Where.
        place: Place,
        /// What was found.
        value: f64,
    },
    /// Squares of a sample's row of `[W tau]` are beyond floats.
    #[error(
        "{place} is {value:e}: with this sample squares in R overflow; q, qd, qdd and tau must be of a real motion (rad or m, s, N m)"
    )]
    Overflow {
        /// The sample's largest number.
        place: Place,
        /// What was found.
        value: f64,
    },
    /// The same in two factors together.
    #[error(
        "squares in R overflow where both factors are merged: their data are in units too small"
    )]
    MergeOverflow,
    /// The attitude of a floating base is none.
    #[error(
        "q[{sample}, 3:7] has length {length}: the attitude of a floating base must be a quaternion (x, y, z, w) of length 1"
    )]
    Quaternion {
        /// Row, from 0.
        sample: u64,
        /// Its length.
        length: f64,
    },
    /// The constraints have no value at a state.
    #[error("sample {sample}: {error}")]
    NoValue {
        /// Row, from 0.
        sample: u64,
        /// What has no value.
        error: NoValue,
    },
    /// The caller stopped it.
    #[error("stopped: no sample was taken in")]
    Stopped,
    /// A column was asked for that is not there, or twice.
    #[error("column {column} of {count} is asked for twice or not there")]
    Column {
        /// The column.
        column: usize,
        /// How many the robot has.
        count: usize,
    },
}

impl ReduceError {
    /// The row of the arrays given that is wrong, if it is one.
    #[must_use]
    pub fn row(&self) -> Option<u64> {
        match self {
            Self::NotFinite { place, .. }
            | Self::Weight { place, .. }
            | Self::Overflow { place, .. } => place.sample,
            Self::Quaternion { sample, .. } | Self::NoValue { sample, .. } => Some(*sample),
            _ => None,
        }
    }

    /// The same of arrays of which the first rows were given before.
    #[must_use]
    pub fn after(mut self, rows: usize) -> Self {
        let row = match &mut self {
            Self::NotFinite { place, .. }
            | Self::Weight { place, .. }
            | Self::Overflow { place, .. } => place.sample.as_mut(),
            Self::Quaternion { sample, .. } | Self::NoValue { sample, .. } => Some(sample),
            _ => None,
        };
        if let Some(row) = row {
            *row += rows as u64;
        }
        self
    }
}

/// An array of samples.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Column<'a> {
    pub name: &'static str,
    pub values: &'a [f64],
    /// Coordinates of a sample.
    width: usize,
    /// Whether there is a row for each sample.
    rows: bool,
}

impl Column<'_> {
    fn place(&self, at: usize) -> Place {
        Place {
            array: self.name,
            sample: self.rows.then_some((at / self.width) as u64),
            joint: at % self.width,
        }
    }

    /// The largest number of a sample and its place.
    pub(crate) fn largest(&self, sample: usize) -> (Place, f64) {
        let first = if self.rows { sample * self.width } else { 0 };
        let size = |at: &usize| self.values[*at].abs();
        let of_sample = first..first + self.width;
        let at = of_sample.max_by(|a, b| size(a).total_cmp(&size(b)));
        let at = at.unwrap_or(first);
        (self.place(at), self.values[at])
    }
}

impl<'a> Samples<'a> {
    /// q, qd, qdd, tau and the weights, if there are any.
    pub(crate) fn columns(&self, [positions, n]: [usize; 2]) -> Vec<Column<'a>> {
        let column = |name, values, width, rows| Column {
            name,
            values,
            width,
            rows,
        };
        let States { q, qd, qdd } = self.states;
        let mut all = vec![
            column("q", q, positions, true),
            column("qd", qd, n, true),
            column("qdd", qdd, n, true),
            column("tau", self.tau, n, true),
        ];
        match self.weights {
            Weights::Equal => {}
            Weights::Joints(w) => all.push(column("weights", w, n, false)),
            Weights::Rows(w) => all.push(column("weights", w, n, true)),
        }
        all
    }

    /// The number of samples, all arrays being of its length and finite.
    pub(crate) fn check(
        &self,
        regressor: &Regressor,
        widths: [usize; 2],
    ) -> Result<usize, ReduceError> {
        let samples = self.states.q.len() / widths[0];
        for column in self.columns(widths) {
            let expected = if column.rows { samples } else { 1 } * column.width;
            if column.values.len() != expected {
                return Err(ReduceError::Length {
                    array: column.name,
                    expected,
                    found: column.values.len(),
                    samples,
                    joints: column.width,
                });
            }
            if let Some(at) = not_finite(column.values) {
                let (place, value) = (column.place(at), column.values[at]);
                return Err(ReduceError::NotFinite { place, value });
            }
            if column.name == "weights"
                && let Some(at) = column.values.iter().position(|w| *w < 0.0)
            {
                let (place, value) = (column.place(at), column.values[at]);
                return Err(ReduceError::Weight { place, value });
            }
        }
        match regressor.check_attitudes(self.states) {
            Err(RegressorError::Quaternion { sample, length }) => Err(ReduceError::Quaternion {
                sample: sample as u64,
                length,
            }),
            _ => Ok(samples),
        }
    }
}

impl Weights<'_> {
    /// The square roots, row by row; nothing where all are equal.
    pub(crate) fn roots(&self, count: usize) -> Vec<f64> {
        match self {
            Self::Equal => Vec::new(),
            Self::Rows(w) => w.iter().map(|w| w.sqrt()).collect(),
            Self::Joints(w) => {
                let row: Vec<f64> = w.iter().map(|w| w.sqrt()).collect();
                row.repeat(count)
            }
        }
    }
}

/// The first number that is not finite. Whole pieces are judged by one sum: zero times
/// anything but a finite number is NaN.
fn not_finite(values: &[f64]) -> Option<usize> {
    const PIECE: usize = 1024;
    for (piece, numbers) in values.chunks(PIECE).enumerate() {
        let mut sums = [0.0; 8];
        let mut whole = numbers.chunks_exact(8);
        for eight in whole.by_ref() {
            for (sum, x) in sums.iter_mut().zip(eight) {
                *sum += x * 0.0;
            }
        }
        let rest: f64 = whole.remainder().iter().map(|x| x * 0.0).sum();
        if sums.iter().sum::<f64>() + rest != 0.0 {
            let at = numbers.iter().position(|x| !x.is_finite());
            return at.map(|at| piece * PIECE + at);
        }
    }
    None
}
