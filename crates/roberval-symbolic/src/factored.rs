//! Polynomials as an engineer would write them.

mod notation;
mod squares;

use std::collections::BTreeMap;

use num_bigint::BigInt;
use num_integer::Integer;
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};

use crate::polynomial::{Monomial, Polynomial, Variable};
use crate::relations::Coefficient;
pub use notation::Notation;
use notation::decimal;
use squares::with_squares;

/// A coefficient, factored: sign, number and common variables before a sum.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Factored {
    /// Whether it is to be subtracted.
    pub negative: bool,
    number: BigRational,
    common: Vec<(Variable, u8)>,
    below: Vec<(Variable, u8)>,
    /// Terms with their signs, whole and without common factor; empty for 1.
    sum: Vec<Term>,
}

/// A part of a sum.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
enum Term {
    /// A number times powers of variables.
    Product(BigInt, Vec<(Variable, u8)>),
    /// A number times the square of a sum of lengths, each with its factor.
    Square(BigInt, Vec<(BigInt, Variable)>),
}

impl Factored {
    /// A coefficient of relations in these variables; `None` for an open one.
    #[must_use]
    pub fn of(coefficient: &Coefficient, variables: &[Variable]) -> Option<Self> {
        let Coefficient::Quotient {
            numerator,
            denominator,
        } = coefficient
        else {
            return None;
        };
        let polynomial = shortest(numerator, variables);
        let common = common_monomial(&polynomial);
        let number = content(&polynomial);
        let negative = is_subtracted(&polynomial);
        let named = |monomial: &[u8]| -> Vec<(Variable, u8)> {
            let with = variables.iter().cloned().zip(monomial.iter().copied());
            with.filter(|(_, e)| *e > 0).collect()
        };
        let whole = whole_terms(&polynomial).into_iter();
        let whole = whole.map(|(c, rest)| (if negative { -c } else { c }, rest));
        let (squares, others) = with_squares(whole.collect());
        let product = |(c, m): (BigInt, Monomial)| Term::Product(c, named(&m));
        let mut sum: Vec<Term> = others.into_iter().map(product).collect();
        sum.extend(squares.into_iter().map(|(c, lengths)| {
            let name = |(factor, at): (BigInt, usize)| (factor, variables[at].clone());
            Term::Square(c, lengths.into_iter().map(name).collect())
        }));
        sum.sort_by_key(|term| {
            let order = term.order();
            (term.coefficient().is_negative(), order.is_empty(), order)
        });
        if matches!(&sum[..], [Term::Product(c, factors)] if c.is_one() && factors.is_empty()) {
            sum.clear();
        }
        Some(Self {
            negative,
            number,
            common: named(&common),
            below: named(denominator),
            sum,
        })
    }

    /// Whether it is 1 or -1.
    #[must_use]
    pub fn is_unit(&self) -> bool {
        self.is_number() && self.number.is_one()
    }

    /// Whether it has no variables.
    fn is_number(&self) -> bool {
        self.common.is_empty() && self.below.is_empty() && self.sum.is_empty()
    }

    /// Without its sign, as a factor of something behind it; empty for 1. Numbers are written
    /// as decimals where they are such, as those of robot files are; not for SymPy.
    #[must_use]
    pub fn text(&self, notation: Notation) -> String {
        if self.is_unit() {
            return String::new();
        }
        let one = BigRational::one();
        let before = self.scaled(notation, &self.number, &one);
        let whole = self.number.is_integer() || self.sum.len() < 2;
        if whole || notation == Notation::SymPy || decimal(&self.number).is_none() {
            return before;
        }
        let inside = self.scaled(notation, &one, &self.number);
        let shorter = inside.chars().count() < before.chars().count();
        if shorter { inside } else { before }
    }

    /// The factor with a number before it and one in each term of the sum.
    fn scaled(&self, notation: Notation, before: &BigRational, inside: &BigRational) -> String {
        let mut factors: Vec<String> = Vec::new();
        let (number, denominator) = match decimal(before) {
            Some(decimal) if notation != Notation::SymPy => (decimal, None),
            _ => {
                let denominator = (!before.is_integer()).then(|| before.denom().to_string());
                (before.numer().to_string(), denominator)
            }
        };
        if notation == Notation::SymPy && self.is_number() {
            return match denominator {
                Some(denominator) => format!("Rational({number}, {denominator})"),
                None => number,
            };
        }
        if number != "1" {
            factors.push(number);
        }
        factors.extend(self.common.iter().map(|f| notation.power(f)));
        match &self.sum[..] {
            [] => {}
            [one @ Term::Square(..)] => {
                factors.push(notation.sum(std::slice::from_ref(one), inside));
            }
            sum => factors.push(format!("({})", notation.sum(sum, inside))),
        }
        if factors.is_empty() {
            factors.push("1".to_owned());
        }
        let mut below: Vec<String> = denominator.into_iter().collect();
        below.extend(self.below.iter().map(|f| notation.power(f)));
        let above = factors.join(notation.times());
        match (&below[..], notation) {
            ([], _) => above,
            (_, Notation::Latex) => format!("\\frac{{{above}}}{{{}}}", below.join(" ")),
            ([one], _) => format!("{above}/{one}"),
            (_, _) => format!("{above}/({})", below.join(notation.times())),
        }
    }
}

