//! From the antecedent's frame to a body's: any placement, or the one of right angles,
//! whose zeros and ones are never multiplied by.

use roberval_mechanism::JointKind;
use roberval_scalar::{Lift, Scalar};

use crate::vector::{
    Mat3, Vec3, add, apply, apply_transposed, cross, dot, lift3, lift9, product, scale,
};
use crate::{Body, JointMotion};

/// What is known of a body's placement beyond its numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Layout {
    /// Any rotation about any axis.
    #[default]
    General,
    /// Right angles.
    Aligned(Aligned),
}

/// A joint axis along an axis of either frame, the other axes then being quarter turns
/// apart: with the axes renamed in turn (x, y, z to y, z, x), the rotation is
/// `diag(1, +-1, +-1) Rot(z, q + quarters pi/2)`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Aligned {
    /// The axis of the body's frame along which the joint's axis lies.
    pub axis: usize,
    /// The axis of the antecedent's frame parallel to it.
    pub onto: usize,
    /// Whether these two are opposite.
    pub flip: bool,
    /// Whether the joint's axis points against the axis of the body's frame.
    pub reversed: bool,
    /// Quarter turns about the axis.
    pub quarters: u8,
    /// Bit k: whether the origin has a component along the antecedent's axis
    /// `onto + 1 + k`, at some joint position.
    pub offsets: u8,
}

impl Layout {
    /// The layout of a body given in floats.
    #[must_use]
    pub fn of(
        joint: JointKind,
        rotation: &Mat3<f64>,
        origin: &Vec3<f64>,
        axis: &Vec3<f64>,
    ) -> Self {
        let along = match joint {
            JointKind::Fixed | JointKind::Floating => Some(2),
            _ => (0..3).find(|&k| {
                axis[k].abs() == 1.0 && turned(k).iter().all(|&i| axis[i] == 0.0 || i == k)
            }),
        };
        let right = rotation
            .iter()
            .flatten()
            .all(|x| [0.0, 1.0, -1.0].contains(x));
        let (Some(along), true) = (along, right) else {
            return Self::General;
        };
        let Some(onto) = (0..3).find(|&i| rotation[i][along] != 0.0) else {
            return Self::General;
        };
        let ([i, j, _], [k, _, _]) = (turned(onto), turned(along));
        let flip = rotation[onto][along] < 0.0;
        let (cos, sin) = (
            rotation[i][k],
            if flip {
                -rotation[j][k]
            } else {
                rotation[j][k]
            },
        );
        let quarters = match (cos > 0.0, cos < 0.0, sin > 0.0) {
            (true, _, _) => 0,
            (_, true, _) => 2,
            (_, _, true) => 1,
            _ => 3,
        };
        let slides = joint == JointKind::Prismatic;
        let offsets = turned(onto)
            .into_iter()
            .enumerate()
            .filter(|&(bit, i)| origin[i] != 0.0 || (bit == 2 && slides))
            .fold(0, |bits, (bit, _)| bits | 1 << bit);
        Self::Aligned(Aligned {
            axis: along,
            onto,
            flip,
            reversed: axis[along] < 0.0,
            quarters,
            offsets,
        })
    }
}

/// The axes that follow axis k in turn, then k itself.
#[inline(always)]
fn turned(k: usize) -> [usize; 3] {
    match k {
        0 => [1, 2, 0],
        1 => [2, 0, 1],
        _ => [0, 1, 2],
    }
}

