//! A fraction from its residue.

use num_bigint::{BigInt, Sign};
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};

/// A fraction is believed if it leaves this many bits of the modulus unexplained: an
/// unrelated residue looks like such a fraction with probability 2^-UNEXPLAINED.
const UNEXPLAINED_BITS: u64 = 20;

/// The fraction n/d with `n = residue d (mod modulus)` that is much smaller than the
/// modulus, if there is one: the continued fraction's step of the largest quotient
/// (Monagan 2004), which needs no guess how the bits divide between n and d.
#[must_use]
pub fn rational_from_residue(residue: &BigInt, modulus: &BigInt) -> Option<BigRational> {
    if residue.is_zero() {
        return Some(BigRational::zero());
    }
    let (mut r0, mut r1) = (modulus.clone(), residue.clone());
    let (mut t0, mut t1) = (BigInt::zero(), BigInt::one());
    let mut best: Option<(BigInt, BigInt, BigInt)> = None;
    while !r1.is_zero() {
        let quotient = &r0 / &r1;
        if best.as_ref().is_none_or(|(q, _, _)| quotient > *q) {
            best = Some((quotient.clone(), r1.clone(), t1.clone()));
        }
        let r2 = &r0 - &quotient * &r1;
        let t2 = &t0 - &quotient * &t1;
        (r0, r1) = (r1, r2);
        (t0, t1) = (t1, t2);
    }
    let (_, numerator, denominator) = best?;
    let used = numerator.bits() + denominator.abs().bits();
    let fraction = BigRational::new(numerator, denominator);
    (used + UNEXPLAINED_BITS <= modulus.bits()).then_some(fraction)
}

/// Joins residues modulo two coprime numbers to one modulo their product.
#[derive(Debug, Clone)]
pub struct ChineseRemainder {
    m1: BigInt,
    m2: BigInt,
    /// 1/m1 modulo m2.
    inverse: BigInt,
}

impl ChineseRemainder {
    /// For residues modulo `m1` and `m2`; `None` if these have a factor in common.
    #[must_use]
    pub fn new(m1: BigInt, m2: BigInt) -> Option<Self> {
        let inverse = m1.modinv(&m2)?;
        Some(Self { m1, m2, inverse })
    }

    /// The residue that is `a1` modulo m1 and `a2` modulo m2, for a1 in `0..m1` in
    /// `0..m1 m2`.
    #[must_use]
    pub fn join(&self, a1: &BigInt, a2: &BigInt) -> BigInt {
        let mut step = ((a2 - a1) * &self.inverse) % &self.m2;
        if step.sign() == Sign::Minus {
            step += &self.m2;
        }
        a1 + &self.m1 * step
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use roberval_scalar::SplitMix64;

    fn modulus() -> BigInt {
        BigInt::from((1_u64 << 62) - 3545)
    }

    #[test]
    fn fractions_of_forty_bits_come_back() {
        let mut random = SplitMix64::new(5);
        for _ in 0..500 {
            let numerator_bits = random.below(39);
            let n = (random.next_u64() >> (63 - numerator_bits)) as i64
                * if random.below(2) == 0 { 1 } else { -1 };
            let d = (random.next_u64() >> (63 - (39 - numerator_bits))).max(1);
            let exact = BigRational::new(n.into(), d.into());
            let p = modulus();
            let inverse = exact.denom().modinv(&p).expect("p is prime");
            let residue = ((exact.numer() * inverse) % &p + &p) % &p;
            assert_eq!(rational_from_residue(&residue, &p), Some(exact));
        }
    }

    #[test]
    fn random_residues_are_almost_never_taken_for_fractions() {
        let mut random = SplitMix64::new(6);
        let p = modulus();
        let taken = (0..10_000)
            .filter(|_| {
                rational_from_residue(&(BigInt::from(random.next_u64()) % &p), &p).is_some()
            })
            .count();
        assert!(taken <= 1, "{taken} of 10000");
    }

    #[test]
    fn two_residues_make_one() {
        let (m1, m2) = (BigInt::from(10_007), BigInt::from(1_000_003));
        let x = BigInt::from(9_876_543_210_i64);
        let (a1, a2) = (&x % &m1, &x % &m2);
        let join = ChineseRemainder::new(m1, m2).expect("coprime");
        assert_eq!(join.join(&a1, &a2), x);
        assert!(ChineseRemainder::new(6.into(), 4.into()).is_none());
    }
}
