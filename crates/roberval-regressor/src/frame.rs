//! From the antecedent's frame to a body's: any placement, or the one of right angles,
//! whose zeros and ones are never multiplied by.

use roberval_mechanism::JointKind;
use roberval_scalar::{Lift, Scalar};

use crate::forces::{Wrench, acceleration_field};
use crate::layout::{Layout, ordered, usual};
use crate::vector::{
    Mat3, Vec3, add, apply, apply_transposed, cross, dot, lift3, lift9, negative, product, scale,
};
use crate::{Body, JointMotion, Tree};

/// How a body's frame lies in its antecedent's, each with its axes in its own order
/// ([`Layout::order`]).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Placing<T> {
    /// The number of the frame in [`with_frame`]; all above are any placement.
    pub frame: u8,
    /// What the joint allows.
    pub joint: JointKind,
    /// Order of the antecedent's axes, and of the body's.
    before: usize,
    pub order: usize,
    /// The origin, in the order of a frame at right angles.
    origin: Vec3<T>,
    /// See [`Aligned`].
    quarters: u8,
    reversed: bool,
    /// How the axis of the antecedent's joint lies, and whether it points against its own.
    pub near: Near,
    against: bool,
}

impl<T: Scalar> Placing<T> {
    /// The placing of each body.
    pub(crate) fn of<C: Copy>(tree: &Tree<C>) -> Vec<Self>
    where
        T: Lift<C>,
    {
        let of = |body: &Body<C>| Self::new(body, body.antecedent.map(|a| &tree.bodies[a]));
        tree.bodies.iter().map(of).collect()
    }

    fn new<C: Copy>(body: &Body<C>, antecedent: Option<&Body<C>>) -> Self
    where
        T: Lift<C>,
    {
        let before = antecedent.map_or(2, |a| a.layout.order());
        let any = Self {
            frame: u8::MAX,
            joint: body.joint,
            before,
            order: body.layout.order(),
            origin: lift3(&body.origin),
            quarters: 0,
            reversed: false,
            near: Near::Any,
            against: false,
        };
        let Layout::Aligned(aligned) = body.layout else {
            return any;
        };
        let onto = (aligned.onto + 3 - before) % 3;
        let offsets = match aligned.offsets {
            0 => 0,
            AXIAL => 1,
            _ => 2,
        };
        let turning = antecedent.filter(|a| a.joint == JointKind::Revolute);
        let its = match turning.map(|a| a.layout) {
            Some(Layout::Aligned(its)) => Some(its),
            _ => None,
        };
        Self {
            frame: (6 * onto + 2 * offsets) as u8 + u8::from(aligned.flip),
            origin: ordered(&any.origin, aligned.onto),
            quarters: aligned.quarters,
            reversed: aligned.reversed,
            near: match its {
                None => Near::Any,
                Some(_) if onto != 0 => Near::Crossed,
                Some(its) => Near::Parallel {
                    opposite: its.reversed != aligned.flip,
                },
            },
            against: its.is_some_and(|its| its.reversed),
            ..any
        }
    }
}

/// How the axis of the antecedent's turning joint lies to that of a body's joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Near {
    /// In any way.
    Any,
    /// At a right angle.
    Crossed,
    /// Parallel.
    Parallel {
        /// Whether it points against it.
        opposite: bool,
    },
}

