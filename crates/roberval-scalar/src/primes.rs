//! Primes of a residue class, found at random.

use crate::SplitMix64;

/// Whether n is prime: Miller-Rabin with the first twelve primes as bases, which decides
/// every number below 3.3e24 (Sorenson and Webster 2015).
#[must_use]
pub fn is_prime(n: u64) -> bool {
    const BASES: [u64; 12] = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37];
    if n < 2 {
        return false;
    }
    for p in BASES {
        if n.is_multiple_of(p) {
            return n == p;
        }
    }
    let twos = (n - 1).trailing_zeros();
    let odd = (n - 1) >> twos;
    BASES.iter().all(|&base| {
        let mut x = power(base, odd, n);
        if x == 1 || x == n - 1 {
            return true;
        }
        (1..twos).any(|_| {
            x = times(x, x, n);
            x == n - 1
        })
    })
}

/// A random prime p with `2^61 < p < 2^62` and `p = -1 (mod n)`: then the circle group
/// modulo p, which has p + 1 elements, holds the rotation by 1/n of a turn.
/// n must be below 2^50, so that the class holds primes enough to choose from.
pub fn random_prime(n: u64, random: &mut SplitMix64) -> u64 {
    assert!(
        (1..1 << 50).contains(&n),
        "too few primes below 2^62 are -1 modulo {n}"
    );
    let (low, high) = ((1_u64 << 61) / n + 1, (1_u64 << 62) / n);
    loop {
        let p = (low + random.next_u64() % (high - low)) * n - 1;
        if is_prime(p) {
            return p;
        }
    }
}

fn times(a: u64, b: u64, n: u64) -> u64 {
    (u128::from(a) * u128::from(b) % u128::from(n)) as u64
}

fn power(mut base: u64, mut exponent: u64, n: u64) -> u64 {
    let mut result = 1;
    while exponent > 0 {
        if exponent & 1 == 1 {
            result = times(result, base, n);
        }
        base = times(base, base, n);
        exponent >>= 1;
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn primes_below_a_thousand_are_those_of_trial_division() {
        for n in 0..1000_u64 {
            let by_division = n > 1 && (2..n).take_while(|d| d * d <= n).all(|d| n % d != 0);
            assert_eq!(is_prime(n), by_division, "{n}");
        }
    }

    #[test]
    fn known_large_primes_and_pseudoprimes_are_told_apart() {
        assert!(is_prime((1 << 61) - 1));
        assert!(is_prime((1 << 62) - 3545));
        assert!(
            !is_prime(3_215_031_751),
            "a strong pseudoprime to 2, 3, 5 and 7"
        );
        assert!(
            !is_prime(3_825_123_056_546_413_051),
            "to the first nine primes"
        );
    }

    #[test]
    fn random_primes_are_in_their_class_and_differ() {
        let mut random = SplitMix64::new(1);
        for n in [120, 360, 55440, 1 << 40] {
            let (p, q) = (random_prime(n, &mut random), random_prime(n, &mut random));
            assert!(is_prime(p) && (p + 1) % n == 0 && p >> 61 == 1);
            assert_ne!(p, q);
        }
    }
}
