//! Joints that follow from others, in a prime field.
//!
//! An independent joint stands at the power z^L of a random point z of the circle, L being
//! the least common denominator of the multipliers with which revolute joints follow it;
//! these stand at powers of z, turned by constant rotations. Its displacement x, which
//! prismatic joints follow, is a random value of its own: x and exp(i x) are algebraically
//! independent. Velocities and accelerations are multiples in any case.

use std::collections::HashMap;

use num_integer::Integer;
use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive};
use roberval_mechanism::{AffineLaw, Closure, JointKind, Mechanism, VariableLaw};
use roberval_scalar::{Fp, LinearInPi, Quantity, SplitMix64};

use super::NotInField;
use super::angles::{compose, power, random_point};
use super::geometry::{Numbers, Rotation};
use super::model::FieldNumbers;
use crate::{Constants, JointMotion, Transmission};

/// Powers of a circle point beyond this would cost too much of the failure probability:
/// such a joint stands at a generic angle.
const LARGEST_POWER: i64 = 1 << 20;

/// How the joints of a mechanism with couples move.
#[derive(Debug, Clone)]
pub(super) struct ExactClosure<'m> {
    /// The law of each of the n joint variables.
    joints: Vec<JointLaw<'m>>,
    /// G.
    pub transmission: Transmission<Fp<'m>>,
    independent: usize,
    /// How many circle points stand for angles that are no powers.
    generic: usize,
    /// Texts of multipliers that stand for generic ones.
    pub generic_texts: Vec<String>,
}

#[derive(Debug, Clone)]
enum JointLaw<'m> {
    /// It moves by itself and nothing follows it.
    Free,
    Revolute(Turns<'m>),
    /// The displacement where all independent ones are 0.
    Prismatic(Fp<'m>),
}

/// The angle of a revolute joint as a product of rotations.
#[derive(Debug, Clone)]
struct Turns<'m> {
    /// Independent coordinates and the powers of their circle points.
    powers: Vec<(usize, i64)>,
    /// Generic circle points, and whether they are mirrored.
    generic: Vec<(usize, bool)>,
    offset: Rotation<Fp<'m>>,
}

/// Which joint variables follow others or are followed: their joints need an axis of
/// length 1.
#[must_use]
pub fn coupled(mechanism: &Mechanism) -> Vec<bool> {
    let Some(closure) = &mechanism.closure else {
        return vec![false; mechanism.dof()];
    };
    let mut coupled = vec![false; closure.laws.len()];
    for (variable, law) in closure.laws.iter().enumerate() {
        match law {
            VariableLaw::Affine(law) => {
                coupled[variable] = true;
                for (place, _) in &law.terms {
                    coupled[closure.independent[*place]] = true;
                }
            }
            VariableLaw::Formula(formula) => {
                coupled[variable] = true;
                for source in formula.joints() {
                    coupled[*source] = true;
                }
            }
            VariableLaw::Independent(_) | VariableLaw::Implicit => {}
        }
    }
    coupled
}

impl<'m> ExactClosure<'m> {
    /// The closure of a mechanism; `None` where all joints are independent.
    pub fn of(
        mechanism: &Mechanism,
        numbers: &mut FieldNumbers<'m, '_>,
    ) -> Result<Option<Self>, NotInField> {
        let Some(closure) = mechanism.closure.as_ref().filter(|_| mechanism.is_affine()) else {
            return Ok(None); // other constraints are opened
        };
        let powers = Powers::of(mechanism, closure);
        let coupled = coupled(mechanism);
        let Constants { zero, one, .. } = numbers.constants();
        let kinds = mechanism.moving().map(|link| link.joint);
        let mut build = Builder {
            powers: &powers,
            constants: &mechanism.description.constants,
            generic: HashMap::new(),
            generic_texts: Vec::new(),
        };
        let (mut joints, mut rows) = (Vec::new(), Vec::new());
        for (variable, (law, kind)) in closure.laws.iter().zip(kinds).enumerate() {
            let (row, offset) = match law {
                VariableLaw::Independent(place) => (vec![(*place, one)], None),
                VariableLaw::Implicit | VariableLaw::Formula(_) => return Ok(None),
                VariableLaw::Affine(law) => {
                    let terms = law.terms.iter();
                    let row = terms.map(|(place, m)| Ok((*place, numbers.value(m)?)));
                    let row = row.collect::<Result<_, NotInField>>()?;
                    (row, Some(&law.offset))
                }
            };
            rows.push(row);
            joints.push(match (kind, law) {
                (_, VariableLaw::Independent(_)) if !coupled[variable] => JointLaw::Free,
                (JointKind::Revolute, VariableLaw::Independent(place)) => {
                    JointLaw::Revolute(Turns {
                        powers: vec![(*place, powers.root[*place])],
                        generic: Vec::new(),
                        offset: (one, zero),
                    })
                }
                (JointKind::Revolute, VariableLaw::Affine(law)) => {
                    JointLaw::Revolute(build.turns(law, numbers)?)
                }
                _ => JointLaw::Prismatic(offset.map_or(Ok(zero), |o| numbers.value(o))?),
            });
        }
        Ok(Some(Self {
            joints,
            transmission: Transmission::from_rows(rows),
            independent: closure.independent.len(),
            generic: build.generic.len(),
            generic_texts: build.generic_texts,
        }))
    }

