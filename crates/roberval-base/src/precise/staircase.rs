//! The staircase elimination in pairs of doubles.

use roberval_scalar::DoubleDouble;

/// An entry of beta (columns having largest entries next to 1) at or below this is 0:
/// pairs of doubles know it to 1e-20, and a coefficient that small is no robot's.
const DUST: f64 = 1e-15;

/// Leftmost independent columns by modified Gram and Schmidt: `W1 = Q R1`, `W2 = Q R2`.
pub(super) struct Staircase {
    /// Places of the independent columns.
    pub kept: Vec<usize>,
    /// Places of the others.
    pub deleted: Vec<usize>,
    /// Of the kept columns, the smallest rest, relative to the column.
    pub smallest_kept: Option<f64>,
    /// Of the others, the largest.
    pub largest_dropped: Option<f64>,
    /// Columns of R1, upper triangular.
    r1: Vec<Vec<DoubleDouble>>,
    /// Columns of R2, as long as columns were kept before.
    r2: Vec<Vec<DoubleDouble>>,
}

impl Staircase {
    /// Columns that leave at most `tolerance` of themselves are dependent.
    pub fn of<'w>(columns: impl Iterator<Item = &'w [DoubleDouble]>, tolerance: f64) -> Self {
        let mut found = Self {
            kept: Vec::new(),
            deleted: Vec::new(),
            smallest_kept: None,
            largest_dropped: None,
            r1: Vec::new(),
            r2: Vec::new(),
        };
        let mut q: Vec<Vec<DoubleDouble>> = Vec::new();
        for (place, column) in columns.enumerate() {
            let mut rest = column.to_vec();
            let size = norm(&rest).to_f64();
            let mut r: Vec<DoubleDouble> = Vec::with_capacity(q.len() + 1);
            for q in &q {
                let along = dot(q, &rest);
                rest.iter_mut()
                    .zip(q)
                    .for_each(|(x, &q)| *x = *x - along * q);
                r.push(along);
            }
            let left = norm(&rest);
            let part = left.to_f64() / size;
            if part > tolerance {
                found.smallest_kept = Some(found.smallest_kept.map_or(part, |x| x.min(part)));
                rest.iter_mut().for_each(|x| *x = *x / left);
                q.push(rest);
                r.push(left);
                found.kept.push(place);
                found.r1.push(r);
            } else {
                found.largest_dropped = Some(found.largest_dropped.map_or(part, |x| x.max(part)));
                found.deleted.push(place);
                found.r2.push(r);
            }
        }
        found
    }

    /// `beta = R1^-1 R2` (Gautier 1991, eq. (17)).
    pub fn relations(&self) -> Vec<Vec<f64>> {
        let mut beta = vec![vec![0.0; self.deleted.len()]; self.kept.len()];
        for (j, r2) in self.r2.iter().enumerate() {
            let mut y = r2.clone();
            for k in (0..y.len()).rev() {
                let x = y[k] / self.r1[k][k];
                for i in 0..k {
                    y[i] = y[i] - self.r1[k][i] * x;
                }
                let x = x.to_f64();
                beta[k][j] = if x.abs() > DUST { x } else { 0.0 };
            }
        }
        beta
    }
}

fn dot(a: &[DoubleDouble], b: &[DoubleDouble]) -> DoubleDouble {
    let products = a.iter().zip(b).map(|(&a, &b)| a * b);
    products.fold(DoubleDouble::ZERO, |sum, x| sum + x)
}

fn norm(x: &[DoubleDouble]) -> DoubleDouble {
    dot(x, x).sqrt()
}
