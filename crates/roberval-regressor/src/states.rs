//! Joint states handed in by users, and what can be wrong with them.

use crate::{Model, NoValue};

/// What is wrong with the arrays handed to a [`Regressor`](crate::Regressor).
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RegressorError {
    /// An array has the wrong number of entries.
    #[error("{array} has {found} entries, expected {expected} ({shape})")]
    Length {
        /// Which array.
        array: &'static str,
        /// What its shape should be.
        shape: String,
        /// Entries expected.
        expected: usize,
        /// Entries found.
        found: usize,
    },
    /// The attitude of a floating base is none.
    #[error(
        "q[{sample}, 3:7] has length {length}: the attitude of a floating base must be a quaternion (x, y, z, w) of length 1"
    )]
    Quaternion {
        /// Row, from 0.
        sample: usize,
        /// Its length.
        length: f64,
    },
    /// An entry is NaN or infinite.
    #[error("{array}[{sample}, {joint}] is {value}: joint states must be finite numbers")]
    NotFinite {
        /// Which array.
        array: &'static str,
        /// Row, from 0.
        sample: usize,
        /// Column, from 0.
        joint: usize,
        /// What was found.
        value: f64,
    },
    /// Zeros were to be kept that are none.
    #[error(
        "out has {value} in row {row}, column {column} of sample {sample}, which is zero in every state: for keep_zeros hand in an array of zeros, or one from an earlier call for the same robot, columns and model"
    )]
    NotZero {
        /// Sample, from 0.
        sample: usize,
        /// Row, from 0.
        row: usize,
        /// Column, from 0.
        column: usize,
        /// What was found.
        value: f64,
    },
    /// The constraints have no value at a state.
    #[error("sample {sample}: {error}")]
    NoValue {
        /// Row, from 0.
        sample: usize,
        /// What has no value.
        error: NoValue,
    },
}

/// N states of the m independent variables, row-major.
///
/// Coordinates stand in link order (rad or m, per s, per s^2). Those of a floating robot
/// begin as Pinocchio's do: q with the base's position and attitude x y z qx qy qz qw, qd
/// with the velocity of the base's origin and its angular velocity, both in the base's
/// frame, qdd with the rates of these six numbers (the spatial acceleration: the origin's
/// own is `dv + w x v`).
#[derive(Debug, Clone, Copy)]
pub struct States<'a> {
    /// Positions, N x m, or N x (m + 1) for a floating robot.
    pub q: &'a [f64],
    /// Velocities, N x m (d0 does not look at them).
    pub qd: &'a [f64],
    /// Accelerations, N x m (h does not look at them).
    pub qdd: &'a [f64],
}

/// A quaternion is scaled to length 1 if it is as near to it as this: numbers written with
/// three digits are, and an attitude in other coordinates hardly ever.
const QUATERNION_ROUNDING: f64 = 1e-2;

impl States<'_> {
    /// The arrays with their widths, for so many coordinates of a position and of a velocity.
    fn arrays(&self, positions: usize, velocities: usize) -> [(&'static str, &[f64], usize); 3] {
        [
            ("q", self.q, positions),
            ("qd", self.qd, velocities),
            ("qdd", self.qdd, velocities),
        ]
    }

    /// The number of samples N, if the lengths agree.
    pub(crate) fn count(
        &self,
        positions: usize,
        velocities: usize,
    ) -> Result<usize, RegressorError> {
        let samples = self.q.len() / positions;
        for (array, values, width) in self.arrays(positions, velocities) {
            if values.len() != samples * width {
                let shape = format!("{samples} samples x {width} coordinates");
                check_length(array, samples * width, values.len(), &shape)?;
            }
        }
        Ok(samples)
    }

    /// What is not finite from this sample on, of what the model looks at.
    #[cold]
    pub(crate) fn not_finite(
        &self,
        model: Model,
        first: usize,
        (positions, velocities): (usize, usize),
    ) -> Option<RegressorError> {
        let arrays = self.arrays(positions, velocities).into_iter();
        let taken = arrays.zip(model.takes()).filter(|(_, takes)| *takes);
        let faults = taken.filter_map(|((array, values, width), _)| {
            let mut rest = values[first * width..].iter();
            let at = first * width + rest.position(|x| !x.is_finite())?;
            let error = RegressorError::NotFinite {
                array,
                sample: at / width,
                joint: at % width,
                value: values[at],
            };
            Some((at / width, error))
        });
        faults.min_by_key(|fault| fault.0).map(|fault| fault.1)
    }

    /// The number of samples N, all finite as far as the model looks at them.
    pub(crate) fn check(
        &self,
        model: Model,
        (positions, velocities): (usize, usize),
    ) -> Result<usize, RegressorError> {
        let samples = self.count(positions, velocities)?;
        if let Some(error) = self.not_finite(model, 0, (positions, velocities)) {
            return Err(error);
        }
        if positions > velocities {
            self.check_quaternions(positions)?;
        }
        Ok(samples)
    }

    pub(crate) fn check_quaternions(&self, positions: usize) -> Result<(), RegressorError> {
        for (sample, q) in self.q.chunks_exact(positions).enumerate() {
            let length = q[3..7].iter().map(|x| x * x).sum::<f64>().sqrt();
            let near_one = (length - 1.0).abs() <= QUATERNION_ROUNDING;
            // What is not finite gets an error of its own.
            if length.is_finite() && !near_one {
                return Err(RegressorError::Quaternion { sample, length });
            }
        }
        Ok(())
    }
}

pub(crate) fn check_length(
    array: &'static str,
    expected: usize,
    found: usize,
    shape: &str,
) -> Result<(), RegressorError> {
    if found == expected {
        return Ok(());
    }
    Err(RegressorError::Length {
        array,
        shape: shape.to_owned(),
        expected,
        found,
    })
}
