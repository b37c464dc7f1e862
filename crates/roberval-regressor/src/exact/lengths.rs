//! Lengths and other numbers of a description in a prime field.

use std::cell::Cell;

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, ToPrimitive, Zero};
use roberval_scalar::{Expr, Fp, LinearInPi, Quantity};

use super::NotInField;
use super::angles::{Angles, prime_factors};

/// Radicands with larger numerators times denominators are not factored.
const LARGEST_RADICAND: u64 = 1 << 40;

/// The numbers of one robot in one field.
pub(crate) struct Lengths<'m, 'd> {
    pub modulus: &'m roberval_scalar::Modulus,
    pub constants: &'d [(String, Quantity)],
    /// pi is transcendental: a random value stands for it.
    pub pi: Fp<'m>,
    /// Set when a square root was met that is no fraction.
    pub roots: Cell<bool>,
}

impl<'m> Lengths<'m, '_> {
    /// The value of a quantity.
    pub fn value(
        &self,
        quantity: &Quantity,
        angles: &Angles<'m, '_>,
    ) -> Result<Fp<'m>, NotInField> {
        if let Some(exact) = LinearInPi::of(&quantity.expr, self.constants) {
            return Ok(
                self.fraction(&exact.rational)? + self.fraction(&exact.half_turns)? * self.pi
            );
        }
        if LinearInPi::is_too_long(&quantity.expr, self.constants) {
            return Err(NotInField::TooLong);
        }
        self.roots.set(true);
        self.expr(&quantity.expr, angles)
    }

    /// The positive square root of a fraction.
    pub fn length(
        &self,
        square: &BigRational,
        angles: &Angles<'m, '_>,
    ) -> Result<Fp<'m>, NotInField> {
        let whole = |n: &BigInt| n.sqrt().pow(2) == *n;
        if !(whole(square.numer()) && whole(square.denom())) {
            self.roots.set(true);
        }
        self.root(square, angles)
    }

    pub fn fraction(&self, x: &BigRational) -> Result<Fp<'m>, NotInField> {
        let numerator = self.modulus.big(x.numer());
        if x.is_integer() {
            return Ok(numerator);
        }
        let denominator = self.modulus.big(x.denom()).inverse();
        Ok(numerator * denominator.ok_or(NotInField::Inverse)?)
    }

    fn expr(&self, expr: &Expr, angles: &Angles<'m, '_>) -> Result<Fp<'m>, NotInField> {
        let value = |e: &Expr| self.expr(e, angles);
        Ok(match expr {
            Expr::Number(decimal) => self.fraction(&decimal.to_rational())?,
            Expr::Name(name) => {
                let at = self.constants.iter().position(|(n, _)| n == name);
                value(&self.constants[at.ok_or(NotInField::Inverse)?].1.expr)?
            }
            Expr::Pi => self.pi,
            Expr::Neg(a) => -value(a)?,
            Expr::Add(a, b) => value(a)? + value(b)?,
            Expr::Sub(a, b) => value(a)? - value(b)?,
            Expr::Mul(a, b) => value(a)? * value(b)?,
            Expr::Div(a, b) => value(a)? * value(b)?.inverse().ok_or(NotInField::Inverse)?,
            Expr::Sqrt(a) => match LinearInPi::of(a, self.constants) {
                Some(square) if square.half_turns.is_zero() => {
                    self.root(&square.rational, angles)?
                }
                _ => value(a)?.sqrt().ok_or(NotInField::Root)?,
            },
        })
    }

    /// `sqrt(n/d) = sqrt(n d)/d`, a product of square roots of primes, so that
    /// `sqrt(2) sqrt(3) = sqrt(6)` holds in the field too.
    fn root(&self, square: &BigRational, angles: &Angles<'m, '_>) -> Result<Fp<'m>, NotInField> {
        let whole = square.numer() * square.denom();
        let denominator = self.fraction(&BigRational::new(One::one(), square.denom().clone()))?;
        let Some(mut rest) = whole.to_u64().filter(|n| *n <= LARGEST_RADICAND) else {
            let value = self.modulus.big(&whole).sqrt().ok_or(NotInField::Root)?;
            return Ok(value * denominator);
        };
        let mut root = denominator;
        for q in prime_factors(rest) {
            let mut odd = false;
            while rest.is_multiple_of(q) {
                rest /= q;
                odd = !odd;
                if !odd {
                    root = root * self.modulus.integer(q as i64);
                }
            }
            if odd {
                root = root * self.prime_root(q, angles)?;
            }
        }
        Ok(root)
    }

    /// The root of 2, 3 or 5 that the field's angles mean by cos 45, 30 and 36 degrees;
    /// of other primes, either root.
    fn prime_root(&self, q: u64, angles: &Angles<'m, '_>) -> Result<Fp<'m>, NotInField> {
        match q {
            2 => Ok(angles.roots()[0]),
            3 => Ok(angles.roots()[1]),
            5 => {
                let cos36 = angles.turn(angles.order() / 10).0;
                Ok(self.modulus.integer(4) * cos36 - self.modulus.integer(1))
            }
            _ => self
                .modulus
                .integer(q as i64)
                .sqrt()
                .ok_or(NotInField::Root),
        }
    }
}
