//! Linear equations in a prime field.

use roberval_scalar::Fp;

/// X of A X = B, given by rows, A having more rows than columns and B as many; `None` if A's
/// columns are dependent or there is no solution.
pub(super) fn solve<'m>(a: &[Vec<Fp<'m>>], b: &[Vec<Fp<'m>>]) -> Option<Vec<Vec<Fp<'m>>>> {
    let unknowns = a.first()?.len();
    let joined = a.iter().zip(b).map(|(a, b)| [a.as_slice(), b].concat());
    let mut rows: Vec<Vec<Fp<'m>>> = joined.collect();
    for k in 0..unknowns {
        let pivot = (k..rows.len()).find(|&i| !rows[i][k].is_zero())?;
        rows.swap(k, pivot);
        let inverse = rows[k][k].inverse()?;
        rows[k].iter_mut().for_each(|x| *x = *x * inverse);
        let row = rows[k].clone();
        for (_, other) in rows.iter_mut().enumerate().filter(|(i, _)| *i != k) {
            let factor = other[k];
            if !factor.is_zero() {
                other
                    .iter_mut()
                    .zip(&row)
                    .for_each(|(x, &y)| *x = *x - factor * y);
            }
        }
    }
    let (solved, rest) = rows.split_at(unknowns);
    let consistent = rest.iter().flatten().all(|x| x.is_zero());
    consistent.then(|| solved.iter().map(|row| row[unknowns..].to_vec()).collect())
}

#[cfg(test)]
mod tests {
    use roberval_scalar::{Modulus, SplitMix64};

    use super::*;

    #[test]
    fn equations_with_more_rows_than_unknowns_are_solved_or_refused() {
        let field = Modulus::new((1 << 61) - 1);
        let mut random = SplitMix64::new(1);
        let mut matrix = |rows: usize, cols: usize| -> Vec<Vec<_>> {
            (0..rows)
                .map(|_| (0..cols).map(|_| field.random(&mut random)).collect())
                .collect()
        };
        let (a, x) = (matrix(5, 3), matrix(3, 2));
        let entry =
            |i: usize, j: usize| (0..3).fold(field.integer(0), |sum, k| sum + a[i][k] * x[k][j]);
        let mut b: Vec<Vec<_>> = (0..5).map(|i| vec![entry(i, 0), entry(i, 1)]).collect();
        assert_eq!(solve(&a, &b), Some(x.clone()));
        b[4][1] = b[4][1] + field.integer(1);
        assert_eq!(solve(&a, &b), None);
        let twice: Vec<Vec<_>> = a.iter().map(|r| vec![r[0], r[1], r[0] + r[1]]).collect();
        assert_eq!(solve(&twice, &b), None);
    }
}
