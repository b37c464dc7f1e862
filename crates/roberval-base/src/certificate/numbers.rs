//! Numbers as texts that any reader of arithmetic expressions evaluates exactly: whole
//! numbers, `+ - * /`, brackets, `pi` and `sqrt()`.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Zero};
use roberval_regressor::AngleUnit;
use roberval_scalar::{Expr, LinearInPi, Quantity};

use super::CertificateError;
use crate::ExactNumber;

/// Named values of a description.
pub(super) type Constants = [(String, Quantity)];

/// Prime factors of radicands are looked for up to here.
const LARGEST_FACTOR: u32 = 1000;

/// The longest text of one number: constants written out may grow without end.
const LONGEST: usize = 4096;

/// The exact value of a number of the description.
pub(super) fn exact_text(
    quantity: &Quantity,
    constants: &Constants,
) -> Result<String, CertificateError> {
    let mut text = String::new();
    let fits = write(&quantity.expr, constants, &mut text);
    fits.then_some(text)
        .ok_or_else(|| CertificateError::TooLong {
            text: quantity.text.clone(),
            limit: LONGEST,
        })
}

/// The size of a unit of angles.
pub(super) fn unit_text(
    unit: &AngleUnit,
    constants: &Constants,
) -> Result<String, CertificateError> {
    match unit.exact() {
        Ok(exact) => Ok(linear(&exact)),
        Err(angle) => {
            let text = exact_text(angle, constants)?;
            let negative = angle.value < 0.0;
            Ok(if negative { format!("-({text})") } else { text })
        }
    }
}

/// Appends the expression; false if it became too long.
fn write(expr: &Expr, constants: &Constants, text: &mut String) -> bool {
    if text.len() > LONGEST {
        return false;
    }
    if let Some(exact) = LinearInPi::of(expr, constants) {
        text.push_str(&linear(&exact));
        return text.len() <= LONGEST;
    }
    let mut pair = |a: &Expr, sign: &str, b: &Expr| {
        text.push('(');
        let first = write(a, constants, text);
        text.push_str(sign);
        let both = first && write(b, constants, text);
        text.push(')');
        both
    };
    match expr {
        Expr::Add(a, b) => pair(a, " + ", b),
        Expr::Sub(a, b) => pair(a, " - ", b),
        Expr::Mul(a, b) => pair(a, " * ", b),
        Expr::Div(a, b) => pair(a, " / ", b),
        Expr::Neg(a) => {
            text.push_str("-(");
            let fits = write(a, constants, text);
            text.push(')');
            fits
        }
        Expr::Sqrt(a) => {
            if let Some(square) = LinearInPi::of(a, constants)
                && let Some(square) = square.as_rational()
            {
                text.push_str(&root_of_fraction(square));
                return text.len() <= LONGEST;
            }
            text.push_str("sqrt(");
            let fits = write(a, constants, text);
            text.push(')');
            fits
        }
        Expr::Name(name) => match constants.iter().position(|(n, _)| n == name) {
            Some(at) => write(&constants[at].1.expr, &constants[..at], text),
            None => false,
        },
        // These are of the form r + s pi.
        Expr::Number(_) | Expr::Pi => false,
    }
}

/// `sqrt(n/d) = sqrt(n d)/d`, a product of square roots of primes where these are easy
/// to find: a prime field has a certain root of 2, 3 and 5, and must be asked for those.
pub(super) fn root_of_fraction(square: &BigRational) -> String {
    let mut rest = square.numer() * square.denom();
    let mut factor = BigRational::new(BigInt::one(), square.denom().clone());
    let mut roots = Vec::new();
    for q in 2..LARGEST_FACTOR {
        while (&rest % (q * q)).is_zero() {
            rest /= q * q;
            factor *= BigInt::from(q);
        }
        if (&rest % q).is_zero() {
            rest /= q;
            roots.push(format!("*sqrt({q})"));
        }
    }
    if !rest.is_one() {
        roots.push(format!("*sqrt({rest})"));
    }
    format!("({factor}{})", roots.concat())
}