    /// The sum over the joints of the number of circle points in their rotations.
    pub fn turns(&self) -> u64 {
        let count = |joint: &JointLaw| match joint {
            JointLaw::Free | JointLaw::Prismatic(_) => 1,
            JointLaw::Revolute(turns) => {
                let powers = turns.powers.iter().map(|(_, e)| e.unsigned_abs());
                powers.sum::<u64>() + turns.generic.len() as u64
            }
        };
        self.joints.iter().map(count).sum()
    }

    /// A random motion of all joints. `free(qd, qdd)` draws the position of a joint to
    /// which nothing is coupled.
    pub fn motions(
        &self,
        constants: Constants<Fp<'m>>,
        rest: bool,
        random: &mut SplitMix64,
        mut free: impl FnMut(usize, Fp<'m>, Fp<'m>, &mut SplitMix64) -> JointMotion<Fp<'m>>,
    ) -> Vec<JointMotion<Fp<'m>>> {
        let Constants { zero, one, .. } = constants;
        let modulus = zero.modulus();
        let mut points =
            |count| -> Vec<_> { (0..count).map(|_| random_point(modulus, random)).collect() };
        let (z, generic) = (points(self.independent), points(self.generic));
        let mut values = || -> Vec<_> {
            (0..self.independent)
                .map(|_| modulus.random(random))
                .collect()
        };
        let (x, mut qad, qadd) = (values(), values(), values());
        if rest {
            qad.fill(zero);
        }
        let sum = |variable: usize, of: &[Fp<'m>], start: Fp<'m>| {
            let row = self.transmission.row(variable);
            row.fold(start, |sum, (place, g)| sum + g * of[place])
        };
        let mut motions = Vec::with_capacity(self.joints.len());
        for (variable, joint) in self.joints.iter().enumerate() {
            let (qd, qdd) = (sum(variable, &qad, zero), sum(variable, &qadd, zero));
            let (cos, sin, q) = match joint {
                JointLaw::Free => {
                    motions.push(free(variable, qd, qdd, random));
                    continue;
                }
                JointLaw::Prismatic(offset) => (one, zero, sum(variable, &x, *offset)),
                JointLaw::Revolute(turns) => {
                    let (cos, sin) = turns.rotation(&z, &generic);
                    (cos, sin, zero)
                }
            };
            motions.push(JointMotion {
                cos,
                sin,
                versine: one - cos,
                q,
                qd,
                qdd,
            });
        }
        motions
    }
}

impl<'m> Turns<'m> {
    fn rotation(&self, z: &[Rotation<Fp<'m>>], generic: &[Rotation<Fp<'m>>]) -> Rotation<Fp<'m>> {
        let mirrored = |(cos, sin): Rotation<Fp<'m>>, yes| (cos, if yes { -sin } else { sin });
        let mut rotation = self.offset;
        for &(place, exponent) in &self.powers {
            let turned = power(z[place], exponent.unsigned_abs());
            rotation = compose(rotation, mirrored(turned, exponent < 0));
        }
        for &(at, mirror) in &self.generic {
            rotation = compose(rotation, mirrored(generic[at], mirror));
        }
        rotation
    }
}

/// The powers of random points of the circle at which revolute joints stand that follow
/// others, or are followed.
#[derive(Debug, Clone)]
pub struct CouplePowers {
    /// L for each independent coordinate, whose own joint stands at the power L.
    pub roots: Vec<i64>,
    /// Whether all revolute joints that follow others have powers: else some multiplier is
    /// no fraction, or its power too large.
    pub complete: bool,
}

