use roberval_mechanism::JointKind;
use roberval_scalar::{Lift, Scalar};

use crate::frame::{Frame, General, Layout, Right, with_frame};
use crate::vector::{Mat3, Vec3, dot, lift3, negative};
use crate::{BaseState, Body, JointMotion, Sink, Tree};

/// How a body moves, in its own frame.
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
struct Screw<T> {
    /// Angular velocity, in the body's frame.
    e: Vec3<T>,
    /// Velocity of the body's origin, in the body's frame.
    v: Vec3<T>,
}

/// A moving joint on a body's path to the base.
#[derive(Debug, Clone, Copy)]
struct Ancestor {
    /// Joint variable: the row of the regressor.
    row: usize,
    /// Whether it is prismatic, its screw then without e.
    slides: bool,
}

/// Where a body's path is in a list of all paths.
#[derive(Debug, Clone, Copy)]
struct Span {
    first: usize,
    /// How many joints the antecedent's path has; its own joint, if any, comes after them.
    inherited: usize,
    /// Where the antecedent's path is.
    from: usize,
}

/// Working memory of [`dynamics`], made once for a tree.
#[derive(Debug, Clone)]
pub struct DynamicsWorkspace<T> {
    states: Vec<BodyState<T>>,
    /// The joints of each body's path from the base, body after body.
    ancestors: Vec<Ancestor>,
    /// Their screws.
    screws: Vec<Screw<T>>,
    spans: Vec<Span>,
}

impl<T: Scalar> DynamicsWorkspace<T> {
    /// Working memory for this tree.
    #[must_use]
    pub fn new<C: Copy>(tree: &Tree<C>) -> Self
    where
        T: Lift<C>,
    {
        let zero = [T::lift(tree.constants.zero); 3];
        let mut ancestors = Vec::new();
        let mut screws = Vec::new();
        let mut spans: Vec<Span> = Vec::with_capacity(tree.bodies.len());
        for body in &tree.bodies {
            let first = ancestors.len();
            let (from, inherited) = match body.antecedent {
                Some(a) => {
                    let own = usize::from(tree.bodies[a].joint.has_axis());
                    (spans[a].first, spans[a].inherited + own)
                }
                None => (first, 0),
            };
            if body.joint == JointKind::Floating {
                let one = T::lift(tree.constants.one);
                unit_screws(zero, one, &mut ancestors, &mut screws);
                spans.push(Span {
                    first,
                    inherited: 6,
                    from,
                });
                continue;
            }
            ancestors.extend_from_within(from..from + inherited);
            screws.resize(ancestors.len(), Screw { e: zero, v: zero });
            if let Some(row) = body.variable {
                let slides = body.joint == JointKind::Prismatic;
                let axis = lift3(&body.axis);
                let (e, v) = if slides { (zero, axis) } else { (axis, zero) };
                ancestors.push(Ancestor { row, slides });
                screws.push(Screw { e, v });
            }
            spans.push(Span {
                first,
                inherited,
                from,
            });
        }
        let rest = BodyState {
            w: zero,
            dw: zero,
            a: zero,
            u: [zero; 3],
        };
        Self {
            states: vec![rest; tree.bodies.len()],
            ancestors,
            screws,
            spans,
        }
    }

    /// Where the base of a floating robot is and how it moves from now on.
    #[inline(always)]
    pub fn move_base<C: Scalar>(&mut self, tree: &Tree<C>, base: &BaseState<T>)
    where
        T: Lift<C>,
    {
        let state = &mut self.states[0];
        (state.w, state.dw, state.a) = (base.w, base.dw, base.acceleration(tree));
    }
}

