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
    f: impl FnOnce(&ExactModel<'_>, &mut SplitMix64) -> T,
) -> Result<T, NotInField> {
    let mut random = SplitMix64::new(seed);
    let mut last = NotInField::Root;
    for _ in 0..MOST_PRIMES {
        let modulus = Modulus::new(random_prime(angles.get(), &mut random));
        let model_seed = random.next_u64();
        match ExactModel::new(mechanism, &modulus, angles, conjugate, model_seed) {
            Ok(exact) => return Ok(f(&exact, &mut random)),
            Err(error) => last = error,
        }
    }
    Err(last)
}