impl CouplePowers {
    /// The powers of a mechanism; `None` where all joints are independent.
    #[must_use]
    pub fn of(mechanism: &Mechanism) -> Option<Self> {
        let powers = Powers::of(mechanism, mechanism.closure.as_ref()?);
        Some(Self {
            complete: powers.others.iter().all(|n| *n == 0),
            roots: powers.root,
        })
    }
}

/// The powers of the independent coordinates' circle points.
struct Powers {
    /// L for each independent coordinate.
    root: Vec<i64>,
    /// For each, the rational multipliers that have their power.
    known: Vec<Vec<BigRational>>,
    /// For each, whether a revolute joint has one of these multipliers, and how many have
    /// others.
    used: Vec<bool>,
    others: Vec<usize>,
}

impl Powers {
    /// The least common denominators, as far as no power becomes too large.
    fn of(mechanism: &Mechanism, closure: &Closure) -> Self {
        let m = closure.independent.len();
        let mut powers = Self {
            root: vec![1; m],
            known: vec![vec![BigRational::one()]; m],
            used: vec![false; m],
            others: vec![0; m],
        };
        for (law, link) in closure.laws.iter().zip(mechanism.moving()) {
            if let (VariableLaw::Independent(place), JointKind::Revolute) = (law, link.joint) {
                powers.used[*place] = true;
            }
            let (VariableLaw::Affine(law), JointKind::Revolute) = (law, link.joint) else {
                continue;
            };
            for (place, multiplier) in &law.terms {
                let constants = &mechanism.description.constants;
                if rational(multiplier, constants).is_some_and(|x| powers.admit(*place, x)) {
                    powers.used[*place] = true;
                } else {
                    powers.others[*place] += 1;
                }
            }
        }
        powers
    }

    fn admit(&mut self, place: usize, multiplier: BigRational) -> bool {
        let Some(denominator) = multiplier.denom().to_i64() else {
            return false;
        };
        let root = i128::from(self.root[place]).lcm(&i128::from(denominator));
        let fits = |x: &BigRational| {
            let power = x * BigRational::from_integer(root.into());
            power.abs() <= BigRational::from_integer(LARGEST_POWER.into())
        };
        let all = self.known[place].iter().all(&fits) && fits(&multiplier);
        if all {
            self.root[place] = root as i64;
            self.known[place].push(multiplier);
        }
        all
    }

    /// Whether other multipliers may be related: one alone is as good as any.
    fn doubtful(&self, place: usize) -> bool {
        self.others[place] + usize::from(self.used[place]) > 1
    }

    /// The power that belongs to a multiplier.
    fn power(&self, place: usize, multiplier: &BigRational) -> Option<i64> {
        if !self.known[place].contains(multiplier) {
            return None;
        }
        let power = multiplier * BigRational::from_integer(self.root[place].into());
        power.to_integer().to_i64()
    }
}

fn rational(x: &Quantity, constants: &[(String, Quantity)]) -> Option<BigRational> {
    LinearInPi::of(&x.expr, constants)?.as_rational().cloned()
}

struct Builder<'a> {
    powers: &'a Powers,
    constants: &'a [(String, Quantity)],
    /// The point of an independent coordinate times a multiplier (the bits of its size).
    generic: HashMap<(usize, u64), usize>,
    generic_texts: Vec<String>,
}

impl Builder<'_> {
    fn turns<'m>(
        &mut self,
        law: &AffineLaw,
        numbers: &mut FieldNumbers<'m, '_>,
    ) -> Result<Turns<'m>, NotInField> {
        let mut turns = Turns {
            powers: Vec::new(),
            generic: Vec::new(),
            offset: numbers.rotation(&law.offset)?,
        };
        for (place, multiplier) in &law.terms {
            let exact = rational(multiplier, self.constants);
            match exact.and_then(|x| self.powers.power(*place, &x)) {
                Some(power) => turns.powers.push((*place, power)),
                None => {
                    let at = self.generic(*place, multiplier);
                    turns.generic.push((at, multiplier.value < 0.0));
                }
            }
        }
        Ok(turns)
    }

    fn generic(&mut self, place: usize, multiplier: &Quantity) -> usize {
        let next = self.generic.len();
        let key = (place, multiplier.value.abs().to_bits());
        let texts = &mut self.generic_texts;
        *self.generic.entry(key).or_insert_with(|| {
            if self.powers.doubtful(place) {
                texts.push(format!("{} times a joint", multiplier.text));
            }
            next
        })
    }
}
