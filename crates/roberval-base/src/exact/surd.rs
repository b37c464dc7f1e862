//! Coefficients in the field of sqrt(2) and sqrt(3): robots with angles of 45, 30 or 15
//! degrees.

use num_rational::BigRational;
use roberval_linalg::rational_from_residue;
use roberval_mechanism::Mechanism;
use roberval_regressor::{AngleOrder, Model, NotInField};
use roberval_scalar::{Fp, Modulus};

use super::decision::is_residue;
use super::number::ExactNumber;
use super::run::{Run, run};

/// Angles times k, k = 1 (mod 4), is the automorphism of the field of 15 degrees that
/// takes (sqrt2, sqrt3) to these signs of themselves.
const CONJUGATES: [(u64, i64, i64); 4] = [(1, 1, 1), (17, 1, -1), (13, -1, 1), (5, -1, -1)];

/// A radicand, and whether sqrt(2) and sqrt(3) divide its root.
struct Root {
    radicand: u32,
    two: bool,
    three: bool,
}

const ROOTS: [Root; 4] = [
    Root { radicand: 1, two: false, three: false },
    Root { radicand: 2, two: true, three: false },
    Root { radicand: 3, two: false, three: true },
    Root { radicand: 6, two: true, three: true },
];

impl Root {
    /// The sign this root takes when sqrt(2) and sqrt(3) take theirs.
    fn sign(&self, two: i64, three: i64) -> i64 {
        (if self.two { two } else { 1 }) * (if self.three { three } else { 1 })
    }
}

/// Writes the entries of `open` as `r1 + r2 sqrt(2) + r3 sqrt(3) + r6 sqrt(6)` where they
/// have this form: each r is a mean over the four automorphisms, with its sign.
pub(super) fn surds(
    mechanism: &Mechanism,
    model: Model,
    order: &[usize],
    angles: AngleOrder,
    first: &Run,
    open: &[(usize, usize)],
    beta: &mut [Vec<ExactNumber>],
) -> Result<(), NotInField> {
    let n = angles.get();
    let in_field = |seed: u64| -> Result<Vec<Run>, NotInField> {
        CONJUGATES
            .iter()
            .map(|c| run(mechanism, model, order, angles, seed, coprime(c.0, n)))
            .collect()
    };
    let found = in_field(first.seed)?;
    let check = in_field(first.seed.wrapping_add(104_729))?;
    if found.iter().chain(&check).any(|r| r.kept != first.kept) {
        return Ok(());
    }
    for &(i, j) in open {
        let terms: Option<Vec<_>> = ROOTS.iter().map(|root| term(root, &found, i, j)).collect();
        let checked = |(root, x): (&Root, &(u32, BigRational))| {
            residue(root, &check, i, j).is_some_and(|r| is_residue(&x.1, r, check[0].p))
        };
        if let Some(terms) = terms
            && ROOTS.iter().zip(&terms).all(checked)
        {
            beta[i][j] = ExactNumber::of_terms(terms);
        }
    }
    Ok(())
}

/// The least k that is `class` modulo 24 and has no factor in common with n.
fn coprime(class: u64, n: u64) -> u64 {
    let mut k = class;
    while num_integer::gcd(k, n) != 1 {
        k += 24;
    }
    k
}

fn term(
    root: &Root,
    runs: &[Run],
    i: usize,
    j: usize,
) -> Option<(u32, BigRational)> {
    let residue = residue(root, runs, i, j)?;
    Some((
        root.0,
        rational_from_residue(&residue.into(), &runs[0].p.into())?,
    ))
}

/// The residue of r in the mean over automorphisms, `sum of sign beta / (4 sqrt(n))`.
fn residue(root: &Root, runs: &[Run], i: usize, j: usize) -> Option<u64> {
    let field = Modulus::new(runs[0].p);
    let mut sum: Fp<'_> = field.integer(0);
    for (run, &(_, a, b)) in runs.iter().zip(&CONJUGATES) {
        sum = sum + field.integer(root.sign(a, b)) * field.big(&run.beta[i][j].into());
    }
    let mut value = field.integer(4);
    for (divides, sqrt) in [(root.two, runs[0].sqrt2), (root.three, runs[0].sqrt3)] {
        if divides {
            value = value * field.big(&sqrt.into());
        }
    }
    Some((sum * value.inverse()?).residue())
}
