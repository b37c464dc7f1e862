use roberval_mechanism::JointKind;
use roberval_scalar::Scalar;

use crate::vector::{Mat3, Vec3, add, apply, apply_transposed, cross, dot, scale};
use crate::{BaseState, Body, Constants, JointMotion, Sink, Tree};

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
    /// Joint variable: the row of the regressor.
    row: usize,
    /// Angular velocity, in the body's frame.
    e: Vec3<T>,
    /// Velocity of the body's origin, in the body's frame.
    v: Vec3<T>,
}

/// Working memory of [`dynamics`], made once for a tree.
#[derive(Debug, Clone)]
pub struct DynamicsWorkspace<T> {
    states: Vec<BodyState<T>>,
    /// The screws of each body's path to the base, body after body.
    screws: Vec<Screw<T>>,
    /// Where each body's screws begin and how many there are.
    spans: Vec<(usize, usize)>,
    base: BodyState<T>,
}

impl<T: Scalar> DynamicsWorkspace<T> {
    /// Working memory for this tree.
    #[must_use]
    pub fn new(tree: &Tree<T>) -> Self {
        let zero = tree.constants.zero;
        let base = BodyState {
            w: [zero; 3],
            dw: [zero; 3],
            a: tree.gravity.map(|g| -g),
            u: [[zero; 3]; 3],
        };
        Self {
            states: Vec::with_capacity(tree.bodies.len()),
            screws: Vec::with_capacity(tree.depths().iter().sum()),
            spans: Vec::with_capacity(tree.bodies.len()),
            base,
        }
    }

    /// Where the base of a floating robot is and how it moves from now on.
    pub fn move_base(&mut self, tree: &Tree<T>, base: &BaseState<T>) {
        let (w, dw) = (base.w, base.dw);
        self.base = BodyState {
            w,
            dw,
            a: base.acceleration(tree),
            u: acceleration_field(w, dw),
        };
    }
}

/// The rows of the dynamic model d at one state (Gautier 1991, eq. (5)), or of d0 if
/// all velocities are zero (eq. (8)): `sink` receives, link by link, the ten inertial
/// columns' entries on every row of the path to the base, then the rotor's.
///
/// `motion` has one entry a body (that of a fixed joint is not looked at); the base of a
/// floating robot is where [`DynamicsWorkspace::move_base`] put it last. Its rows are the
/// wrench on it, force before moment, in its own frame.
pub fn dynamics<T: Scalar>(
    tree: &Tree<T>,
    motion: &[JointMotion<T>],
    workspace: &mut DynamicsWorkspace<T>,
    sink: &mut impl Sink<T>,
) {
    workspace.states.clear();
    workspace.screws.clear();
    workspace.spans.clear();
    for (j, (body, motion)) in tree.bodies.iter().zip(motion).enumerate() {
        let parent = body
            .antecedent
            .map_or(workspace.base, |a| workspace.states[a]);
        let state = if body.joint == JointKind::Floating {
            unit_screws(tree.constants, workspace);
            parent
        } else {
            let (rotation, origin) = body.placement(motion);
            carry_screws(body, &rotation, origin, tree.constants, workspace);
            forward(body, motion, &parent, &rotation, origin)
        };
        workspace.states.push(state);
        if body.massless {
            continue;
        }
        let (first, count) = workspace.spans[j];
        for screw in &workspace.screws[first..first + count] {
            sink.link(j, screw.row, project(screw, &state));
        }
        if let (Some(row), true) = (body.variable, body.rotor) {
            sink.rotor(j, row, motion.qdd * body.axis_squared);
        }
    }
}

