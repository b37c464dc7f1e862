//! Exact coefficients: fractions, sums of fractions times square roots, or rounded.

use std::fmt;

use num_bigint::{BigInt, BigUint};
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive, Zero};

/// One coefficient of beta.
#[derive(Debug, Clone, PartialEq)]
pub enum ExactNumber {
    /// A fraction, exactly.
    Rational(BigRational),
    /// `sum of r_i sqrt(n_i)`, exactly; n = 1 is the rational part. No zero terms.
    Surd(Vec<(u32, BigRational)>),
    /// A number that has no such form, rounded to a double.
    Rounded(f64),
}

impl ExactNumber {
    /// Exactly 0.
    #[must_use]
    pub fn zero() -> Self {
        Self::Rational(BigRational::zero())
    }

    /// The sum of these terms, in its simplest form.
    #[must_use]
    pub fn of_terms(terms: Vec<(u32, BigRational)>) -> Self {
        let mut terms: Vec<_> = terms.into_iter().filter(|(_, r)| !r.is_zero()).collect();
        match terms.as_slice() {
            [] => Self::zero(),
            [(1, _)] => Self::Rational(terms.swap_remove(0).1),
            _ => Self::Surd(terms),
        }
    }

    /// Whether this is exactly 0.
    #[must_use]
    pub fn is_zero(&self) -> bool {
        matches!(self, Self::Rational(r) if r.is_zero())
    }

    /// Whether this is known exactly.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        !matches!(self, Self::Rounded(_))
    }

    /// The nearest double of a fraction; of a sum with square roots, the nearest but for
    /// a few units in the last place.
    #[must_use]
    pub fn to_f64(&self) -> f64 {
        match self {
            Self::Rational(r) => nearest_double(r),
            Self::Surd(terms) => {
                let term = |(n, r): &(u32, BigRational)| nearest_double(r) * f64::from(*n).sqrt();
                terms.iter().map(term).sum()
            }
            Self::Rounded(x) => *x,
        }
    }
}

impl fmt::Display for ExactNumber {
    /// `363/1250`, `1/2 + 3/4 sqrt(2)`, or the digits of the rounded number.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Rational(r) => write!(f, "{r}"),
            Self::Rounded(x) => write!(f, "{x}"),
            Self::Surd(terms) => {
                for (i, (n, r)) in terms.iter().enumerate() {
                    let sign = match (i, r.is_negative()) {
                        (0, false) => "",
                        (0, true) => "-",
                        (_, false) => " + ",
                        (_, true) => " - ",
                    };
                    write!(f, "{sign}{}", r.abs())?;
                    if *n != 1 {
                        write!(f, " sqrt({n})")?;
                    }
                }
                Ok(())
            }
        }
    }
}

/// The double nearest to a fraction (ties to even; below the normal range the last bit
/// may be rounded twice).
fn nearest_double(x: &BigRational) -> f64 {
    let (n, d) = (x.numer().magnitude(), x.denom().magnitude());
    if n.is_zero() {
        return 0.0;
    }
    // 66 bits of quotient, the last of them "there is more": u128 -> f64 then rounds once.
    let shift = 66 - (n.bits() as i64 - d.bits() as i64);
    let (n, d) = if shift >= 0 {
        (n << shift as u64, d.clone())
    } else {
        (n.clone(), d << (-shift) as u64)
    };
    let (quotient, rest): (BigUint, BigUint) = (&n / &d, &n % &d);
    let sticky = u128::from(!rest.is_zero());
    let bits = quotient.to_u128().unwrap_or(0) | sticky;
    let magnitude = times_power_of_two(bits as f64, -shift);
    if x.numer() < &BigInt::zero() {
        -magnitude
    } else {
        magnitude
    }
}

fn times_power_of_two(x: f64, exponent: i64) -> f64 {
    let half = (exponent / 2).clamp(-1100, 1100) as i32;
    let rest = (exponent - i64::from(half)).clamp(-1100, 1100) as i32;
    x * 2_f64.powi(half) * 2_f64.powi(rest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use roberval_scalar::{Quantity, SplitMix64};

    #[test]
    fn fractions_round_to_the_nearest_double() {
        let mut random = SplitMix64::new(9);
        for _ in 0..2000 {
            // Decimal texts are read with correct rounding by the standard library.
            let digits = random.next_u64() >> random.below(60);
            let exponent = random.below(60) as i32 - 40;
            let text = format!("-{digits}e{exponent}");
            let quantity = Quantity::parse_decimal(&text).expect("a decimal");
            let roberval_scalar::Expr::Number(decimal) = quantity.expr else {
                panic!("a decimal is a number")
            };
            assert_eq!(
                nearest_double(&decimal.to_rational()),
                text.parse().expect("a float"),
                "{text}"
            );
        }
    }

    #[test]
    fn sums_with_roots_are_written_the_way_one_reads_them() {
        let r = |n: i64, d: i64| BigRational::new(n.into(), d.into());
        let surd = ExactNumber::of_terms(vec![(1, r(-1, 2)), (2, r(3, 4)), (3, r(0, 1))]);
        assert_eq!(surd.to_string(), "-1/2 + 3/4 sqrt(2)");
        assert!((surd.to_f64() - (0.75 * 2_f64.sqrt() - 0.5)).abs() < 1e-16);
        assert_eq!(ExactNumber::of_terms(vec![(1, r(2, 4))]).to_string(), "1/2");
        assert!(ExactNumber::of_terms(vec![]).is_zero());
    }
}
