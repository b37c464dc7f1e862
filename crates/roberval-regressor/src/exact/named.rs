//! Where named constants stand in expressions.

use roberval_scalar::{Expr, LinearInPi, Quantity};

/// How often a constant stands in an angle's expression: k of `k name + rest`. 0 where it
/// stands otherwise.
pub(crate) fn times(expr: &Expr, constants: &[(String, Quantity)], name: &str) -> i64 {
    whole_multiple(expr, constants, name).unwrap_or(0)
}

/// k of `k name + rest` for a whole number k, rest without that name; `None` if the
/// constant stands in the expression otherwise.
#[must_use]
pub fn whole_multiple(expr: &Expr, constants: &[(String, Quantity)], name: &str) -> Option<i64> {
    let of = |e: &Expr| whole_multiple(e, constants, name);
    let number = |e: &Expr| {
        let value = LinearInPi::of(e, constants)?.as_rational()?.clone();
        value
            .is_integer()
            .then(|| i64::try_from(value.numer()).ok())?
    };
    match expr {
        Expr::Number(_) | Expr::Pi => Some(0),
        Expr::Name(own) if own == name => Some(1),
        Expr::Name(other) => {
            let at = constants.iter().position(|(n, _)| n == other)?;
            whole_multiple(&constants[at].1.expr, &constants[..at], name)
        }
        Expr::Neg(a) => of(a).map(|k| -k),
        Expr::Add(a, b) => of(a)?.checked_add(of(b)?),
        Expr::Sub(a, b) => of(a)?.checked_sub(of(b)?),
        Expr::Mul(a, b) => match (of(a)?, of(b)?) {
            (0, 0) => Some(0),
            (0, k) => number(a)?.checked_mul(k),
            (k, 0) => number(b)?.checked_mul(k),
            _ => None,
        },
        Expr::Div(a, b) => match (of(a)?, of(b)?) {
            (0, 0) => Some(0),
            (k, 0) => number(b).filter(|d| *d != 0 && k % d == 0).map(|d| k / d),
            _ => None,
        },
        Expr::Sqrt(a) => of(a).filter(|k| *k == 0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constants_are_counted_with_their_signs_and_through_other_constants() {
        let mut constants = Vec::new();
        for (name, text) in [("A", "0.3"), ("B", "pi/2 - 2*A"), ("C", "0.1")] {
            let value = Quantity::parse_angle(text, &constants).unwrap();
            constants.push((name.to_owned(), value));
        }
        for (text, expected) in [
            ("A", Some(1)),
            ("-A + 90*(pi/180)", Some(-1)),
            ("3*B + C", Some(-6)),
            ("(4*A)/2", Some(2)),
            ("A*A", None),
            ("A/2", None),
            ("C/2", Some(0)),
        ] {
            let expr = Quantity::parse_angle(text, &constants).unwrap().expr;
            assert_eq!(whole_multiple(&expr, &constants, "A"), expected, "{text}");
        }
    }
}
