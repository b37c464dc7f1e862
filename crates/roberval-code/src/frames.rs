//! Other frames for the same robot, in which turns are short.
//!
//! A link may be placed by any rotation, which takes nine multiplications a vector. Frames as
//! Khalil and Kleinfinger choose them leave a turn about x, of four: z along the joint's
//! axis, x at right angles to the next one's; the angle between both x is the joint's.

use roberval_mechanism::JointKind;
use roberval_regressor::{Body, Tree};
use roberval_scalar::vector::{Mat3, Vec3, apply, apply_transposed, product};

/// Entries of rotations this near to 0 and 1 are that: a few roundings.
const ROUNDING: f64 = 1e-15;

/// A robot in such frames.
pub(crate) struct Frames {
    pub tree: Tree<f64>,
    /// Rotation from each body's new frame to its old one.
    pub rotations: Vec<Mat3<f64>>,
    /// What the angle of each body's joint has more in the new frames.
    pub offsets: Vec<f64>,
}

impl Frames {
    /// The frames of a tree.
    pub fn of(tree: &Tree<f64>) -> Self {
        let (first, gammas) = along_axes(tree);
        let offsets = offsets(tree, &gammas);
        let rotations: Vec<_> = first
            .iter()
            .zip(&offsets)
            .map(|(rotation, angle)| snapped(product(rotation, &about_z(*angle))))
            .collect();
        let body = |(j, body): (usize, &Body<f64>)| {
            let antecedent = body.antecedent.map_or(IDENTITY, |a| rotations[a]);
            // The joint turns by the offset as well.
            let own = match body.joint {
                JointKind::Revolute => first[j],
                _ => rotations[j],
            };
            let rotation = product(&transposed(&antecedent), &product(&body.rotation, &own));
            Body {
                rotation: snapped(rotation),
                origin: apply_transposed(&antecedent, body.origin),
                axis: if body.joint.has_axis() { Z } else { body.axis },
                ..body.clone()
            }
        };
        let bodies = tree.bodies.iter().enumerate().map(body).collect();
        Self {
            tree: Tree {
                bodies,
                ..tree.clone()
            },
            rotations,
            offsets,
        }
    }
}

const IDENTITY: Mat3<f64> = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
const Z: Vec3<f64> = [0.0, 0.0, 1.0];

/// Frames with z along the axes and x at right angles to the antecedent's z, and the angle
/// about that z from the antecedent's x, of bodies that move.
fn along_axes(tree: &Tree<f64>) -> (Vec<Mat3<f64>>, Vec<f64>) {
    let (mut frames, mut gammas) = (Vec::new(), Vec::new());
    for body in &tree.bodies {
        let antecedent: Mat3<f64> = body.antecedent.map_or(IDENTITY, |a| frames[a]);
        let back = transposed(&body.rotation);
        let as_antecedent = product(&back, &antecedent);
        let (frame, gamma) = match body.joint {
            JointKind::Floating => (IDENTITY, 0.0),
            JointKind::Fixed => (as_antecedent, 0.0),
            JointKind::Revolute | JointKind::Prismatic => {
                let axis = apply_transposed(&antecedent, apply(&body.rotation, body.axis));
                let (turn, gamma) = onto(axis);
                (product(&as_antecedent, &turn), gamma)
            }
        };
        frames.push(frame);
        gammas.push(gamma);
    }
    (frames, gammas)
}

/// The turn about z by gamma, then about x, that brings z along an axis.
fn onto([x, y, z]: Vec3<f64>) -> (Mat3<f64>, f64) {
    // Of the two ways the one with gamma between -90 and 90 degrees.
    let sin = if y > 0.0 { -x.hypot(y) } else { x.hypot(y) };
    let (cos_gamma, sin_gamma) = match sin.abs() > ROUNDING {
        true => (-y / sin, x / sin),
        false => (1.0, 0.0),
    };
    let about_x = [[1.0, 0.0, 0.0], [0.0, z, -sin], [0.0, sin, z]];
    let gamma = sin_gamma.atan2(cos_gamma);
    (product(&about_z(gamma), &about_x), gamma)
}

/// Each revolute joint's x is turned on to the x of the next joint, the first if there are
/// several; what is fixed to a body turns with it.
fn offsets(tree: &Tree<f64>, gammas: &[f64]) -> Vec<f64> {
    let bodies = &tree.bodies;
    let mut offsets: Vec<Option<f64>> = vec![None; bodies.len()];
    for (j, body) in bodies
        .iter()
        .enumerate()
        .filter(|(_, b)| b.joint.has_axis())
    {
        let mut carrier = body.antecedent;
        while let Some(a) = carrier.filter(|&a| bodies[a].joint == JointKind::Fixed) {
            carrier = bodies[a].antecedent;
        }
        if let Some(a) = carrier.filter(|&a| bodies[a].joint == JointKind::Revolute) {
            offsets[a].get_or_insert(gammas[j]);
        }
    }
    for (j, body) in bodies.iter().enumerate() {
        if body.joint == JointKind::Fixed {
            offsets[j] = body.antecedent.and_then(|a| offsets[a]);
        }
    }
    offsets.into_iter().map(Option::unwrap_or_default).collect()
}

fn about_z(angle: f64) -> Mat3<f64> {
    let (s, c) = angle.sin_cos();
    [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]
}

fn transposed(a: &Mat3<f64>) -> Mat3<f64> {
    [0, 1, 2].map(|i| [0, 1, 2].map(|k| a[k][i]))
}

fn snapped(a: Mat3<f64>) -> Mat3<f64> {
    a.map(|row| {
        row.map(|x| match x {
            x if (x - x.round()).abs() <= ROUNDING => x.round(),
            x => x,
        })
    })
}
