//! Fractions as doubles.

use num_bigint::BigUint;
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive, Zero};

/// The double nearest to a fraction (ties to even), infinite beyond their range.
#[must_use]
pub fn nearest_double(x: &BigRational) -> f64 {
    let (n, d) = (x.numer().magnitude(), x.denom().magnitude());
    if n.is_zero() {
        return 0.0;
    }
    // 66 bits of quotient, the last of them "there is more": u128 -> f64 then rounds once.
    // Near the end of the doubles' range only two bits beyond it, so that the scaling
    // rounds once and the conversion does not.
    let shift = (66 - (n.bits() as i64 - d.bits() as i64)).min(LAST_BIT + 2);
    let (n, d) = if shift >= 0 {
        (n << shift as u64, d.clone())
    } else {
        (n.clone(), d << (-shift) as u64)
    };
    let (quotient, rest): (BigUint, BigUint) = (&n / &d, &n % &d);
    let sticky = u128::from(!rest.is_zero());
    let bits = quotient.to_u128().unwrap_or(0) | sticky;
    let magnitude = times_power_of_two(bits as f64, -shift);
    if x.is_negative() {
        -magnitude
    } else {
        magnitude
    }
}

/// The smallest double is `2^-LAST_BIT`.
const LAST_BIT: i64 = 1074;

fn times_power_of_two(x: f64, exponent: i64) -> f64 {
    let half = (exponent / 2).clamp(-1100, 1100) as i32;
    let rest = (exponent - i64::from(half)).clamp(-1100, 1100) as i32;
    x * 2_f64.powi(half) * 2_f64.powi(rest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Quantity, SplitMix64};

    #[test]
    fn fractions_round_to_the_nearest_double() {
        let mut random = SplitMix64::new(9);
        for _ in 0..2000 {
            // Decimal texts are read with correct rounding by the standard library.
            let digits = random.next_u64() >> random.below(60);
            let exponent = random.below(640) as i32 - 380;
            let text = format!("-{digits}e{exponent}");
            let quantity = Quantity::parse_decimal(&text).expect("a decimal");
            let crate::Expr::Number(decimal) = quantity.expr else {
                panic!("a decimal is a number")
            };
            assert_eq!(
                nearest_double(&decimal.to_rational()),
                text.parse().expect("a float"),
                "{text}"
            );
        }
    }
}
