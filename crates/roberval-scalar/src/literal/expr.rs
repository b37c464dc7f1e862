use std::fmt;

use super::Decimal;

/// An expression as the user wrote it, kept as a tree so that it can be evaluated in
/// floats, exactly, or in symbols.
///
/// A minus sign right before a number belongs to the number.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Expr {
    /// A decimal number.
    Number(Decimal),
    /// A named constant of the robot file.
    Name(String),
    /// The number pi.
    Pi,
    /// `-a`
    Neg(Box<Expr>),
    /// `a + b`
    Add(Box<Expr>, Box<Expr>),
    /// `a - b`
    Sub(Box<Expr>, Box<Expr>),
    /// `a * b`
    Mul(Box<Expr>, Box<Expr>),
    /// `a / b`
    Div(Box<Expr>, Box<Expr>),
    /// `sqrt(a)`
    Sqrt(Box<Expr>),
}

impl Expr {
    /// `self * (pi / 180)`: an angle in degrees.
    pub(super) fn degrees(self) -> Self {
        let half_turn = Self::Number(Decimal {
            mantissa: 18.into(),
            exponent: 1,
        });
        let unit = Self::Div(Box::new(Self::Pi), Box::new(half_turn));
        Self::Mul(Box::new(self), Box::new(unit))
    }

    /// How tightly the outermost operation binds: 0 sums, 1 products, 2 all the rest.
    fn precedence(&self) -> u8 {
        match self {
            Self::Add(..) | Self::Sub(..) => 0,
            Self::Mul(..) | Self::Div(..) => 1,
            _ => 2,
        }
    }

    fn write_operand(&self, f: &mut fmt::Formatter<'_>, least: u8) -> fmt::Result {
        if self.precedence() < least {
            write!(f, "({self})")
        } else {
            write!(f, "{self}")
        }
    }
}

impl fmt::Display for Expr {
    /// A text that reads back as the same tree.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (a, sign, b, level) = match self {
            Self::Number(x) => return write!(f, "{x}"),
            Self::Name(name) => return f.write_str(name),
            Self::Pi => return f.write_str("pi"),
            Self::Sqrt(a) => return write!(f, "sqrt({a})"),
            Self::Neg(a) => return write!(f, "-({a})"),
            Self::Add(a, b) => (a, '+', b, 0),
            Self::Sub(a, b) => (a, '-', b, 0),
            Self::Mul(a, b) => (a, '*', b, 1),
            Self::Div(a, b) => (a, '/', b, 1),
        };
        a.write_operand(f, level)?;
        write!(f, " {sign} ")?;
        b.write_operand(f, level + 1)
    }
}
