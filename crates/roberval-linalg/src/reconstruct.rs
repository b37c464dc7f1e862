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

/// The residue modulo `m1 m2` that is `a1` modulo `m1` and `a2` modulo `m2` (m1, m2
/// coprime), in `0..m1 m2`.
#[must_use]
pub fn chinese_remainder(a1: &BigInt, m1: &BigInt, a2: &BigInt, m2: &BigInt) -> BigInt {
    // m1 is invertible modulo m2, so that this inverse exists.
    let inverse = m1.modinv(m2).unwrap_or_default();
    let step = ((a2 - a1) * inverse) % m2;
    let step = if step.sign() == Sign::Minus {
        step + m2
    } else {
        step
    };
    a1 + m1 * step
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
        assert_eq!(chinese_remainder(&(&x % &m1), &m1, &(&x % &m2), &m2), x);
    }
}
