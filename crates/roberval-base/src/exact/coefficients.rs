//! beta from its residues: fractions, or sums of fractions times sqrt(2), sqrt(3) and
//! sqrt(6) for robots with angles of 45, 30 or 15 degrees. What is neither is left to be
//! rounded.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::Zero;
use roberval_linalg::{ChineseRemainder, rational_from_residue};
use roberval_regressor::{AngleOrder, NotInField};
use roberval_scalar::{Modulus, cancellation_point};

use super::number::ExactNumber;
use super::run::Run;

/// Fields whose residues are joined at most to find a fraction: 12 times 62 bits hold
/// the products of two lengths with 15 digits, divided by another such.
const MOST_JOINED: u64 = 12;

/// An automorphism of the field of 15 degrees: angles are taken k times, k = 1 (mod 4),
/// and sqrt(2) and sqrt(3) take these signs.
struct Automorphism {
    k: u64,
    two: i64,
    three: i64,
}

const IDENTITY: Automorphism = Automorphism {
    k: 1,
    two: 1,
    three: 1,
};
const OTHERS: [Automorphism; 3] = [
    Automorphism {
        k: 17,
        two: 1,
        three: -1,
    },
    Automorphism {
        k: 13,
        two: -1,
        three: 1,
    },
    Automorphism {
        k: 5,
        two: -1,
        three: -1,
    },
];

/// A radicand, and whether sqrt(2) and sqrt(3) divide its root.
struct Root {
    radicand: u32,
    two: bool,
    three: bool,
}

const ONE: Root = Root {
    radicand: 1,
    two: false,
    three: false,
};
const SURDS: [Root; 3] = [
    Root {
        radicand: 2,
        two: true,
        three: false,
    },
    Root {
        radicand: 3,
        two: false,
        three: true,
    },
    Root {
        radicand: 6,
        two: true,
        three: true,
    },
];

/// beta as two agreeing runs and, where these do not suffice, further ones tell it.
/// `field(seed, conjugate)` runs the engine in another field.
pub(super) fn coefficients(
    first: &Run,
    second: &Run,
    angles: AngleOrder,
    field: impl Fn(u64, u64) -> Result<Run, NotInField>,
) -> Result<Vec<Vec<ExactNumber>>, NotInField> {
    let (mut beta, mut open) = short_fractions(first, second);
    if open.is_empty() || !first.algebraic || !angles.twelfths() {
        return Ok(beta);
    }
    let rational = angles.right() && !first.roots;
    let mut automorphisms = vec![IDENTITY];
    let mut roots = vec![ONE];
    if !rational {
        automorphisms.extend(OTHERS);
        roots.extend(SURDS);
    }
    let mut joined: Option<Joined> = None;
    for k in 0..MOST_JOINED {
        let seed = first.seed.wrapping_add(7919 * k);
        let conjugate = |a: &Automorphism| field(seed, coprime(a.k, angles.get()));
        let runs: Vec<Run> = automorphisms
            .iter()
            .map(conjugate)
            .collect::<Result<_, _>>()?;
        if runs.iter().any(|r| r.kept != first.kept) {
            continue; // an unlucky field: the next one will do
        }
        let residues = Residues::of(&runs, &automorphisms, &roots, &open);
        joined = Some(match joined {
            None => Joined::of(residues),
            Some(before) => before.confirm(&residues, &roots, &mut open, &mut beta),
        });
        if open.is_empty() {
            break;
        }
    }
    Ok(beta)
}

/// Fractions that one prime holds and the other confirms; and the entries left open.
fn short_fractions(first: &Run, second: &Run) -> (Vec<Vec<ExactNumber>>, Vec<(usize, usize)>) {
    let p = BigInt::from(first.p);
    let field = Modulus::new(second.p);
    let fraction = |a1: u64, a2: u64| {
        if (a1, a2) == (0, 0) {
            return Some(BigRational::zero()); // most entries
        }
        let fraction = rational_from_residue(&a1.into(), &p)?;
        let confirmed =
            field.big(fraction.numer()) == field.big(fraction.denom()) * field.element(a2);
        confirmed.then_some(fraction)
    };
    let mut open = Vec::new();
    let mut beta = Vec::with_capacity(first.beta.len());
    for (i, (row1, row2)) in first.beta.iter().zip(&second.beta).enumerate() {
        cancellation_point();
        let mut entry = |(j, (&a1, &a2)): (usize, (&u64, &u64))| match fraction(a1, a2) {
            Some(fraction) => ExactNumber::Rational(fraction),
            None => {
                open.push((i, j));
                ExactNumber::Rounded(f64::NAN)
            }
        };
        beta.push(row1.iter().zip(row2).enumerate().map(&mut entry).collect());
    }
    (beta, open)
}

