use roberval_mechanism::JointKind;
use roberval_scalar::{Lift, Scalar};

use crate::forces::Forces;
use crate::frame::{Frame, General, Near, Placing, Right, with_frame};
use crate::layout::ordered;
use crate::vector::{Mat3, Vec3, lift3, negative};
use crate::{BaseState, Body, Constants, JointMotion, Sink, Tree};

/// How a body moves, in its own frame. The recursion takes its axes in turn, so that the
/// joint's comes last.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BodyState<T> {
    /// Angular velocity.
    pub w: Vec3<T>,
    /// Angular acceleration.
    pub dw: Vec3<T>,
    /// Acceleration of the frame's origin; gravity enters as that of the base, -g.
    pub a: Vec3<T>,
    /// U = `[dw]x + [w]x [w]x`: a point fixed at p in the frame accelerates by a + U p.
    pub u: Mat3<T>,
}

/// A unit velocity of one joint, as a body on its way to the tip feels it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Screw<T> {
    /// Angular velocity, in the body's frame.
    pub e: Vec3<T>,
    /// Velocity of the body's origin, in the body's frame.
    pub v: Vec3<T>,
}

/// A moving joint on a body's path to the base.
#[derive(Debug, Clone, Copy)]
struct Ancestor {
    /// Joint variable: the row of the regressor.
    row: usize,
    /// Whether it is prismatic, its screw then without e.
    slides: bool,
}

/// A body in motion.
#[derive(Debug, Clone)]
struct Link<T> {
    placing: Placing<T>,
    state: BodyState<T>,
    /// The joints of its path from the base, its own last.
    path: Vec<Ancestor>,
    /// Their screws.
    screws: Vec<Screw<T>>,
    /// How many of them are inherited and lie in any way.
    far: usize,
    /// The row of its own joint, if it has an axis.
    row: Option<usize>,
}

/// Working memory of [`dynamics`], made once for a tree.
#[derive(Debug, Clone)]
pub struct DynamicsWorkspace<T> {
    links: Vec<Link<T>>,
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
            links.push(Link::new(tree, body, placing, antecedent));
        }
        Self { links }
    }

    /// Where the base of a floating robot is and how it moves from now on.
    #[inline(always)]
    pub fn move_base<C: Scalar>(&mut self, tree: &Tree<C>, base: &BaseState<T>)
    where
        T: Lift<C>,
    {
        let state = &mut self.links[0].state;
        (state.w, state.dw, state.a) = (base.w, base.dw, base.acceleration(tree));
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
        let mut screws = vec![Screw { e: zero, v: zero }; path.len()];
        let mut far = path.len() - usize::from(placing.near != Near::Any);
        if body.joint == JointKind::Floating {
            unit_screws(zero, T::lift(tree.constants.one), &mut path, &mut screws);
            far = path.len();
        } else if let Some(row) = body.variable {
            let slides = body.joint == JointKind::Prismatic;
            let axis = ordered(&lift3(&body.axis), placing.order);
            let (e, v) = if slides { (zero, axis) } else { (axis, zero) };
            path.push(Ancestor { row, slides });
            screws.push(Screw { e, v });
        }
        Self {
            state: BodyState {
                w: zero,
                dw: zero,
                a: zero,
                u: [zero; 3],
            },
            far,
            row: body.variable.filter(|_| body.joint.has_axis()),
            placing,
            path,
            screws,
        }
    }
}

/// The six unit velocities of a base that floats, along and about its axes.
fn unit_screws<T: Scalar>(
    zero: Vec3<T>,
    one: T,
    path: &mut Vec<Ancestor>,
    screws: &mut Vec<Screw<T>>,
) {
    for row in 0..6 {
        let mut unit = zero;
        unit[row % 3] = one;
        let slides = row < 3;
        let (e, v) = if slides { (zero, unit) } else { (unit, zero) };
        path.push(Ancestor { row, slides });
        screws.push(Screw { e, v });
    }
}

/// The rows of the dynamic model d at one state (Gautier 1991, eq. (5)), or of d0 if
/// all velocities are zero (eq. (8)): `sink` receives, link by link, the ten inertial
/// columns' entries on every row of the path from the base, then the rotor's.
///
/// `motion` has one entry a body (that of a fixed joint is not looked at); the base of a
/// floating robot is where [`DynamicsWorkspace::move_base`] put it last. Its rows are the
/// wrench on it, force before moment, in its own frame.
#[inline(always)]
pub fn dynamics<C: Copy, T: Lift<C>>(
    tree: &Tree<C>,
    motion: &[JointMotion<T>],
    workspace: &mut DynamicsWorkspace<T>,
    sink: &mut impl Sink<T>,
) {
    let links = &mut workspace.links[..];
    for (j, (body, motion)) in tree.bodies.iter().zip(motion).enumerate() {
        let (before, from_here) = links.split_at_mut(j);
        let [link, ..] = from_here else { return };
        if body.joint != JointKind::Floating {
            let antecedent = body.antecedent.map(|a| &before[a]);
            let Link {
                placing,
                state,
                path,
                screws,
                far,
                ..
            } = link;
            let (far, near) = screws.split_at_mut(*far);
            let to = (state, &path[..], far, near);
            with_frame!(
                body, placing, motion, step, tree, body, motion, antecedent, to
            );
        }
        let forces = Forces::of(&link.state);
        link.state.u = forces.u;
        if body.massless {
            continue;
        }
        let body = (j, body, motion.qdd);
        match link.placing.order {
            0 => columns::<0, C, T>(tree, body, link, &forces, sink),
            1 => columns::<1, C, T>(tree, body, link, &forces, sink),
            _ => columns::<2, C, T>(tree, body, link, &forces, sink),
        }
    }
}

