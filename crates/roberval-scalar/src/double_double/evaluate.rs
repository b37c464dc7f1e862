//! Expressions in double-double arithmetic.

use num_rational::BigRational;
use num_traits::Zero;

use super::DoubleDouble;
use crate::{Expr, LinearInPi, Quantity};

impl DoubleDouble {
    /// The value of an expression, `constants` being its named values: nearest where it
    /// is `r + s pi`, else operation by operation. `None` where a name is unknown, a
    /// divisor is zero or a radicand negative.
    #[must_use]
    pub fn of_expr(expr: &Expr, constants: &[(String, Quantity)]) -> Option<Self> {
        if let Some(exact) = LinearInPi::of(expr, constants) {
            return Some(Self::of_linear(&exact));
        }
        let value = |e: &Expr| Self::of_expr(e, constants);
        let result = match expr {
            Expr::Number(_) | Expr::Pi => return None, // are of the form r + s pi
            Expr::Name(name) => {
                let at = constants.iter().position(|(n, _)| n == name)?;
                Self::of_expr(&constants[at].1.expr, &constants[..at])?
            }
            Expr::Neg(a) => -value(a)?,
            Expr::Add(a, b) => value(a)? + value(b)?,
            Expr::Sub(a, b) => value(a)? - value(b)?,
            Expr::Mul(a, b) => value(a)? * value(b)?,
            Expr::Div(a, b) => value(a)? / value(b)?,
            Expr::Sqrt(a) => value(a)?.sqrt(),
        };
        result.to_f64().is_finite().then_some(result)
    }

    /// Cosine and sine of an angle written as an expression; `None` as for
    /// [`DoubleDouble::of_expr`].
    #[must_use]
    pub fn cos_sin_of_expr(angle: &Expr, constants: &[(String, Quantity)]) -> Option<(Self, Self)> {
        let exact = match LinearInPi::of(angle, constants) {
            Some(exact) => exact,
            None => LinearInPi {
                rational: Self::of_expr(angle, constants)?.to_rational(),
                half_turns: BigRational::zero(),
            },
        };
        Some(Self::cos_sin(&exact))
    }
}
