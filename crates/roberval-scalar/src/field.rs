//! Arithmetic modulo a prime of at most 62 bits.

use std::fmt;
use std::ops::{Add, Mul, Neg, Sub};

use num_bigint::{BigInt, BigUint};
use num_traits::{Signed, ToPrimitive};

use crate::{Scalar, SplitMix64};

/// A prime p with what Montgomery's multiplication needs: numbers are kept as
/// `a 2^64 mod p`, so that a product costs three multiplications and no division.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Modulus {
    p: u64,
    /// `-1/p mod 2^64`
    neg_inverse: u64,
    /// `2^128 mod p`
    r2: u64,
}

impl Modulus {
    /// The largest bit length of p: sums of two residues and of a product with one stay
    /// far from overflow.
    pub const BITS: u32 = 62;

    /// Arithmetic modulo `p`, an odd prime below 2^62 (primality is the caller's to know:
    /// see [`crate::is_prime`]).
    ///
    /// # Panics
    /// If p is even or has more than 62 bits.
    #[must_use]
    pub fn new(p: u64) -> Self {
        assert!(
            p % 2 == 1 && p < 1 << Self::BITS,
            "{p} is no odd prime below 2^62"
        );
        // Newton's iteration doubles the correct bits of 1/p mod 2^64: 3, 6, ..., 96.
        let mut inverse = p;
        for _ in 0..5 {
            inverse = inverse.wrapping_mul(2_u64.wrapping_sub(p.wrapping_mul(inverse)));
        }
        let r = (1_u128 << 64) % u128::from(p);
        Self {
            p,
            neg_inverse: inverse.wrapping_neg(),
            r2: ((r * r) % u128::from(p)) as u64,
        }
    }

    /// p
    #[must_use]
    pub fn p(&self) -> u64 {
        self.p
    }

    /// Montgomery's product `a b / 2^64 mod p` of two residues.
    #[inline(always)]
    #[must_use]
    pub fn product(&self, a: u64, b: u64) -> u64 {
        let wide = u128::from(a) * u128::from(b);
        let m = (wide as u64).wrapping_mul(self.neg_inverse);
        let sum = (wide + u128::from(m) * u128::from(self.p)) >> 64;
        self.reduced(sum as u64)
    }

    /// `a + b mod p`
    #[inline(always)]
    #[must_use]
    pub fn sum(&self, a: u64, b: u64) -> u64 {
        self.reduced(a + b)
    }

    /// `a - b mod p`
    #[inline(always)]
    #[must_use]
    pub fn difference(&self, a: u64, b: u64) -> u64 {
        self.reduced(a + (self.p - b))
    }

    /// A number below 2p, once reduced; `min` compiles to a conditional move.
    #[inline(always)]
    fn reduced(&self, a: u64) -> u64 {
        a.min(a.wrapping_sub(self.p))
    }

    /// The residue of an integer.
    #[must_use]
    pub fn integer(&self, n: i64) -> Fp<'_> {
        let magnitude = self.element(n.unsigned_abs() % self.p);
        if n < 0 { -magnitude } else { magnitude }
    }

    /// The element with this residue, a number below p.
    #[must_use]
    pub fn element(&self, residue: u64) -> Fp<'_> {
        debug_assert!(
            residue < self.p,
            "{residue} is no residue modulo {}",
            self.p
        );
        self.from_raw(self.product(residue, self.r2))
    }

    /// The residue of a large integer.
    #[must_use]
    pub fn big(&self, n: &BigInt) -> Fp<'_> {
        if let Some(n) = n.to_i64() {
            return self.integer(n);
        }
        let magnitude = n.magnitude() % BigUint::from(self.p);
        let residue = self.element(magnitude.to_u64().unwrap_or(0));
        if n.is_negative() { -residue } else { residue }
    }

    /// A uniform residue.
    pub fn random(&self, random: &mut SplitMix64) -> Fp<'_> {
        // As many random bits as p has, until they are below p: at most twice on average.
        let unused = self.p.leading_zeros();
        loop {
            let value = random.next_u64() >> unused;
            if value < self.p {
                return self.from_raw(value);
            }
        }
    }

    /// The element with this Montgomery form, see [`Fp::raw`].
    #[must_use]
    pub fn from_raw(&self, value: u64) -> Fp<'_> {
        Fp {
            value,
            modulus: self,
        }
    }
}

/// An element of the field of p elements. It knows its field: mixing fields is a bug.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Fp<'m> {
    value: u64,
    modulus: &'m Modulus,
}