impl Term {
    fn coefficient(&self) -> &BigInt {
        let (Self::Product(coefficient, _) | Self::Square(coefficient, _)) = self;
        coefficient
    }

    /// Terms go by their variables' names, high powers first.
    fn order(&self) -> Vec<(String, std::cmp::Reverse<u8>)> {
        let name = |variable: &Variable| match variable {
            Variable::Length(name) | Variable::Cos(name) | Variable::Sin(name) => name.clone(),
        };
        let mut names: Vec<_> = match self {
            Self::Product(_, factors) => factors.iter().map(|(v, e)| (name(v), *e)).collect(),
            Self::Square(_, sum) => sum.iter().map(|(_, v)| (name(v), 2)).collect(),
        };
        names.sort();
        let reversed = names.into_iter().map(|(n, e)| (n, std::cmp::Reverse(e)));
        reversed.collect()
    }
}

/// The polynomial, or the same with `1 - sin^2` for squares of cosines, whichever is written
/// with fewer terms; angle by angle.
fn shortest(polynomial: &Polynomial, variables: &[Variable]) -> Polynomial {
    let mut best = polynomial.clone();
    for (at, variable) in variables.iter().enumerate() {
        if matches!(variable, Variable::Cos(_)) {
            let other = with_sines(&best, at);
            if written_terms(&other) < written_terms(&best) {
                best = other;
            }
        }
    }
    best
}

/// Terms, squares of sums being one.
fn written_terms(polynomial: &Polynomial) -> usize {
    let (squares, others) = with_squares(whole_terms(polynomial));
    squares.len() + others.len()
}

/// Whether it reads best with a minus before it: all terms are negative, or it is minus a
/// square.
fn is_subtracted(polynomial: &Polynomial) -> bool {
    polynomial.terms.values().all(Signed::is_negative)
        || matches!(&with_squares(whole_terms(polynomial)),
            (squares, others) if others.is_empty() && squares.iter().all(|(c, _)| c.is_negative()))
}

/// The terms over their common number and monomial.
fn whole_terms(polynomial: &Polynomial) -> Vec<(BigInt, Monomial)> {
    let (common, number) = (common_monomial(polynomial), content(polynomial));
    let whole = |(monomial, coefficient): (&Monomial, &BigRational)| {
        let rest = monomial.iter().zip(&common).map(|(e, c)| e - c).collect();
        ((coefficient / &number).to_integer(), rest)
    };
    polynomial.terms.iter().map(whole).collect()
}

/// Replaces `cos^2` by `1 - sin^2` as long as there is one.
fn with_sines(polynomial: &Polynomial, cosine: usize) -> Polynomial {
    let mut terms: BTreeMap<Monomial, BigRational> = polynomial.terms.clone();
    while let Some((monomial, coefficient)) = terms
        .iter()
        .find(|(m, _)| m[cosine] >= 2)
        .map(|(m, c)| (m.clone(), c.clone()))
    {
        terms.remove(&monomial);
        let mut one = monomial.clone();
        one[cosine] -= 2;
        let mut sine = one.clone();
        sine[cosine + 1] += 2;
        *terms.entry(one).or_insert_with(BigRational::zero) += &coefficient;
        *terms.entry(sine).or_insert_with(BigRational::zero) -= &coefficient;
    }
    Polynomial::of(terms)
}

fn common_monomial(polynomial: &Polynomial) -> Monomial {
    let mut monomials = polynomial.terms.keys();
    let first = monomials.next().cloned().unwrap_or_default();
    monomials.fold(first, |common, m| {
        common.iter().zip(m).map(|(a, b)| *a.min(b)).collect()
    })
}

/// The positive number such that all coefficients are whole multiples of it without a
/// common divisor.
fn content(polynomial: &Polynomial) -> BigRational {
    let (mut numerator, mut denominator) = (BigInt::zero(), BigInt::one());
    for coefficient in polynomial.terms.values() {
        numerator = numerator.gcd(coefficient.numer());
        denominator = denominator.lcm(coefficient.denom());
    }
    BigRational::new(numerator, denominator)
}
