use std::cell::Cell;

use roberval_mechanism::{JointKind, Mechanism, ParameterSpace};
use roberval_scalar::{Fp, Modulus, Quantity, SplitMix64};

use super::angles::{AngleOrder, Angles};
use super::geometry::{Numbers, Rotation, RowsWorkspace, tree};
use super::lengths::Lengths;
use crate::base::{attitude, squared_length};
use crate::{BaseState, Body, Constants, JointMotion, Model, Tree};

/// A number of the description has no place in this field: try another prime.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum NotInField {
    /// The field has no such square root.
    #[error("a square root of the description is not in this prime field")]
    Root,
    /// A number of the description has thousands of digits.
    #[error("an expression of the description is too long to be evaluated exactly")]
    TooLong,
    /// A denominator of the description is zero in the field.
    #[error("a denominator of the description is zero in this prime field")]
    Inverse,
}

/// A robot in a prime field: gives regressor rows at random states.
#[derive(Debug, Clone)]
pub struct ExactModel<'m> {
    modulus: &'m Modulus,
    tree: Tree<Fp<'m>>,
    space: ParameterSpace,
    generic: Vec<String>,
    rotations: usize,
    roots: [Fp<'m>; 2],
    has_roots: bool,
}

impl<'m> ExactModel<'m> {
    /// The mechanism's description in this field. `modulus` must be -1 modulo `order`.
    /// Rational angles are taken `conjugate` times: 1 for the robot itself; a number that
    /// has no factor in common with `order` gives the robot whose square roots have other
    /// signs.
    ///
    /// # Errors
    /// [`NotInField`] if a square root or an inverse is missing: another prime has it.
    pub fn new(
        mechanism: &Mechanism,
        modulus: &'m Modulus,
        order: AngleOrder,
        conjugate: u64,
        seed: u64,
    ) -> Result<Self, NotInField> {
        let description = &mechanism.description;
        let mut random = SplitMix64::new(seed);
        let pi = modulus.random(&mut random);
        let mut numbers = FieldNumbers {
            angles: Angles::new(modulus, order, conjugate, random),
            lengths: Lengths {
                modulus,
                constants: &description.constants,
                pi,
                roots: Cell::new(false),
            },
            half: modulus.integer(2).inverse().ok_or(NotInField::Inverse)?,
        };
        Ok(Self {
            modulus,
            tree: tree(mechanism, &mut numbers)?,
            space: mechanism.parameters(),
            roots: numbers.angles.roots(),
            has_roots: numbers.lengths.roots.get(),
            generic: numbers.angles.generic_texts,
            rotations: numbers.angles.generic_rotations,
        })
    }

