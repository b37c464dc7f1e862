//! Expressions in numbers of any precision.

use num_rational::BigRational;
use num_traits::Zero;

use crate::{Expr, LinearInPi, Quantity, Real};

/// Numbers that are told `r + s pi` as well as they can hold it.
pub(crate) trait OfLinear: Real {
    /// The value of `r + s pi`.
    fn of_linear(x: &LinearInPi) -> Self;
    /// Cosine and sine of an angle, exact at multiples of pi/2.
    fn cos_sin_of_linear(angle: &LinearInPi) -> (Self, Self);
    /// Exactly this number.
    fn to_rational(self) -> BigRational;
}

/// The value of an expression, `constants` being its named values: nearest where it is
/// `r + s pi`, else operation by operation. `None` where a name is unknown, a divisor is
/// zero or a radicand negative.
pub(crate) fn of_expr<T: OfLinear>(expr: &Expr, constants: &[(String, Quantity)]) -> Option<T> {
    if let Some(exact) = LinearInPi::of(expr, constants) {
        return Some(T::of_linear(&exact));
    }
    let value = |e: &Expr| of_expr::<T>(e, constants);
    let result = match expr {
        Expr::Number(_) | Expr::Pi => return None, // are of the form r + s pi
        Expr::Name(name) => {
            let at = constants.iter().position(|(n, _)| n == name)?;
            of_expr(&constants[at].1.expr, &constants[..at])?
        }
        Expr::Neg(a) => -value(a)?,
        Expr::Add(a, b) => value(a)? + value(b)?,
        Expr::Sub(a, b) => value(a)? - value(b)?,
        Expr::Mul(a, b) => value(a)? * value(b)?,
        Expr::Div(a, b) => value(a)? / value(b).filter(|b| b.to_f64() != 0.0)?,
        Expr::Sqrt(a) => value(a).filter(|a| a.to_f64() >= 0.0)?.sqrt(),
    };
    result.to_f64().is_finite().then_some(result)
}

/// Cosine and sine of an angle written as an expression; `None` as for [`of_expr`].
pub(crate) fn cos_sin_of_expr<T: OfLinear>(
    angle: &Expr,
    constants: &[(String, Quantity)],
) -> Option<(T, T)> {
    let exact = match LinearInPi::of(angle, constants) {
        Some(exact) => exact,
        None => LinearInPi {
            rational: of_expr::<T>(angle, constants)?.to_rational(),
            half_turns: BigRational::zero(),
        },
    };
    Some(T::cos_sin_of_linear(&exact))
}
