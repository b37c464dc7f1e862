//! The recursion: bodies set in motion from the base outward, and what their inertia forces do
//! on the joints of their paths.

use roberval_mechanism::JointKind;
use roberval_scalar::{Lift, Scalar};

use crate::forces::Forces;
use crate::frame::{Frame, General, Near, Right, with_frame};
use crate::vector::{Vec3, lift3, negative};
use crate::workspace::{Ancestor, Link, Own};
use crate::{Constants, DynamicsWorkspace, JointMotion, Nonzero, Sink, Tree};

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
}

/// The rows of the dynamic model d at one state (Gautier 1991, eq. (5)), or of d0 if
/// all velocities are zero (eq. (8)): `sink` receives, link by link, the ten inertial
/// columns' entries on every row of the path from the base, then the rotor's.
///
/// `motion` has one entry a body ([`JointMotion::still`] for a fixed joint); the base of a
/// floating robot is where [`DynamicsWorkspace::move_base`] put it last. Its rows are the
/// wrench on it, force before moment, in its own frame.
#[inline(always)]
pub fn dynamics<C: Copy, T: Lift<C>>(
    tree: &Tree<C>,
    motion: &[JointMotion<T>],
    workspace: &mut DynamicsWorkspace<T>,
    sink: &mut impl Sink<T>,
) {
    let zero = T::lift(tree.constants.zero);
    let links = &mut workspace.links[..];
    for (j, motion) in motion.iter().enumerate() {
        let (before, from_here) = links.split_at_mut(j);
        let [link, ..] = from_here else { return };
        let state = match link.placing.joint {
            JointKind::Floating => link.state,
            joint => {
                let antecedent = link.antecedent.map(|a| &before[a]);
                let (body, placing) = (&tree.bodies[j], &link.placing);
                let to = link.path.split_at_mut(link.far);
                with_frame!(body, placing, motion, step, tree, joint, antecedent, to)
            }
        };
        match link.own {
            Own::Alone { opposite } => {
                let forces = Forces::spinning(zero, &state);
                link.keep(&state);
                alone(zero, (j, link, opposite), &forces, motion.qdd, sink);
            }
            _ => {
                let forces = Forces::of(&state);
                link.keep(&state);
                match link.placing.order {
                    _ if link.massless => {}
                    0 => on_path::<0, T>(zero, (j, link), motion.qdd, &forces, sink),
                    1 => on_path::<1, T>(zero, (j, link), motion.qdd, &forces, sink),
                    _ => on_path::<2, T>(zero, (j, link), motion.qdd, &forces, sink),
                }
            }
        }
    }
}

/// The columns of a body that turns about its last axis and about nothing else.
#[inline(always)]
fn alone<T: Scalar>(
    zero: T,
    (j, link, opposite): (usize, &Link<T>, bool),
    forces: &Forces<T>,
    qdd: T,
    sink: &mut impl Sink<T>,
) {
    if let ([own, ..], false) = (&link.path[..], link.massless) {
        let columns = forces.on_last_axis(opposite, zero);
        let (row, of) = (own.row, Nonzero::turning_alone);
        match link.placing.order {
            0 => sink.link(j, row, columns.in_order::<0>(), of(0)),
            1 => sink.link(j, row, columns.in_order::<1>(), of(1)),
            _ => sink.link(j, row, columns.in_order::<2>(), of(2)),
        }
        rotor((j, link), own.row, qdd, sink);
    }
}

/// What the forces of a body do on the joints of its path, its axes in this order.
#[inline(always)]
fn on_path<const ORDER: usize, T: Scalar>(
    zero: T,
    (j, link): (usize, &Link<T>),
    qdd: T,
    forces: &Forces<T>,
    sink: &mut impl Sink<T>,
) {
    let (far, others) = link.path.split_at(link.far);
    for ancestor in far {
        on_ancestor::<ORDER, T>(zero, j, ancestor, forces, sink);
    }
    let mut others = others.iter();
    let near = match link.placing.near {
        Near::Any => None,
        near => others.next().map(|ancestor| (near, ancestor)),
    };
    if let Some((near, Ancestor { row, screw, .. })) = near {
        let columns = match near {
            Near::Parallel { opposite } => forces.on_parallel(opposite, zero, screw),
            _ => forces.on_crossed(screw),
        };
        sink.link(j, *row, columns.in_order::<ORDER>(), Nonzero::ALL);
    }
    let Some(own) = others.next() else { return };
    match link.own {
        Own::Last { opposite } => {
            let columns = forces.on_last_axis(opposite, zero).in_order::<ORDER>();
            sink.link(j, own.row, columns, Nonzero::turning(ORDER));
        }
        // One that is alone does not come here.
        Own::Any | Own::Alone { .. } => on_ancestor::<ORDER, T>(zero, j, own, forces, sink),
    }
    rotor((j, link), own.row, qdd, sink);
}

