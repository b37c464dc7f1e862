//! Polynomials with rational coefficients.

use std::collections::BTreeMap;

use num_rational::BigRational;
use num_traits::{One, Zero};
use roberval_scalar::{Fp, Modulus};

/// What a polynomial is in.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Variable {
    /// A length.
    Length(String),
    /// The cosine of an angle.
    Cos(String),
    /// The sine of an angle.
    Sin(String),
}

/// Exponents, one a variable.
pub type Monomial = Vec<u8>;

/// A polynomial in the variables of its [`crate::SymbolicRelations`]. Sines occur at most
/// once in a term: the square is `1 - cos^2`.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Default)]
pub struct Polynomial {
    /// Coefficients that are not zero.
    pub terms: BTreeMap<Monomial, BigRational>,
}

impl Polynomial {
    /// The sum of terms.
    #[must_use]
    pub fn of(terms: impl IntoIterator<Item = (Monomial, BigRational)>) -> Self {
        let mut sum: BTreeMap<Monomial, BigRational> = BTreeMap::new();
        for (monomial, coefficient) in terms {
            *sum.entry(monomial).or_insert_with(BigRational::zero) += coefficient;
        }
        sum.retain(|_, coefficient| !coefficient.is_zero());
        Self { terms: sum }
    }

    /// Whether it is the number 1.
    #[must_use]
    pub fn is_one(&self) -> bool {
        let mut terms = self.terms.iter();
        let is_one = |(m, c): (&Monomial, &BigRational)| c.is_one() && m.iter().all(|e| *e == 0);
        terms.next().is_some_and(is_one) && terms.next().is_none()
    }

    /// Its value in a prime field; `None` if a coefficient's denominator is zero there.
    #[must_use]
    pub fn value<'m>(&self, modulus: &'m Modulus, at: &[Fp<'m>]) -> Option<Fp<'m>> {
        let mut sum = modulus.integer(0);
        for (monomial, coefficient) in &self.terms {
            let denominator = modulus.big(coefficient.denom()).inverse()?;
            let coefficient = modulus.big(coefficient.numer()) * denominator;
            sum = sum + coefficient * power(modulus, monomial, at);
        }
        Some(sum)
    }

    /// Its value in doubles.
    #[must_use]
    pub fn to_f64(&self, at: &[f64]) -> f64 {
        let term = |(monomial, coefficient): (&Monomial, &BigRational)| {
            let powers = monomial.iter().zip(at);
            let product: f64 = powers.map(|(e, x)| x.powi(i32::from(*e))).product();
            num_traits::ToPrimitive::to_f64(coefficient).unwrap_or(f64::NAN) * product
        };
        self.terms.iter().map(term).sum()
    }
}

/// The value of a monomial.
pub(crate) fn power<'m>(modulus: &'m Modulus, monomial: &[u8], at: &[Fp<'m>]) -> Fp<'m> {
    let powers = monomial.iter().zip(at).filter(|(e, _)| **e > 0);
    powers.fold(modulus.integer(1), |product, (e, x)| {
        product * x.pow(u64::from(*e))
    })
}