/// A body's frame with its joint moved: R is the rotation to the antecedent's frame, p
/// the origin in it.
///
/// Each frame takes the antecedent's vectors in its own order of components.
pub(crate) trait Frame<T: Scalar> {
    /// A vector of the antecedent in this order.
    fn take(&self, v: &Vec3<T>) -> Vec3<T>;
    /// A vector of this frame in its usual order.
    fn give(&self, v: Vec3<T>, to: &mut Vec3<T>);
    /// R' v
    fn turn(&self, v: Vec3<T>) -> Vec3<T>;
    /// `v + e x p`
    fn carry(&self, v: Vec3<T>, e: Vec3<T>) -> Vec3<T>;
    /// a + U p, U as the antecedent has it.
    fn at_origin(&self, a: Vec3<T>, u: &Mat3<T>) -> Vec3<T>;
    /// h + g . p
    fn rise(&self, h: T, g: Vec3<T>) -> T;
    /// v + s times the joint's axis.
    fn along_axis(&self, v: Vec3<T>, s: T) -> Vec3<T>;
    /// `v + s (w x axis)`
    fn across_axis(&self, v: Vec3<T>, w: Vec3<T>, s: T) -> Vec3<T>;
}

/// Any placement.
pub(crate) struct General<T> {
    rotation: Mat3<T>,
    origin: Vec3<T>,
    axis: Vec3<T>,
}

impl<T: Scalar> General<T> {
    #[inline(always)]
    pub(crate) fn new<C: Copy>(body: &Body<C>, motion: &JointMotion<T>) -> Self
    where
        T: Lift<C>,
    {
        let (fixed, origin, axis) = (
            lift9(&body.rotation),
            lift3(&body.origin),
            lift3(&body.axis),
        );
        let (rotation, origin) = match body.joint {
            JointKind::Revolute => (product(&fixed, &motion.rotation(axis)), origin),
            JointKind::Prismatic => (fixed, add(origin, apply(&fixed, scale(axis, motion.q)))),
            JointKind::Fixed | JointKind::Floating => (fixed, origin),
        };
        Self {
            rotation,
            origin,
            axis,
        }
    }
}

impl<T: Scalar> Frame<T> for General<T> {
    #[inline(always)]
    fn take(&self, v: &Vec3<T>) -> Vec3<T> {
        *v
    }

    #[inline(always)]
    fn give(&self, v: Vec3<T>, to: &mut Vec3<T>) {
        *to = v;
    }

    #[inline(always)]
    fn turn(&self, v: Vec3<T>) -> Vec3<T> {
        apply_transposed(&self.rotation, v)
    }

    #[inline(always)]
    fn carry(&self, v: Vec3<T>, e: Vec3<T>) -> Vec3<T> {
        add(v, cross(e, self.origin))
    }

    #[inline(always)]
    fn at_origin(&self, a: Vec3<T>, u: &Mat3<T>) -> Vec3<T> {
        add(a, apply(u, self.origin))
    }

    #[inline(always)]
    fn rise(&self, h: T, g: Vec3<T>) -> T {
        h + dot(g, self.origin)
    }

    #[inline(always)]
    fn along_axis(&self, v: Vec3<T>, s: T) -> Vec3<T> {
        let a = self.axis;
        [
            a[0].mul_add(s, v[0]),
            a[1].mul_add(s, v[1]),
            a[2].mul_add(s, v[2]),
        ]
    }

    #[inline(always)]
    fn across_axis(&self, v: Vec3<T>, w: Vec3<T>, s: T) -> Vec3<T> {
        add(v, cross(w, scale(self.axis, s)))
    }
}

/// Right angles; which components of the origin are there and whether the axes are
/// opposite is known when this is compiled.
pub(crate) struct Right<T, const OFFSETS: u8, const FLIP: bool> {
    /// Cosine and sine of the whole turn, and minus the sine.
    c: T,
    s: T,
    minus_s: T,
    /// p in this frame's order; components not in OFFSETS are never looked at.
    p: Vec3<T>,
    /// See [`Aligned`].
    reversed: bool,
    from: [usize; 3],
    to: [usize; 3],
}

