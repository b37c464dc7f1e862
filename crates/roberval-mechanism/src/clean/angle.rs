//! Multiples of pi/12: the nearest one, how far away it is, and its text.

use std::f64::consts::PI;

use roberval_scalar::{Constants, Expr, LinearInPi, Quantity};

/// pi minus the double nearest to it.
const PI_REST: f64 = 1.224_646_799_147_353_2e-16;

/// Beyond this many turns no decimal is a rounded multiple of pi/12 by intention.
const MOST_TURNS: f64 = 16.0;

/// The k of the multiple k pi/12 nearest to an angle, and |angle - k pi/12| in rad to
/// full relative precision; `None` for angles of more than sixteen turns.
pub(super) fn nearest(angle: f64) -> Option<(i32, f64)> {
    if angle.abs() > MOST_TURNS * 2.0 * PI {
        return None;
    }
    let k = (angle * 12.0 / PI).round();
    // 12 angle - k pi, each product as an exact sum of two doubles.
    let (turn, turn_rest) = (12.0 * angle, 12.0_f64.mul_add(angle, -12.0 * angle));
    let (multiple, multiple_rest) = (k * PI, k.mul_add(PI, -k * PI) + k * PI_REST);
    let distance = ((turn - multiple) + (turn_rest - multiple_rest)).abs() / 12.0;
    Some((k as i32, distance))
}

/// `k pi/12` as an exact expression in lowest terms: `0`, `-pi`, `5*pi/12`.
pub(super) fn multiple(k: i32) -> Option<Quantity> {
    let common = greatest_common_divisor(k.unsigned_abs(), 12) as i32;
    let (numerator, denominator) = (k / common, 12 / common);
    let top = match numerator {
        0 => "0".to_owned(),
        1 => "pi".to_owned(),
        -1 => "-pi".to_owned(),
        n => format!("{n}*pi"),
    };
    let text = match denominator {
        1 => top,
        d if k != 0 => format!("{top}/{d}"),
        _ => top,
    };
    Quantity::parse_angle(&text, &[]).ok()
}

fn greatest_common_divisor(a: u32, b: u32) -> u32 {
    if b == 0 {
        a
    } else {
        greatest_common_divisor(b, a % b)
    }
}

/// What is known of a number's exact value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Exact {
    /// It is the multiple of pi/12 in question.
    Same,
    /// It is another rational multiple of pi.
    Fraction,
    /// It is no rational multiple of pi, or too long an expression to tell.
    Other,
}

/// Compares the exact value of a number with k pi/12.
pub(super) fn compare(expr: &Expr, constants: &Constants, k: i32) -> Exact {
    if let Expr::Number(decimal) = expr {
        let zero = decimal.mantissa.bits() == 0;
        return match (zero, k) {
            (true, 0) => Exact::Same,
            (true, _) => Exact::Fraction,
            (false, _) => Exact::Other,
        };
    }
    if digits_left(expr, constants, MOST_DIGITS).is_none() {
        return Exact::Other;
    }
    match LinearInPi::of(expr, constants) {
        Some(value) if value.rational.numer().bits() == 0 => {
            let turns = &value.half_turns;
            if turns.numer() * 12 == turns.denom() * k {
                Exact::Same
            } else {
                Exact::Fraction
            }
        }
        _ => Exact::Other,
    }
}

/// More digits and names than anyone writes in an angle.
const MOST_DIGITS: usize = 1000;

