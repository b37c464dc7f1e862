//! Exact truth for integer matrices: reduced echelon form modulo 2^61 - 1 and rational reconstruction.

/// 2^61 - 1, a prime.
pub const P: u64 = (1 << 61) - 1;

fn mul(a: u64, b: u64) -> u64 {
    (u128::from(a) * u128::from(b) % u128::from(P)) as u64
}

fn inverse(a: u64) -> u64 {
    let (mut base, mut exponent, mut result) = (a, P - 2, 1);
    while exponent > 0 {
        if exponent & 1 == 1 {
            result = mul(result, base);
        }
        base = mul(base, base);
        exponent >>= 1;
    }
    result
}

/// Pivot columns (the leftmost independent ones) and, for every other column in order, its
/// coefficients on the pivot columns, as residues.
pub fn reduced_echelon(rows: &[Vec<i64>], cols: usize) -> (Vec<usize>, Vec<Vec<u64>>) {
    let mut a: Vec<Vec<u64>> = rows
        .iter()
        .map(|row| row.iter().map(|&x| x.rem_euclid(P as i64) as u64).collect())
        .collect();
    let mut pivots = Vec::new();
    for j in 0..cols {
        let top = pivots.len();
        let Some(found) = (top..a.len()).find(|&i| a[i][j] != 0) else {
            continue;
        };
        a.swap(top, found);
        let factor = inverse(a[top][j]);
        a[top].iter_mut().for_each(|x| *x = mul(*x, factor));
        let pivot = a[top].clone();
        for (i, row) in a.iter_mut().enumerate() {
            if i != top && row[j] != 0 {
                let minus = P - row[j];
                row.iter_mut()
                    .zip(&pivot)
                    .for_each(|(x, &y)| *x = (*x + mul(minus, y)) % P);
            }
        }
        pivots.push(j);
    }
    let others = (0..cols).filter(|j| !pivots.contains(j));
    let relations = others
        .map(|j| (0..pivots.len()).map(|i| a[i][j]).collect())
        .collect();
    (pivots, relations)
}

/// The fraction n / d with |n|, d <= sqrt(P / 2) that the residue stands for, if there is one.
pub fn fraction(residue: u64) -> Option<(i64, i64)> {
    const BOUND: i128 = 1 << 30;
    let (mut r, mut s) = ((i128::from(P), 0_i128), (i128::from(residue), 1_i128));
    while s.0 > BOUND {
        let q = r.0 / s.0;
        (r, s) = (s, (r.0 - q * s.0, r.1 - q * s.1));
    }
    let (n, d) = if s.1 < 0 { (-s.0, -s.1) } else { s };
    (d != 0 && d <= BOUND).then_some((n as i64, d as i64))
}