/// The same on a joint that lies in any way.
#[inline(always)]
fn on_ancestor<const ORDER: usize, T: Scalar>(
    zero: T,
    j: usize,
    ancestor: &Ancestor<T>,
    forces: &Forces<T>,
    sink: &mut impl Sink<T>,
) {
    let Ancestor { row, slides, screw } = ancestor;
    if *slides {
        let columns = forces.on_translation(zero, screw.v).in_order::<ORDER>();
        sink.link(j, *row, columns, Nonzero::SLIDING);
    } else {
        let columns = forces.on_screw(screw).in_order::<ORDER>();
        sink.link(j, *row, columns, Nonzero::ALL);
    }
}

/// The Ia column, if there is one.
#[inline(always)]
fn rotor<T: Scalar>((j, link): (usize, &Link<T>), row: usize, qdd: T, sink: &mut impl Sink<T>) {
    if let Some(squared) = link.rotor {
        sink.rotor(j, row, squared * qdd);
    }
}

/// Of the joints of a body's path those that lie in any way, and all others.
type Path<'a, T> = (&'a mut [Ancestor<T>], &'a mut [Ancestor<T>]);

/// One body: its motion and its path's screws, from the antecedent's.
#[inline(always)]
fn step<C: Copy, T: Lift<C>>(
    frame: &impl Frame<T>,
    tree: &Tree<C>,
    joint: JointKind,
    antecedent: Option<&Link<T>>,
    (far, near): Path<'_, T>,
) -> BodyState<T> {
    let parent = antecedent.map(|a| &a.state);
    let state = forward(frame, tree, joint, parent);
    let Some(antecedent) = antecedent else {
        return state;
    };
    for (own, from) in far.iter_mut().zip(&antecedent.path) {
        let v = frame.take(&from.screw.v);
        if from.slides {
            own.screw.v = frame.turn(v);
            continue;
        }
        let e = frame.take(&from.screw.e);
        own.screw.e = frame.turn(e);
        own.screw.v = frame.turn(frame.carry(v, e));
    }
    if let (true, [near, ..]) = (frame.is_near(), near) {
        let Constants { zero, one, .. } = tree.constants;
        (near.screw.e, near.screw.v) = frame.near(T::lift(zero), T::lift(one));
    }
    state
}

/// Velocities and accelerations from the antecedent's (Newton-Euler, outward).
#[inline(always)]
pub(crate) fn forward<C: Copy, T: Lift<C>>(
    frame: &impl Frame<T>,
    tree: &Tree<C>,
    joint: JointKind,
    parent: Option<&BodyState<T>>,
) -> BodyState<T> {
    let zero = [T::lift(tree.constants.zero); 3];
    let (mut w, mut dw, mut a) = match parent {
        Some(parent) => {
            let [w, dw, a] = [&parent.w, &parent.dw, &parent.a].map(|v| frame.take(v));
            let a = frame.at_origin(a, w, dw);
            (frame.turn(w), frame.turn(dw), frame.turn(a))
        }
        None => {
            let up = negative(lift3(&tree.gravity));
            (zero, zero, frame.turn(frame.take(&up)))
        }
    };
    let (qd, qdd) = frame.rates();
    match joint {
        JointKind::Revolute => {
            dw = frame.along_axis(frame.across_axis(dw, w, qd), qdd);
            w = frame.along_axis(w, qd);
        }
        JointKind::Prismatic => {
            a = frame.along_axis(frame.across_axis(a, w, qd + qd), qdd);
        }
        JointKind::Fixed | JointKind::Floating => {}
    }
    BodyState { w, dw, a }
}
