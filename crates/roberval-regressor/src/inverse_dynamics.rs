//! The torques of lanes of samples: Newton and Euler's recursion, velocities outward and
//! wrenches inward.
//!
//! The same as the rows times X, at a cost that grows with the bodies and not with their paths.
//! [`crate::newton_euler()`] is for expressions, which drop zeros by themselves; here frames
//! at right angles ([`crate::frame`]) do.

use roberval_mechanism::{JointKind, ParameterSpace};
use roberval_scalar::{Lift, Scalar};

use crate::dynamics::{BodyState, forward};
use crate::forces::{Forces, Inertia, Wrench};
use crate::frame::{Frame, General, Right, with_frame};
use crate::vector::add;
use crate::workspace::Own;
use crate::{DynamicsWorkspace, JointMotion, Tree};

/// What is kept of each body beside its motion.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Load<T> {
    inertia: Inertia,
    /// Of the body and of all that hang on it.
    wrench: Wrench<T>,
}

/// The bodies' loads for these standard parameters, in room of earlier ones.
pub(crate) fn set_inertias<T: Lift<f64>>(
    loads: &mut Vec<Load<T>>,
    workspace: &DynamicsWorkspace<T>,
    (space, x): (&ParameterSpace, &[f64]),
) {
    loads.clear();
    loads.extend(workspace.links.iter().enumerate().map(|(j, link)| Load {
        inertia: match link.massless {
            true => Inertia::NONE,
            false => {
                let rotor = usize::from(link.rotor.is_some());
                let x = &x[space.first_column(j)..][..10 + rotor];
                Inertia::new(x, link.placing.order)
            }
        },
        wrench: Wrench {
            f: [T::lift(0.0); 3],
            n: [T::lift(0.0); 3],
        },
    }));
}

/// Torques (and forces) of all joint variables at one state; of a base that floats the wrench
/// on it, force before moment, in its own frame. `motion`, `workspace` and the base as
/// for [`crate::dynamics()`], and `loads` of [`set_inertias`].
#[inline(always)]
pub(crate) fn inverse_dynamics<T: Lift<f64>>(
    tree: &Tree<f64>,
    motion: &[JointMotion<T>],
    workspace: &mut DynamicsWorkspace<T>,
    loads: &mut [Load<T>],
    torques: &mut [T],
) {
    outward(tree, motion, workspace, loads);
    inward(tree, motion, workspace, loads, torques);
}

/// Motions of the bodies, and the wrench that each one takes by itself.
#[inline(always)]
fn outward<T: Lift<f64>>(
    tree: &Tree<f64>,
    motion: &[JointMotion<T>],
    workspace: &mut DynamicsWorkspace<T>,
    loads: &mut [Load<T>],
) {
    let links = &mut workspace.links[..];
    for (j, (motion, load)) in motion.iter().zip(loads).enumerate() {
        let (before, from_here) = links.split_at_mut(j);
        let [link, ..] = from_here else { return };
        let (body, placing) = (&tree.bodies[j], &link.placing);
        let parent = link.antecedent.map(|a| &before[a].state);
        let state = match placing.joint {
            JointKind::Floating => link.state,
            joint => with_frame!(body, placing, motion, forward, tree, joint, parent),
        };
        load.wrench = match link.own {
            Own::Alone { .. } => on_last_axis(&state, &load.inertia),
            _ => Forces::of(&state).wrench(&load.inertia),
        };
        link.keep(&state);
    }
}

/// The same of a body before which nothing moves: only the moment about its axis matters.
#[inline(always)]
fn on_last_axis<T: Lift<f64>>(state: &BodyState<T>, inertia: &Inertia) -> Wrench<T> {
    let zero = T::lift(0.0);
    let moment = Forces::spinning(zero, state).moment(2, inertia);
    Wrench {
        f: [zero; 3],
        n: [zero, zero, moment],
    }
}

/// Wrenches from the tips to the base, and what of them the joints take.
#[inline(always)]
fn inward<T: Lift<f64>>(
    tree: &Tree<f64>,
    motion: &[JointMotion<T>],
    workspace: &DynamicsWorkspace<T>,
    loads: &mut [Load<T>],
    torques: &mut [T],
) {
    let links = workspace.links.iter().zip(motion).enumerate();
    for (j, (link, motion)) in links.rev() {
        let (body, placing) = (&tree.bodies[j], &link.placing);
        let (before, from_here) = loads.split_at_mut(j);
        let [load, ..] = from_here else { return };
        if let (JointKind::Floating, Some(row)) = (placing.joint, body.variable) {
            torques[row..row + 3].copy_from_slice(&load.wrench.f);
            torques[row + 3..row + 6].copy_from_slice(&load.wrench.n);
            continue;
        }
        let on = link.antecedent.map(|a| &mut before[a].wrench);
        let torque = with_frame!(
            body,
            placing,
            motion,
            hand_on,
            placing.joint,
            load.wrench,
            on
        );
        if let Some(row) = body.variable {
            torques[row] = match link.rotor {
                Some(squared) => {
                    (squared * motion.qdd).mul_add(T::lift(load.inertia.rotor), torque)
                }
                None => torque,
            };
        }
    }
}

/// Adds the wrench to that on the antecedent, and gives what of it the joint takes.
#[inline(always)]
fn hand_on<T: Scalar>(
    frame: &impl Frame<T>,
    joint: JointKind,
    wrench: Wrench<T>,
    antecedent: Option<&mut Wrench<T>>,
) -> T {
    if let Some(sum) = antecedent {
        let Wrench { f, n } = frame.inward(wrench);
        (sum.f, sum.n) = (add(sum.f, f), add(sum.n, n));
    }
    match joint {
        JointKind::Prismatic => frame.on_axis(wrench.f),
        _ => frame.on_axis(wrench.n),
    }
}