    /// The field.
    #[must_use]
    pub fn modulus(&self) -> &'m Modulus {
        self.modulus
    }

    /// The robot's constants in the field.
    #[must_use]
    pub fn tree(&self) -> &Tree<Fp<'m>> {
        &self.tree
    }

    /// The angles that stand for generic ones, as written.
    #[must_use]
    pub fn generic(&self) -> &[String] {
        &self.generic
    }

    /// The square root of 2 that the angles mean by cos 45 degrees.
    #[must_use]
    pub fn sqrt2(&self) -> Fp<'m> {
        self.roots[0]
    }

    /// The square root of 3 that the angles mean by cos 30 degrees.
    #[must_use]
    pub fn sqrt3(&self) -> Fp<'m> {
        self.roots[1]
    }

    /// Whether numbers of the description have square roots that are no fractions.
    #[must_use]
    pub fn has_roots(&self) -> bool {
        self.has_roots
    }

    /// An upper bound of the degree of a row's entries, denominators cleared, in the
    /// random values: a rotation enters at most three times, twice by `w x w` and once by
    /// transport, each with degree 2 in its half-angle tangent; velocities add 2. A floating
    /// base's attitude enters once, with gravity, with degree 2 in its quaternion.
    #[must_use]
    pub fn degree(&self) -> usize {
        let joints = self.tree.bodies.iter().filter(|b| b.variable.is_some());
        6 * (joints.count() + self.rotations) + 2
    }

    /// Fills `rows` (rows of a sample x C) at a random state. Rows of h are not yet
    /// differences.
    ///
    /// # Panics
    /// If `rows` does not have this size.
    pub fn fill(
        &self,
        model: Model,
        random: &mut SplitMix64,
        work: &mut ExactWorkspace<'m>,
        rows: &mut [Fp<'m>],
    ) {
        if self.tree.is_floating() {
            work.move_base(&self.tree, &self.base(model, random));
        }
        let motion = |body: &Body<Fp<'m>>| self.motion(body, model, random);
        work.fill(&self.tree, &self.space, model, motion, rows);
    }

    /// Working memory for [`ExactModel::fill`].
    #[must_use]
    pub fn workspace(&self) -> ExactWorkspace<'m> {
        RowsWorkspace::new(&self.tree)
    }

    /// A random state of a floating base: the attitude of a random quaternion, of any
    /// length that has an inverse.
    fn base(&self, model: Model, random: &mut SplitMix64) -> BaseState<Fp<'m>> {
        let constants = self.tree.constants;
        let mut three = || [(); 3].map(|()| self.modulus.random(random));
        let (position, v, w, dv, dw) = (three(), three(), three(), three(), three());
        let (quaternion, inverse) = loop {
            let quaternion = [(); 4].map(|()| self.modulus.random(random));
            if let Some(inverse) = squared_length(quaternion).inverse() {
                break (quaternion, inverse);
            }
        };
        let state = BaseState {
            attitude: attitude(quaternion, inverse, constants),
            position,
            v,
            w,
            dv,
            dw,
        };
        if model == Model::D0 {
            state.at_rest(constants.zero)
        } else {
            state
        }
    }

    /// A random motion: a rational point of the circle for a revolute joint, in units of
    /// its axis vector a: `t = tan(q/2)/|a|`.
    fn motion(
        &self,
        body: &Body<Fp<'m>>,
        model: Model,
        random: &mut SplitMix64,
    ) -> JointMotion<Fp<'m>> {
        let Constants { zero, one, .. } = self.tree.constants;
        let mut draw = || self.modulus.random(random);
        let (mut cos, mut sin, mut versine, mut q) = (one, zero, zero, zero);
        match body.joint {
            JointKind::Revolute => loop {
                let t = draw();
                let t2 = t * t * body.axis_squared;
                let Some(inverse) = (one + t2).inverse() else {
                    continue;
                };
                cos = (one - t2) * inverse;
                sin = (t + t) * inverse;
                versine = sin * t;
                break;
            },
            JointKind::Prismatic => q = draw(),
            JointKind::Fixed | JointKind::Floating => {}
        }
        let qd = if model == Model::D0 { zero } else { draw() };
        JointMotion {
            cos,
            sin,
            versine,
            q,
            qd,
            qdd: draw(),
        }
    }
}

/// Working memory of [`ExactModel::fill`].
pub type ExactWorkspace<'m> = RowsWorkspace<Fp<'m>>;

/// Literals as numbers of the field.
struct FieldNumbers<'m, 'd> {
    angles: Angles<'m>,
    lengths: Lengths<'m, 'd>,
    half: Fp<'m>,
}

impl<'m> Numbers for FieldNumbers<'m, '_> {
    type Number = Fp<'m>;
    type Error = NotInField;

    fn constants(&self) -> Constants<Fp<'m>> {
        Constants {
            zero: self.lengths.modulus.integer(0),
            one: self.lengths.modulus.integer(1),
            half: self.half,
        }
    }

    fn rotation(&mut self, angle: &Quantity) -> Result<Rotation<Fp<'m>>, NotInField> {
        Ok(self.angles.rotation(angle, self.lengths.constants))
    }

    fn value(&mut self, quantity: &Quantity) -> Result<Fp<'m>, NotInField> {
        self.lengths.value(quantity, &self.angles)
    }
}