/// A body's frame with its joint moved: R is the rotation to the antecedent's frame, p
/// the origin in it.
pub(crate) trait Frame<T: Scalar> {
    /// A vector of the antecedent with its axes as this frame wants them.
    fn take(&self, v: &Vec3<T>) -> Vec3<T>;
    /// R' v
    fn turn(&self, v: Vec3<T>) -> Vec3<T>;
    /// `v + e x p`
    fn carry(&self, v: Vec3<T>, e: Vec3<T>) -> Vec3<T>;
    /// a + U p, given the antecedent's w and dw.
    fn at_origin(&self, a: Vec3<T>, w: Vec3<T>, dw: Vec3<T>) -> Vec3<T>;
    /// h + g . p
    fn rise(&self, h: T, g: Vec3<T>) -> T;
    /// Velocity and acceleration of the joint, along [`Frame::along_axis`].
    fn rates(&self) -> (T, T);
    /// v + s times the joint's axis.
    fn along_axis(&self, v: Vec3<T>, s: T) -> Vec3<T>;
    /// `v + s (w x axis)`
    fn across_axis(&self, v: Vec3<T>, w: Vec3<T>, s: T) -> Vec3<T>;
    /// What v has along the joint's axis.
    fn on_axis(&self, v: Vec3<T>) -> T;
    /// The wrench on the antecedent, about its origin, with its axes in its own order.
    fn inward(&self, wrench: Wrench<T>) -> Wrench<T>;
    /// Whether the antecedent's joint has an axis at right angles to the joint's.
    fn is_near(&self) -> bool;
    /// Its screw: e in this frame and the origin's velocity.
    fn near(&self, zero: T, one: T) -> (Vec3<T>, Vec3<T>);
}

/// Any placement.
pub(crate) struct General<T> {
    rotation: Mat3<T>,
    origin: Vec3<T>,
    axis: Vec3<T>,
    rates: (T, T),
    /// Order of the antecedent's axes.
    order: usize,
}

impl<T: Scalar> General<T> {
    #[inline(always)]
    pub(crate) fn new<C: Copy>(
        body: &Body<C>,
        placing: &Placing<T>,
        motion: &JointMotion<T>,
    ) -> Self
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
            rates: (motion.qd, motion.qdd),
            order: placing.before,
        }
    }
}

impl<T: Scalar> Frame<T> for General<T> {
    #[inline(always)]
    fn take(&self, v: &Vec3<T>) -> Vec3<T> {
        usual(v, self.order)
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
    fn at_origin(&self, a: Vec3<T>, w: Vec3<T>, dw: Vec3<T>) -> Vec3<T> {
        add(a, apply(&acceleration_field(w, dw), self.origin))
    }

    #[inline(always)]
    fn rise(&self, h: T, g: Vec3<T>) -> T {
        h + dot(g, self.origin)
    }

    #[inline(always)]
    fn rates(&self) -> (T, T) {
        self.rates
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
    fn on_axis(&self, v: Vec3<T>) -> T {
        dot(self.axis, v)
    }

    #[inline(always)]
    fn inward(&self, Wrench { f, n }: Wrench<T>) -> Wrench<T> {
        let (f, n) = (apply(&self.rotation, f), apply(&self.rotation, n));
        let n = add(n, cross(self.origin, f));
        Wrench {
            f: ordered(&f, self.order),
            n: ordered(&n, self.order),
        }
    }

    #[inline(always)]
    fn is_near(&self) -> bool {
        false
    }

    #[inline(always)]
    fn near(&self, zero: T, _: T) -> (Vec3<T>, Vec3<T>) {
        // Not called: in any directions nothing is near.
        ([zero; 3], [zero; 3])
    }

    #[inline(always)]
    fn across_axis(&self, v: Vec3<T>, w: Vec3<T>, s: T) -> Vec3<T> {
        add(v, cross(w, scale(self.axis, s)))
    }
}

/// Bit of the offset along the joint's axis.
const AXIAL: u8 = 0b100;

/// Right angles. Which of the antecedent's axes is the joint's, which components the origin
/// may have and whether the axes are opposite is known when this is compiled.
pub(crate) struct Right<'a, T, const FRAME: u8> {
    /// Cosine and sine of the whole turn, and minus the sine.
    c: T,
    s: T,
    minus_s: T,
    /// p in this frame's order; components that it never has are not looked at.
    p: Vec3<T>,
    /// Along the last axis, whichever way the joint's points.
    rates: (T, T),
    placing: &'a Placing<T>,
}

impl<'a, T: Scalar, const FRAME: u8> Right<'a, T, FRAME> {
    /// Which of the antecedent's axes is parallel to the joint's: 0, its own joint's, the
    /// last; 1 and 2, the first and the second.
    const ONTO: usize = FRAME as usize / 6;
    /// See [`Aligned`].
    const OFFSETS: u8 = [0, AXIAL, 0b111][FRAME as usize / 2 % 3];
    const FLIP: bool = FRAME % 2 == 1;

