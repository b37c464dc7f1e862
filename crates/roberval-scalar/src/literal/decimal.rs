use std::fmt;

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed, Zero};

use super::{LiteralError, LiteralFault, MAX_LITERAL_BYTES, quoted};

/// The largest power of ten that is read: beyond it a number is certainly no double.
const MAX_EXPONENT: i32 = 9999;

/// A decimal number exactly as written: `mantissa * 10^exponent`.
///
/// Canonical: the mantissa has no trailing zeros, and zero is `0 * 10^0`. So two
/// decimals are equal as values exactly when they are equal as structures.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Decimal {
    /// All digits, with the sign.
    pub mantissa: BigInt,
    /// Power of ten.
    pub exponent: i32,
}

impl Decimal {
    /// The number 0.
    #[must_use]
    pub fn zero() -> Self {
        Self {
            mantissa: BigInt::zero(),
            exponent: 0,
        }
    }

    /// A whole number.
    #[must_use]
    pub fn integer(mut mantissa: BigInt) -> Self {
        let ten = BigInt::from(10);
        let mut exponent = 0;
        while !mantissa.is_zero() && (&mantissa % &ten).is_zero() {
            mantissa /= &ten;
            exponent += 1;
        }
        Self { mantissa, exponent }
    }

    /// Reads `[+-] digits [. digits] [e [+-] digits]`; one side of the point may be empty.
    ///
    /// # Errors
    /// When the text is anything else, or too long, or its exponent beyond +-9999.
    pub fn parse(text: &str) -> Result<Self, LiteralError> {
        if text.len() > MAX_LITERAL_BYTES {
            return Err(too_long(text));
        }
        let unsigned = text.strip_prefix(['+', '-']).unwrap_or(text);
        let offset = text.len() - unsigned.len();
        let end = scan(unsigned);
        if end == 0 || end < unsigned.len() {
            return Err(not_a_number(text, offset + end));
        }
        let decimal = Self::from_scanned(unsigned).map_err(|e| e.at(offset))?;
        Ok(if text.starts_with('-') {
            decimal.negated()
        } else {
            decimal
        })
    }

    /// The value of a text that [`scan`] took as a whole.
    pub(super) fn from_scanned(text: &str) -> Result<Self, LiteralError> {
        let (digits, power) = match text.find(['e', 'E']) {
            Some(at) => (&text[..at], exponent(&text[at + 1..])?),
            None => (text, 0),
        };
        let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
        let all = format!("{whole}{fraction}");
        let significant = all.trim_end_matches('0');
        let dropped = (all.len() - significant.len()) as i32;
        // Only ASCII digits are left; no digits at all is zero.
        let mantissa: BigInt = significant.parse().unwrap_or_default();
        if mantissa.is_zero() {
            return Ok(Self::zero());
        }
        let exponent = power - fraction.len() as i32 + dropped;
        if exponent.abs() > MAX_EXPONENT {
            return Err(out_of_range(text));
        }
        Ok(Self { mantissa, exponent })
    }

    /// `-self`
    #[must_use]
    pub fn negated(self) -> Self {
        Self {
            mantissa: -self.mantissa,
            exponent: self.exponent,
        }
    }

    /// The nearest double (ties to even); infinite beyond the doubles' range.
    #[must_use]
    pub fn to_f64(&self) -> f64 {
        // The standard library's reader rounds correctly, digit strings of any length.
        format!("{}e{}", self.mantissa, self.exponent)
            .parse()
            .unwrap_or(f64::NAN)
    }

    /// The same number as a fraction in lowest terms.
    #[must_use]
    pub fn to_rational(&self) -> BigRational {
        let power = BigInt::from(10).pow(self.exponent.unsigned_abs());
        if self.exponent < 0 {
            BigRational::new(self.mantissa.clone(), power)
        } else {
            BigRational::from(&self.mantissa * power)
        }
    }
}

impl fmt::Display for Decimal {
    /// Plain digits where that is short, else with an exponent; reads back as itself.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let digits = self.mantissa.abs().to_string();
        let sign = if self.mantissa.is_negative() { "-" } else { "" };
        let places = self.exponent.unsigned_abs() as usize;
        if self.exponent == 0 {
            write!(f, "{sign}{digits}")
        } else if self.exponent < 0 && places <= 20 {
            let digits = format!("{digits:0>width$}", width = places + 1);
            let (whole, fraction) = digits.split_at(digits.len() - places);
            write!(f, "{sign}{whole}.{fraction}")
        } else {
            write!(f, "{sign}{digits}e{}", self.exponent)
        }
    }
}

/// Length of the unsigned decimal number at the start of `text`; 0 if there is none.
pub(super) fn scan(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |from: usize| {
        bytes[from..]
            .iter()
            .take_while(|b| b.is_ascii_digit())
            .count()
    };
    let whole = digits(0);
    let mut end = whole;
    let mut fraction = 0;
    if bytes.get(end) == Some(&b'.') {
        fraction = digits(end + 1);
        end += 1 + fraction;
    }
    if whole + fraction == 0 {
        return 0;
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let power = digits((end + 1 + sign).min(bytes.len()));
        if power > 0 {
            end += 1 + sign + power;
        }
    }
    end
}

fn exponent(text: &str) -> Result<i32, LiteralError> {
    text.parse()
        .ok()
        .filter(|e: &i32| e.abs() <= MAX_EXPONENT)
        .ok_or_else(|| out_of_range(text))
}

fn out_of_range(text: &str) -> LiteralError {
    LiteralError::not_finite(format!("the exponent {} is out of range", quoted(text)))
        .hint(format!("at most +-{MAX_EXPONENT}"))
}

pub(super) fn too_long(text: &str) -> LiteralError {
    LiteralError::new(
        LiteralFault::TooLarge,
        format!(
            "the number or expression {} has {} bytes",
            quoted(text),
            text.len()
        ),
    )
    .hint(format!("at most {MAX_LITERAL_BYTES}"))
}

/// The error for a text that is not one decimal number, wrong from `offset` on.
fn not_a_number(text: &str, offset: usize) -> LiteralError {
    let bare = text.trim_start_matches(['+', '-']).to_ascii_lowercase();
    if ["nan", "inf", "infinity"].contains(&bare.as_str()) {
        return LiteralError::not_finite(format!("{} is not a finite number", quoted(text)))
            .at(offset);
    }
    let error = LiteralError::syntax(offset, format!("{} is not a number", quoted(text)));
    let rest = &text[offset..];
    error.hint(if text.is_empty() {
        "write a decimal number such as 0.25"
    } else if rest == "," {
        "leave the comma out: numbers are separated by spaces"
    } else if rest.starts_with(',') {
        "write a decimal point, not a comma"
    } else if rest.starts_with(['x', 'X']) {
        "write it in decimal, not in hexadecimal"
    } else if text.contains(['\u{2212}', '\u{2013}']) {
        "write the minus sign as -"
    } else {
        "write a decimal number such as -1.5 or 2e-3"
    })
}
