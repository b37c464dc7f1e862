//! How expressions depend on constants.

use num_traits::Zero;
use roberval_scalar::{Expr, LinearInPi, Quantity};

/// Whether an angle is a multiple of 90 degrees.
pub(super) fn is_right(angle: &Quantity, constants: &[(String, Quantity)]) -> bool {
    LinearInPi::of(&angle.expr, constants).is_some_and(|x| {
        let quarters = x.half_turns * num_bigint::BigInt::from(2);
        x.rational.is_zero() && quarters.is_integer()
    })
}

/// Whether an expression uses a name itself.
pub(super) fn names(expr: &Expr, name: &str) -> bool {
    find(expr, &mut |e| matches!(e, Expr::Name(own) if own == name))
}

/// Whether an expression depends on a constant, be it through others.
pub(super) fn stands_in(expr: &Expr, constants: &[(String, Quantity)], name: &str) -> bool {
    find(expr, &mut |e| match e {
        Expr::Name(own) if own == name => true,
        Expr::Name(other) => {
            let at = constants.iter().position(|(n, _)| n == other);
            at.is_some_and(|at| stands_in(&constants[at].1.expr, &constants[..at], name))
        }
        _ => false,
    })
}

/// Whether an expression takes a square root of something that depends on a constant.
pub(super) fn under_root(expr: &Expr, constants: &[(String, Quantity)], name: &str) -> bool {
    find(expr, &mut |e| match e {
        Expr::Sqrt(inner) => stands_in(inner, constants, name),
        Expr::Name(other) => {
            let at = constants.iter().position(|(n, _)| n == other);
            at.is_some_and(|at| under_root(&constants[at].1.expr, &constants[..at], name))
        }
        _ => false,
    })
}

/// Degrees of an expression, above and below, in the constants that are symbols.
pub(super) fn degrees(
    expr: &Expr,
    constants: &[(String, Quantity)],
    symbol: &dyn Fn(&str) -> bool,
) -> (usize, usize) {
    let of = |inner: &Expr| degrees(inner, constants, symbol);
    match expr {
        Expr::Number(_) | Expr::Pi => (0, 0),
        Expr::Name(name) if symbol(name) => (1, 0),
        Expr::Name(name) => match constants.iter().position(|(n, _)| n == name) {
            Some(at) => degrees(&constants[at].1.expr, &constants[..at], symbol),
            None => (0, 0),
        },
        Expr::Neg(a) | Expr::Sqrt(a) => of(a),
        Expr::Add(a, b) | Expr::Sub(a, b) => {
            let ((a, below_a), (b, below_b)) = (of(a), of(b));
            ((a + below_b).max(b + below_a), below_a + below_b)
        }
        Expr::Mul(a, b) => {
            let ((a, below_a), (b, below_b)) = (of(a), of(b));
            (a + b, below_a + below_b)
        }
        Expr::Div(a, b) => {
            let ((a, below_a), (b, below_b)) = (of(a), of(b));
            (a + below_b, below_a + b)
        }
    }
}

/// Whether a part of an expression is such.
fn find(expr: &Expr, such: &mut impl FnMut(&Expr) -> bool) -> bool {
    such(expr)
        || match expr {
            Expr::Number(_) | Expr::Name(_) | Expr::Pi => false,
            Expr::Neg(a) | Expr::Sqrt(a) => find(a, such),
            Expr::Add(a, b) | Expr::Sub(a, b) | Expr::Mul(a, b) | Expr::Div(a, b) => {
                find(a, such) || find(b, such)
            }
        }
}
