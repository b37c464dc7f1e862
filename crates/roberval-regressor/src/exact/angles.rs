//! Constant angles as points of the circle group of a prime field.

use num_bigint::BigInt;
use num_integer::Integer;
use num_rational::BigRational;
use num_traits::ToPrimitive;
use roberval_mechanism::{Geometry, JointKind, Mechanism, VariableLaw};
use roberval_scalar::{Fp, LinearInPi, Modulus, Quantity, SplitMix64};

use super::geometry::Rotation;
use super::units::AngleUnits;

/// Rotations of this order are always there: multiples of 3 degrees, and with them the
/// square roots of 2, 3 and 5.
const USUAL_ORDER: u64 = 120;

/// Orders up to this leave primes enough below 2^62 to choose from.
const LARGEST_ORDER: u64 = 1 << 40;

/// The order n of the rotation whose powers are the robot's rational angles: primes must
/// be -1 modulo n.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AngleOrder {
    order: u64,
    /// The least order that the description's own angles need.
    needed: u64,
}

impl AngleOrder {
    /// The least order that holds the robot's rational multiples of pi (of those
    /// with unwieldy denominators, as many as fit).
    #[must_use]
    pub fn of(robot: &Mechanism) -> Self {
        let (mut order, mut needed) = (USUAL_ORDER, 1);
        for angle in angles(robot) {
            let Some(turns) = LinearInPi::of(&angle.expr, &robot.description.constants) else {
                continue;
            };
            let turns = turns.half_turns / BigInt::from(2);
            if let Some(denominator) = turns.denom().to_u64() {
                let both = u128::from(order).lcm(&u128::from(denominator));
                if both <= u128::from(LARGEST_ORDER) {
                    order = both as u64;
                    needed = needed.lcm(&denominator);
                }
            }
        }
        Self { order, needed }
    }

    /// n
    #[must_use]
    pub fn get(self) -> u64 {
        self.order
    }

    /// How many n-th parts of a turn these half turns are, modulo n; `None` if no whole
    /// number.
    pub(crate) fn steps(self, half_turns: &BigRational) -> Option<u64> {
        let order = BigInt::from(self.order);
        let steps = half_turns * &order / BigInt::from(2);
        let whole = steps.is_integer().then(|| steps.to_integer())?;
        whole.mod_floor(&order).to_u64()
    }

    /// Whether all rational angles are multiples of 90 degrees, so that their cosines
    /// and sines are whole.
    #[must_use]
    pub fn right(self) -> bool {
        4_u64.is_multiple_of(self.needed)
    }

    /// Whether all rational angles are multiples of 15 degrees, so that their cosines
    /// and sines are sums of fractions of 1, sqrt(2), sqrt(3) and sqrt(6).
    #[must_use]
    pub fn twelfths(self) -> bool {
        24_u64.is_multiple_of(self.needed)
    }
}

/// The constant angles: those of the geometry, loops included, and those at which revolute joints stand
/// where the ones that they follow stand at 0.
pub(crate) fn angles(robot: &Mechanism) -> impl Iterator<Item = &Quantity> {
    let links = robot
        .description
        .links
        .iter()
        .flat_map(|link| match &link.geometry {
            Geometry::Mdh(g) => vec![&g.gamma, &g.alpha, &g.theta],
            Geometry::Placed { origins, .. } => origins.iter().flat_map(|o| &o.rpy).collect(),
        });
    let laws = robot.closure.iter().flat_map(|closure| &closure.laws);
    let offsets = laws
        .zip(robot.moving())
        .filter_map(|(law, link)| match law {
            VariableLaw::Affine(law) if link.joint == JointKind::Revolute => Some(&law.offset),
            _ => None,
        });
    let loops = robot.description.loops.iter();
    let frames = loops.flat_map(|closure| &closure.frames);
    links
        .chain(offsets)
        .chain(frames.flat_map(|frame| &frame.rpy))
}

/// A point of the circle from `t = tan(angle/2)`; `None` where `1 + t^2 = 0`.
pub(crate) fn circle_point<'m>(t: Fp<'m>) -> Option<Rotation<Fp<'m>>> {
    let one = t.modulus().integer(1);
    let inverse = (one + t * t).inverse()?;
    Some(((one - t * t) * inverse, (t + t) * inverse))
}

