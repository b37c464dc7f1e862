//! Numbers as the user wrote them: text, tree and float value side by side.

mod decimal;
mod evaluate;
mod expr;
mod parse;

use std::fmt;

use num_bigint::BigInt;
use num_rational::BigRational;

use crate::nearest_double;
pub use decimal::Decimal;
pub use expr::Expr;

/// The longest number or expression that is read, in bytes.
pub const MAX_LITERAL_BYTES: usize = 1000;

/// The deepest nesting of brackets, signs and functions in an expression.
pub const MAX_LITERAL_DEPTH: usize = 100;

/// Named values that an expression may use, in the order of their definition.
pub type Constants = [(String, Quantity)];

/// Whether a constant may have this name: letters, digits and `_`, no digit first, and
/// not a word of the grammar (`pi`, `sqrt`, `deg`, `nan`, `inf`).
#[must_use]
pub fn is_constant_name(name: &str) -> bool {
    let reserved = ["pi", "sqrt", "deg"].contains(&name)
        || ["nan", "inf", "infinity"].contains(&name.to_ascii_lowercase().as_str());
    !reserved
        && name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

/// What kind of fault a literal has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum LiteralFault {
    /// The text does not follow the grammar.
    Syntax,
    /// A name that is not among the constants.
    UnknownName,
    /// The value is not a finite real number: division by zero, square root of a
    /// negative number, overflow, `nan`, `inf`.
    NotFinite,
    /// The text is too long or too deeply nested.
    TooLarge,
}

/// What is wrong with a number or expression.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message}{}", hint.as_ref().map(|h| format!("; {h}")).unwrap_or_default())]
pub struct LiteralError {
    /// The kind of fault.
    pub fault: LiteralFault,
    /// What is wrong.
    pub message: String,
    /// What would be right, where that is known.
    pub hint: Option<String>,
    /// Byte offset in the text, where known.
    pub offset: Option<usize>,
}

impl LiteralError {
    fn new(fault: LiteralFault, message: impl Into<String>) -> Self {
        Self {
            fault,
            message: message.into(),
            hint: None,
            offset: None,
        }
    }

    fn syntax(offset: usize, message: impl Into<String>) -> Self {
        Self::new(LiteralFault::Syntax, message).at(offset)
    }

    fn not_finite(message: impl Into<String>) -> Self {
        Self::new(LiteralFault::NotFinite, message)
    }

    fn at(mut self, offset: usize) -> Self {
        self.offset = Some(offset);
        self
    }

    fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }
}

/// A number as written (text and expression) and its value as a float.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// The text as written, e.g. `-90 deg`, `D3`, `0.29`.
    pub text: String,
    /// The same as a tree; degrees are spelled out as `x * (pi / 180)`.
    pub expr: Expr,
    /// The value in SI units (m, rad, kg, kg m^2, m/s^2); always finite.
    pub value: f64,
}

impl Quantity {
    /// The number 0.
    #[must_use]
    pub fn zero() -> Self {
        Self {
            text: "0".to_owned(),
            expr: Expr::Number(Decimal::zero()),
            value: 0.0,
        }
    }

    /// A fraction, written `n/d` (or as an integer).
    #[must_use]
    pub fn from_rational(x: &BigRational) -> Self {
        let whole = |n: &BigInt| Expr::Number(Decimal::integer(n.clone()));
        let expr = if x.is_integer() {
            whole(x.numer())
        } else {
            Expr::Div(Box::new(whole(x.numer())), Box::new(whole(x.denom())))
        };
        Self {
            text: x.to_string(),
            expr,
            value: nearest_double(x),
        }
    }

    /// A computed number, written as the shortest decimal that reads back as `x`.
    ///
    /// # Errors
    /// When `x` is NaN or infinite.
    pub fn from_f64(x: f64) -> Result<Self, LiteralError> {
        if !x.is_finite() {
            return Err(LiteralError::not_finite(format!(
                "{x} is not a finite number"
            )));
        }
        let text = format!("{x:?}");
        Self::parse_decimal(text.strip_suffix(".0").unwrap_or(&text))
    }

    /// Reads a plain decimal number such as `-1.5e-3`: no expression, no name.
    ///
    /// # Errors
    /// When the text is not one finite decimal number.
    pub fn parse_decimal(text: &str) -> Result<Self, LiteralError> {
        let text = text.trim();
        let decimal = Decimal::parse(text)?;
        let value = decimal.to_f64();
        if !value.is_finite() {
            return Err(evaluate::overflow(text));
        }
        Ok(Self {
            text: text.to_owned(),
            expr: Expr::Number(decimal),
            value,
        })
    }

    /// Reads a number or an expression of numbers, constants, `pi`, `+ - * / ( )` and
    /// `sqrt()` that has no unit of its own.
    ///
    /// # Errors
    /// When the text does not follow the grammar, uses an unknown name, has no finite
    /// value, or is too long or too deeply nested.
    pub fn parse_number(text: &str, constants: &Constants) -> Result<Self, LiteralError> {
        let expr = parse::expression(text, parse::Degrees::Refused)?;
        Self::evaluated(text, expr, constants)
    }

    /// Reads a length in metres, as [`Quantity::parse_number`] does.
    ///
    /// # Errors
    /// As [`Quantity::parse_number`].
    pub fn parse_length(text: &str, constants: &Constants) -> Result<Self, LiteralError> {
        Self::parse_number(text, constants)
    }

    /// Reads an angle: a number or expression in radians, or one in degrees that ends in
    /// `deg` (`-90 deg`, `(45/2) deg`).
    ///
    /// # Errors
    /// As [`Quantity::parse_number`].
    pub fn parse_angle(text: &str, constants: &Constants) -> Result<Self, LiteralError> {
        let expr = parse::expression(text, parse::Degrees::Allowed)?;
        Self::evaluated(text, expr, constants)
    }

    fn evaluated(text: &str, expr: Expr, constants: &Constants) -> Result<Self, LiteralError> {
        let value = expr.to_f64(constants)?;
        Ok(Self {
            text: text.trim().to_owned(),
            expr,
            value,
        })
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// A text for a message: quoted, control characters escaped, cut when long.
fn quoted(text: &str) -> String {
    let head: String = text.chars().take(60).collect();
    let dots = if head.len() < text.len() { "..." } else { "" };
    format!("{head:?}{dots}")
}

#[cfg(test)]
mod tests;
