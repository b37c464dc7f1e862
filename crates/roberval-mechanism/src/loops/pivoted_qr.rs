//! QR with column pivoting by Householder reflections, over any precision.

use roberval_scalar::Real;

/// A P = Q R for a matrix of a few dozen rows and columns.
#[derive(Debug, Clone)]
pub(crate) struct PivotedQr<T> {
    /// Householder vectors v, `H = I - v v'` with v'v = 2; v begins with k zeros.
    reflectors: Vec<Vec<T>>,
    /// Columns of R in the order of the pivots.
    r: Vec<Vec<T>>,
    /// The column of A that each column of R was.
    pivots: Vec<usize>,
    rows: usize,
}

impl<T: Real> PivotedQr<T> {
    /// Factors the matrix with these columns, of `rows` numbers each.
    pub fn of(mut columns: Vec<Vec<T>>, rows: usize) -> Self {
        let mut pivots: Vec<usize> = (0..columns.len()).collect();
        let mut reflectors = Vec::new();
        for k in 0..rows.min(columns.len()) {
            let rest = |column: &Vec<T>| square(&column[k..]).to_f64();
            let best = (k..columns.len())
                .max_by(|&i, &j| rest(&columns[i]).total_cmp(&rest(&columns[j])))
                .unwrap_or(k);
            columns.swap(k, best);
            pivots.swap(k, best);
            let Some(v) = reflector(&columns[k], k) else {
                break; // nothing but zeros is left
            };
            columns[k..]
                .iter_mut()
                .for_each(|column| reflect(&v, column));
            reflectors.push(v);
        }
        Self {
            reflectors,
            r: columns,
            pivots,
            rows,
        }
    }

    /// |R_kk|, not increasing.
    pub fn diagonal(&self) -> Vec<f64> {
        let entry = |k: usize| self.r[k][k].to_f64().abs();
        (0..self.reflectors.len()).map(entry).collect()
    }

    /// How many |R_kk| are above this part of the largest.
    pub fn rank(&self, tolerance: f64) -> usize {
        let diagonal = self.diagonal();
        let large = |r: &&f64| **r > tolerance * diagonal[0];
        diagonal.iter().take_while(large).count()
    }

    /// Q' b
    fn transposed_times(&self, mut b: Vec<T>) -> Vec<T> {
        self.reflectors.iter().for_each(|v| reflect(v, &mut b));
        b
    }

    /// Q y
    fn times(&self, mut y: Vec<T>) -> Vec<T> {
        self.reflectors
            .iter()
            .rev()
            .for_each(|v| reflect(v, &mut y));
        y
    }

    /// The columns of Q from the one after `rank` on: an orthonormal basis of what is at
    /// right angles to the first `rank` columns of A P.
    pub fn complement(&self, rank: usize) -> Vec<Vec<T>> {
        let unit = |k: usize| {
            let mut e = vec![T::from(0.0); self.rows];
            e[k] = T::from(1.0);
            self.times(e)
        };
        (rank..self.rows).map(unit).collect()
    }

    /// The shortest x with A' x = b in the first `rank` pivots' equations.
    pub fn shortest_of_transposed(&self, rank: usize, b: &[T]) -> Vec<T> {
        let mut y = vec![T::from(0.0); self.rows];
        for k in 0..rank {
            let mut rest = b[self.pivots[k]];
            for i in 0..k {
                rest = rest - self.r[k][i] * y[i];
            }
            y[k] = rest / self.r[k][k];
        }
        self.times(y)
    }

    /// The x with A x = b where A's columns are independent and b lies in their span (or
    /// nearest to it).
    pub fn solve(&self, b: Vec<T>) -> Vec<T> {
        let mut y = self.transposed_times(b);
        let n = self.reflectors.len();
        let mut x = vec![T::from(0.0); self.pivots.len()];
        for k in (0..n).rev() {
            let value = y[k] / self.r[k][k];
            x[self.pivots[k]] = value;
            for i in 0..k {
                y[i] = y[i] - self.r[k][i] * value;
            }
        }
        x
    }
}

fn square<T: Real>(x: &[T]) -> T {
    x.iter().fold(T::from(0.0), |sum, &x| x.mul_add(x, sum))
}

