use roberval_linalg::Matrix;
use roberval_mechanism::{JointKind, Mechanism};
use roberval_regressor::{Model, Regressor};

use crate::{BaseError, Samples};

/// A column is without effect if its largest entry is below this many eps of what the
/// entry would be if nothing cancelled. Structural zeros come out at 0 to 10 eps on
/// generated robots; a real effect is larger by many decades.
const ZERO_COLUMN_ULPS: f64 = 1024.0;

/// Bytes that W may take; beyond it a request is a mistake.
const MOST_ENTRIES: usize = 1 << 29;

/// The observation matrix W: the model's rows at random samples, all C columns.
#[derive(Debug, Clone)]
pub struct Observation {
    /// r x C.
    pub w: Matrix,
    /// For each column, its largest entry over the largest magnitude of its entries.
    pub effects: Vec<f64>,
}

impl Observation {
    /// The columns with an effect on the model: c of them.
    #[must_use]
    pub fn with_effect(&self) -> Vec<usize> {
        self.split(true)
    }

    /// The columns without effect: zero in d and d0, constant in h.
    #[must_use]
    pub fn without_effect(&self) -> Vec<usize> {
        self.split(false)
    }

    fn split(&self, effect: bool) -> Vec<usize> {
        (0..self.effects.len())
            .filter(|&j| (self.effects[j] > ZERO_COLUMN_ULPS * f64::EPSILON) == effect)
            .collect()
    }
}

/// W at these samples (Gautier 1991, eq. (6), (9), (12)).
///
/// The rows of h are differences to the first sample's: only differences of energy
/// matter (eq. (11)), so that "constant" and "zero" become one test for all models.
/// Rows of prismatic joints, forces, are multiplied by the robot's length.
///
/// # Errors
/// [`BaseError::TooManyRows`] if W would not fit in memory.
pub fn observe(
    mechanism: &Mechanism,
    model: Model,
    samples: &Samples,
) -> Result<Observation, BaseError> {
    let regressor = Regressor::new(mechanism);
    let width = regressor.parameters().len();
    let rows = samples.count * model.rows(mechanism.dof());
    if rows.saturating_mul(width) > MOST_ENTRIES {
        return Err(BaseError::TooManyRows {
            rows,
            most: MOST_ENTRIES / width,
        });
    }
    let mut values = vec![0.0; rows * width];
    let mut magnitudes = vec![0.0; rows * width];
    regressor.fill(model, samples.states(), &mut values)?;
    regressor.fill_magnitudes(model, samples.states(), &mut magnitudes)?;
    let first = match model {
        Model::H => {
            differences(&mut values, width, |x, reference| x - reference);
            differences(&mut magnitudes, width, |x, reference| x + reference);
            width
        }
        Model::D | Model::D0 => {
            weigh_rows(mechanism, &mut values, width);
            weigh_rows(mechanism, &mut magnitudes, width);
            0
        }
    };
    let w = Matrix::from_row_major((values.len() - first) / width, width, &values[first..])?;
    let effects = effects(&w, &magnitudes[first..]);
    Ok(Observation { w, effects })
}

fn differences(rows: &mut [f64], width: usize, difference: impl Fn(f64, f64) -> f64) {
    let (reference, rows) = rows.split_at_mut(width.min(rows.len()));
    for row in rows.chunks_exact_mut(width) {
        for (x, reference) in row.iter_mut().zip(reference.iter()) {
            *x = difference(*x, *reference);
        }
    }
}

fn weigh_rows(mechanism: &Mechanism, rows: &mut [f64], width: usize) {
    let length = mechanism.characteristic_length();
    let weights: Vec<f64> = mechanism
        .moving()
        .map(|link| {
            if link.joint == JointKind::Prismatic {
                length
            } else {
                1.0
            }
        })
        .collect();
    for (row, weight) in rows.chunks_exact_mut(width).zip(weights.iter().cycle()) {
        for x in row {
            *x *= weight;
        }
    }
}

fn effects(w: &Matrix, magnitudes: &[f64]) -> Vec<f64> {
    let mut largest = vec![0.0_f64; w.cols()];
    for row in magnitudes.chunks_exact(w.cols()) {
        for (largest, x) in largest.iter_mut().zip(row) {
            *largest = largest.max(*x);
        }
    }
    (0..w.cols())
        .map(|j| {
            let entry = w.col(j).iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            if entry == 0.0 {
                0.0
            } else {
                entry / largest[j]
            }
        })
        .collect()
}
