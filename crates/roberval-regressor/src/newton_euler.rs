//! The torques themselves: forces carried inward, one link after the other.
//!
//! Newton and Euler's recursion with what is known to make it cheap: the products of
//! velocities are shared through U (Khalil and Kleinfinger 1987). Two identities more are
//! used here. The points of a revolute joint's axis belong to both bodies, so that the
//! column of U along the axis is the antecedent's, turned. And mass on that axis belongs to
//! either body ([`Moments`]), which leaves zeros. That is for expressions, whose zeros and ones
//! fold; batches of floats have frames at right angles and a recursion of their own.

use roberval_mechanism::{JointKind, ParameterSpace};
use roberval_scalar::Scalar;

use crate::forces::acceleration_field;
use crate::vector::{Mat3, Vec3, add, apply, apply_transposed, cross, dot, scale};
use crate::{BaseState, Body, JointMotion, Moments, Shape, Tree};

/// How a body moves, in its own frame.
#[derive(Debug, Clone, Copy)]
struct BodyState<T> {
    /// Angular velocity.
    w: Vec3<T>,
    /// Angular acceleration.
    dw: Vec3<T>,
    /// Acceleration of the frame's origin; gravity enters as that of the base, -g.
    a: Vec3<T>,
    /// U = `[dw]x + [w]x [w]x`: a point fixed at p in the frame accelerates by a + U p.
    u: Mat3<T>,
}

/// The force of a body and all it carries on its antecedent, and the moment about the
/// body's origin, in the body's frame.
#[derive(Debug, Clone, Copy)]
struct Wrench<T> {
    f: Vec3<T>,
    n: Vec3<T>,
}

/// The torques d X by Newton and Euler's recursion: velocities outward, forces inward.
/// The same function of X as [`crate::dynamics`] with the sink [`crate::Torques`].
///
/// `motion` and `shapes` have one entry a body, `x` one number a column of `space`; `base` is
/// where the base of a floating robot is; `regroup` moves mass between bodies as no motion can
/// tell, which is worth it if X are base parameters; `turn` is called with a body's index when
/// its turn begins, outward and again inward. Gives one torque (or force) a joint variable, and
/// of a base that floats the force, then the moment on it, in its frame.
pub fn newton_euler<T: Scalar>(
    tree: &Tree<T>,
    shapes: &[Shape],
    (base, motion): (Option<&BaseState<T>>, &[JointMotion<T>]),
    (space, x): (&ParameterSpace, &[T]),
    regroup: bool,
    mut turn: impl FnMut(usize),
) -> Vec<T> {
    let zero = tree.constants.zero;
    let ground = resting(zero, tree.gravity.map(|g| -g));
    let mut states: Vec<BodyState<T>> = Vec::with_capacity(tree.bodies.len());
    for (j, body) in tree.bodies.iter().enumerate() {
        turn(j);
        let parent = body.antecedent.map_or(&ground, |a| &states[a]);
        states.push(match base.filter(|_| body.joint == JointKind::Floating) {
            Some(base) => floating(tree, base),
            None => outward(body, shapes[j], &motion[j], parent),
        });
    }
    let moments = Moments::of(tree, shapes, (space, x), regroup);
    let still = Wrench {
        f: [zero; 3],
        n: [zero; 3],
    };
    let mut carried = vec![still; tree.bodies.len()];
    let mut torques = vec![zero; tree.dof];
    for (j, body) in tree.bodies.iter().enumerate().rev() {
        turn(j);
        let own = inertia_forces(&states[j], shapes[j], &moments[j]);
        let (f, n) = (add(own.f, carried[j].f), add(own.n, carried[j].n));
        match (body.joint, body.variable) {
            (JointKind::Floating, Some(row)) => {
                torques[row..row + 3].copy_from_slice(&f);
                torques[row + 3..row + 6].copy_from_slice(&n);
            }
            (JointKind::Prismatic, Some(row)) => torques[row] = dot(body.axis, f),
            (_, Some(row)) => torques[row] = dot(body.axis, n),
            (_, None) => {}
        }
        if let Some(row) = body.variable.filter(|_| body.rotor) {
            let ia = x[space.first_column(j) + 10];
            torques[row] = torques[row] + ia * motion[j].qdd * body.axis_squared;
        }
        if let Some(a) = body.antecedent {
            let (f, n) = (turned(body, &motion[j], f), turned(body, &motion[j], n));
            carried[a].f = add(carried[a].f, f);
            carried[a].n = add(carried[a].n, add(n, cross(lever(body, &motion[j]), f)));
        }
    }
    torques
}