/// The columns of one body, its axes in this order.
#[inline(always)]
fn columns<const ORDER: usize, C: Copy, T: Lift<C>>(
    tree: &Tree<C>,
    (j, body, qdd): (usize, &Body<C>, T),
    link: &Link<T>,
    forces: &Forces<T>,
    sink: &mut impl Sink<T>,
) {
    let zero = T::lift(tree.constants.zero);
    let mut joints = link.path.iter().zip(&link.screws);
    for (ancestor, screw) in joints.by_ref().take(link.far) {
        let columns = match ancestor.slides {
            false => forces.on_screw(screw),
            true => forces.on_translation(zero, screw.v),
        };
        sink.link(j, ancestor.row, columns.in_order::<ORDER>());
    }
    if let Some((ancestor, screw)) = joints.next() {
        let row = ancestor.row;
        match link.placing.near {
            Near::Any => {}
            Near::Crossed => {
                let columns = forces.on_crossed(screw);
                sink.link(j, row, columns.in_order::<ORDER>());
            }
            Near::Parallel { opposite } => {
                let columns = forces.on_parallel(opposite, zero, screw);
                sink.link(j, row, columns.in_order::<ORDER>());
            }
        }
    }
    let Some(row) = link.row else { return };
    let columns = forces.on_own_joint(body, zero);
    sink.link(j, row, columns.in_order::<ORDER>());
    if body.rotor {
        sink.rotor(j, row, T::lift(body.axis_squared) * qdd);
    }
}

/// What moves with a link: its state, the joints of its path, and of their screws those that
/// lie in any way and all others.
type Moving<'a, T> = (
    &'a mut BodyState<T>,
    &'a [Ancestor],
    &'a mut [Screw<T>],
    &'a mut [Screw<T>],
);

/// One body: its motion and its path's screws, from the antecedent's.
#[inline(always)]
fn step<C: Copy, T: Lift<C>>(
    frame: &impl Frame<T>,
    tree: &Tree<C>,
    body: &Body<C>,
    motion: &JointMotion<T>,
    antecedent: Option<&Link<T>>,
    (state, path, far, near): Moving<'_, T>,
) {
    forward(
        frame,
        tree,
        body,
        motion,
        antecedent.map(|a| &a.state),
        state,
    );
    let Some(antecedent) = antecedent else { return };
    for ((own, from), ancestor) in far.iter_mut().zip(&antecedent.screws).zip(path) {
        let v = frame.take(&from.v);
        if ancestor.slides {
            own.v = frame.turn(v);
            continue;
        }
        let e = frame.take(&from.e);
        own.e = frame.turn(e);
        own.v = frame.turn(frame.carry(v, e));
    }
    if let (true, [screw, ..]) = (frame.is_near(), near) {
        let Constants { zero, one, .. } = tree.constants;
        (screw.e, screw.v) = frame.near(T::lift(zero), T::lift(one));
    }
}

/// Velocities and accelerations from the antecedent's (Newton-Euler, outward).
#[inline(always)]
fn forward<C: Copy, T: Lift<C>>(
    frame: &impl Frame<T>,
    tree: &Tree<C>,
    body: &Body<C>,
    motion: &JointMotion<T>,
    parent: Option<&BodyState<T>>,
    state: &mut BodyState<T>,
) {
    let zero = [T::lift(tree.constants.zero); 3];
    let (mut w, mut dw, mut a) = match parent {
        Some(parent) => (
            frame.turn(frame.take(&parent.w)),
            frame.turn(frame.take(&parent.dw)),
            frame.turn(frame.at_origin(frame.take(&parent.a), &parent.u)),
        ),
        None => {
            let up = negative(lift3(&tree.gravity));
            (zero, zero, frame.turn(frame.take(&up)))
        }
    };
    let (qd, qdd) = (motion.qd, motion.qdd);
    match body.joint {
        JointKind::Revolute => {
            dw = frame.along_axis(frame.across_axis(dw, w, qd), qdd);
            w = frame.along_axis(w, qd);
        }
        JointKind::Prismatic => {
            a = frame.along_axis(frame.across_axis(a, w, qd + qd), qdd);
        }
        JointKind::Fixed | JointKind::Floating => {}
    }
    (state.w, state.dw, state.a) = (w, dw, a);
}

/// U = `[dw]x + [w]x [w]x`.
#[inline(always)]
pub(crate) fn acceleration_field<T: Scalar>(w: Vec3<T>, dw: Vec3<T>) -> Mat3<T> {
    let (xx, yy, zz) = (w[0] * w[0], w[1] * w[1], w[2] * w[2]);
    let (xy, xz, yz) = (w[0] * w[1], w[0] * w[2], w[1] * w[2]);
    [
        [-(yy + zz), xy - dw[2], xz + dw[1]],
        [xy + dw[2], -(xx + zz), yz - dw[0]],
        [xz - dw[1], yz + dw[0], -(xx + yy)],
    ]
}
