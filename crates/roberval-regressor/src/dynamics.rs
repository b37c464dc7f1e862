use roberval_mechanism::JointKind;
use roberval_scalar::{Lift, Scalar};

use crate::forces::Forces;
use crate::frame::{Frame, General, Near, Placing, Right, with_frame};
use crate::layout::{Layout, ordered};
use crate::vector::{Mat3, Vec3, lift3, negative};
use crate::{BaseState, Body, Constants, JointMotion, Nonzero, Sink, Tree};

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

/// A moving joint on a body's path to the base, and its unit velocity.
#[derive(Debug, Clone, Copy)]
struct Ancestor<T> {
    /// Joint variable: the row of the regressor.
    row: usize,
    /// Whether it is prismatic, its screw then without e.
    slides: bool,
    screw: Screw<T>,
}

/// A body in motion.
#[derive(Debug, Clone)]
struct Link<T> {
    placing: Placing<T>,
    antecedent: Option<usize>,
    state: BodyState<T>,
    /// The joints of its path from the base, its own last.
    path: Vec<Ancestor<T>>,
    /// How many of them are inherited and lie in any way.
    far: usize,
    own: Own,
    /// The squared length of its joint's axis, if there is an Ia column.
    rotor: Option<T>,
    /// Whether there are no columns at all.
    massless: bool,
    /// Whether another body hangs on it.
    carries: bool,
}

/// How a body's own joint lies in its frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Own {
    /// Along its screw, which may slide.
    Any,
    /// About the last axis or against it.
    Last { opposite: bool },
    /// The same, and there is no other velocity: the body hangs on the resting base.
    Alone { opposite: bool },
}

impl Own {
    fn of<C>(body: &Body<C>) -> Self {
        match (body.joint, body.layout) {
            (JointKind::Revolute, Layout::Aligned(aligned)) => {
                let opposite = aligned.reversed;
                match body.antecedent {
                    None => Self::Alone { opposite },
                    Some(_) => Self::Last { opposite },
                }
            }
            _ => Self::Any,
        }
    }
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
                u: [zero; 3],
            },
            path,
            far,
            own: Own::of(body),
            rotor: body.rotor.then(|| T::lift(body.axis_squared)),
            massless: body.massless,
            carries: false,
            placing,
        }
    }
}

impl<T: Scalar> Link<T> {
    /// Keeps for the bodies that hang on it how it moves.
    #[inline(always)]
    fn keep(&mut self, state: &BodyState<T>, forces: &Forces<T>) {
        if self.carries {
            let &BodyState { w, dw, a, .. } = state;
            self.state = BodyState {
                w,
                dw,
                a,
                u: forces.u,
            };
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
    let zero = T::lift(tree.constants.zero);
    let links = &mut workspace.links[..];
    for (j, motion) in motion.iter().enumerate() {
        let (before, from_here) = links.split_at_mut(j);
        let [link, ..] = from_here else { return };
        let mut state = link.state;
        if link.placing.joint != JointKind::Floating {
            let antecedent = link.antecedent.map(|a| &before[a]);
            let Link {
                placing, path, far, ..
            } = link;
            let to = path.split_at_mut(*far);
            state = with_frame!(
                &tree.bodies[j],
                placing,
                motion,
                step,
                tree,
                placing.joint,
                antecedent,
                to
            );
        }
        match link.own {
            Own::Alone { opposite } => {
                let forces = Forces::spinning(zero, &state);
                link.keep(&state, &forces);
                alone(zero, (j, link, opposite), &forces, motion.qdd, sink);
            }
            _ => {
                let forces = Forces::of(&state);
                link.keep(&state, &forces);
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
        Own::Any => on_ancestor::<ORDER, T>(zero, j, own, forces, sink),
        Own::Last { opposite } | Own::Alone { opposite } => {
            let columns = forces.on_last_axis(opposite, zero).in_order::<ORDER>();
            sink.link(j, own.row, columns, Nonzero::turning(ORDER));
        }
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
    let state = forward(frame, tree, joint, antecedent.map(|a| &a.state));
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
fn forward<C: Copy, T: Lift<C>>(
    frame: &impl Frame<T>,
    tree: &Tree<C>,
    joint: JointKind,
    parent: Option<&BodyState<T>>,
) -> BodyState<T> {
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
    let u = [zero; 3];
    BodyState { w, dw, a, u }
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
