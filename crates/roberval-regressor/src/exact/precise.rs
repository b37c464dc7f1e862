//! The recursion in numbers of many digits: the robot as written, in pairs of doubles to
//! about 100 bits.

use std::marker::PhantomData;

use roberval_mechanism::{JointKind, Mechanism, Origin, ParameterSpace};
use roberval_scalar::{Quantity, Real};

use super::NotInField;
use super::geometry::{Numbers, Rotation, RowsWorkspace, pose, tree};
use crate::loops::{LoopExpansion, precise_linkage};
use crate::{BaseState, Body, Constants, Expansion, JointMotion, Model, NoValue, Tree};

/// A robot in pairs of doubles or wide numbers: gives regressor rows at states near those
/// asked for.
#[derive(Debug, Clone)]
pub struct PreciseModel<T> {
    tree: Tree<T>,
    expansion: Option<Expansion<T>>,
    space: ParameterSpace,
}

impl<T: Real> PreciseModel<T> {
    /// The mechanism's description to the precision of the numbers.
    ///
    /// # Errors
    /// [`NotInField::Inverse`] if an expression of the description divides by zero.
    pub fn new(mechanism: &Mechanism) -> Result<Self, NotInField> {
        let mut numbers = Written {
            constants: &mechanism.description.constants,
            numbers: PhantomData,
        };
        let mut tree = tree(mechanism, &mut numbers)?;
        let expansion = match &mechanism.assembly {
            None => Expansion::of(mechanism).map_err(|_| NotInField::Inverse)?,
            Some(assembly) => {
                tree.bodies.iter_mut().for_each(normalise);
                let place = |origin: &Origin| pose(origin, &mut numbers);
                let linkage = precise_linkage(mechanism, assembly, &tree, place)?;
                let loops =
                    LoopExpansion::new(assembly.clone(), linkage, mechanism.base_variables());
                Some(Expansion::of_loops(loops))
            }
        };
        Ok(Self {
            tree,
            expansion,
            space: mechanism.parameters(),
        })
    }

    /// The robot's constants.
    #[must_use]
    pub fn tree(&self) -> &Tree<T> {
        &self.tree
    }

    /// Working memory for [`PreciseModel::fill`].
    #[must_use]
    pub fn workspace(&self) -> RowsWorkspace<T> {
        let mut work = RowsWorkspace::new(&self.tree);
        work.joints = self.expansion.as_ref().map(Expansion::states);
        work
    }

    /// Fills `rows` (rows of a sample x C, row-major) at the state `q`, `qd`, `qdd` of the
    /// independent joints (as [`crate::States`] has them). Without constraints a revolute
    /// joint stands at the point of the circle whose half-angle tangent is the double next to
    /// that of q: exactly on the circle, nearly at q; a floating base has the attitude of its
    /// quaternion, whatever its length. Rows of h are not yet differences.
    ///
    /// # Errors
    /// [`NoValue`] if the constraints have no value at this state.
    ///
    /// # Panics
    /// If a slice does not have its size.
    pub fn fill(
        &self,
        model: Model,
        [q, qd, qdd]: [&[f64]; 3],
        work: &mut RowsWorkspace<T>,
        rows: &mut [T],
    ) -> Result<(), NoValue> {
        let rest = model == Model::D0;
        if self.tree.is_floating() {
            let constants = self.tree.constants;
            let mut base = BaseState::read([q, qd, qdd], constants, |x| constants.one / x);
            if rest {
                base = base.at_rest(constants.zero);
            }
            work.move_base(&self.tree, &base);
        }
        let q = self.tree.variables(q);
        if let Some(expansion) = &self.expansion {
            let exact = |x: &[f64]| x.iter().map(|&x| T::from(x)).collect::<Vec<T>>();
            let velocities = if rest {
                vec![0.0; qd.len()]
            } else {
                qd.to_vec()
            };
            let state = [exact(q), exact(&velocities), exact(qdd)];
            let last = work.joints.take();
            let mut all = last.unwrap_or_else(|| expansion.states());
            expansion.expand(state.each_ref().map(|x| &x[..]), &mut all)?;
            let motion = |body: &Body<T>| match body.variable {
                None => still(),
                Some(k) => precise_motion(body, [all.q[k], all.qd[k], all.qdd[k]]),
            };
            let transmission = Some(&all.transmission);
            work.fill(&self.tree, &self.space, model, motion, transmission, rows);
            work.joints = Some(all);
            return Ok(());
        }
        let motion = |body: &Body<T>| match body.variable {
            None => still(),
            Some(k) => motion(body, q[k], if rest { 0.0 } else { qd[k] }, qdd[k]),
        };
        work.fill(&self.tree, &self.space, model, motion, None, rows);
        Ok(())
    }
}

/// The joints of loops move in units of their axes, whose lengths must then be 1.
fn normalise<T: Real>(body: &mut Body<T>) {
    let length = body.axis_squared.sqrt();
    if length.to_f64() > 0.0 {
        body.axis = body.axis.map(|x| x / length);
        body.axis_squared = T::from(1.0);
    }
}

fn still<T: Real>() -> JointMotion<T> {
    JointMotion::still(T::from(0.0), T::from(1.0))
}

/// A motion in units of the axis vector a, as it is written: `t = tan(q/2)/|a|`.
fn motion<T: Real>(body: &Body<T>, q: f64, qd: f64, qdd: f64) -> JointMotion<T> {
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
    let one = T::from(1.0);
    let t = T::from((0.5 * q).tan() / length);
    let t2 = t * t * body.axis_squared;
    motion.cos = (one - t2) / (one + t2);
    motion.sin = (t + t) / (one + t2);
    motion.versine = motion.sin * t;
    motion
}

/// The same from positions in pairs of doubles.
fn precise_motion<T: Real>(body: &Body<T>, [q, qd, qdd]: [T; 3]) -> JointMotion<T> {
    let length = body.axis_squared.sqrt();
    let mut motion = JointMotion {
        qd: qd / length,
        qdd: qdd / length,
        ..still()
    };
    if body.joint == JointKind::Prismatic {
        motion.q = q / length;
        return motion;
    }
    let (cos, sin) = Real::cos_sin(q);
    motion.cos = cos;
    motion.sin = sin / length;
    motion.versine = (T::from(1.0) - cos) / body.axis_squared;
    motion
}

/// Literals as numbers of this precision.
struct Written<'d, T> {
    constants: &'d [(String, Quantity)],
    numbers: PhantomData<T>,
}

impl<T: Real> Numbers for Written<'_, T> {
    type Number = T;
    type Error = NotInField;

    fn constants(&self) -> Constants<T> {
        Constants {
            zero: T::from(0.0),
            one: T::from(1.0),
            half: T::from(0.5),
        }
    }

    fn rotation(&mut self, angle: &Quantity) -> Result<Rotation<T>, NotInField> {
        T::cos_sin_of_quantity(angle, self.constants).ok_or(NotInField::Inverse)
    }

    fn value(&mut self, quantity: &Quantity) -> Result<T, NotInField> {
        T::of_quantity(quantity, self.constants).ok_or(NotInField::Inverse)
    }

    fn inverse_length(&mut self, _: &[Quantity; 3], squared: T) -> Result<T, NotInField> {
        Ok(T::from(1.0) / squared.sqrt())
    }
}
