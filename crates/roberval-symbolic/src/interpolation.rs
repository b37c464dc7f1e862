//! Polynomials from their values in a prime field.

use num_bigint::BigInt;
use roberval_linalg::rational_from_residue;
use roberval_scalar::{Fp, Modulus};

use crate::polynomial::{Monomial, Polynomial, power};

/// More unknown coefficients than these are not asked for.
pub(crate) const MOST_MONOMIALS: usize = 500;

/// What is known of a polynomial before its coefficients.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) struct Shape {
    /// The lengths it depends on, as variables.
    pub lengths: Vec<usize>,
    /// The angles it depends on: the variable of the cosine (the sine's follows) and the
    /// highest degree.
    pub angles: Vec<(usize, u8)>,
    /// The highest degree in the lengths together.
    pub degree: u8,
}

impl Shape {
    /// The monomials that may occur, of `count` variables; `None` if there are too many.
    pub fn monomials(&self, count: usize) -> Option<Vec<Monomial>> {
        let mut all = vec![vec![0; count]];
        for &length in &self.lengths {
            all = self.with(all, |m| {
                let used: u8 = self.lengths.iter().map(|&l| m[l]).sum();
                (0..=self.degree - used)
                    .map(|e| vec![(length, e)])
                    .collect()
            })?;
        }
        for &(cosine, degree) in &self.angles {
            all = self.with(all, |_| {
                let without = (0..=degree).map(|e| vec![(cosine, e), (cosine + 1, 0)]);
                let with_sine = (0..degree).map(|e| vec![(cosine, e), (cosine + 1, 1)]);
                without.chain(with_sine).collect()
            })?;
        }
        Some(all)
    }

    fn with(
        &self,
        all: Vec<Monomial>,
        factors: impl Fn(&Monomial) -> Vec<Vec<(usize, u8)>>,
    ) -> Option<Vec<Monomial>> {
        let mut next = Vec::new();
        for monomial in all {
            for factor in factors(&monomial) {
                let mut product = monomial.clone();
                factor.into_iter().for_each(|(at, e)| product[at] = e);
                next.push(product);
            }
            if next.len() > MOST_MONOMIALS {
                return None;
            }
        }
        Some(next)
    }
}

/// For each of several value lists, the polynomial with these monomials that takes them at
/// the points; `None` where there is none with rational coefficients of moderate size.
/// There must be more points than monomials: the others check.
pub(crate) fn interpolate<'m>(
    modulus: &'m Modulus,
    monomials: &[Monomial],
    points: &[Vec<Fp<'m>>],
    values: &[Vec<Fp<'m>>],
) -> Vec<Option<Polynomial>> {
    let n = monomials.len();
    let mut rows: Vec<Vec<Fp<'m>>> = points
        .iter()
        .enumerate()
        .map(|(at, point)| {
            let powers = monomials.iter().map(|m| power(modulus, m, point));
            powers.chain(values.iter().map(|list| list[at])).collect()
        })
        .collect();
    let mut independent = true;
    for column in 0..n {
        let Some(pivot) = (column..rows.len()).find(|&r| !rows[r][column].is_zero()) else {
            independent = false;
            break;
        };
        rows.swap(column, pivot);
        let inverse = rows[column][column].inverse().expect("not zero");
        let scaled: Vec<Fp<'m>> = rows[column].iter().map(|x| *x * inverse).collect();
        for (r, row) in rows.iter_mut().enumerate().filter(|(r, _)| *r != column) {
            let factor = row[column];
            if factor.is_zero() {
                continue;
            }
            let _ = r;
            for (x, s) in row.iter_mut().zip(&scaled).skip(column) {
                *x = *x - factor * *s;
            }
        }
        rows[column] = scaled;
    }
    let solve = |list: usize| {
        let checked = rows[n..].iter().all(|row| row[n + list].is_zero());
        (independent && checked).then_some(())?;
        let terms = monomials.iter().enumerate().map(|(at, monomial)| {
            let coefficient = fraction(modulus, rows[at][n + list])?;
            Some((monomial.clone(), coefficient))
        });
        Some(Polynomial::of(terms.collect::<Option<Vec<_>>>()?))
    };
    (0..values.len()).map(solve).collect()
}

fn fraction(modulus: &Modulus, x: Fp<'_>) -> Option<num_rational::BigRational> {
    rational_from_residue(&BigInt::from(x.residue()), &BigInt::from(modulus.p()))
}
