//! Polynomials of few terms, one symbol after another.
//!
//! Where the sums along each symbol have so many products that a coefficient for each would be
//! too many unknowns, most of them are zero. With the symbols from some place on held, an
//! entry is a polynomial in the symbols before; its terms are, but for bad luck, those of the
//! next polynomial with that symbol's powers left out (R. Zippel, Probabilistic algorithms for
//! sparse polynomials, EUROSAM 1979). So each symbol costs a grid of samples, terms found so
//! far by powers of that symbol.

use roberval_regressor::NotInField;
use roberval_scalar::{Fp, Modulus, SplitMix64};

use crate::field::{Answer, Oracle, Value};
use crate::interpolation::{CHECKS, Shape, coefficients, product, rational};
use crate::lines::Local;
use crate::polynomial::{Monomial, power};
use crate::relations::Open;
use crate::samples::{Found, Place};

/// A coefficient of more terms is not looked for: nobody reads it.
const MOST_TERMS: usize = 150;

/// An entry with the terms that it has where the symbols from some place on are held.
struct Partial<'s, 'm> {
    place: Place,
    shape: &'s Shape,
    below: Monomial,
    terms: Result<Vec<(Monomial, Fp<'m>)>, Open>,
}

/// The numerators of entries of these shapes. The values of the symbols are held at a point
/// that has this answer.
pub(crate) fn sparse<'m>(
    (oracle, modulus): (&Oracle<'_>, &'m Modulus),
    held: (&[Value], &Answer),
    entries: &[(Place, Shape)],
    random: &mut SplitMix64,
) -> Result<Vec<Found>, NotInField> {
    let start = |(place, shape)| Partial::new(modulus, place, shape);
    let entries = entries.iter().map(|(place, shape)| (*place, shape));
    let mut partials: Vec<Partial<'_, 'm>> = entries.map(start).collect();
    for symbol in 0..oracle.named.symbols.len() {
        let variable = oracle.named.variable(symbol);
        let mut active: Vec<(&mut Partial<'_, 'm>, &Local)> = partials
            .iter_mut()
            .filter(|p| p.terms.is_ok())
            .filter_map(|p| p.shape.local(variable).map(|local| (p, local)))
            .collect();
        let sizes = active.iter().map(|(p, local)| (p.len(), local.above.len()));
        let most = |a: (usize, usize), b: (usize, usize)| (a.0.max(b.0), a.1.max(b.1));
        let Some((rows, columns)) = sizes.reduce(most) else {
            continue;
        };
        let grid = Grid {
            symbol,
            size: (rows + CHECKS, columns + CHECKS),
            places: active.iter().map(|(p, _)| p.place).collect(),
        };
        let values = grid.values((oracle, modulus), held, random)?;
        for (k, (partial, local)) in active.iter_mut().enumerate() {
            partial.extend(modulus, local, &values, k);
        }
    }
    let found = partials.into_iter().map(|p| rational(modulus, p.terms?));
    Ok(found.collect())
}

impl<'s, 'm> Partial<'s, 'm> {
    /// All symbols are held: a number.
    fn new(modulus: &'m Modulus, place: Place, shape: &'s Shape) -> Self {
        let number = (vec![0; shape.variables], modulus.integer(1));
        Self {
            place,
            shape,
            below: shape.below(),
            terms: Ok(vec![number]),
        }
    }

    /// How many terms it has.
    fn len(&self) -> usize {
        self.terms.as_ref().map_or(0, Vec::len)
    }

    /// Takes the powers of one more symbol in.
    fn extend(&mut self, modulus: &'m Modulus, local: &Local, grid: &Values<'m>, k: usize) {
        let Ok(terms) = &self.terms else {
            return;
        };
        let before: Vec<Monomial> = terms.iter().map(|(m, _)| m.clone()).collect();
        let (rows, columns) = (before.len() + CHECKS, local.above.len() + CHECKS);
        let first = |row: &Vec<Vec<Fp<'m>>>| row[0].clone();
        let row_points: Vec<Vec<Fp<'m>>> = grid.points[..rows].iter().map(first).collect();
        let lists: Vec<Vec<Fp<'m>>> = (0..columns)
            .map(|column| {
                let value = |row: usize| {
                    let below = power(modulus, &self.below, &grid.points[row][column]);
                    grid.values[row][column][k] * below
                };
                (0..rows).map(value).collect()
            })
            .collect();
        let fits = coefficients(modulus, &before, &row_points, &lists);
        let fits = fits.into_iter().collect::<Option<Vec<_>>>();
        let along = fits.and_then(|fits| {
            let term = |t: usize| fits.iter().map(|fit| fit[t]).collect();
            let lists: Vec<Vec<Fp<'m>>> = (0..before.len()).map(term).collect();
            let points = &grid.points[0][..columns];
            let fits = coefficients(modulus, &local.above, points, &lists);
            fits.into_iter().collect::<Option<Vec<_>>>()
        });
        self.terms = along.ok_or(Open::NotPolynomial).and_then(|along| {
            let products = before.iter().zip(along).flat_map(|(m, fit)| {
                let powers = local.above.iter().zip(fit).filter(|(_, c)| !c.is_zero());
                powers.map(move |(p, c)| (product(m, p), c))
            });
            let products: Vec<_> = products.collect();
            (products.len() <= MOST_TERMS)
                .then_some(products)
                .ok_or(Open::TooLong)
        });
    }
}

/// Where samples are taken for one symbol.
struct Grid {
    symbol: usize,
    /// Rows: values of the symbols before; columns: values of this one.
    size: (usize, usize),
    /// The entries of beta that are wanted.
    places: Vec<Place>,
}

/// The values of the variables, and of the entries, row by row.
struct Values<'m> {
    points: Vec<Vec<Vec<Fp<'m>>>>,
    values: Vec<Vec<Vec<Fp<'m>>>>,
}

impl Grid {
    fn values<'m>(
        &self,
        (oracle, modulus): (&Oracle<'_>, &'m Modulus),
        (held, first): (&[Value], &Answer),
        random: &mut SplitMix64,
    ) -> Result<Values<'m>, NotInField> {
        let (rows, columns) = self.size;
        let mut draw = || Value::Number(modulus.random(random).residue());
        let along: Vec<Value> = (0..columns).map(|_| draw()).collect();
        let mut all = Values {
            points: Vec::new(),
            values: Vec::new(),
        };
        while all.points.len() < rows {
            let mut point = held.to_vec();
            point[..self.symbol].copy_from_slice(&oracle.point(modulus, random)[..self.symbol]);
            let (mut points, mut values) = (Vec::new(), Vec::new());
            for value in &along {
                point[self.symbol] = *value;
                let answer = oracle.ask(modulus, &point, random.next_u64())?;
                if answer.kept != first.kept || answer.deleted != first.deleted {
                    break;
                }
                points.push(oracle.variables(modulus, &point));
                let value = |&(i, j): &Place| modulus.element(answer.beta[i][j]);
                values.push(self.places.iter().map(value).collect());
            }
            if points.len() == columns {
                all.points.push(points);
                all.values.push(values);
            }
        }
        Ok(all)
    }
}