/// `(3/10)`, `(1/2*pi)` or `(3/10 + 1/2*pi)`; brackets only where there is an operation.
fn linear(x: &LinearInPi) -> String {
    match (x.rational.is_zero(), x.half_turns.is_zero()) {
        (_, true) => bracketed(x.rational.to_string()),
        (true, false) => format!("({}*pi)", x.half_turns),
        (false, false) => format!("({} + {}*pi)", x.rational, x.half_turns),
    }
}

fn bracketed(text: String) -> String {
    if text.contains(['/', '-']) {
        format!("({text})")
    } else {
        text
    }
}

/// A coefficient of beta: a fraction, a sum with square roots, or, after `nearest`, the
/// double as `m*2^k` with the 53 bits of m; `0*2^-256` for what is nearer to 0 than half of
/// that.
pub(super) fn coefficient(x: &ExactNumber) -> String {
    match x {
        ExactNumber::Rational(r) => r.to_string(),
        ExactNumber::Surd(terms) => {
            let term = |(n, r): &(u32, BigRational)| match n {
                1 => r.to_string(),
                n => format!("{r}*{}", root_of_fraction(&BigInt::from(*n).into())),
            };
            terms.iter().map(term).collect::<Vec<_>>().join(" + ")
        }
        ExactNumber::Rounded(x) => {
            let (m, k) = if x.is_normal() { parts(*x) } else { (0, -256) };
            format!("nearest {m}*2^{k}")
        }
    }
}

/// (m, k) of the normal double m 2^k, m having 53 bits.
fn parts(x: f64) -> (i64, i64) {
    const FRACTION: u32 = f64::MANTISSA_DIGITS - 1;
    let bits = x.abs().to_bits();
    let m = (1 << FRACTION | bits & ((1 << FRACTION) - 1)) as i64;
    let k = (bits >> FRACTION) as i64 - 1075;
    (if x < 0.0 { -m } else { m }, k)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(written: &str) -> String {
        let third = Quantity::parse_number("1/3", &[]).expect("a number");
        let constants = [("third".to_owned(), third)];
        let quantity = Quantity::parse_angle(written, &constants).expect("an angle");
        exact_text(&quantity, &constants).expect("short")
    }

    #[test]
    fn numbers_are_written_exactly_and_without_names() {
        assert_eq!(text("0.290"), "(29/100)");
        assert_eq!(text("-3"), "(-3)");
        assert_eq!(text("-90 deg"), "(-1/2*pi)");
        assert_eq!(text("third - 2*pi"), "(1/3 + -2*pi)");
        assert_eq!(
            text("-sqrt(2*third)/third"),
            "(-((1/3*sqrt(2)*sqrt(3))) / (1/3))"
        );
    }

    #[test]
    fn constants_that_grow_without_end_are_refused() {
        let mut constants: Vec<(String, Quantity)> = Vec::new();
        let mut before = "sqrt(2)".to_owned();
        for k in 0..40 {
            let quantity = Quantity::parse_number(&format!("{before} + {before}"), &constants);
            let name = format!("c{k}");
            constants.push((name.clone(), quantity.expect("a number")));
            before = name;
        }
        let last = constants.pop().expect("forty").1;
        assert!(matches!(
            exact_text(&last, &constants),
            Err(CertificateError::TooLong { .. })
        ));
    }

    #[test]
    fn doubles_are_written_with_all_their_bits() {
        let text = |x: f64| coefficient(&ExactNumber::Rounded(x));
        assert_eq!(text(1.0), "nearest 4503599627370496*2^-52");
        assert_eq!(text(-0.1), "nearest -7205759403792794*2^-56");
        assert_eq!(text(2_f64.powi(70)), "nearest 4503599627370496*2^18");
        assert_eq!(text(0.0), "nearest 0*2^-256");
        for x in [1e300, -1e-300, 5.2e16, 1.0 / 3.0] {
            let (m, k) = parts(x);
            assert_eq!(
                m as f64 * 2_f64.powi(k as i32 / 2) * 2_f64.powi(k as i32 - k as i32 / 2),
                x
            );
        }
    }
}
