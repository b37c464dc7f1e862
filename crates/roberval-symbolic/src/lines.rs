//! Entries of beta along one symbol: what of it they have above and below.
//!
//! With all other symbols held at random values an entry is a function of one symbol. The few
//! terms that it has there are, but for bad luck, all that it has anywhere; the whole is a
//! sum of products of such terms, one of each symbol (R. Zippel, Probabilistic algorithms for
//! sparse polynomials, EUROSAM 1979).

use roberval_regressor::NotInField;
use roberval_scalar::{Fp, Modulus, SplitMix64};

use crate::field::{Answer, Oracle, Value};
use crate::interpolation::{CHECKS, coefficients};
use crate::naming::SymbolKind;
use crate::polynomial::{Monomial, power};

/// The highest power above, where none is below, of a constant that is a length.
const HIGHEST_LENGTH_DEGREE: u8 = 3;

/// An angle that stands in many places is taken to enter with this degree at most.
const HIGHEST_ANGLE_DEGREE: usize = 6;

/// The highest power below of a constant that is a length.
const HIGHEST_LENGTH_BELOW: u8 = 2;

/// What may stand below: powers of a cosine and a sine.
const BELOW_ANGLE: [[u8; 2]; 7] = [[0, 0], [1, 0], [0, 1], [1, 1], [2, 0], [0, 2], [2, 2]];

/// An entry as a function of one symbol: a sum of these monomials, with coefficients that
/// depend on the others, over a monomial.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Local {
    pub above: Vec<Monomial>,
    pub below: Monomial,
}

impl Local {
    /// Whether the symbol does not matter.
    pub fn is_constant(&self) -> bool {
        let one = |m: &Monomial| m.iter().all(|e| *e == 0);
        one(&self.below) && self.above.iter().all(one)
    }
}

/// Answers along one symbol, the others being held.
pub(crate) struct Line<'a, 'm> {
    pub oracle: &'a Oracle<'a>,
    pub modulus: &'m Modulus,
    /// Where the others are held, and the answer there.
    pub held: (&'a [Value], &'a Answer),
    pub symbol: usize,
    points: Vec<Vec<Fp<'m>>>,
    answers: Vec<Answer>,
}

impl<'a, 'm> Line<'a, 'm> {
    pub fn new(
        (oracle, modulus): (&'a Oracle<'a>, &'m Modulus),
        held: (&'a [Value], &'a Answer),
        symbol: usize,
    ) -> Self {
        Self {
            oracle,
            modulus,
            held,
            symbol,
            points: Vec::new(),
            answers: Vec::new(),
        }
    }

    /// What these entries of beta are along the line; `None` for no sum over a monomial.
    pub fn locals(
        &mut self,
        entries: &[(usize, usize)],
        random: &mut SplitMix64,
    ) -> Result<Vec<Option<Local>>, NotInField> {
        let mut found: Vec<Option<Local>> = vec![None; entries.len()];
        for (above, below) in self.candidates() {
            let open: Vec<usize> = (0..entries.len()).filter(|&k| found[k].is_none()).collect();
            if open.is_empty() {
                break;
            }
            self.extend(above.len() + CHECKS, random)?;
            let points = &self.points[..above.len() + CHECKS];
            let values = open.iter().map(|&k| {
                let (i, j) = entries[k];
                let value = |(answer, point): (&Answer, &Vec<Fp<'m>>)| {
                    let below = power(self.modulus, &below, point);
                    self.modulus.element(answer.beta[i][j]) * below
                };
                self.answers.iter().zip(points).map(value).collect()
            });
            let fits = coefficients(self.modulus, &above, points, &values.collect::<Vec<_>>());
            for (k, fit) in open.into_iter().zip(fits) {
                found[k] = fit.map(|fit| {
                    let terms = above.iter().zip(fit).filter(|(_, c)| !c.is_zero());
                    Local {
                        above: terms.map(|(m, _)| m.clone()).collect(),
                        below: below.clone(),
                    }
                });
            }
        }
        Ok(found)
    }

    /// What may stand above and below, short ones first.
    fn candidates(&self) -> Vec<(Vec<Monomial>, Monomial)> {
        let named = self.oracle.named;
        let symbol = &named.symbols[self.symbol];
        let (at, count) = (named.variable(self.symbol), named.variables());
        let monomial = |exponents: &[u8]| {
            let mut monomial = vec![0; count];
            monomial[at..at + exponents.len()].copy_from_slice(exponents);
            monomial
        };
        match symbol.kind {
            SymbolKind::Length => {
                // Where `L^2` is a length all powers are twice as high.
                let highest = symbol.degree.saturating_mul(HIGHEST_LENGTH_DEGREE);
                let below = symbol.degree.saturating_mul(HIGHEST_LENGTH_BELOW);
                let candidate = |e: u8| {
                    let above = 0..=highest.saturating_add(e);
                    (above.map(|e| monomial(&[e])).collect(), monomial(&[e]))
                };
                (0..=below).map(candidate).collect()
            }
            SymbolKind::Angle => {
                let uses = (2 * symbol.uses).min(HIGHEST_ANGLE_DEGREE) as u8;
                let candidate = |[cos, sin]: [u8; 2]| {
                    let degree = uses + cos + sin;
                    let cosines = (0..=degree).map(|e| monomial(&[e, 0]));
                    let sines = (0..degree).map(|e| monomial(&[e, 1]));
                    (cosines.chain(sines).collect(), monomial(&[cos, sin]))
                };
                BELOW_ANGLE.map(candidate).to_vec()
            }
        }
    }

    /// Makes sure that there are so many points.
    fn extend(&mut self, count: usize, random: &mut SplitMix64) -> Result<(), NotInField> {
        let (held, first) = self.held;
        while self.points.len() < count {
            let mut point = held.to_vec();
            point[self.symbol] = Value::Number(self.modulus.random(random).residue());
            let answer = self.oracle.ask(self.modulus, &point, random.next_u64())?;
            if answer.kept == first.kept && answer.deleted == first.deleted {
                self.points
                    .push(self.oracle.variables(self.modulus, &point));
                self.answers.push(answer);
            }
        }
        Ok(())
    }
}