/// The state of a body without velocities.
fn resting<T: Scalar>(zero: T, a: Vec3<T>) -> BodyState<T> {
    BodyState {
        w: [zero; 3],
        dw: [zero; 3],
        a,
        u: [[zero; 3]; 3],
    }
}

/// The state of a base that floats.
fn floating<T: Scalar>(tree: &Tree<T>, base: &BaseState<T>) -> BodyState<T> {
    BodyState {
        w: base.w,
        dw: base.dw,
        a: base.acceleration(tree),
        u: acceleration_field(base.w, base.dw),
    }
}

/// Velocities and accelerations from the antecedent's.
fn outward<T: Scalar>(
    body: &Body<T>,
    shape: Shape,
    motion: &JointMotion<T>,
    parent: &BodyState<T>,
) -> BodyState<T> {
    // In the body's orientation before its joint has turned.
    let before = |v: Vec3<T>| apply_transposed(&body.rotation, v);
    let (w0, dw0) = (before(parent.w), before(parent.dw));
    let mut a = before(add(parent.a, apply(&parent.u, lever(body, motion))));
    let (velocity, acceleration) = (scale(body.axis, motion.qd), scale(body.axis, motion.qdd));
    if body.joint != JointKind::Revolute {
        let coriolis = cross(w0, velocity);
        a = add(add(a, add(coriolis, coriolis)), acceleration);
        let u = acceleration_field(w0, dw0);
        return BodyState {
            w: w0,
            dw: dw0,
            a,
            u,
        };
    }
    let turn = motion.rotation(body.axis);
    let after = |v: Vec3<T>| apply_transposed(&turn, v);
    let (a, turned) = (after(a), after(w0));
    let w = add(turned, velocity);
    let Some(k) = shape.along else {
        let dw = add(add(after(dw0), cross(turned, velocity)), acceleration);
        let u = acceleration_field(w, dw);
        return BodyState { w, dw, a, u };
    };
    // The column of U along the axis is the antecedent's.
    let (i, j) = ((k + 1) % 3, (k + 2) % 3);
    let u0 = acceleration_field(w0, dw0);
    let column = after([0, 1, 2].map(|row| u0[row][k]));
    let mut dw = add(dw0, acceleration);
    dw[j] = column[i] - w[i] * w[k];
    dw[i] = w[j] * w[k] - column[j];
    let mut u = acceleration_field(w, dw);
    if shape.right {
        u[k][k] = u0[k][k];
    }
    BodyState { w, dw, a, u }
}

/// What the body's motion takes: `f = M a + U ms`, `n = J dw + w x J w + ms x a`; the
/// moment is the skew part of U S.
fn inertia_forces<T: Scalar>(
    state: &BodyState<T>,
    shape: Shape,
    moments: &Moments<T>,
) -> Wrench<T> {
    let &BodyState { w, dw, a, ref u } = state;
    let (s, ms) = (&moments.second, moments.first);
    let k = shape.along.unwrap_or(2);
    let (i, j) = ((k + 1) % 3, (k + 2) % 3);
    let squares = w.map(|x| x * x);
    let mut n = cross(ms, a);
    n[i] = n[i] + u[k][i] * s[i][j] + u[k][j] * s[j][j] - u[j][k] * s[k][k] - u[j][i] * s[i][k]
        + (squares[k] - squares[j]) * s[j][k];
    n[j] = n[j] + u[i][j] * s[j][k] + u[i][k] * s[k][k] - u[k][i] * s[i][i] - u[k][j] * s[i][j]
        + (squares[i] - squares[k]) * s[i][k];
    n[k] = n[k]
        + dw[k] * (s[i][i] + s[j][j])
        + (w[i] * w[j]) * (s[i][i] - s[j][j])
        + (squares[j] - squares[i]) * s[i][j]
        + u[j][k] * s[i][k]
        - u[i][k] * s[j][k];
    Wrench {
        f: add(apply(u, ms), scale(a, moments.mass)),
        n,
    }
}

/// The body's origin in the antecedent's frame.
fn lever<T: Scalar>(body: &Body<T>, motion: &JointMotion<T>) -> Vec3<T> {
    match body.joint {
        JointKind::Prismatic => {
            let shift = apply(&body.rotation, scale(body.axis, motion.q));
            add(body.origin, shift)
        }
        _ => body.origin,
    }
}

/// From the body's frame to the antecedent's: the joint's turn, then the constant one.
/// One after the other, because each has more zeros than their product.
fn turned<T: Scalar>(body: &Body<T>, motion: &JointMotion<T>, v: Vec3<T>) -> Vec3<T> {
    let v = match body.joint {
        JointKind::Revolute => apply(&motion.rotation(body.axis), v),
        _ => v,
    };
    apply(&body.rotation, v)
}