impl<T: Scalar, const OFFSETS: u8, const FLIP: bool> Right<T, OFFSETS, FLIP> {
    #[inline(always)]
    pub(crate) fn new<C: Copy>(body: &Body<C>, aligned: &Aligned, motion: &JointMotion<T>) -> Self
    where
        T: Lift<C>,
    {
        let (from, to) = (turned(aligned.onto), turned(aligned.axis));
        let origin: Vec3<T> = lift3(&body.origin);
        let mut p = [origin[from[0]], origin[from[1]], origin[from[2]]];
        let (mut c, mut s) = (motion.cos, motion.sin);
        match body.joint {
            JointKind::Revolute if aligned.reversed => s = -s,
            JointKind::Prismatic if aligned.reversed != FLIP => p[2] = p[2] - motion.q,
            JointKind::Prismatic => p[2] = p[2] + motion.q,
            JointKind::Revolute | JointKind::Fixed | JointKind::Floating => {}
        }
        (c, s) = match aligned.quarters {
            0 => (c, s),
            1 => (-s, c),
            2 => (-c, -s),
            _ => (s, -c),
        };
        Self {
            c,
            s,
            minus_s: -s,
            p,
            reversed: aligned.reversed,
            from,
            to,
        }
    }

    /// Whether p has component k.
    #[inline(always)]
    fn has(k: u8) -> bool {
        OFFSETS & (1 << k) != 0
    }
}

impl<T: Scalar, const OFFSETS: u8, const FLIP: bool> Frame<T> for Right<T, OFFSETS, FLIP> {
    #[inline(always)]
    fn take(&self, v: &Vec3<T>) -> Vec3<T> {
        [v[self.from[0]], v[self.from[1]], v[self.from[2]]]
    }

    #[inline(always)]
    fn give(&self, v: Vec3<T>, to: &mut Vec3<T>) {
        to[self.to[0]] = v[0];
        to[self.to[1]] = v[1];
        to[self.to[2]] = v[2];
    }

    #[inline(always)]
    fn turn(&self, v: Vec3<T>) -> Vec3<T> {
        let (c, s) = (self.c, self.s);
        if FLIP {
            let y = v[1].neg_mul_add(c, self.minus_s * v[0]);
            [v[1].neg_mul_add(s, c * v[0]), y, -v[2]]
        } else {
            let y = v[0].neg_mul_add(s, c * v[1]);
            [v[1].mul_add(s, c * v[0]), y, v[2]]
        }
    }

    #[inline(always)]
    fn carry(&self, v: Vec3<T>, e: Vec3<T>) -> Vec3<T> {
        let (mut v, p) = (v, self.p);
        if Self::has(0) {
            v[1] = e[2].mul_add(p[0], v[1]);
            v[2] = e[1].neg_mul_add(p[0], v[2]);
        }
        if Self::has(1) {
            v[2] = e[0].mul_add(p[1], v[2]);
            v[0] = e[2].neg_mul_add(p[1], v[0]);
        }
        if Self::has(2) {
            v[0] = e[1].mul_add(p[2], v[0]);
            v[1] = e[0].neg_mul_add(p[2], v[1]);
        }
        v
    }

    #[inline(always)]
    fn at_origin(&self, a: Vec3<T>, u: &Mat3<T>) -> Vec3<T> {
        let mut sum = a;
        for k in 0..3 {
            if Self::has(k as u8) {
                for (sum, &row) in sum.iter_mut().zip(&self.from) {
                    *sum = u[row][self.from[k]].mul_add(self.p[k], *sum);
                }
            }
        }
        sum
    }

    #[inline(always)]
    fn rise(&self, h: T, g: Vec3<T>) -> T {
        let mut sum = h;
        for k in 0..3 {
            if Self::has(k as u8) {
                sum = g[k].mul_add(self.p[k], sum);
            }
        }
        sum
    }

    #[inline(always)]
    fn along_axis(&self, v: Vec3<T>, s: T) -> Vec3<T> {
        let z = if self.reversed { v[2] - s } else { v[2] + s };
        [v[0], v[1], z]
    }

    #[inline(always)]
    fn across_axis(&self, v: Vec3<T>, w: Vec3<T>, s: T) -> Vec3<T> {
        let s = if self.reversed { -s } else { s };
        [w[1].mul_add(s, v[0]), w[0].neg_mul_add(s, v[1]), v[2]]
    }
}