/// Whether `x = residue (mod p)`.
fn is_residue(x: &BigRational, residue: &BigInt, p: &BigInt) -> bool {
    ((x.numer() - x.denom() * residue) % p).is_zero()
}

/// The least k that is `class` modulo 24 and has no factor in common with n.
fn coprime(class: u64, n: u64) -> u64 {
    let mut k = class;
    while num_integer::gcd(k, n) != 1 {
        k += 24;
    }
    k
}

/// In one field, the residue of each root's factor in each open entry.
struct Residues {
    p: BigInt,
    /// For each open entry, one residue a root.
    values: Vec<Vec<BigInt>>,
}

impl Residues {
    /// The factor of sqrt(n) is the mean of `sign beta / sqrt(n)` over the automorphisms.
    fn of(
        runs: &[Run],
        automorphisms: &[Automorphism],
        roots: &[Root],
        open: &[(usize, usize)],
    ) -> Self {
        let field = Modulus::new(runs[0].p);
        let count = field.integer(automorphisms.len() as i64);
        let factor = |root: &Root, i: usize, j: usize| {
            let mut sum = field.integer(0);
            for (run, a) in runs.iter().zip(automorphisms) {
                let sign =
                    (if root.two { a.two } else { 1 }) * (if root.three { a.three } else { 1 });
                sum = sum + field.integer(sign) * field.element(run.beta[i][j]);
            }
            let mut divisor = count;
            for (divides, sqrt) in [(root.two, runs[0].sqrt2), (root.three, runs[0].sqrt3)] {
                if divides {
                    divisor = divisor * field.element(sqrt);
                }
            }
            let inverse = divisor.inverse().unwrap_or(field.integer(0));
            BigInt::from((sum * inverse).residue())
        };
        let values = open
            .iter()
            .map(|&(i, j)| roots.iter().map(|r| factor(r, i, j)).collect());
        Self {
            p: runs[0].p.into(),
            values: values.collect(),
        }
    }
}

/// Residues modulo a product of primes.
struct Joined(Residues);

impl Joined {
    fn of(residues: Residues) -> Self {
        Self(residues)
    }

    /// Closes the entries whose fractions so far are confirmed by another field, and
    /// joins that field's residues for the others.
    fn confirm(
        self,
        next: &Residues,
        roots: &[Root],
        open: &mut Vec<(usize, usize)>,
        beta: &mut [Vec<ExactNumber>],
    ) -> Self {
        let Residues { p: modulus, values } = self.0;
        let product = &modulus * &next.p;
        let Some(remainder) = ChineseRemainder::new(modulus.clone(), next.p.clone()) else {
            return Self(Residues { p: modulus, values }); // the same prime again
        };
        let mut rest = Vec::new();
        let mut still = Vec::new();
        for ((&(i, j), old), new) in open.iter().zip(values).zip(&next.values) {
            cancellation_point();
            let guess = |(r, a): (&BigInt, &BigInt)| {
                rational_from_residue(r, &modulus).filter(|x| is_residue(x, a, &next.p))
            };
            match old.iter().zip(new).map(guess).collect::<Option<Vec<_>>>() {
                Some(factors) => {
                    let terms = roots.iter().map(|r| r.radicand).zip(factors).collect();
                    beta[i][j] = ExactNumber::of_terms(terms);
                }
                None => {
                    let join = |(r, a): (&BigInt, &BigInt)| remainder.join(r, a);
                    rest.push(old.iter().zip(new).map(join).collect());
                    still.push((i, j));
                }
            }
        }
        *open = still;
        Self(Residues {
            p: product,
            values: rest,
        })
    }
}