/// A budget of digits less those of an expression with its constants spelled out;
/// `None` where they are more. Exact evaluation needs such a bound: constants that each
/// use the one before twice spell out to any length.
fn digits_left(expr: &Expr, constants: &Constants, budget: usize) -> Option<usize> {
    let budget = budget.checked_sub(1)?;
    match expr {
        Expr::Number(decimal) => {
            let digits = decimal.mantissa.bits() / 3 + u64::from(decimal.exponent.unsigned_abs());
            budget.checked_sub(usize::try_from(digits).ok()?)
        }
        Expr::Pi => Some(budget),
        Expr::Name(name) => {
            let at = constants.iter().position(|(known, _)| known == name)?;
            digits_left(&constants[at].1.expr, &constants[..at], budget)
        }
        Expr::Neg(a) | Expr::Sqrt(a) => digits_left(a, constants, budget),
        Expr::Add(a, b) | Expr::Sub(a, b) | Expr::Mul(a, b) | Expr::Div(a, b) => {
            digits_left(b, constants, digits_left(a, constants, budget)?)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn angle(text: &str) -> Quantity {
        Quantity::parse_angle(text, &[]).unwrap()
    }

    #[test]
    fn multiples_are_written_in_lowest_terms() {
        let text = |k| multiple(k).unwrap().text;
        assert_eq!([0, 12, -12, 6].map(text), ["0", "pi", "-pi", "pi/2"]);
        assert_eq!(
            [-6, 5, -10, 18].map(text),
            ["-pi/2", "5*pi/12", "-5*pi/6", "3*pi/2"]
        );
        assert_eq!(
            [24, -36, 1, -4].map(text),
            ["2*pi", "-3*pi", "pi/12", "-pi/3"]
        );
    }

    #[test]
    fn a_multiple_is_exactly_what_it_says_and_its_own_nearest() {
        for k in -380..=380 {
            let quantity = multiple(k).unwrap();
            assert_eq!(compare(&quantity.expr, &[], k), Exact::Same, "{k}");
            let (found, distance) = nearest(quantity.value).unwrap();
            // pi, the product and the quotient are rounded.
            let rounding = 1.5 * f64::EPSILON * quantity.value.abs();
            assert!(found == k && distance <= rounding, "{k}: {distance:e}");
        }
    }

    #[test]
    fn the_distance_has_full_relative_precision() {
        for (value, k, distance) in [
            (std::f64::consts::FRAC_PI_2, 6, 6.123_233_995_736_766e-17),
            (-std::f64::consts::PI, -12, 1.224_646_799_147_353_2e-16),
            (1.5708, 6, 3.673_205_103_380_769e-6),
            (1e-300, 0, 1e-300),
        ] {
            let (found, size) = nearest(value).unwrap();
            assert_eq!(found, k);
            assert!((size / distance - 1.0).abs() < 1e-9, "{value}: {size:e}");
        }
        assert_eq!(nearest(101.0), None);
    }

    #[test]
    fn fractions_of_a_turn_are_known_however_they_are_written() {
        for text in ["pi/2", "90 deg", "(180/2) deg", "pi - pi/2", "sqrt(1/4)*pi"] {
            assert_eq!(compare(&angle(text).expr, &[], 6), Exact::Same, "{text}");
        }
        for text in ["89.99 deg", "pi/7", "0", "3*pi/2"] {
            assert_eq!(
                compare(&angle(text).expr, &[], 6),
                Exact::Fraction,
                "{text}"
            );
        }
        for text in ["1.5708", "pi/2 + 1e-5", "sqrt(2)", "pi*pi/(2*pi)"] {
            assert_eq!(compare(&angle(text).expr, &[], 6), Exact::Other, "{text}");
        }
    }

    #[test]
    fn an_expression_that_spells_out_to_any_length_is_given_up() {
        let mut constants = vec![("c0".to_owned(), angle("pi"))];
        for k in 1..1000 {
            let last = k - 1;
            let next = Quantity::parse_angle(&format!("(c{last} + c{last})/2"), &constants);
            constants.push((format!("c{k}"), next.unwrap()));
        }
        let last = Quantity::parse_angle("c999", &constants).unwrap();
        assert_eq!(compare(&last.expr, &constants, 12), Exact::Other);
        let tiny = Quantity::parse_angle(&["1e-9999"; 120].join("*"), &[]).unwrap();
        assert_eq!(compare(&tiny.expr, &[], 0), Exact::Other);
    }
}