impl<'m> Fp<'m> {
    /// The residue in `0..p`.
    #[must_use]
    pub fn residue(self) -> u64 {
        self.modulus.product(self.value, 1)
    }

    /// The Montgomery form, for loops that keep the modulus apart.
    #[inline(always)]
    #[must_use]
    pub fn raw(self) -> u64 {
        self.value
    }

    /// Whether this is 0.
    #[must_use]
    pub fn is_zero(self) -> bool {
        self.value == 0
    }

    /// The field.
    #[must_use]
    pub fn modulus(self) -> &'m Modulus {
        self.modulus
    }

    /// The power with a nonnegative exponent.
    #[must_use]
    pub fn pow(self, mut exponent: u64) -> Self {
        let (mut base, mut power) = (self, self.modulus.integer(1));
        while exponent > 0 {
            if exponent & 1 == 1 {
                power = power * base;
            }
            base = base * base;
            exponent >>= 1;
        }
        power
    }

    /// 1/a; `None` for 0.
    #[must_use]
    pub fn inverse(self) -> Option<Self> {
        (!self.is_zero()).then(|| self.pow(self.modulus.p - 2))
    }

    /// A square root, if there is one. For p = 3 (mod 4) only.
    #[must_use]
    pub fn sqrt(self) -> Option<Self> {
        debug_assert_eq!(self.modulus.p % 4, 3);
        let root = self.pow(self.modulus.p.div_ceil(4));
        (root * root == self).then_some(root)
    }
}

impl fmt::Debug for Fp<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} mod {}", self.residue(), self.modulus.p)
    }
}

macro_rules! operator {
    ($name:ident, $method:ident, $how:ident) => {
        impl $name for Fp<'_> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                debug_assert_eq!(self.modulus.p, other.modulus.p, "numbers of two fields");
                self.modulus
                    .from_raw(self.modulus.$how(self.value, other.value))
            }
        }
    };
}

operator!(Add, add, sum);
operator!(Sub, sub, difference);
operator!(Mul, mul, product);

impl Neg for Fp<'_> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.modulus
            .from_raw(self.modulus.difference(0, self.value))
    }
}

impl Scalar for Fp<'_> {}

#[cfg(test)]
mod tests {
    use super::*;

    const PRIMES: [u64; 4] = [3, 10007, (1 << 61) - 1, (1 << 62) - 3545];

    #[test]
    fn operations_are_those_of_integers_modulo_p() {
        for p in PRIMES {
            let field = Modulus::new(p);
            let mut random = SplitMix64::new(p);
            for _ in 0..500 {
                let (a, b) = (random.next_u64() % p, random.next_u64() % p);
                let (x, y) = (field.element(a), field.element(b));
                let (a, b, p) = (u128::from(a), u128::from(b), u128::from(p));
                assert_eq!(u128::from((x + y).residue()), (a + b) % p);
                assert_eq!(u128::from((x - y).residue()), (a + p - b) % p);
                assert_eq!(u128::from((x * y).residue()), a * b % p);
                assert_eq!(u128::from((-x).residue()), (p - a) % p);
            }
        }
    }

    #[test]
    fn every_number_but_zero_has_an_inverse() {
        for p in PRIMES {
            let field = Modulus::new(p);
            assert!(field.integer(0).inverse().is_none());
            for n in [1, 2, -1, 17, i64::MAX, i64::MIN] {
                let x = field.integer(n);
                if let Some(inverse) = x.inverse() {
                    assert_eq!(x * inverse, field.integer(1), "{n} mod {p}");
                }
            }
        }
    }

    #[test]
    fn half_of_the_numbers_have_square_roots() {
        let field = Modulus::new((1 << 62) - 3545);
        let mut random = SplitMix64::new(7);
        let roots = (0..400)
            .filter(|_| field.random(&mut random).sqrt().is_some())
            .count();
        assert!((140..260).contains(&roots), "{roots} of 400");
        assert_eq!(
            field.integer(4).sqrt().map(|r| r * r),
            Some(field.integer(4))
        );
        assert!(field.integer(-1).sqrt().is_none(), "p = 3 (mod 4)");
    }

    #[test]
    fn large_integers_keep_their_sign_and_residue() {
        let field = Modulus::new((1 << 62) - 3545);
        let n: BigInt = "-123456789012345678901234567890123"
            .parse()
            .expect("digits");
        let p = BigInt::from(field.p());
        let expected = ((&n % &p) + &p) % &p;
        assert_eq!(BigInt::from(field.big(&n).residue()), expected);
    }
}