/// The six unit velocities of a base that floats, along and about its axes.
fn unit_screws<T: Scalar>(
    zero: Vec3<T>,
    one: T,
    ancestors: &mut Vec<Ancestor>,
    screws: &mut Vec<Screw<T>>,
) {
    for row in 0..6 {
        let mut unit = zero;
        unit[row % 3] = one;
        let slides = row < 3;
        let (e, v) = if slides { (zero, unit) } else { (unit, zero) };
        ancestors.push(Ancestor { row, slides });
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
    for (j, (body, motion)) in tree.bodies.iter().zip(motion).enumerate() {
        if body.joint != JointKind::Floating {
            with_frame!(body, motion, step, tree, j, motion, workspace);
        }
        let state = &mut workspace.states[j];
        let forces = Forces::of(state);
        state.u = forces.u;
        if body.massless {
            continue;
        }
        let Span {
            first, inherited, ..
        } = workspace.spans[j];
        let ancestors = &workspace.ancestors[first..first + inherited];
        let screws = &workspace.screws[first..first + inherited];
        for k in 0..inherited {
            let columns = match ancestors[k].slides {
                false => forces.on_screw(&screws[k]),
                true => forces.on_translation(tree.constants.zero, screws[k].v),
            };
            sink.link(j, ancestors[k].row, columns);
        }
        let Some(row) = body.variable.filter(|_| body.joint.has_axis()) else {
            continue;
        };
        sink.link(j, row, forces.on_own_joint(body, tree.constants.zero));
        if body.rotor {
            sink.rotor(j, row, T::lift(body.axis_squared) * motion.qdd);
        }
    }
}

/// One body: its motion and the screws of its path, from the antecedent's.
#[inline(always)]
fn step<C: Copy, T: Lift<C>>(
    frame: &impl Frame<T>,
    tree: &Tree<C>,
    j: usize,
    motion: &JointMotion<T>,
    workspace: &mut DynamicsWorkspace<T>,
) {
    let body = &tree.bodies[j];
    let (before, from_here) = workspace.states.split_at_mut(j);
    let parent = body.antecedent.map(|a| &before[a]);
    forward(frame, tree, body, motion, parent, &mut from_here[0]);
    let Span {
        first,
        inherited,
        from,
    } = workspace.spans[j];
    let (before, own) = workspace.screws.split_at_mut(first);
    let (own, from) = (&mut own[..inherited], &before[from..from + inherited]);
    let ancestors = &workspace.ancestors[first..first + inherited];
    for k in 0..inherited {
        let v = frame.take(&from[k].v);
        if ancestors[k].slides {
            frame.give(frame.turn(v), &mut own[k].v);
            continue;
        }
        let e = frame.take(&from[k].e);
        frame.give(frame.turn(e), &mut own[k].e);
        frame.give(frame.turn(frame.carry(v, e)), &mut own[k].v);
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
    frame.give(w, &mut state.w);
    frame.give(dw, &mut state.dw);
    frame.give(a, &mut state.a);
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

/// The inertia forces of a body, parameter by parameter: the force of a unit first moment
/// m is `U m` and its moment `m x a`; that of a unit mass is `a`; a unit inertia J gives
/// the moment `J dw + w x J w`.
struct Forces<T> {
    dw: Vec3<T>,
    a: Vec3<T>,
    u: Mat3<T>,
    xy: T,
    xz: T,
    yz: T,
    /// x2 - y2, z2 - x2, y2 - z2 of w.
    x2_y2: T,
    z2_x2: T,
    y2_z2: T,
}

impl<T: Scalar> Forces<T> {
    #[inline(always)]
    fn of(state: &BodyState<T>) -> Self {
        let (w, dw) = (state.w, state.dw);
        let (x2, y2, z2) = (w[0] * w[0], w[1] * w[1], w[2] * w[2]);
        let (xy, xz, yz) = (w[0] * w[1], w[0] * w[2], w[1] * w[2]);
        Self {
            dw,
            a: state.a,
            u: [
                [-(y2 + z2), xy - dw[2], xz + dw[1]],
                [xy + dw[2], -(x2 + z2), yz - dw[0]],
                [xz - dw[1], yz + dw[0], -(x2 + y2)],
            ],
            xy,
            xz,
            yz,
            x2_y2: x2 - y2,
            z2_x2: z2 - x2,
            y2_z2: y2 - z2,
        }
    }

    /// Their power along a screw, XX to M.
    #[inline(always)]
    fn on_screw(&self, screw: &Screw<T>) -> [T; 10] {
        let ([ex, ey, ez], v) = (screw.e, screw.v);
        let Self { dw, a, u, .. } = self;
        [
            ez.neg_mul_add(self.xy, ey.mul_add(self.xz, dw[0] * ex)),
            ez.mul_add(self.x2_y2, ex.neg_mul_add(u[2][0], u[2][1] * ey)),
            ey.mul_add(self.z2_x2, ez.neg_mul_add(u[1][2], u[1][0] * ex)),
            ez.mul_add(self.xy, ex.neg_mul_add(self.yz, dw[1] * ey)),
            ex.mul_add(self.y2_z2, ey.neg_mul_add(u[0][1], u[0][2] * ez)),
            ex.mul_add(self.yz, ey.neg_mul_add(self.xz, dw[2] * ez)),
            self.along(0, v, ey.neg_mul_add(a[2], a[1] * ez)),
            self.along(1, v, ez.neg_mul_add(a[0], a[2] * ex)),
            self.along(2, v, ex.neg_mul_add(a[1], a[0] * ey)),
            dot(v, *a),
        ]
    }

    /// `U' v` along axis k, added to what the rotation gives.
    #[inline(always)]
    fn along(&self, k: usize, v: Vec3<T>, turning: T) -> T {
        let u = &self.u;
        let sum = u[0][k].mul_add(v[0], turning);
        u[2][k].mul_add(v[2], u[1][k].mul_add(v[1], sum))
    }

    /// Their power along a translation.
    #[inline(always)]
    fn on_translation<C: Copy>(&self, zero: C, v: Vec3<T>) -> [T; 10]
    where
        T: Lift<C>,
    {
        let Self { a, u, .. } = self;
        let zero = T::lift(zero);
        let column = |k: usize| [u[0][k], u[1][k], u[2][k]];
        let [mx, my, mz] = [dot(column(0), v), dot(column(1), v), dot(column(2), v)];
        [zero, zero, zero, zero, zero, zero, mx, my, mz, dot(v, *a)]
    }

    /// Their power along the unit velocity of the body's own joint: mostly a copy.
    #[inline(always)]
    fn on_own_joint<C: Copy>(&self, body: &Body<C>, zero: C) -> [T; 10]
    where
        T: Lift<C>,
    {
        let axis = lift3(&body.axis);
        let Self { dw, a, u, .. } = self;
        let none = T::lift(zero);
        let aligned = match &body.layout {
            Layout::Aligned(aligned) => Some((aligned.axis, aligned.reversed)),
            Layout::General => None,
        };
        let columns = match (body.joint, aligned.map(|(along, _)| along)) {
            (JointKind::Prismatic, _) => return self.on_translation(zero, axis),
            (_, None) => {
                return self.on_screw(&Screw {
                    e: axis,
                    v: [none; 3],
                });
            }
            (_, Some(0)) => [
                dw[0], -u[2][0], u[1][0], -self.yz, self.y2_z2, self.yz, none, a[2], -a[1], none,
            ],
            (_, Some(1)) => [
                self.xz, u[2][1], self.z2_x2, dw[1], -u[0][1], -self.xz, -a[2], none, a[0], none,
            ],
            (_, Some(_)) => [
                -self.xy, self.x2_y2, -u[1][2], self.xy, u[0][2], dw[2], a[1], -a[0], none, none,
            ],
        };
        let mut columns = columns;
        if let Some((_, true)) = aligned {
            for column in &mut columns {
                *column = -*column;
            }
        }
        columns
    }
}
