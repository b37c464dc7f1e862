use std::cell::Cell;

use roberval_mechanism::{JointKind, Mechanism, ParameterSpace};
use roberval_scalar::{Fp, LinearInPi, Modulus, Quantity, SplitMix64};

use super::angles::{AngleOrder, Angles, compose, power};
use super::closure::ExactClosure;
use super::geometry::{Numbers, Rotation, RowsWorkspace, tree};
use super::lengths::Lengths;
use super::loops::{ExactLoops, NotClosed};
use super::named::times;
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
    /// Loops whose closed configurations are not easy to find in any prime field.
    #[error("{0}, so that prime fields do not decide them")]
    Loops(NotClosed),
}

/// A constant's rotation in a prime field.
#[derive(Debug, Clone)]
pub struct Turn<'m> {
    /// The constant's name.
    pub name: String,
    /// Cosine and sine.
    pub rotation: (Fp<'m>, Fp<'m>),
}

/// A robot in a prime field: gives regressor rows at random states.
#[derive(Debug, Clone)]
pub struct ExactModel<'m> {
    modulus: &'m Modulus,
    tree: Tree<Fp<'m>>,
    closure: Option<ExactClosure<'m>>,
    loops: Option<Result<ExactLoops<'m>, NotClosed>>,
    space: ParameterSpace,
    generic: Vec<String>,
    algebraic: bool,
    steps: u64,
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
        Self::with_turns(mechanism, modulus, order, conjugate, seed, &[])
    }

    /// The same with named angles turned further: an angle of the description in whose
    /// expression one of these constants stands k times (once in `A`, -2 times in
    /// `pi/2 - 2*A`) is turned k times by the constant's rotation. A symbol for an angle
    /// is a constant of value 0 with a random rotation.
    ///
    /// # Errors
    /// As [`ExactModel::new`].
    pub fn with_turns(
        mechanism: &Mechanism,
        modulus: &'m Modulus,
        order: AngleOrder,
        conjugate: u64,
        seed: u64,
        turns: &[Turn<'m>],
    ) -> Result<Self, NotInField> {
        let mut random = SplitMix64::new(seed);
        let pi = modulus.random(&mut random);
        let angles = Angles::new(modulus, mechanism, order, conjugate, &mut random);
        let mut numbers = FieldNumbers::new(mechanism, angles, pi, turns)?;
        let tree = tree(mechanism, &mut numbers)?;
        let closure = ExactClosure::of(mechanism, &mut numbers)?;
        let mut generic = numbers.angles.units.generic();
        generic.extend(numbers.lengths_of_axes.clone());
        generic.extend(closure.iter().flat_map(|c| c.generic_texts.clone()));
        let loops = match mechanism.assembly {
            None => None,
            Some(_) => {
                let joints = variable_bodies(&tree);
                let first = mechanism.base_variables();
                let free = |k: usize, random: &mut SplitMix64| {
                    position(joints[first + k], tree.constants, random)
                };
                let mut random = SplitMix64::new(!seed);
                Some(ExactLoops::of(
                    mechanism,
                    &tree,
                    &mut numbers,
                    &mut random,
                    free,
                )?)
            }
        };
        Ok(Self {
            modulus,
            tree,
            closure,
            loops,
            space: mechanism.parameters(),
            roots: numbers.angles.roots(),
            has_roots: numbers.lengths.roots.get(),
            generic,
            algebraic: numbers.angles.units.units().is_empty(),
            steps: numbers.angles.steps,
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

    /// The angles for which generic ones stand, as written.
    #[must_use]
    pub fn generic(&self) -> &[String] {
        &self.generic
    }

    /// Whether all angles are multiples of 2 pi/order, whose cosines are algebraic numbers.
    #[must_use]
    pub fn is_algebraic(&self) -> bool {
        self.algebraic
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

    /// Whether prime fields hold the robot's constraints: its loops, if it has some.
    ///
    /// # Errors
    /// [`NotClosed`] with the reason; the model is then that of the opened tree.
    pub fn holds_constraints(&self) -> Result<(), NotClosed> {
        match &self.loops {
            Some(Err(reason)) => Err(*reason),
            _ => Ok(()),
        }
    }

    /// Whether numbers of the description have square roots that are no fractions.
    #[must_use]
    pub fn has_roots(&self) -> bool {
        self.has_roots
    }

    /// An upper bound of the degree of a row's entries, denominators cleared, in the
    /// random values: a rotation enters at most three times, twice by `w x w` and once by
    /// transport, each with degree 2 in its half-angle tangent (2 N for the N-th power of a
    /// random one); velocities add 2. A joint that follows others at powers of their
    /// rotations counts as often as these say. A floating base counts six times: its
    /// attitude enters once, with gravity, with degree 2 in its quaternion.
    #[must_use]
    pub fn degree(&self) -> u64 {
        if let Some(Ok(loops)) = &self.loops {
            return loops.degree(self.steps);
        }
        let joints = self
            .closure
            .as_ref()
            .map_or(self.tree.dof as u64, ExactClosure::turns);
        6 * (joints + self.steps) + 2
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
        let rest = model == Model::D0;
        if self.tree.is_floating() {
            work.move_base(&self.tree, &self.base(rest, random));
        }
        let constants = self.tree.constants;
        let still = JointMotion::still(constants.zero, constants.one);
        if let Some(Ok(loops)) = &self.loops {
            let joints = variable_bodies(&self.tree);
            let joints = &joints[loops.first_joint()..];
            let free = |k: usize, random: &mut SplitMix64| position(joints[k], constants, random);
            let (motions, transmission) = loops.motions(rest, random, free);
            let motion = |body: &Body<Fp<'m>>| body.variable.map_or(still, |k| motions[k]);
            let transmission = Some(&transmission);
            work.fill(&self.tree, &self.space, model, motion, transmission, rows);
            return;
        }
        let Some(closure) = &self.closure else {
            let motion = |body: &Body<Fp<'m>>| self.free_motion(body, rest, random);
            work.fill(&self.tree, &self.space, model, motion, None, rows);
            return;
        };
        let joints = variable_bodies(&self.tree);
        let motions = closure.motions(constants, rest, random, |variable, qd, qdd, random| {
            self.motion(joints[variable], qd, qdd, random)
        });
        let motion = |body: &Body<Fp<'m>>| body.variable.map_or(still, |v| motions[v]);
        let transmission = Some(&closure.transmission);
        work.fill(&self.tree, &self.space, model, motion, transmission, rows);
    }

    /// Working memory for [`ExactModel::fill`].
    #[must_use]
    pub fn workspace(&self) -> ExactWorkspace<'m> {
        RowsWorkspace::new(&self.tree)
    }

    /// A random state of a floating base: the attitude of a random quaternion, of any
    /// length that has an inverse.
    fn base(&self, rest: bool, random: &mut SplitMix64) -> BaseState<Fp<'m>> {
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
        if rest {
            state.at_rest(constants.zero)
        } else {
            state
        }
    }

    /// A random motion of a joint by itself.
    fn free_motion(
        &self,
        body: &Body<Fp<'m>>,
        rest: bool,
        random: &mut SplitMix64,
    ) -> JointMotion<Fp<'m>> {
        let zero = self.tree.constants.zero;
        let motion = self.motion(body, zero, zero, random);
        let mut draw = || self.modulus.random(random);
        JointMotion {
            qd: if rest { zero } else { draw() },
            qdd: draw(),
            ..motion
        }
    }

    /// A random position with this velocity and acceleration.
    fn motion(
        &self,
        body: &Body<Fp<'m>>,
        qd: Fp<'m>,
        qdd: Fp<'m>,
        random: &mut SplitMix64,
    ) -> JointMotion<Fp<'m>> {
        JointMotion {
            qd,
            qdd,
            ..position(body, self.tree.constants, random)
        }
    }
}

