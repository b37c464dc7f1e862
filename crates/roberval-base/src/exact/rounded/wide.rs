//! W2 = W1 beta in numbers of 448 digits behind the point: of robots that are all but
//! singular, as files are that say 1.5707963267948966 and are taken literally.

use roberval_mechanism::Mechanism;
use roberval_regressor::Model;
use roberval_scalar::{Real, Wide, cancellation_point};

use super::{columns_of_w, samples_for};
use crate::exact::ExactError;

/// Bits behind the point.
const BITS: u64 = 448;

/// Bits by which a pivot must exceed what rounding may have left in its place.
const CLEARLY: i32 = 64;

/// Entries of at most 2^-256 count as 0: cosines of roundings of pi/2 along a chain are
/// multiplied, down to 2^-556 on an arm of seven joints.
const DUST: u64 = BITS - 256;

/// Rows at hand for each that is needed: a link's own columns are in few rows.
const ROWS: usize = 3;

/// beta, found twice at different samples.
pub(super) struct TwoSolutions([Option<Vec<Vec<Wide>>>; 2]);

impl TwoSolutions {
    /// An entry and, as what both solutions differ by, its relative error: infinite where
    /// W1 has not the rank that it should have. What is no more than 2^-256 is 0.
    pub fn entry(&self, i: usize, j: usize) -> (f64, f64) {
        let [Some(first), Some(second)] = &self.0 else {
            return (f64::NAN, f64::INFINITY);
        };
        let (x, y) = (first[i][j], second[i][j]);
        let dust = Wide::units(DUST);
        if !x.abs().exceeds(&dust) && !y.abs().exceeds(&dust) {
            return (0.0, 0.0);
        }
        let error = (x - y).to_f64().abs() / x.to_f64().abs();
        (
            x.to_f64(),
            if error.is_nan() { f64::INFINITY } else { error },
        )
    }
}

/// beta of the columns `gone`, kept x gone.
pub(super) fn solve(
    mechanism: &Mechanism,
    model: Model,
    kept: &[usize],
    gone: &[usize],
    seed: u64,
) -> Result<TwoSolutions, ExactError> {
    let once = |seed: u64| -> Result<_, ExactError> {
        Ok(eliminated(mechanism, model, kept, gone, seed)?.solution())
    };
    Ok(TwoSolutions([once(!seed)?, once(!seed ^ 1)?]))
}

/// Whether the kept columns are independent at the angles as written: beyond doubt, where
/// they are.
pub(in crate::exact) fn independent(
    mechanism: &Mechanism,
    model: Model,
    kept: &[usize],
    seed: u64,
) -> Result<bool, ExactError> {
    Ok(eliminated(mechanism, model, kept, &[], seed)?.is_complete())
}

fn eliminated(
    mechanism: &Mechanism,
    model: Model,
    kept: &[usize],
    gone: &[usize],
    seed: u64,
) -> Result<Elimination, ExactError> {
    let columns = [kept, gone].concat();
    let samples = samples_for(mechanism, model, ROWS * kept.len(), seed)?;
    let w = columns_of_w::<Wide>(mechanism, model, &samples)?;
    let mut elimination = Elimination::new(kept.len());
    // Rows of one joint after those of another: each brings columns of its own.
    let joints = model.rows(mechanism.independent());
    let rows = w.first().map_or(0, Vec::len);
    let order = (0..joints).rev();
    for row in order.flat_map(|joint| (joint..rows).step_by(joints)) {
        if elimination.is_complete() {
            break;
        }
        elimination.insert(columns.iter().map(|&c| w[c][row]).collect());
    }
    Ok(elimination)
}

/// Gauss's elimination row by row; each takes the largest of its entries as the pivot.
struct Elimination {
    unknowns: usize,
    /// Pivot columns, and rows with 1 there.
    pivots: Vec<(usize, Vec<Wide>)>,
    /// What rounding may have done to each of these rows, in last places: a first-order
    /// bound, as it grows along the way.
    noise: Vec<f64>,
}

impl Elimination {
    fn new(unknowns: usize) -> Self {
        Self {
            unknowns,
            pivots: Vec::with_capacity(unknowns),
            noise: Vec::with_capacity(unknowns),
        }
    }

    fn is_complete(&self) -> bool {
        self.pivots.len() == self.unknowns
    }

    fn insert(&mut self, mut row: Vec<Wide>) {
        cancellation_point();
        let mut noise = 1.0;
        for ((k, pivot), rounding) in self.pivots.iter().zip(&self.noise) {
            noise += row[*k].to_f64().abs() * rounding;
            clear(&mut row, *k, pivot);
        }
        let larger = |best: usize, k: usize| {
            if row[k].abs().exceeds(&row[best].abs()) {
                k
            } else {
                best
            }
        };
        let k = (0..self.unknowns).fold(0, larger);
        let size = row[k].to_f64().abs();
        if size * 2_f64.powi(BITS as i32 - CLEARLY) > noise {
            let inverse = Wide::from(1.0) / row[k];
            row.iter_mut().for_each(|x| *x = *x * inverse);
            self.pivots.push((k, row));
            self.noise.push(1.0 + noise / size);
        }
    }

    /// The right sides, in the order of the unknowns; `None` if rows are missing.
    fn solution(mut self) -> Option<Vec<Vec<Wide>>> {
        if !self.is_complete() {
            return None;
        }
        for i in (1..self.unknowns).rev() {
            cancellation_point();
            let (above, rest) = self.pivots.split_at_mut(i);
            let (k, row) = &rest[0];
            for (_, other) in above {
                clear(other, *k, row);
            }
        }
        self.pivots.sort_by_key(|(k, _)| *k);
        let sides = self.pivots.into_iter();
        Some(
            sides
                .map(|(_, row)| row[self.unknowns..].to_vec())
                .collect(),
        )
    }
}

/// Takes so much of a pivot's row away that nothing is left in its column.
fn clear(row: &mut [Wide], column: usize, pivot: &[Wide]) {
    let factor = row[column];
    if factor.is_zero() {
        return;
    }
    for (x, &y) in row.iter_mut().zip(pivot) {
        if !y.is_zero() {
            *x = *x - factor * y;
        }
    }
}
