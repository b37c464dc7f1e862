//! Row echelon form modulo a prime, grown row by row: rank, leftmost independent
//! columns and relations without a tolerance.

use roberval_scalar::{Fp, Modulus, cancellation_point};

/// The row space of the rows seen so far, in echelon form.
///
/// The leading columns are the leftmost independent columns: the paper's choice.
#[derive(Debug, Clone)]
pub struct Echelon<'m> {
    modulus: &'m Modulus,
    cols: usize,
    /// For each column the row that leads there, its leading entry 1.
    leading: Vec<Option<Row>>,
    rank: usize,
}

/// Montgomery forms from the leading column on, and where they are not zero.
#[derive(Debug, Clone)]
struct Row {
    entries: Vec<u64>,
    /// Stretches of nonzero entries, as ranges of columns: a regressor's rows are zero off
    /// the path of their joint, and elimination keeps most of that.
    runs: Vec<(usize, usize)>,
}

impl Row {
    fn new(entries: Vec<u64>) -> Self {
        let mut runs: Vec<(usize, usize)> = Vec::new();
        for (j, &entry) in entries.iter().enumerate() {
            match runs.last_mut() {
                _ if entry == 0 => {}
                Some((_, end)) if *end == j => *end = j + 1,
                _ => runs.push((j, j + 1)),
            }
        }
        Self { entries, runs }
    }
}

impl<'m> Echelon<'m> {
    /// The empty row space of `cols` columns.
    #[must_use]
    pub fn new(modulus: &'m Modulus, cols: usize) -> Self {
        Self {
            modulus,
            cols,
            leading: vec![None; cols],
            rank: 0,
        }
    }

    /// The number of independent rows, and columns, so far.
    #[must_use]
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// Adds a row; true if it was independent of the rows before it.
    ///
    /// # Panics
    /// If the row does not have one entry a column.
    pub fn insert(&mut self, row: &[Fp<'_>]) -> bool {
        assert_eq!(row.len(), self.cols, "one entry a column");
        cancellation_point();
        let mut entries: Vec<u64> = row.iter().map(|x| x.raw()).collect();
        for j in 0..self.cols {
            if entries[j] == 0 {
                continue;
            }
            match &self.leading[j] {
                Some(pivot) => subtract_multiple(self.modulus, &mut entries, pivot, j),
                None => {
                    self.lead(j, entries);
                    return true;
                }
            }
        }
        false
    }

    fn lead(&mut self, j: usize, mut entries: Vec<u64>) {
        let inverse = self.modulus.from_raw(entries[j]).inverse();
        let inverse = inverse.expect("a nonzero entry has an inverse").raw();
        for entry in &mut entries[j..] {
            *entry = self.modulus.product(*entry, inverse);
        }
        self.leading[j] = Some(Row::new(entries));
        self.rank += 1;
    }

    /// The leading columns, ascending: each independent of those before it.
    #[must_use]
    pub fn kept(&self) -> Vec<usize> {
        (0..self.cols)
            .filter(|&j| self.leading[j].is_some())
            .collect()
    }

    /// beta: for each kept column (a row) and each other column (ascending), the
    /// coefficient in W2 = W1 beta. This is the reduced echelon form.
    #[must_use]
    pub fn relations(&self) -> Vec<Vec<Fp<'m>>> {
        let mut reduced = self.leading.clone();
        for j in (0..self.cols).rev() {
            cancellation_point();
            let Some(mut row) = reduced[j].take() else {
                continue;
            };
            for k in j + 1..self.cols {
                if row.entries[k] != 0
                    && let Some(below) = &reduced[k]
                {
                    subtract_multiple(self.modulus, &mut row.entries, below, k);
                }
            }
            reduced[j] = Some(Row::new(row.entries));
        }
        let deleted: Vec<usize> = (0..self.cols).filter(|&j| reduced[j].is_none()).collect();
        let coefficients = |row: &Row| {
            let entries = deleted.iter().map(|&j| row.entries[j]);
            entries.map(|x| self.modulus.from_raw(x)).collect()
        };
        reduced.iter().flatten().map(coefficients).collect()
    }
}

/// `entries -= entries[j] * pivot`, the pivot's entry at j being 1.
#[inline(always)]
fn subtract_multiple(modulus: &Modulus, entries: &mut [u64], pivot: &Row, j: usize) {
    let factor = modulus.difference(0, entries[j]);
    for &(start, end) in &pivot.runs {
        for (entry, p) in entries[start..end]
            .iter_mut()
            .zip(&pivot.entries[start..end])
        {
            *entry = modulus.sum(*entry, modulus.product(factor, *p));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use roberval_scalar::SplitMix64;

    const P: u64 = (1 << 62) - 3545;

    #[test]
    fn leading_columns_are_the_leftmost_independent_ones_and_relations_hold() {
        let field = Modulus::new(P);
        let mut random = SplitMix64::new(3);
        for _ in 0..200 {
            let (cols, rank) = (1 + random.below(20), 1 + random.below(12));
            // Each column is new (if room is left) or a combination of earlier ones.
            let mut basis = 0;
            let mut columns: Vec<Vec<Fp<'_>>> = Vec::new();
            let mut fresh = Vec::new();
            for j in 0..cols {
                let new = basis < rank && (random.below(2) == 0 || j == 0);
                let column: Vec<Fp<'_>> = if new {
                    basis += 1;
                    (0..30).map(|_| field.random(&mut random)).collect()
                } else {
                    let weights: Vec<_> = columns
                        .iter()
                        .map(|_| field.integer(random.below(7) as i64 - 3))
                        .collect();
                    (0..30)
                        .map(|i| {
                            columns
                                .iter()
                                .zip(&weights)
                                .fold(field.integer(0), |s, (c, w)| s + c[i] * *w)
                        })
                        .collect()
                };
                fresh.push(new);
                columns.push(column);
            }
            let mut echelon = Echelon::new(&field, cols);
            for i in 0..30 {
                let row: Vec<_> = columns.iter().map(|c| c[i]).collect();
                assert_eq!(echelon.insert(&row), i < basis);
            }
            let planted: Vec<usize> = (0..cols).filter(|&j| fresh[j]).collect();
            assert_eq!(echelon.kept(), planted);
            assert_eq!(echelon.rank(), basis);
            let beta = echelon.relations();
            let deleted: Vec<usize> = (0..cols).filter(|j| !fresh[*j]).collect();
            for (k, &column) in deleted.iter().enumerate() {
                for i in 0..30 {
                    let sum = planted
                        .iter()
                        .zip(&beta)
                        .fold(field.integer(0), |s, (&j, row)| s + columns[j][i] * row[k]);
                    assert_eq!(sum, columns[column][i]);
                }
            }
        }
    }

    #[test]
    fn a_dependent_row_changes_nothing() {
        let field = Modulus::new(P);
        let row: Vec<_> = [0, 3, 1, 0].map(|n| field.integer(n)).into();
        let twice: Vec<_> = row.iter().map(|x| *x + *x).collect();
        let mut echelon = Echelon::new(&field, 4);
        assert!(echelon.insert(&row));
        assert!(!echelon.insert(&twice));
        assert_eq!(echelon.kept(), [1]);
    }
}
