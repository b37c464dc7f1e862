//! Exact coefficients: fractions, sums of fractions times square roots, or rounded.

use std::fmt;

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};
use roberval_scalar::{DoubleDouble, nearest_double};

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

    /// The nearest double.
    #[must_use]
    pub fn to_f64(&self) -> f64 {
        match self {
            Self::Rational(r) => nearest_double(r),
            Self::Surd(terms) => rounded(terms, nearest_double),
            Self::Rounded(x) => *x,
        }
    }

    /// The nearest pair of doubles; of a rounded number, that number.
    pub(super) fn to_double_double(&self) -> DoubleDouble {
        match self {
            Self::Rational(r) => DoubleDouble::nearest(r),
            Self::Surd(terms) => rounded(terms, DoubleDouble::nearest),
            Self::Rounded(x) => (*x).into(),
        }
    }
}

/// A sum of fractions times square roots, by `round`: bits are added until the bounds on
/// both sides of it round to the same. The sum is irrational, so that this ends.
fn rounded<T: PartialEq>(terms: &[(u32, BigRational)], round: impl Fn(&BigRational) -> T) -> T {
    let mut bits = 128_u64;
    loop {
        let unit = BigInt::one() << bits;
        let sum: BigInt = terms.iter().map(|(n, r)| times_root(*n, r, bits)).sum();
        let bound = |error: i64| round(&BigRational::new(&sum + error, unit.clone()));
        let error = terms.len() as i64;
        let (low, high) = (bound(-error), bound(error));
        if low == high {
            return low;
        }
        bits *= 2;
    }
}

/// `r sqrt(n) 2^bits`, to less than one unit.
fn times_root(n: u32, r: &BigRational, bits: u64) -> BigInt {
    // floor(floor(x) / d) = floor(x / d): the fraction's numerator goes under the root.
    let square = r.numer() * r.numer() * n;
    let root = (square << (2 * bits)).sqrt() / r.denom();
    if r.is_negative() { -root } else { root }
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

#[cfg(test)]
mod tests {
    use super::*;
    use num_traits::ToPrimitive;
    use roberval_scalar::SplitMix64;

    #[test]
    fn sums_with_roots_are_written_the_way_one_reads_them() {
        let r = |n: i64, d: i64| BigRational::new(n.into(), d.into());
        let surd = ExactNumber::of_terms(vec![(1, r(-1, 2)), (2, r(3, 4)), (3, r(0, 1))]);
        assert_eq!(surd.to_string(), "-1/2 + 3/4 sqrt(2)");
        assert!((surd.to_f64() - (0.75 * 2_f64.sqrt() - 0.5)).abs() < 2e-16);
        assert_eq!(ExactNumber::of_terms(vec![(1, r(2, 4))]).to_string(), "1/2");
        assert!(ExactNumber::of_terms(vec![]).is_zero());
    }

    #[test]
    fn sums_with_roots_round_to_the_nearest_double_even_when_they_cancel() {
        let mut random = SplitMix64::new(11);
        for _ in 0..300 {
            // a^2 - 2 b^2 = +-1: a - b sqrt(2) is as small as 1/(2a).
            let (mut a, mut b) = (BigInt::one(), BigInt::one());
            for _ in 0..random.below(60) {
                (a, b) = (&a + 2 * &b, a + b);
            }
            let negative = &a * &a < 2 * &b * &b;
            let surd = ExactNumber::of_terms(vec![(1, a.clone().into()), (2, (-b.clone()).into())]);
            // a - b sqrt(2) = (a^2 - 2 b^2)/(a + b sqrt(2)), where nothing cancels.
            let sum = a.to_f64().expect("finite") + b.to_f64().expect("finite") * 2_f64.sqrt();
            let expected = if negative { -1.0 / sum } else { 1.0 / sum };
            let error = (surd.to_f64() - expected) / expected;
            assert!(error.abs() < 1e-15, "{surd}: {error}");
            // The double found is nearer than its neighbours: compare squares exactly.
            let pair = surd.to_double_double();
            assert_eq!(pair.to_f64(), surd.to_f64(), "{surd}");
            let x = pair.to_rational();
            let root = (BigRational::from(a) - x) / b;
            let error = (&root * &root / BigInt::from(2) - BigRational::one()).abs();
            assert!(nearest_double(&error) < 1e-30, "{surd}");
        }
    }
}
