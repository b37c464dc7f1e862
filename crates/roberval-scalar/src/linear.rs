//! Exact values of expressions: a rational number plus a rational multiple of pi.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Zero};

use crate::{Expr, Quantity};

/// `rational + pi * turns2`, the exact value of most angles and lengths.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct LinearInPi {
    /// The part without pi.
    pub rational: BigRational,
    /// The factor of pi: half turns, if this is an angle.
    pub half_turns: BigRational,
}

impl LinearInPi {
    fn rational(rational: BigRational) -> Self {
        Self {
            rational,
            half_turns: BigRational::zero(),
        }
    }

    fn map(self, f: impl Fn(BigRational) -> BigRational) -> Self {
        Self {
            rational: f(self.rational),
            half_turns: f(self.half_turns),
        }
    }

    /// The exact value of an expression, `constants` being its named values; `None` if
    /// it is not of this form (square roots of non-squares, products of pi).
    #[must_use]
    pub fn of(expr: &Expr, constants: &[(String, Quantity)]) -> Option<Self> {
        let value = |e: &Expr| Self::of(e, constants);
        match expr {
            Expr::Number(decimal) => Some(Self::rational(decimal.to_rational())),
            Expr::Name(name) => {
                let at = constants.iter().position(|(n, _)| n == name)?;
                // A constant refers to earlier ones only, so that this ends.
                Self::of(&constants[at].1.expr, &constants[..at])
            }
            Expr::Pi => Some(Self {
                rational: BigRational::zero(),
                half_turns: BigRational::one(),
            }),
            Expr::Neg(a) => value(a).map(|a| a.map(|x| -x)),
            Expr::Add(a, b) => Some(value(a)?.plus(value(b)?)),
            Expr::Sub(a, b) => Some(value(a)?.plus(value(b)?.map(|x| -x))),
            Expr::Mul(a, b) => {
                let (a, b) = (value(a)?, value(b)?);
                let (factor, other) = match (a.as_rational(), b.as_rational()) {
                    (Some(a), _) => (a.clone(), b),
                    (None, Some(b)) => (b.clone(), a),
                    (None, None) => return None,
                };
                Some(other.map(|x| x * &factor))
            }
            Expr::Div(a, b) => {
                let (a, b) = (value(a)?, value(b)?);
                let divisor = b.as_rational()?.clone();
                (!divisor.is_zero()).then(|| a.map(|x| x / &divisor))
            }
            Expr::Sqrt(a) => {
                let a = value(a)?;
                let square = a.as_rational()?;
                let root = |n: &BigInt| Some(n.sqrt()).filter(|r| r * r == *n);
                let root = BigRational::new(root(square.numer())?, root(square.denom())?);
                Some(Self::rational(root))
            }
        }
    }

    /// The value, if pi is not in it.
    #[must_use]
    pub fn as_rational(&self) -> Option<&BigRational> {
        self.half_turns.is_zero().then_some(&self.rational)
    }

    fn plus(self, other: Self) -> Self {
        Self {
            rational: self.rational + other.rational,
            half_turns: self.half_turns + other.half_turns,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str) -> Option<(String, String)> {
        let constants = [
            (
                "a".to_owned(),
                Quantity::parse_number("0.3", &[]).expect("a number"),
            ),
            (
                "b".to_owned(),
                Quantity::parse_number(
                    "2*a",
                    &[(
                        "a".to_owned(),
                        Quantity::parse_number("0.3", &[]).expect("a number"),
                    )],
                )
                .expect("a number"),
            ),
        ];
        let expr = Quantity::parse_number(text, &constants)
            .expect("an expression")
            .expr;
        let exact = LinearInPi::of(&expr, &constants)?;
        Some((exact.rational.to_string(), exact.half_turns.to_string()))
    }

    #[test]
    fn decimals_are_fractions_and_pi_stays_apart() {
        let pair = |a: &str, b: &str| Some((a.to_owned(), b.to_owned()));
        assert_eq!(value("0.29"), pair("29/100", "0"));
        assert_eq!(value("3*pi/4 - 1.5e-3"), pair("-3/2000", "3/4"));
        assert_eq!(value("b*b + sqrt(4/9)"), pair("77/75", "0"));
        assert_eq!(value("pi*a"), pair("0", "3/10"));
        assert_eq!(value("sqrt(2)"), None);
        assert_eq!(value("pi*pi"), None);
    }

    #[test]
    fn degrees_are_fractions_of_pi() {
        let angle = Quantity::parse_angle("-22.5 deg", &[]).expect("an angle");
        let exact = LinearInPi::of(&angle.expr, &[]).expect("linear in pi");
        assert_eq!(exact.half_turns.to_string(), "-1/8");
        assert!(exact.rational.is_zero());
    }
}
