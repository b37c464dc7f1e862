//! A prime field that holds a robot.

use roberval_mechanism::Mechanism;
use roberval_regressor::{AngleOrder, ExactModel, NotInField};
use roberval_scalar::{Modulus, SplitMix64, random_prime};

/// Primes tried before a description's square roots count as unobtainable: each prime
/// has a given root with probability 1/2.
const MOST_PRIMES: usize = 256;

/// What `f` makes of the mechanism in a random prime field that has all its numbers.
/// Constant angles of finite order are taken `conjugate` times (1, or a number that has
/// no factor in common with that order). All that is random comes from `seed`; `f`
/// receives the source for more.
pub(crate) fn in_some_field<T>(
    mechanism: &Mechanism,
    angles: AngleOrder,
    seed: u64,
    conjugate: u64,
    mut f: impl FnMut(&ExactModel<'_>, &mut SplitMix64) -> T,
) -> Result<T, NotInField> {
    try_fields(angles, seed, |modulus, seed, random| {
        let exact = ExactModel::new(mechanism, modulus, angles, conjugate, seed)?;
        Ok(f(&exact, random))
    })
}

/// The first of many random prime fields that succeeds. `attempt` receives the field, a
/// seed and the source for more.
pub(super) fn try_fields<T>(
    angles: AngleOrder,
    seed: u64,
    mut attempt: impl FnMut(&Modulus, u64, &mut SplitMix64) -> Result<T, NotInField>,
) -> Result<T, NotInField> {
    let mut random = SplitMix64::new(seed);
    let mut last = NotInField::Root;
    for _ in 0..MOST_PRIMES {
        let modulus = Modulus::new(random_prime(angles.get(), &mut random));
        let seed = random.next_u64();
        match attempt(&modulus, seed, &mut random) {
            Err(error @ (NotInField::Root | NotInField::Inverse)) => last = error,
            other => return other,
        }
    }
    Err(last)
}