/// A random position: a rational point of the circle for a revolute joint, in units of
/// its axis vector a: `t = tan(q/2)/|a|`.
pub(super) fn position<'m>(
    body: &Body<Fp<'m>>,
    Constants { zero, one, .. }: Constants<Fp<'m>>,
    random: &mut SplitMix64,
) -> JointMotion<Fp<'m>> {
    let mut draw = || one.modulus().random(random);
    let mut position = JointMotion::still(zero, one);
    match body.joint {
        JointKind::Revolute => loop {
            let t = draw();
            let t2 = t * t * body.axis_squared;
            let Some(inverse) = (one + t2).inverse() else {
                continue;
            };
            position.cos = (one - t2) * inverse;
            position.sin = (t + t) * inverse;
            position.versine = position.sin * t;
            break;
        },
        JointKind::Prismatic => position.q = draw(),
        JointKind::Fixed | JointKind::Floating => {}
    }
    position
}

/// The body of each variable.
pub(super) fn variable_bodies<T>(tree: &Tree<T>) -> Vec<&Body<T>> {
    let bodies = tree.bodies.iter();
    bodies
        .flat_map(|body| std::iter::repeat_n(body, body.joint.dof()))
        .collect()
}

/// Working memory of [`ExactModel::fill`].
pub type ExactWorkspace<'m> = RowsWorkspace<Fp<'m>>;

