//! Polynomials as an engineer would write them.

mod squares;

use std::collections::BTreeMap;

use num_bigint::BigInt;
use num_integer::Integer;
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};

use crate::polynomial::{Monomial, Polynomial, Variable};
use crate::relations::Coefficient;
use squares::with_squares;

/// Python's keywords, and what the SymPy module defines.
const TAKEN: [&str; 42] = [
    "False",
    "None",
    "True",
    "and",
    "as",
    "assert",
    "async",
    "await",
    "break",
    "class",
    "continue",
    "def",
    "del",
    "elif",
    "else",
    "except",
    "finally",
    "for",
    "from",
    "global",
    "if",
    "import",
    "in",
    "is",
    "lambda",
    "nonlocal",
    "not",
    "or",
    "pass",
    "raise",
    "return",
    "try",
    "while",
    "with",
    "yield",
    "Function",
    "Rational",
    "cos",
    "f",
    "sin",
    "symbols",
    "relations",
];

/// How formulas are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Notation {
    /// `2 R3`, `R4^2 - D4^2`.
    Text,
    /// `2 R_{3}`, `R_{4}^{2} - D_{4}^{2}`.
    Latex,
    /// `2*R3`, `R4**2 - D4**2`.
    SymPy,
}

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
        sum.sort_by_key(|term| (term.coefficient().is_negative(), term.order()));
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

    /// Without its sign, as a factor of something behind it; empty for 1.
    #[must_use]
    pub fn text(&self, notation: Notation) -> String {
        if self.is_unit() {
            return String::new();
        }
        let mut factors: Vec<String> = Vec::new();
        let numerator = self.number.numer();
        if !numerator.is_one() {
            factors.push(numerator.to_string());
        }
        factors.extend(self.common.iter().map(|f| notation.power(f)));
        match &self.sum[..] {
            [] => {}
            [one @ Term::Square(..)] => factors.push(notation.sum(std::slice::from_ref(one))),
            sum => factors.push(format!("({})", notation.sum(sum))),
        }
        if factors.is_empty() {
            factors.push("1".to_owned());
        }
        let mut below: Vec<String> = Vec::new();
        if !self.number.denom().is_one() {
            below.push(self.number.denom().to_string());
        }
        if notation == Notation::SymPy && below.len() == 1 && self.is_number() {
            return format!("Rational({numerator}, {})", below[0]);
        }
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

impl Notation {
    fn times(self) -> &'static str {
        match self {
            Self::Text | Self::Latex => " ",
            Self::SymPy => "*",
        }
    }

    /// A variable.
    #[must_use]
    pub fn variable(self, variable: &Variable) -> String {
        match (self, variable) {
            (_, Variable::Length(name)) => self.name(name),
            (Self::Latex, Variable::Cos(name)) => format!("\\cos {}", self.name(name)),
            (Self::Latex, Variable::Sin(name)) => format!("\\sin {}", self.name(name)),
            (_, Variable::Cos(name)) => format!("cos({})", self.name(name)),
            (_, Variable::Sin(name)) => format!("sin({})", self.name(name)),
        }
    }

    /// A symbol's name; for SymPy one that Python and the module leave free.
    #[must_use]
    pub fn name(self, name: &str) -> String {
        if self == Self::SymPy && TAKEN.contains(&name) {
            return format!("{name}_");
        }
        if self != Self::Latex {
            return name.to_owned();
        }
        let digits = name
            .find(|c: char| c.is_ascii_digit())
            .unwrap_or(name.len());
        let (letters, index) = name.split_at(digits);
        let greek = ["alpha", "gamma", "theta"].contains(&letters);
        let index = index.replace('_', "\\_");
        let head = match letters.len() {
            1 => letters.to_owned(),
            _ if greek => format!("\\{letters}"),
            _ => format!("\\mathit{{{}}}", letters.replace('_', "\\_")),
        };
        match index.is_empty() {
            true => head,
            false => format!("{head}_{{{index}}}"),
        }
    }

    fn power(self, (variable, exponent): &(Variable, u8)) -> String {
        let base = self.variable(variable);
        match (self, exponent, variable) {
            (_, 1, _) => base,
            (Self::Latex, e, Variable::Length(_)) => format!("{base}^{{{e}}}"),
            (Self::Latex, e, Variable::Cos(name)) => format!("\\cos^{{{e}}} {}", self.name(name)),
            (Self::Latex, e, Variable::Sin(name)) => format!("\\sin^{{{e}}} {}", self.name(name)),
            (Self::Text, e, _) => format!("{base}^{e}"),
            (Self::SymPy, e, _) => format!("{base}**{e}"),
        }
    }

    fn sum(self, terms: &[Term]) -> String {
        let mut text = String::new();
        for term in terms {
            let coefficient = term.coefficient();
            text += sign(text.is_empty(), coefficient.is_negative());
            let mut pieces: Vec<String> = match term {
                Term::Product(_, factors) => factors.iter().map(|f| self.power(f)).collect(),
                Term::Square(_, sum) => vec![self.square(sum)],
            };
            if !coefficient.abs().is_one() || pieces.is_empty() {
                pieces.insert(0, coefficient.abs().to_string());
            }
            text += &pieces.join(self.times());
        }
        text
    }

    fn square(self, sum: &[(BigInt, Variable)]) -> String {
        let mut text = String::new();
        for (factor, variable) in sum {
            text += sign(text.is_empty(), factor.is_negative());
            if !factor.abs().is_one() {
                text += &format!("{}{}", factor.abs(), self.times());
            }
            text += &self.variable(variable);
        }
        match self {
            Self::Text => format!("({text})^2"),
            Self::Latex => format!("({text})^{{2}}"),
            Self::SymPy => format!("({text})**2"),
        }
    }
}

/// Between the terms of a sum.
fn sign(first: bool, negative: bool) -> &'static str {
    match (first, negative) {
        (true, false) => "",
        (true, true) => "-",
        (false, false) => " + ",
        (false, true) => " - ",
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
