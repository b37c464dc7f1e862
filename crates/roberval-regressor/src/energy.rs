use roberval_mechanism::JointKind;
use roberval_scalar::Scalar;

use crate::vector::{Mat3, Vec3, add, apply_transposed, cross, dot, scale};
use crate::{BaseState, Body, JointMotion, Sink, Tree};

/// What the energy of a body needs, in the body's frame.
#[derive(Debug, Clone, Copy)]
struct BodyState<T> {
    /// Angular velocity.
    w: Vec3<T>,
    /// Velocity of the frame's origin.
    v: Vec3<T>,
    /// Acceleration of gravity.
    g: Vec3<T>,
    /// g . p, with p the origin in the base frame.
    height: T,
}

/// Working memory of [`energy`], made once for a tree.
#[derive(Debug, Clone)]
pub struct EnergyWorkspace<T> {
    states: Vec<BodyState<T>>,
    base: BodyState<T>,
}

impl<T: Scalar> EnergyWorkspace<T> {
    /// Working memory for this tree.
    #[must_use]
    pub fn new(tree: &Tree<T>) -> Self {
        let zero = tree.constants.zero;
        Self {
            states: Vec::with_capacity(tree.bodies.len()),
            base: BodyState {
                w: [zero; 3],
                v: [zero; 3],
                g: tree.gravity,
                height: zero,
            },
        }
    }

    /// Where the base of a floating robot is and how it moves from now on.
    pub fn move_base(&mut self, tree: &Tree<T>, base: &BaseState<T>) {
        self.base = BodyState {
            w: base.w,
            v: base.v,
            g: base.gravity(tree),
            height: base.height(tree),
        };
    }
}

/// The energy row h at one state (Gautier 1991, eq. (10)): `sink` receives it as row 0,
/// link by link. Only differences of h between states mean anything. The base of a floating
/// robot is where [`EnergyWorkspace::move_base`] put it last.
pub fn energy<T: Scalar>(
    tree: &Tree<T>,
    motion: &[JointMotion<T>],
    workspace: &mut EnergyWorkspace<T>,
    sink: &mut impl Sink<T>,
) {
    let half = tree.constants.half;
    workspace.states.clear();
    for (j, (body, motion)) in tree.bodies.iter().zip(motion).enumerate() {
        let parent = body
            .antecedent
            .map_or(workspace.base, |a| workspace.states[a]);
        let state = if body.joint == JointKind::Floating {
            parent
        } else {
            let (rotation, origin) = body.placement(motion);
            forward(body, motion, &parent, &rotation, origin)
        };
        workspace.states.push(state);
        if body.massless {
            continue;
        }
        sink.link(j, 0, link_energy(&state, half));
        if body.rotor {
            sink.rotor(j, 0, half * motion.qd * motion.qd * body.axis_squared);
        }
    }
}

#[inline(always)]
fn forward<T: Scalar>(
    body: &Body<T>,
    motion: &JointMotion<T>,
    parent: &BodyState<T>,
    rotation: &Mat3<T>,
    origin: Vec3<T>,
) -> BodyState<T> {
    let mut w = apply_transposed(rotation, parent.w);
    let mut v = apply_transposed(rotation, add(parent.v, cross(parent.w, origin)));
    let velocity = scale(body.axis, motion.qd);
    match body.joint {
        JointKind::Revolute => w = add(w, velocity),
        JointKind::Prismatic => v = add(v, velocity),
        JointKind::Fixed | JointKind::Floating => {}
    }
    BodyState {
        w,
        v,
        g: apply_transposed(rotation, parent.g),
        height: parent.height + dot(parent.g, origin),
    }
}

/// The ten functions h_i of a link (Gautier 1991, eq. (10)).
#[inline(always)]
fn link_energy<T: Scalar>(state: &BodyState<T>, half: T) -> [T; 10] {
    let BodyState { w, v, g, height } = *state;
    let momentum = cross(v, w);
    [
        half * w[0] * w[0],
        w[0] * w[1],
        w[0] * w[2],
        half * w[1] * w[1],
        w[1] * w[2],
        half * w[2] * w[2],
        momentum[0] - g[0],
        momentum[1] - g[1],
        momentum[2] - g[2],
        half * dot(v, v) - height,
    ]
}