/// The vector of the reflection that takes entries k.. of the column to its first;
/// `None` if they are zero.
fn reflector<T: Real>(column: &[T], k: usize) -> Option<Vec<T>> {
    let norm = square(&column[k..]).sqrt();
    if norm.to_f64() == 0.0 {
        return None;
    }
    let mut v = column.to_vec();
    v[..k].fill(T::from(0.0));
    // Away from the axis, so that nothing cancels.
    v[k] = if v[k].to_f64() < 0.0 {
        v[k] - norm
    } else {
        v[k] + norm
    };
    let length = (square(&v) * T::from(0.5)).sqrt();
    v.iter_mut().for_each(|x| *x = *x / length);
    Some(v)
}

fn reflect<T: Real>(v: &[T], x: &mut [T]) {
    let along = v
        .iter()
        .zip(&*x)
        .fold(T::from(0.0), |sum, (&v, &x)| v.mul_add(x, sum));
    x.iter_mut().zip(v).for_each(|(x, &v)| *x = *x - along * v);
}

#[cfg(test)]
mod tests {
    use roberval_scalar::{DoubleDouble, SplitMix64};

    use super::*;

    /// Columns of a random matrix of this rank.
    fn matrix<T: Real>(rows: usize, columns: usize, rank: usize, seed: u64) -> Vec<Vec<T>> {
        let mut random = SplitMix64::new(seed);
        let mut draw =
            |n: usize| -> Vec<T> { (0..n).map(|_| T::from(random.uniform(-1.0, 1.0))).collect() };
        let basis: Vec<Vec<T>> = (0..rank).map(|_| draw(rows)).collect();
        let column = |factors: &[T]| -> Vec<T> {
            let entry = |i: usize| {
                let terms = basis.iter().zip(factors);
                terms.fold(T::from(0.0), |sum, (b, &f)| b[i].mul_add(f, sum))
            };
            (0..rows).map(entry).collect()
        };
        (0..columns).map(|_| column(&draw(rank))).collect()
    }

    fn check<T: Real>(eps: f64) {
        for (seed, (rows, cols, rank)) in (1..).zip([(5, 5, 3), (7, 4, 4), (4, 9, 2), (6, 6, 6)]) {
            let a = matrix::<T>(rows, cols, rank, seed);
            let qr = PivotedQr::of(a.clone(), rows);
            assert_eq!(qr.rank(1e4 * eps), rank);
            for n in qr.complement(rank) {
                for column in &a {
                    let along = n
                        .iter()
                        .zip(column)
                        .fold(T::from(0.0), |s, (&x, &y)| s + x * y);
                    assert!(along.to_f64().abs() < 100.0 * eps);
                }
            }
        }
    }

    #[test]
    fn rank_and_complement_are_those_of_the_matrix_in_both_precisions() {
        check::<f64>(f64::EPSILON);
        check::<DoubleDouble>(1e-31);
    }

    #[test]
    fn equations_with_a_solution_are_solved() {
        let a = matrix::<f64>(7, 4, 4, 9);
        let x = [1.0, -2.0, 0.5, 3.0];
        let b: Vec<f64> = (0..7)
            .map(|i| (0..4).map(|j| a[j][i] * x[j]).sum())
            .collect();
        let found = PivotedQr::of(a, 7).solve(b);
        assert!(x.iter().zip(found).all(|(x, y)| (x - y).abs() < 1e-13));
        // A' x = b for a matrix whose columns depend on each other.
        let a = matrix::<f64>(6, 5, 3, 4);
        let y: Vec<f64> = (0..6).map(|i| f64::from(i) - 2.0).collect();
        let b: Vec<f64> = a
            .iter()
            .map(|c| c.iter().zip(&y).map(|(c, y)| c * y).sum())
            .collect();
        let x = PivotedQr::of(a.clone(), 6).shortest_of_transposed(3, &b);
        for (column, b) in a.iter().zip(&b) {
            let product: f64 = column.iter().zip(&x).map(|(c, x)| c * x).sum();
            assert!((product - b).abs() < 1e-12);
        }
    }
}
