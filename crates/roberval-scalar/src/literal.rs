use std::fmt;

use num_bigint::BigInt;

/// A decimal number exactly as written: `mantissa * 10^exponent`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Decimal {
    /// All digits, with the sign.
    pub mantissa: BigInt,
    /// Power of ten.
    pub exponent: i32,
}

/// An expression as the user wrote it, kept as a tree so that it can be evaluated in
/// floats, exactly, or in symbols.
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

/// What is wrong with a number or expression.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{message}")]
pub struct LiteralError {
    /// What is wrong, and what would be right.
    pub message: String,
    /// Byte offset in the text, where known.
    pub offset: Option<usize>,
}

/// A number as written (text and expression) and its value as a float.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// The text as written, e.g. `-90 deg`, `D3`, `0.29`.
    pub text: String,
    /// The same as a tree; degrees are spelled out as `x * (pi / 180)`.
    pub expr: Expr,
    /// The value in SI units (m, rad, kg, kg m^2, m/s^2).
    pub value: f64,
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}