    #[inline(always)]
    pub(crate) fn new(placing: &'a Placing<T>, motion: &JointMotion<T>) -> Self {
        let JointMotion {
            cos: mut c,
            sin: mut s,
            mut q,
            mut qd,
            mut qdd,
            ..
        } = *motion;
        if placing.reversed {
            // Against the last axis: along it backwards.
            (s, q, qd, qdd) = (-s, -q, -qd, -qdd);
        }
        let mut p = placing.origin;
        if placing.joint == JointKind::Prismatic {
            p[2] = if Self::FLIP { p[2] - q } else { p[2] + q };
        }
        (c, s) = match placing.quarters {
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
            rates: (qd, qdd),
            placing,
        }
    }

    /// Where the first of the antecedent's axes, in this frame's order, turns to, and its
    /// product with p.
    #[inline(always)]
    fn first(&self, zero: T) -> (Vec3<T>, Vec3<T>) {
        let ([x, y], p) = (self.turned_second(), &self.p);
        let mut v = [zero; 3];
        if Self::has(2) {
            (v[0], v[1]) = (-(x * p[2]), -(y * p[2]));
        }
        if Self::has(1) {
            v[2] = if Self::FLIP { -p[1] } else { p[1] };
        }
        ([self.c, self.minus_s, zero], v)
    }

    /// The same of the second axis.
    #[inline(always)]
    fn second(&self, zero: T) -> (Vec3<T>, Vec3<T>) {
        let ([x, y], p) = (self.turned_second(), &self.p);
        let mut v = [zero; 3];
        if Self::has(2) {
            (v[0], v[1]) = (self.c * p[2], self.minus_s * p[2]);
        }
        if Self::has(0) {
            v[2] = if Self::FLIP { p[0] } else { -p[0] };
        }
        ([x, y, zero], v)
    }

    /// The same of the third axis, which is parallel to the joint's.
    #[inline(always)]
    fn third(&self, zero: T, one: T) -> (Vec3<T>, Vec3<T>) {
        let ([x, y], p) = (self.turned_second(), &self.p);
        let mut v = [zero; 3];
        if Self::has(0) {
            (v[0], v[1]) = (x * p[0], y * p[0]);
        }
        if Self::has(1) {
            v[0] = self.c.neg_mul_add(p[1], v[0]);
            v[1] = self.s.mul_add(p[1], v[1]);
        }
        ([zero, zero, if Self::FLIP { -one } else { one }], v)
    }

    /// The first two components of the second axis, turned.
    #[inline(always)]
    fn turned_second(&self) -> [T; 2] {
        if Self::FLIP {
            [self.minus_s, -self.c]
        } else {
            [self.s, self.c]
        }
    }

    /// R v
    #[inline(always)]
    fn turn_back(&self, v: Vec3<T>) -> Vec3<T> {
        let (c, s) = (self.c, self.s);
        if Self::FLIP {
            // R is symmetric.
            return self.turn(v);
        }
        let y = v[0].mul_add(s, c * v[1]);
        [v[1].neg_mul_add(s, c * v[0]), y, v[2]]
    }

    /// Whether p has component k.
    #[inline(always)]
    fn has(k: u8) -> bool {
        Self::OFFSETS & (1 << k) != 0
    }
}

impl<T: Scalar, const FRAME: u8> Frame<T> for Right<'_, T, FRAME> {
    #[inline(always)]
    fn take(&self, v: &Vec3<T>) -> Vec3<T> {
        [
            v[Self::ONTO % 3],
            v[(Self::ONTO + 1) % 3],
            v[(Self::ONTO + 2) % 3],
        ]
    }

