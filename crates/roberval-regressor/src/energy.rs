use roberval_mechanism::JointKind;
use roberval_scalar::{Lift, Scalar};

use crate::frame::{Frame, General, Placing, Right, with_frame};
use crate::layout::usual;
use crate::vector::{Vec3, cross, dot, lift3};
use crate::{BaseState, JointMotion, Nonzero, Sink, Tree};

/// What the energy of a body needs, in the body's frame with its joint's axis last.
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

impl<T: Copy> BodyState<T> {
    /// The same with the axes x, y, z.
    #[inline(always)]
    fn in_usual_order(&self, order: usize) -> Self {
        Self {
            w: usual(&self.w, order),
            v: usual(&self.v, order),
            g: usual(&self.g, order),
            height: self.height,
        }
    }
}

/// Working memory of [`energy`], made once for a tree.
#[derive(Debug, Clone)]
pub struct EnergyWorkspace<T> {
    states: Vec<BodyState<T>>,
    placings: Vec<Placing<T>>,
}

impl<T: Scalar> EnergyWorkspace<T> {
    /// Working memory for this tree.
    #[must_use]
    pub fn new<C: Copy>(tree: &Tree<C>) -> Self
    where
        T: Lift<C>,
    {
        let zero = T::lift(tree.constants.zero);
        let rest = BodyState {
            w: [zero; 3],
            v: [zero; 3],
            g: lift3(&tree.gravity),
            height: zero,
        };
        Self {
            states: vec![rest; tree.bodies.len()],
            placings: Placing::of(tree),
        }
    }

    /// Where the base of a floating robot is and how it moves from now on.
    #[inline(always)]
    pub fn move_base<C: Scalar>(&mut self, tree: &Tree<C>, base: &BaseState<T>)
    where
        T: Lift<C>,
    {
        self.states[0] = BodyState {
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
#[inline(always)]
pub fn energy<C: Copy, T: Lift<C>>(
    tree: &Tree<C>,
    motion: &[JointMotion<T>],
    workspace: &mut EnergyWorkspace<T>,
    sink: &mut impl Sink<T>,
) {
    let half = T::lift(tree.constants.half);
    for (j, (body, motion)) in tree.bodies.iter().zip(motion).enumerate() {
        let (states, placing) = (&mut workspace.states, &workspace.placings[j]);
        if body.joint != JointKind::Floating {
            with_frame!(body, placing, motion, forward, tree, j, states);
        }
        if body.massless {
            continue;
        }
        let state = states[j].in_usual_order(body.layout.order());
        sink.link(j, 0, link_energy(&state, half), Nonzero::ALL);
        if body.rotor {
            let squared = T::lift(body.axis_squared);
            sink.rotor(j, 0, half * motion.qd * motion.qd * squared);
        }
    }
}

#[inline(always)]
fn forward<C: Copy, T: Lift<C>>(
    frame: &impl Frame<T>,
    tree: &Tree<C>,
    j: usize,
    states: &mut [BodyState<T>],
) {
    let body = &tree.bodies[j];
    let zero = T::lift(tree.constants.zero);
    let (mut w, mut v, g, height) = match body.antecedent.map(|a| states[a]) {
        Some(parent) => {
            let (w, g) = (frame.take(&parent.w), frame.take(&parent.g));
            let v = frame.carry(frame.take(&parent.v), w);
            (frame.turn(w), frame.turn(v), g, parent.height)
        }
        None => (
            [zero; 3],
            [zero; 3],
            frame.take(&lift3(&tree.gravity)),
            zero,
        ),
    };
    match body.joint {
        JointKind::Revolute => w = frame.along_axis(w, frame.rates().0),
        JointKind::Prismatic => v = frame.along_axis(v, frame.rates().0),
        JointKind::Fixed | JointKind::Floating => {}
    }
    states[j] = BodyState {
        w,
        v,
        height: frame.rise(height, g),
        g: frame.turn(g),
    };
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