/// Calls `$step(frame, arguments)` with the frame that fits the body's layout.
macro_rules! with_frame {
    ($body:expr, $motion:expr, $step:ident, $($argument:expr),*) => {
        with_frame!(@match $body, $motion, $step, [$($argument),*],
            0 1 2 3 4 5 6 7)
    };
    (@match $body:expr, $motion:expr, $step:ident, $arguments:tt, $($offsets:literal)*) => {
        match &$body.layout {
            Layout::General => with_frame!(@call $step, General::new($body, $motion), $arguments),
            Layout::Aligned(aligned) => match (aligned.offsets, aligned.flip) {
                $(
                    ($offsets, false) => with_frame!(@call $step,
                        Right::<_, $offsets, false>::new($body, aligned, $motion), $arguments),
                    ($offsets, true) => with_frame!(@call $step,
                        Right::<_, $offsets, true>::new($body, aligned, $motion), $arguments),
                )*
                // There are no other combinations of three bits.
                _ => with_frame!(@call $step, General::new($body, $motion), $arguments),
            },
        }
    };
    (@call $step:ident, $frame:expr, [$($argument:expr),*]) => {
        $step(&$frame, $($argument),*)
    };
}
pub(crate) use with_frame;

#[cfg(test)]
mod tests {
    use roberval_mechanism::{Mechanism, SourceFormat};
    use roberval_testkit::{Angles, Family};

    use super::*;
    use crate::{DenseRows, DynamicsWorkspace, EnergyWorkspace, Tree, dynamics, energy};

    /// Rounding of a few thousand operations, relative to the largest entry.
    const ROUNDING: f64 = 1e-14;

    fn rows(tree: &Tree<f64>, robot: &Mechanism, seed: f64) -> Vec<f64> {
        let space = &robot.parameters();
        let motion: Vec<_> = (0..tree.bodies.len())
            .map(|j| {
                let (q, qd, qdd) = (seed + j as f64, 2.0 - seed, seed - 0.3 * j as f64);
                match tree.bodies[j].joint {
                    JointKind::Revolute => JointMotion::revolute(q, qd, qdd),
                    _ => JointMotion::prismatic(q, qd, qdd),
                }
            })
            .collect();
        let mut rows = vec![0.0; (tree.dof + 1) * space.len()];
        let (d, h) = rows.split_at_mut(tree.dof * space.len());
        let mut sink = DenseRows { space, rows: d };
        dynamics(tree, &motion, &mut DynamicsWorkspace::new(tree), &mut sink);
        let mut sink = DenseRows { space, rows: h };
        energy(tree, &motion, &mut EnergyWorkspace::new(tree), &mut sink);
        rows
    }

    #[test]
    fn right_angles_need_no_other_recursion_than_any_angles() {
        let mut seen = std::collections::BTreeSet::new();
        for seed in 0..400 {
            let family = Family {
                angles: Angles::Right,
                format: [SourceFormat::Mdh, SourceFormat::Urdf][seed as usize % 2],
                ..Family::default()
            };
            let robot = Mechanism::new(&family.robot(seed)).expect("valid");
            let tree = Tree::of(&robot);
            let mut general = tree.clone();
            for body in &mut general.bodies {
                let Layout::Aligned(aligned) = body.layout else {
                    panic!("all angles of this family are right");
                };
                seen.insert((aligned.axis, aligned.onto, aligned.flip, aligned.quarters));
                body.layout = Layout::General;
            }
            let at = 0.1 * seed as f64;
            let (found, expected) = (rows(&tree, &robot, at), rows(&general, &robot, at));
            let largest = expected.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
            for (found, expected) in found.iter().zip(&expected) {
                let error = (found - expected).abs() / largest;
                assert!(error <= ROUNDING, "robot {seed}: {found} for {expected}");
            }
        }
        assert_eq!(seen.len(), 72, "3 axes onto 3, flipped or not, 4 turns");
    }
}