    #[inline(always)]
    fn turn(&self, v: Vec3<T>) -> Vec3<T> {
        let (c, s) = (self.c, self.s);
        if Self::FLIP {
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
    fn at_origin(&self, a: Vec3<T>, w: Vec3<T>, dw: Vec3<T>) -> Vec3<T> {
        let (u, mut sum) = (acceleration_field(w, dw), a);
        for k in 0..3 {
            if Self::has(k as u8) {
                for (row, sum) in u.iter().zip(&mut sum) {
                    *sum = row[k].mul_add(self.p[k], *sum);
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
    fn rates(&self) -> (T, T) {
        self.rates
    }

    #[inline(always)]
    fn along_axis(&self, v: Vec3<T>, s: T) -> Vec3<T> {
        [v[0], v[1], v[2] + s]
    }

    #[inline(always)]
    fn on_axis(&self, v: Vec3<T>) -> T {
        if self.placing.reversed { -v[2] } else { v[2] }
    }

    #[inline(always)]
    fn inward(&self, Wrench { f, n }: Wrench<T>) -> Wrench<T> {
        let (f, mut n, p) = (self.turn_back(f), self.turn_back(n), self.p);
        if Self::has(0) {
            n[1] = f[2].neg_mul_add(p[0], n[1]);
            n[2] = f[1].mul_add(p[0], n[2]);
        }
        if Self::has(1) {
            n[2] = f[0].neg_mul_add(p[1], n[2]);
            n[0] = f[2].mul_add(p[1], n[0]);
        }
        if Self::has(2) {
            n[0] = f[1].neg_mul_add(p[2], n[0]);
            n[1] = f[0].mul_add(p[2], n[1]);
        }
        let [f, n] = [f, n].map(|v| usual(&v, (Self::ONTO + 2) % 3));
        Wrench { f, n }
    }

    #[inline(always)]
    fn is_near(&self) -> bool {
        self.placing.near != Near::Any
    }

    #[inline(always)]
    fn near(&self, zero: T, one: T) -> (Vec3<T>, Vec3<T>) {
        let (e, v) = match Self::ONTO {
            // The antecedent's own axis is the last there, here it is the first.
            2 => self.first(zero),
            1 => self.second(zero),
            _ => self.third(zero, one),
        };
        match self.placing.against {
            true => (negative(e), negative(v)),
            false => (e, v),
        }
    }

    #[inline(always)]
    fn across_axis(&self, v: Vec3<T>, w: Vec3<T>, s: T) -> Vec3<T> {
        [w[1].mul_add(s, v[0]), w[0].neg_mul_add(s, v[1]), v[2]]
    }
}

/// Calls `$step(frame, arguments)` with the frame that fits the body's placing.
macro_rules! with_frame {
    ($body:expr, $placing:expr, $motion:expr, $step:ident, $($argument:expr),*) => {
        with_frame!(@of $body, $placing, $motion, $step, [$($argument),*],
            0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17)
    };
    (@of $body:expr, $placing:expr, $motion:expr, $step:ident, $arguments:tt,
     $($frame:literal)*) => {
        match $placing.frame {
            $(
                $frame => with_frame!(@call $step,
                    Right::<_, $frame>::new($placing, $motion), $arguments),
            )*
            _ => with_frame!(@call $step, General::new($body, $placing, $motion), $arguments),
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
    use crate::{DenseRows, DynamicsWorkspace, EnergyWorkspace, dynamics, energy};

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
            // Some bodies by the general recursion among others at right angles, and all.
            let mut mixed = tree.clone();
            for body in mixed.bodies.iter_mut().skip(seed as usize % 3).step_by(2) {
                body.layout = Layout::General;
            }
            let mut general = tree.clone();
            for body in &mut general.bodies {
                let Layout::Aligned(aligned) = body.layout else {
                    panic!("all angles of this family are right");
                };
                seen.insert((aligned.axis, aligned.onto, aligned.flip, aligned.quarters));
                body.layout = Layout::General;
            }
            let at = 0.1 * seed as f64;
            let expected = rows(&general, &robot, at);
            let largest = expected.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
            for tree in [&tree, &mixed] {
                for (found, expected) in rows(tree, &robot, at).iter().zip(&expected) {
                    let error = (found - expected).abs() / largest;
                    assert!(error <= ROUNDING, "robot {seed}: {found} for {expected}");
                }
            }
        }
        assert_eq!(seen.len(), 72, "3 axes onto 3, flipped or not, 4 turns");
    }
}
