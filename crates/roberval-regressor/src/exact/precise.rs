//! The recursion in pairs of doubles: the robot as written, to about 100 bits.

use roberval_mechanism::{JointKind, Mechanism, ParameterSpace};
use roberval_scalar::{DoubleDouble, Quantity};

use super::NotInField;
use super::geometry::{Numbers, Rotation, RowsWorkspace, tree};
use crate::{BaseState, Body, Constants, JointMotion, Model, Tree};

/// A robot in double-double arithmetic: gives regressor rows at states near those asked
/// for.
#[derive(Debug, Clone)]
pub struct PreciseModel {
    tree: Tree<DoubleDouble>,
    space: ParameterSpace,
}

impl PreciseModel {
    /// The mechanism's description to the precision of the numbers.
    ///
    /// # Errors
    /// [`NotInField::Inverse`] if an expression of the description divides by zero.
    pub fn new(mechanism: &Mechanism) -> Result<Self, NotInField> {
        let mut numbers = Pairs {
            constants: &mechanism.description.constants,
        };
        Ok(Self {
            tree: tree(mechanism, &mut numbers)?,
            space: mechanism.parameters(),
        })
    }

    /// The robot's constants.
    #[must_use]
    pub fn tree(&self) -> &Tree<DoubleDouble> {
        &self.tree
    }

    /// Working memory for [`PreciseModel::fill`].
    #[must_use]
    pub fn workspace(&self) -> RowsWorkspace<DoubleDouble> {
        RowsWorkspace::new(&self.tree)
    }

    /// Fills `rows` (rows of a sample x C, row-major) at the state `q`, `qd`, `qdd` (as
    /// [`crate::States`] has them). A revolute joint stands at the point of the circle whose half-angle
    /// tangent is the double next to that of q: exactly on the circle, nearly at q; a
    /// floating base has exactly the attitude of its quaternion, whatever its length. Rows
    /// of h are not yet differences.
    ///
    /// # Panics
    /// If a slice does not have its size.
    pub fn fill(
        &self,
        model: Model,
        [q, qd, qdd]: [&[f64]; 3],
        work: &mut RowsWorkspace<DoubleDouble>,
        rows: &mut [DoubleDouble],
    ) {
        let rest = model == Model::D0;
        let offset = self.tree.position_offset();
        if self.tree.is_floating() {
            let constants = self.tree.constants;
            let mut base = BaseState::read([q, qd, qdd], constants, |x| DoubleDouble::ONE / x);
            if rest {
                base = base.at_rest(constants.zero);
            }
            work.move_base(&self.tree, &base);
        }
        let motion = |body: &Body<DoubleDouble>| match body.variable {
            None => still(),
            Some(k) => motion(body, q[k + offset], if rest { 0.0 } else { qd[k] }, qdd[k]),
        };
        work.fill(&self.tree, &self.space, model, motion, rows);
    }
}

fn still() -> JointMotion<DoubleDouble> {
    let (zero, one) = (DoubleDouble::ZERO, DoubleDouble::ONE);
    JointMotion {
        cos: one,
        sin: zero,
        versine: zero,
        q: zero,
        qd: zero,
        qdd: zero,
    }
}

/// A motion in units of the axis vector a, as it is written: `t = tan(q/2)/|a|`.
fn motion(body: &Body<DoubleDouble>, q: f64, qd: f64, qdd: f64) -> JointMotion<DoubleDouble> {
    let length = body.axis_squared.to_f64().sqrt();
    let mut motion = JointMotion {
        qd: (qd / length).into(),
        qdd: (qdd / length).into(),
        ..still()
    };
    if body.joint == JointKind::Prismatic {
        motion.q = (q / length).into();
        return motion;
    }
    let one = DoubleDouble::ONE;
    let t = DoubleDouble::from((0.5 * q).tan() / length);
    let t2 = t * t * body.axis_squared;
    motion.cos = (one - t2) / (one + t2);
    motion.sin = (t + t) / (one + t2);
    motion.versine = motion.sin * t;
    motion
}

/// Literals as pairs of doubles.
struct Pairs<'d> {
    constants: &'d [(String, Quantity)],
}

impl Numbers for Pairs<'_> {
    type Number = DoubleDouble;
    type Error = NotInField;

    fn constants(&self) -> Constants<DoubleDouble> {
        Constants {
            zero: DoubleDouble::ZERO,
            one: DoubleDouble::ONE,
            half: 0.5.into(),
        }
    }

    fn rotation(&mut self, angle: &Quantity) -> Result<Rotation<DoubleDouble>, NotInField> {
        DoubleDouble::cos_sin_of_expr(&angle.expr, self.constants).ok_or(NotInField::Inverse)
    }

    fn value(&mut self, quantity: &Quantity) -> Result<DoubleDouble, NotInField> {
        DoubleDouble::of_expr(&quantity.expr, self.constants).ok_or(NotInField::Inverse)
    }
}