/// The rotation by the sum of two angles.
pub(crate) fn compose<'m>(a: Rotation<Fp<'m>>, b: Rotation<Fp<'m>>) -> Rotation<Fp<'m>> {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}

pub(crate) fn power<'m>(mut a: Rotation<Fp<'m>>, mut exponent: u64) -> Rotation<Fp<'m>> {
    let modulus = a.0.modulus();
    let mut result = (modulus.integer(1), modulus.integer(0));
    while exponent > 0 {
        if exponent & 1 == 1 {
            result = compose(result, a);
        }
        a = compose(a, a);
        exponent >>= 1;
    }
    result
}

/// The angles of one robot in one field.
pub(crate) struct Angles<'m, 'd> {
    modulus: &'m Modulus,
    order: AngleOrder,
    /// A rotation of exactly that order.
    root: Rotation<Fp<'m>>,
    pub units: AngleUnits<'d>,
    /// A random rotation for each unit.
    random: Vec<Rotation<Fp<'m>>>,
    /// How often constant rotations take those, in all.
    pub steps: u64,
}

impl<'m, 'd> Angles<'m, 'd> {
    /// `modulus` must be -1 modulo `order`.
    pub fn new(
        modulus: &'m Modulus,
        robot: &'d Mechanism,
        order: AngleOrder,
        conjugate: u64,
        random: &mut SplitMix64,
    ) -> Self {
        let root = power(root_of_order(modulus, order.order, random), conjugate);
        let units = AngleUnits::of(robot, order);
        let points = units.units().iter().map(|_| random_point(modulus, random));
        Self {
            modulus,
            order,
            root,
            random: points.collect(),
            units,
            steps: 0,
        }
    }

    /// The square roots of 2 and 3: twice the cosines of 45 and 30 degrees.
    pub fn roots(&self) -> [Fp<'m>; 2] {
        [8, 12].map(|part| self.modulus.integer(2) * self.turn(self.order.get() / part).0)
    }

    /// The order n of the finite rotations.
    pub fn order(&self) -> u64 {
        self.order.get()
    }

    /// The rotation by `k / order` of a turn.
    pub fn turn(&self, k: u64) -> Rotation<Fp<'m>> {
        power(self.root, k % self.order())
    }

    /// The rotation by an angle of the description: whole steps of the finite order, then
    /// whole steps of a unit.
    pub fn rotation(&mut self, angle: &Quantity) -> Rotation<Fp<'m>> {
        let parts = self.units.parts(angle);
        let finite = self.turn(self.order.steps(&parts.half_turns).unwrap_or(0));
        let Some((unit, steps)) = parts.multiple else {
            return finite;
        };
        self.steps += steps.unsigned_abs();
        let (cos, sin) = power(self.random[unit], steps.unsigned_abs());
        compose(finite, (cos, if steps < 0 { -sin } else { sin }))
    }
}

pub(crate) fn random_point<'m>(modulus: &'m Modulus, random: &mut SplitMix64) -> Rotation<Fp<'m>> {
    loop {
        if let Some(point) = circle_point(modulus.random(random)) {
            return point;
        }
    }
}

/// A rotation whose least power that is the identity is the n-th (n a multiple of 4) and
/// whose n/4-th power is the quarter turn (0, 1): not its mirror image (0, -1).
fn root_of_order<'m>(modulus: &'m Modulus, n: u64, random: &mut SplitMix64) -> Rotation<Fp<'m>> {
    let identity = (modulus.integer(1), modulus.integer(0));
    let divisors: Vec<u64> = prime_factors(n);
    loop {
        let root = power(random_point(modulus, random), (modulus.p() + 1) / n);
        if divisors.iter().all(|q| power(root, n / q) != identity) {
            let mirrored = power(root, n / 4).1 != modulus.integer(1);
            return (root.0, if mirrored { -root.1 } else { root.1 });
        }
    }
}

/// The primes that divide n, by trial division (n is at most 2^40).
pub(crate) fn prime_factors(mut n: u64) -> Vec<u64> {
    let mut factors = Vec::new();
    let mut q = 2;
    while q * q <= n {
        if n.is_multiple_of(q) {
            factors.push(q);
            while n.is_multiple_of(q) {
                n /= q;
            }
        }
        q += 1;
    }
    if n > 1 {
        factors.push(n);
    }
    factors
}
