//! Polynomials from their values in a prime field.

use num_bigint::BigInt;
use roberval_linalg::rational_from_residue;
use roberval_scalar::{Fp, Modulus};

use crate::lines::Local;
use crate::polynomial::{Monomial, Polynomial, power};
use crate::relations::Open;
use crate::samples::Found;

/// More unknown coefficients than these are not asked for at once: [`crate::sparse`] does it.
const MOST_MONOMIALS: usize = 250;

/// Points beyond the unknown coefficients that check each interpolation.
pub(crate) const CHECKS: usize = 2;

/// What is known of an entry before its coefficients: a polynomial over a monomial.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Shape {
    /// What it is along each symbol that matters.
    pub locals: Vec<Local>,
    /// Number of lengths, the first of the variables.
    pub lengths: usize,
    /// Number of variables.
    pub variables: usize,
    /// The degrees in the lengths together that terms above may have.
    pub degrees: Vec<i16>,
}

impl Shape {
    /// What stands below.
    pub fn below(&self) -> Monomial {
        let one = vec![0; self.variables];
        self.locals.iter().fold(one, |m, l| product(&m, &l.below))
    }

    /// What it is along the symbol that has this variable; `None` if that does not matter.
    pub fn local(&self, variable: usize) -> Option<&Local> {
        // A cosine and its sine are neighbours.
        let last = self.variables - 1;
        let next = if variable >= self.lengths {
            variable + 1
        } else {
            variable
        }
        .min(last);
        let is_in = |m: &Monomial| m[variable] > 0 || m[next] > 0;
        let mut locals = self.locals.iter();
        locals.find(|l| is_in(&l.below) || l.above.iter().any(is_in))
    }

    /// The monomials that may stand above it; `None` if there are too many.
    pub fn above(&self, below: &Monomial) -> Option<Vec<Monomial>> {
        let degree = |m: &Monomial| total_degree(m, self.lengths);
        let highest = self.degrees.iter().copied().max()?;
        let mut all = vec![vec![0; below.len()]];
        for local in &self.locals {
            let mut next = Vec::new();
            for monomial in &all {
                let products = local.above.iter().map(|m| product(monomial, m));
                next.extend(products.filter(|m| degree(m) <= highest));
                if next.len() > MOST_MONOMIALS * MOST_MONOMIALS {
                    return None;
                }
            }
            all = next;
        }
        all.retain(|m| self.degrees.contains(&degree(m)));
        (all.len() <= MOST_MONOMIALS).then_some(all)
    }
}

/// The degree of a monomial in the lengths, the first of the variables, together.
pub(crate) fn total_degree(monomial: &Monomial, lengths: usize) -> i16 {
    monomial[..lengths].iter().map(|&e| i16::from(e)).sum()
}

pub(crate) fn product(a: &Monomial, b: &Monomial) -> Monomial {
    a.iter().zip(b).map(|(x, y)| x + y).collect()
}

/// For each of several value lists, the polynomial with these monomials that takes them at
/// the points, if there is one with rational coefficients of moderate size.
pub(crate) fn interpolate<'m>(
    modulus: &'m Modulus,
    monomials: &[Monomial],
    points: &[Vec<Fp<'m>>],
    values: &[Vec<Fp<'m>>],
) -> Vec<Found> {
    let polynomial = |fit: Option<Vec<Fp<'m>>>| {
        let terms = monomials
            .iter()
            .cloned()
            .zip(fit.ok_or(Open::NotPolynomial)?);
        rational(modulus, terms)
    };
    let fits = coefficients(modulus, monomials, points, values);
    fits.into_iter().map(polynomial).collect()
}

/// The polynomial with the rational numbers that coefficients stand for.
pub(crate) fn rational<'m>(
    modulus: &Modulus,
    terms: impl IntoIterator<Item = (Monomial, Fp<'m>)>,
) -> Found {
    let term = |(m, c): (Monomial, Fp<'m>)| Some((m, fraction(modulus, c)?));
    let terms = terms.into_iter().map(term).collect::<Option<Vec<_>>>();
    Ok(Polynomial::of(terms.ok_or(Open::NotRational)?))
}

/// For each of several value lists, the coefficients of these monomials whose sum takes them
/// at the points; `None` where there are none. There must be more points than monomials: the
/// others check.
pub(crate) fn coefficients<'m>(
    modulus: &'m Modulus,
    monomials: &[Monomial],
    points: &[Vec<Fp<'m>>],
    values: &[Vec<Fp<'m>>],
) -> Vec<Option<Vec<Fp<'m>>>> {
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
        for (_, row) in rows.iter_mut().enumerate().filter(|(r, _)| *r != column) {
            let factor = row[column];
            if factor.is_zero() {
                continue;
            }
            for (x, s) in row.iter_mut().zip(&scaled).skip(column) {
                *x = *x - factor * *s;
            }
        }
        rows[column] = scaled;
    }
    let solve = |list: usize| {
        let checked = rows[n..].iter().all(|row| row[n + list].is_zero());
        let solution = || rows[..n].iter().map(|row| row[n + list]).collect();
        (independent && checked).then(solution)
    };
    (0..values.len()).map(solve).collect()
}

fn fraction(modulus: &Modulus, x: Fp<'_>) -> Option<num_rational::BigRational> {
    rational_from_residue(&BigInt::from(x.residue()), &BigInt::from(modulus.p()))
}
