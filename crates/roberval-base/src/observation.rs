use roberval_linalg::Matrix;
use roberval_mechanism::{Mechanism, Motion};
use roberval_regressor::{Model, Regressor};

use crate::{BaseError, Samples};

/// A place in the rows is without effect if its largest entry is below this many eps of
/// what the entry would be if nothing cancelled. Structural zeros come out at 0 to 10 eps
/// on generated robots; a real effect is larger by many decades.
const ZERO_ULPS: f64 = 1024.0;

/// Entries that W may have; beyond it a request is a mistake.
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
            .filter(|&j| has_effect(self.effects[j]) == effect)
            .collect()
    }
}

/// W at these samples (Gautier 1991, eq. (6), (9), (12)).
///
/// The rows of h are differences to the first sample's: only differences of energy
/// matter (eq. (11)), so that "constant" and "zero" become one test for all models.
/// Rows of prismatic joints and other forces are multiplied by the robot's length.
///
/// # Errors
/// [`BaseError::TooManyRows`] if W would not fit in memory.
pub fn observe(
    mechanism: &Mechanism,
    model: Model,
    samples: &Samples,
) -> Result<Observation, BaseError> {
    let rows = observation_rows(mechanism, model, samples)?;
    let w = Matrix::from_row_major(rows.count(), rows.width, &rows.values)?;
    let effects = rows.effects(rows.width);
    Ok(Observation { w, effects })
}

/// The entries of W and their magnitudes, row-major, all C columns.
pub(crate) struct ObservationRows {
    /// C.
    pub width: usize,
    /// r x C entries.
    pub values: Vec<f64>,
    /// What the entries would be if nothing cancelled.
    magnitudes: Vec<f64>,
}

impl ObservationRows {
    /// r.
    fn count(&self) -> usize {
        self.values.len() / self.width
    }

    /// For each column, what its largest entry would be if nothing cancelled.
    pub fn largest_magnitudes(&self) -> Vec<f64> {
        largest(&self.magnitudes, self.width)
    }

    /// Reading the entries as rows of `width` places: for each place, its largest entry
    /// over its largest magnitude. With `width` = C the places are the columns; with n C
    /// they are the places of a sample's n rows.
    pub fn effects(&self, width: usize) -> Vec<f64> {
        largest(&self.values, width)
            .iter()
            .zip(largest(&self.magnitudes, width))
            .map(|(&entry, magnitude)| if entry == 0.0 { 0.0 } else { entry / magnitude })
            .collect()
    }
}

/// Whether a place with this effect is more than rounding noise.
pub(crate) fn has_effect(effect: f64) -> bool {
    effect > ZERO_ULPS * f64::EPSILON
}

/// The rows that [`observe`] makes a matrix of.
pub(crate) fn observation_rows(
    mechanism: &Mechanism,
    model: Model,
    samples: &Samples,
) -> Result<ObservationRows, BaseError> {
    let regressor = Regressor::new(mechanism);
    let width = regressor.parameters().len();
    let rows = samples.count * model.rows(mechanism.independent());
    check_size(rows, width)?;
    let mut values = vec![0.0; rows * width];
    let mut magnitudes = vec![0.0; rows * width];
    regressor.fill(model, samples.states(), &mut values)?;
    regressor.fill_magnitudes(model, samples.states(), &mut magnitudes)?;
    match model {
        Model::H => {
            differences(&mut values, width, |x, reference| x - reference);
            differences(&mut magnitudes, width, |x, reference| x + reference);
        }
        Model::D | Model::D0 => {
            weigh_rows(mechanism, &mut values, width);
            weigh_rows(mechanism, &mut magnitudes, width);
        }
    }
    Ok(ObservationRows {
        width,
        values,
        magnitudes,
    })
}

/// Refuses a W that would not fit in memory.
pub(crate) fn check_size(rows: usize, width: usize) -> Result<(), BaseError> {
    if rows.saturating_mul(width) > MOST_ENTRIES {
        return Err(BaseError::TooManyRows {
            rows,
            most: MOST_ENTRIES / width,
        });
    }
    Ok(())
}

/// Subtracts the first row from the others and takes it out.
fn differences(rows: &mut Vec<f64>, width: usize, difference: impl Fn(f64, f64) -> f64) {
    let reference: Vec<f64> = rows.drain(..width.min(rows.len())).collect();
    for row in rows.chunks_exact_mut(width) {
        for (x, reference) in row.iter_mut().zip(reference.iter()) {
            *x = difference(*x, *reference);
        }
    }
}

fn weigh_rows(mechanism: &Mechanism, rows: &mut [f64], width: usize) {
    let weights = row_weights(mechanism);
    for (row, weight) in rows.chunks_exact_mut(width).zip(weights.iter().cycle()) {
        for x in row {
            *x *= weight;
        }
    }
}

/// What each row is multiplied by in W: the robot's length for forces.
pub(crate) fn row_weights(mechanism: &Mechanism) -> Vec<f64> {
    let length = mechanism.characteristic_length();
    let weight = |motion| match motion {
        Motion::Translation => length,
        Motion::Rotation => 1.0,
    };
    mechanism
        .independent_motions()
        .into_iter()
        .map(weight)
        .collect()
}

/// The largest size at each place of rows of `width` numbers.
fn largest(values: &[f64], width: usize) -> Vec<f64> {
    let mut largest = vec![0.0_f64; width];
    for row in values.chunks_exact(width) {
        for (largest, x) in largest.iter_mut().zip(row) {
            *largest = largest.max(x.abs());
        }
    }
    largest
}