/// Literals as numbers of the field.
pub(super) struct FieldNumbers<'m, 'd> {
    turns: &'d [Turn<'m>],
    angles: Angles<'m, 'd>,
    lengths: Lengths<'m, 'd>,
    half: Fp<'m>,
    /// Lengths of axes whose root could be either.
    lengths_of_axes: Vec<String>,
}

impl<'m, 'd> FieldNumbers<'m, 'd> {
    /// The numbers of a mechanism's description; `pi` stands for pi.
    pub fn new(
        mechanism: &'d Mechanism,
        angles: Angles<'m, 'd>,
        pi: Fp<'m>,
        turns: &'d [Turn<'m>],
    ) -> Result<Self, NotInField> {
        let modulus = pi.modulus();
        Ok(Self {
            angles,
            lengths: Lengths {
                modulus,
                constants: &mechanism.description.constants,
                pi,
                roots: Cell::new(false),
            },
            half: modulus.integer(2).inverse().ok_or(NotInField::Inverse)?,
            lengths_of_axes: Vec::new(),
            turns,
        })
    }
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
        let mut rotation = self.angles.rotation(angle);
        for turn in self.turns {
            let times = times(&angle.expr, self.lengths.constants, &turn.name);
            let (cos, sin) = power(turn.rotation, times.unsigned_abs());
            rotation = compose(rotation, (cos, if times < 0 { -sin } else { sin }));
        }
        Ok(rotation)
    }

    fn value(&mut self, quantity: &Quantity) -> Result<Fp<'m>, NotInField> {
        self.lengths.value(quantity, &self.angles)
    }

    /// The positive root where the square is a fraction; elsewhere either.
    fn inverse_length(
        &mut self,
        axis: &[Quantity; 3],
        squared: Fp<'m>,
    ) -> Result<Fp<'m>, NotInField> {
        let one = self.lengths.modulus.integer(1);
        if squared == one {
            return Ok(one);
        }
        let component = |x: &Quantity| {
            let exact = LinearInPi::of(&x.expr, self.lengths.constants)?;
            exact.as_rational().map(|x| x * x)
        };
        let [x, y, z] = axis.each_ref().map(component);
        let root = match (x, y, z) {
            (Some(x), Some(y), Some(z)) => self.lengths.length(&(x + y + z), &self.angles)?,
            _ => {
                self.lengths_of_axes
                    .push("the length of an axis".to_owned());
                squared.sqrt().ok_or(NotInField::Root)?
            }
        };
        root.inverse().ok_or(NotInField::Inverse)
    }
}
