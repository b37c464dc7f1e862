//! What the recursion keeps of each body: made once for a tree, moved state after state.

use roberval_mechanism::JointKind;
use roberval_scalar::{Lift, Scalar};

use crate::dynamics::BodyState;
use crate::frame::{Near, Placing};
use crate::layout::{Layout, ordered};
use crate::vector::{Vec3, lift3};
use crate::{BaseState, Body, Tree};

/// Working memory of [`crate::dynamics()`], made once for a tree.
#[derive(Debug, Clone)]
pub struct DynamicsWorkspace<T> {
    pub(crate) links: Vec<Link<T>>,
}

/// A body in motion.
#[derive(Debug, Clone)]
pub(crate) struct Link<T> {
    pub placing: Placing<T>,
    pub antecedent: Option<usize>,
    /// How it moves, if another body hangs on it.
    pub state: BodyState<T>,
    /// The joints of its path from the base, its own last.
    pub path: Vec<Ancestor<T>>,
    /// How many of them are inherited and lie in any way.
    pub far: usize,
    pub own: Own,
    /// The squared length of its joint's axis, if there is an Ia column.
    pub rotor: Option<T>,
    /// Whether there are no columns at all.
    pub massless: bool,
    /// Whether another body hangs on it.
    carries: bool,
}

/// A moving joint on a body's path to the base, and its unit velocity.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ancestor<T> {
    /// Joint variable: the row of the regressor.
    pub row: usize,
    /// Whether it is prismatic, its screw then without e.
    pub slides: bool,
    pub screw: Screw<T>,
}

/// A unit velocity of one joint, as a body on its way to the tip feels it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Screw<T> {
    /// Angular velocity, in the body's frame.
    pub e: Vec3<T>,
    /// Velocity of the body's origin, in the body's frame.
    pub v: Vec3<T>,
}

/// How a body's own joint lies in its frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Own {
    /// Along its screw, which may slide.
    Any,
    /// About the last axis or against it.
    Last { opposite: bool },
    /// The same, and there is no other velocity: what the body hangs on rests.
    Alone { opposite: bool },
}

impl Own {
    /// `first`: no joint of its path comes before its own.
    fn of<C>(body: &Body<C>, first: bool) -> Self {
        let (JointKind::Revolute, Layout::Aligned(aligned)) = (body.joint, body.layout) else {
            return Self::Any;
        };
        let opposite = aligned.reversed;
        match first {
            true => Self::Alone { opposite },
            false => Self::Last { opposite },
        }
    }
}

impl<T: Scalar> DynamicsWorkspace<T> {
    /// Working memory for this tree.
    #[must_use]
    pub fn new<C: Copy>(tree: &Tree<C>) -> Self
    where
        T: Lift<C>,
    {
        let mut links: Vec<Link<T>> = Vec::with_capacity(tree.bodies.len());
        for (body, placing) in tree.bodies.iter().zip(Placing::of(tree)) {
            let antecedent = body.antecedent.map(|a| &links[a]);
            let link = Link::new(tree, body, placing, antecedent);
            if let Some(a) = body.antecedent {
                links[a].carries = true;
            }
            links.push(link);
        }
        Self { links }
    }

    /// Where the base of a floating robot is and how it moves from now on.
    #[inline(always)]
    pub fn move_base<C: Scalar>(&mut self, tree: &Tree<C>, base: &BaseState<T>)
    where
        T: Lift<C>,
    {
        self.links[0].state = BodyState {
            w: base.w,
            dw: base.dw,
            a: base.acceleration(tree),
        };
    }
}

impl<T: Scalar> Link<T> {
    fn new<C: Copy>(
        tree: &Tree<C>,
        body: &Body<C>,
        placing: Placing<T>,
        antecedent: Option<&Self>,
    ) -> Self
    where
        T: Lift<C>,
    {
        let zero = [T::lift(tree.constants.zero); 3];
        let mut path = antecedent.map_or_else(Vec::new, |a| a.path.clone());
        let own = Own::of(body, path.is_empty());
        let mut far = path.len() - usize::from(placing.near != Near::Any);
        if body.joint == JointKind::Floating {
            unit_screws(zero, T::lift(tree.constants.one), &mut path);
            far = path.len();
        } else if let Some(row) = body.variable {
            let slides = body.joint == JointKind::Prismatic;
            let axis = ordered(&lift3(&body.axis), placing.order);
            path.push(Ancestor::new(row, slides, zero, axis));
        }
        Self {
            antecedent: body.antecedent,
            state: BodyState {
                w: zero,
                dw: zero,
                a: zero,
            },
            path,
            far,
            own,
            rotor: body.rotor.then(|| T::lift(body.axis_squared)),
            massless: body.massless,
            carries: false,
            placing,
        }
    }

    /// Keeps for the bodies that hang on it how it moves.
    #[inline(always)]
    pub(crate) fn keep(&mut self, state: &BodyState<T>) {
        if self.carries {
            self.state = *state;
        }
    }
}

impl<T: Scalar> Ancestor<T> {
    /// The unit velocity along or about an axis through the body's origin.
    fn new(row: usize, slides: bool, zero: Vec3<T>, axis: Vec3<T>) -> Self {
        let (e, v) = if slides { (zero, axis) } else { (axis, zero) };
        let screw = Screw { e, v };
        Self { row, slides, screw }
    }
}

/// The six unit velocities of a base that floats, along and about its axes.
fn unit_screws<T: Scalar>(zero: Vec3<T>, one: T, path: &mut Vec<Ancestor<T>>) {
    for row in 0..6 {
        let mut unit = zero;
        unit[row % 3] = one;
        path.push(Ancestor::new(row, row < 3, zero, unit));
    }
}