/// Velocities and accelerations from the antecedent's (Newton-Euler, outward).
#[inline(always)]
fn forward<T: Scalar>(
    body: &Body<T>,
    motion: &JointMotion<T>,
    parent: &BodyState<T>,
    rotation: &Mat3<T>,
    origin: Vec3<T>,
) -> BodyState<T> {
    let mut w = apply_transposed(rotation, parent.w);
    let mut dw = apply_transposed(rotation, parent.dw);
    let mut a = apply_transposed(rotation, add(parent.a, apply(&parent.u, origin)));
    let (velocity, acceleration) = (scale(body.axis, motion.qd), scale(body.axis, motion.qdd));
    match body.joint {
        JointKind::Revolute => {
            dw = add(add(dw, cross(w, velocity)), acceleration);
            w = add(w, velocity);
        }
        JointKind::Prismatic => {
            let coriolis = cross(w, velocity);
            a = add(add(a, add(coriolis, coriolis)), acceleration);
        }
        JointKind::Fixed | JointKind::Floating => {}
    }
    BodyState {
        w,
        dw,
        a,
        u: acceleration_field(w, dw),
    }
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

/// The six unit velocities of a base that floats, along and about its axes.
fn unit_screws<T: Scalar>(constants: Constants<T>, workspace: &mut DynamicsWorkspace<T>) {
    let Constants { zero, one, .. } = constants;
    let still = [zero; 3];
    for row in 0..6 {
        let mut unit = still;
        unit[row % 3] = one;
        let (e, v) = if row < 3 {
            (still, unit)
        } else {
            (unit, still)
        };
        workspace.screws.push(Screw { row, e, v });
    }
    workspace.spans.push((0, 6));
}

/// Brings the antecedent's screws into this body's frame and adds the joint's own.
#[inline(always)]
fn carry_screws<T: Scalar>(
    body: &Body<T>,
    rotation: &Mat3<T>,
    origin: Vec3<T>,
    constants: Constants<T>,
    workspace: &mut DynamicsWorkspace<T>,
) {
    let first = workspace.screws.len();
    let (from, count) = body.antecedent.map_or((0, 0), |a| workspace.spans[a]);
    for k in from..from + count {
        let Screw { row, e, v } = workspace.screws[k];
        workspace.screws.push(Screw {
            row,
            e: apply_transposed(rotation, e),
            v: apply_transposed(rotation, add(v, cross(e, origin))),
        });
    }
    if let Some(row) = body.variable {
        let still = [constants.zero; 3];
        let (e, v) = match body.joint {
            JointKind::Prismatic => (still, body.axis),
            _ => (body.axis, still),
        };
        workspace.screws.push(Screw { row, e, v });
    }
    workspace
        .spans
        .push((first, workspace.screws.len() - first));
}

/// The power of the link's inertia forces along a screw, parameter by parameter, XX to M:
/// the force of a unit first moment m is `U m` and its moment `m x a`; that of a unit
/// mass is `a`; a unit inertia J gives the moment `J dw + w x J w`.
#[inline(always)]
fn project<T: Scalar>(screw: &Screw<T>, state: &BodyState<T>) -> [T; 10] {
    let (e, v) = (screw.e, screw.v);
    let (w, dw, a, u) = (state.w, state.dw, state.a, &state.u);
    let (xy, xz, yz) = (w[0] * w[1], w[0] * w[2], w[1] * w[2]);
    let (x2, y2, z2) = (w[0] * w[0], w[1] * w[1], w[2] * w[2]);
    let moment = add(cross(a, e), apply_transposed(u, v));
    [
        dw[0] * e[0] + xz * e[1] - xy * e[2],
        (x2 - y2) * e[2] - u[2][0] * e[0] + u[2][1] * e[1],
        u[1][0] * e[0] + (z2 - x2) * e[1] - u[1][2] * e[2],
        dw[1] * e[1] - yz * e[0] + xy * e[2],
        (y2 - z2) * e[0] - u[0][1] * e[1] + u[0][2] * e[2],
        yz * e[0] - xz * e[1] + dw[2] * e[2],
        moment[0],
        moment[1],
        moment[2],
        dot(v, a),
    ]
}
