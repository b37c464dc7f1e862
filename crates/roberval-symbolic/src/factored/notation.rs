//! How formulas are written.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Signed};

use super::Term;
use crate::polynomial::Variable;

/// Decimals of more digits behind the point are written as fractions.
const MOST_DIGITS: usize = 9;

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

/// Letters that LaTeX has by these names.
const GREEK: [&str; 12] = [
    "alpha", "beta", "gamma", "delta", "epsilon", "theta", "lambda", "mu", "phi", "psi", "rho",
    "omega",
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
    /// `2 <i>R</i><sub>3</sub>`, names being identifiers.
    Html,
}

impl Notation {
    pub(super) fn times(self) -> &'static str {
        match self {
            Self::Text | Self::Latex => " ",
            Self::Html => "\u{a0}",
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
        let digits = name
            .find(|c: char| c.is_ascii_digit())
            .unwrap_or(name.len());
        let (letters, index) = name.split_at(digits);
        match self {
            Self::Text | Self::SymPy => return name.to_owned(),
            Self::Html if index.is_empty() => return format!("<i>{letters}</i>"),
            Self::Html => return format!("<i>{letters}</i><sub>{index}</sub>"),
            Self::Latex => {}
        }
        let greek = GREEK.contains(&letters);
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

    pub(super) fn power(self, (variable, exponent): &(Variable, u8)) -> String {
        let base = self.variable(variable);
        match (self, exponent, variable) {
            (_, 1, _) => base,
            (Self::Latex, e, Variable::Length(_)) => format!("{base}^{{{e}}}"),
            (Self::Latex, e, Variable::Cos(name)) => format!("\\cos^{{{e}}} {}", self.name(name)),
            (Self::Latex, e, Variable::Sin(name)) => format!("\\sin^{{{e}}} {}", self.name(name)),
            (Self::Text, e, _) => format!("{base}^{e}"),
            (Self::SymPy, e, _) => format!("{base}**{e}"),
            (Self::Html, e, _) => format!("{base}<sup>{e}</sup>"),
        }
    }

    /// A sum whose coefficients are to be taken times a number, such that they are decimals.
    pub(super) fn sum(self, terms: &[Term], times: &BigRational) -> String {
        let mut text = String::new();
        for term in terms {
            let coefficient = times * term.coefficient();
            text += sign(text.is_empty(), coefficient.is_negative());
            let mut pieces: Vec<String> = match term {
                Term::Product(_, factors) => factors.iter().map(|f| self.power(f)).collect(),
                Term::Square(_, sum) => vec![self.square(sum)],
            };
            if !coefficient.abs().is_one() || pieces.is_empty() {
                let size = coefficient.abs();
                pieces.insert(0, decimal(&size).unwrap_or_else(|| size.to_string()));
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
            Self::Html => format!("({text})<sup>2</sup>"),
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

/// A number that is not negative as a decimal; `None` if it is none of few digits.
pub(super) fn decimal(x: &BigRational) -> Option<String> {
    let scaled = |digits: usize| x * BigRational::from(BigInt::from(10).pow(digits as u32));
    let digits = (0..=MOST_DIGITS).find(|&digits| scaled(digits).is_integer())?;
    let all = format!(
        "{:0>width$}",
        scaled(digits).to_integer(),
        width = digits + 1
    );
    let (whole, behind) = all.split_at(all.len() - digits);
    Some(match behind {
        "" => whole.to_owned(),
        _ => format!("{whole}.{behind}"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fractions_of_powers_of_ten_are_decimals() {
        let text = |above: i64, below: i64| decimal(&BigRational::new(above.into(), below.into()));
        assert_eq!(text(9, 4).as_deref(), Some("2.25"));
        assert_eq!(text(1, 100).as_deref(), Some("0.01"));
        assert_eq!(text(300, 1).as_deref(), Some("300"));
        assert_eq!(text(1, 3), None);
    }
}
