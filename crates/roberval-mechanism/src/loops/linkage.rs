//! Where the links of a tree are, and how far its loops are from being closed.

use roberval_scalar::vector::{
    Mat3, Vec3, add, apply, cross, dot, product, rotation_about, scale, sub,
};
use roberval_scalar::{Real, Scalar};

use super::{Condition, CoupleLaw, Cut};
use crate::JointKind;

/// A placement: the point x of the placed frame is at `rotation x + origin`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose<T> {
    /// Its columns are the axes.
    pub rotation: Mat3<T>,
    /// In units of [`Linkage::unit`].
    pub origin: Vec3<T>,
}

impl<T: Scalar> Pose<T> {
    /// This placement, then another on it.
    #[must_use]
    pub fn then(&self, next: &Self) -> Self {
        Self {
            rotation: product(&self.rotation, &next.rotation),
            origin: add(self.origin, apply(&self.rotation, next.origin)),
        }
    }

    /// The axis x, y, z = 0, 1, 2.
    #[must_use]
    pub fn axis(&self, k: usize) -> Vec3<T> {
        self.rotation.map(|row| row[k])
    }
}

/// A link's constants.
#[derive(Debug, Clone, PartialEq)]
pub struct LinkFrame<T> {
    /// Index of the antecedent; `None` is the base.
    pub antecedent: Option<usize>,
    /// What the joint allows.
    pub joint: JointKind,
    /// Its place on the antecedent at joint variable 0.
    pub pose: Pose<T>,
    /// The joint's unit axis in the link's frame.
    pub axis: Vec3<T>,
}

/// A loop's constants.
#[derive(Debug, Clone, PartialEq)]
pub struct LoopFrames<T> {
    /// The links A and B; `None` is the base.
    pub links: [Option<usize>; 2],
    /// The frames on them.
    pub poses: [Pose<T>; 2],
    /// What the cut joint allows.
    pub cut: Cut,
}

/// A tree of links, antecedents first, with loops to be closed. All lengths, variables of
/// prismatic joints included, are in units of one length, so that equations of positions
/// and of directions compare.
#[derive(Debug, Clone, PartialEq)]
pub struct Linkage<T> {
    links: Vec<LinkFrame<T>>,
    loops: Vec<LoopFrames<T>>,
    couples: Vec<CoupleLaw<T>>,
    unit: f64,
    /// 0 and 1.
    numbers: [T; 2],
    /// The link of each joint variable.
    joints: Vec<usize>,
    /// For each loop, the variables that move one side against the other, and whether
    /// they move B.
    between: Vec<Vec<(usize, bool)>>,
}

/// A linkage at one place: links, joints and cut frames in the base frame.
#[derive(Debug, Clone)]
pub struct Configuration<'a, T> {
    linkage: &'a Linkage<T>,
    q: Vec<T>,
    poses: Vec<Pose<T>>,
    /// The two frames of each loop.
    frames: Vec<[Pose<T>; 2]>,
}

/// How a point fixed in a body, or its frame, moves: velocities and the accelerations that
/// they cause while no joint accelerates.
#[derive(Clone, Copy)]
struct Rates<T> {
    w: Vec3<T>,
    dw: Vec3<T>,
    v: Vec3<T>,
    a: Vec3<T>,
}

impl<T: Real> Linkage<T> {
    /// A linkage whose lengths are in metres, to be measured in `unit` metres (a power of
    /// two, so that nothing is rounded).
    #[must_use]
    pub fn new(
        mut links: Vec<LinkFrame<T>>,
        mut loops: Vec<LoopFrames<T>>,
        couples: Vec<CoupleLaw<T>>,
        unit: f64,
    ) -> Self {
        let per_unit = T::from(1.0 / unit);
        let shrink = |pose: &mut Pose<T>| pose.origin = scale(pose.origin, per_unit);
        links.iter_mut().for_each(|l| shrink(&mut l.pose));
        loops
            .iter_mut()
            .for_each(|l| l.poses.iter_mut().for_each(shrink));
        let one_dof = |l: &&LinkFrame<T>| l.joint != JointKind::Fixed;
        let lengths: Vec<bool> = links
            .iter()
            .filter(one_dof)
            .map(|l| l.joint == JointKind::Prismatic)
            .collect();
        let in_units = |k: usize| T::from(if lengths[k] { unit } else { 1.0 });
        let couples = couples.into_iter().map(|c| c.in_units(in_units)).collect();
        let numbers = [T::from(0.0), T::from(1.0)];
        Self {
            unit,
            ..Self::of_numbers(links, loops, couples, numbers)
        }
    }

    /// The linkage at these joint variables.
    #[must_use]
    pub fn at(&self, q_all: &[T]) -> Configuration<'_, T> {
        self.placed(q_all, |variable, link| {
            let (cos, sin) = match link.joint {
                JointKind::Prismatic => (T::from(1.0), T::from(0.0)),
                _ => q_all[variable].cos_sin(),
            };
            link.moved(q_all[variable], [cos, sin, T::from(1.0) - cos])
        })
    }
}

impl<T: Scalar> Linkage<T> {
    /// A linkage in numbers whose 0 and 1 are given, its lengths as they are.
    #[must_use]
    pub fn of_numbers(
        links: Vec<LinkFrame<T>>,
        loops: Vec<LoopFrames<T>>,
        couples: Vec<CoupleLaw<T>>,
        numbers: [T; 2],
    ) -> Self {
        let moves = |l: &usize| links[*l].joint != JointKind::Fixed;
        let joints: Vec<usize> = (0..links.len()).filter(moves).collect();
        let path = |link: Option<usize>| std::iter::successors(link, |l| links[*l].antecedent);
        let between = |l: &LoopFrames<T>| {
            let mut side = vec![0_i8; links.len()];
            path(l.links[0]).for_each(|l| side[l] -= 1);
            path(l.links[1]).for_each(|l| side[l] += 1);
            let variables = joints.iter().enumerate();
            let apart = variables.filter(|(_, l)| side[**l] != 0);
            apart.map(|(k, l)| (k, side[*l] > 0)).collect()
        };
        let between = loops.iter().map(between).collect();
        Self {
            links,
            loops,
            couples,
            unit: 1.0,
            numbers,
            joints,
            between,
        }
    }

    /// The unit of length, m.
    #[must_use]
    pub fn unit(&self) -> f64 {
        self.unit
    }

    /// Number of joint variables n.
    #[must_use]
    pub fn dof(&self) -> usize {
        self.joints.len()
    }

    /// Number of equations, redundant ones included.
    #[must_use]
    pub fn equations(&self) -> usize {
        let loops = self.loops.iter().map(|l| l.cut.conditions().len());
        loops.sum::<usize>() + self.couples.len()
    }

    /// Whether a variable is a length, in units of [`Linkage::unit`].
    #[must_use]
    pub fn is_length(&self, variable: usize) -> bool {
        self.links[self.joints[variable]].joint == JointKind::Prismatic
    }

    /// Whether a variable is part of some loop or couple.
    #[must_use]
    pub fn is_constrained(&self, variable: usize) -> bool {
        self.between.iter().flatten().any(|(k, _)| *k == variable)
            || self.couples.iter().any(|c| c.has(variable))
    }

    /// The variables that move one side of a loop against the other, and whether they move
    /// B.
    #[must_use]
    pub fn between(&self, number: usize) -> &[(usize, bool)] {
        &self.between[number]
    }

    /// The constants of the loops.
    #[must_use]
    pub fn loops(&self) -> &[LoopFrames<T>] {
        &self.loops
    }

    /// The linkage with each moving link placed on its antecedent by its variable.
    pub fn placed(
        &self,
        q: &[T],
        mut moved: impl FnMut(usize, &LinkFrame<T>) -> Pose<T>,
    ) -> Configuration<'_, T> {
        let mut poses: Vec<Pose<T>> = Vec::with_capacity(self.links.len());
        let mut variable = 0;
        for link in &self.links {
            let mut pose = link.pose;
            if link.joint != JointKind::Fixed {
                pose = moved(variable, link);
                variable += 1;
            }
            poses.push(match link.antecedent {
                None => pose,
                Some(a) => poses[a].then(&pose),
            });
        }
        let frame = |link: Option<usize>, pose: &Pose<T>| match link {
            None => *pose,
            Some(link) => poses[link].then(pose),
        };
        let frames = |l: &LoopFrames<T>| [0, 1].map(|s| frame(l.links[s], &l.poses[s]));
        Configuration {
            linkage: self,
            q: q.to_vec(),
            frames: self.loops.iter().map(frames).collect(),
            poses,
        }
    }
}

impl<T: Scalar> LinkFrame<T> {
    /// Its place on the antecedent: slid by q, or turned by an angle of this cosine, sine
    /// and versine (divided by the length of the axis and its square).
    #[must_use]
    pub fn moved(&self, q: T, [cos, sin, versine]: [T; 3]) -> Pose<T> {
        let Pose { rotation, origin } = self.pose;
        if self.joint == JointKind::Prismatic {
            let origin = add(origin, apply(&rotation, scale(self.axis, q)));
            return Pose { rotation, origin };
        }
        let turn = rotation_about(self.axis, cos, sin, versine);
        Pose {
            rotation: product(&rotation, &turn),
            origin,
        }
    }
}

impl<T: Real> Configuration<'_, T> {
    /// The largest residual, m or rad.
    #[must_use]
    pub fn gap(&self) -> f64 {
        let loops = self.linkage.loops.iter();
        let conditions = loops.flat_map(|l| l.cut.conditions());
        let units = conditions.map(|condition| match condition {
            Condition::Point(_) => self.linkage.unit,
            Condition::Axes(..) => 1.0,
        });
        let units = units.chain(std::iter::repeat(1.0));
        let sizes = self.residual().into_iter().zip(units);
        sizes.fold(0.0, |m, (x, unit)| m.max(x.to_f64().abs() * unit))
    }

    /// Whether the axes that must point the same way do, where the equations only make
    /// them parallel.
    #[must_use]
    pub fn is_aligned(&self) -> bool {
        let mut each = self.linkage.loops.iter().zip(&self.frames);
        let same = |a: &Pose<T>, b: &Pose<T>, k| dot(a.axis(k), b.axis(k)).to_f64() > 0.0;
        each.all(|(l, [a, b])| l.cut.aligned().iter().all(|&k| same(a, b, k)))
    }
}

impl<T: Scalar> Configuration<'_, T> {
    /// What each equation is off by, loop after loop.
    #[must_use]
    pub fn residual(&self) -> Vec<T> {
        let each = self.linkage.loops.iter().zip(&self.frames);
        each.flat_map(|(l, [a, b])| {
            l.cut.conditions().iter().map(|condition| match *condition {
                Condition::Point(u) => dot(a.axis(u), sub(b.origin, a.origin)),
                Condition::Axes(u, w) => dot(a.axis(u), b.axis(w)),
            })
        })
        .chain(self.linkage.couples.iter().map(|c| c.residual(&self.q)))
        .collect()
    }

    /// J: the derivatives of the residual, a row of n numbers an equation. A joint turns B
    /// against A (or A against B) about its axis e through the point p.
    #[must_use]
    pub fn jacobian(&self) -> Vec<Vec<T>> {
        let linkage = self.linkage;
        let [zero, one] = linkage.numbers;
        let mut rows = Vec::with_capacity(linkage.equations());
        for ((l, between), [a, b]) in linkage.loops.iter().zip(&linkage.between).zip(&self.frames) {
            for condition in l.cut.conditions() {
                let mut row = vec![zero; linkage.dof()];
                for &(k, moves_b) in between {
                    let (e, p) = self.joint(k);
                    let arm = sub(b.origin, p);
                    let rate = match (*condition, linkage.is_length(k)) {
                        (Condition::Point(u), true) => dot(a.axis(u), e),
                        (Condition::Point(u), false) => dot(a.axis(u), cross(e, arm)),
                        (Condition::Axes(..), true) => zero,
                        (Condition::Axes(u, w), false) => dot(a.axis(u), cross(e, b.axis(w))),
                    };
                    row[k] = if moves_b { rate } else { -rate };
                }
                rows.push(row);
            }
        }
        let dof = linkage.dof();
        rows.extend(
            linkage
                .couples
                .iter()
                .map(|c| c.derivative(dof, [zero, one])),
        );
        rows
    }

    /// The axis of a joint and a point on it.
    #[must_use]
    pub fn joint(&self, variable: usize) -> (Vec3<T>, Vec3<T>) {
        let link = self.linkage.joints[variable];
        let pose = &self.poses[link];
        (
            apply(&pose.rotation, self.linkage.links[link].axis),
            pose.origin,
        )
    }

    /// The two frames of a loop.
    #[must_use]
    pub fn frames(&self, number: usize) -> &[Pose<T>; 2] {
        &self.frames[number]
    }

    /// Jdot qd: the second derivatives of the residual while no joint accelerates.
    #[must_use]
    pub fn bias(&self, qd: &[T]) -> Vec<T> {
        let zero = self.linkage.numbers[0];
        let rates = self.rates(qd);
        let each = self.linkage.loops.iter().zip(&self.frames);
        each.flat_map(|(l, [a, b])| {
            let of = |side: usize, pose: &Pose<T>| match l.links[side] {
                None => Rates::still(zero),
                Some(link) => rates[link].at(sub(pose.origin, self.poses[link].origin)),
            };
            let (ra, rb) = (of(0, a), of(1, b));
            l.cut
                .conditions()
                .iter()
                .map(move |condition| match *condition {
                    Condition::Point(u) => ra.product_bias(
                        a.axis(u),
                        [sub(b.origin, a.origin), sub(rb.v, ra.v), sub(rb.a, ra.a)],
                    ),
                    Condition::Axes(u, w) => ra.product_bias(a.axis(u), rb.of_axis(b.axis(w))),
                })
        })
        .chain(self.linkage.couples.iter().map(|_| zero))
        .collect()
    }

    /// The rates of all links' origins.
    fn rates(&self, qd: &[T]) -> Vec<Rates<T>> {
        let links = &self.linkage.links;
        let zero = self.linkage.numbers[0];
        let mut rates: Vec<Rates<T>> = Vec::with_capacity(links.len());
        let mut variable = 0;
        for (link, pose) in links.iter().zip(&self.poses) {
            let (before, base) = match link.antecedent {
                None => (Rates::still(zero), [zero; 3]),
                Some(a) => (rates[a], self.poses[a].origin),
            };
            let mut now = before.at(sub(pose.origin, base));
            if link.joint != JointKind::Fixed {
                let velocity = scale(self.joint(variable).0, qd[variable]);
                now.joint(link.joint, velocity);
                variable += 1;
            }
            rates.push(now);
        }
        rates
    }
}

impl<T: Scalar> Rates<T> {
    fn still(zero: T) -> Self {
        let zero = [zero; 3];
        Self {
            w: zero,
            dw: zero,
            v: zero,
            a: zero,
        }
    }

    /// The same body at a point r away.
    fn at(&self, r: Vec3<T>) -> Self {
        let turning = cross(self.w, r);
        Self {
            v: add(self.v, turning),
            a: add(self.a, add(cross(self.dw, r), cross(self.w, turning))),
            ..*self
        }
    }

    /// Adds a joint's velocity along its axis, which turns with the body before it.
    fn joint(&mut self, kind: JointKind, velocity: Vec3<T>) {
        let carried = cross(self.w, velocity);
        if kind == JointKind::Prismatic {
            self.v = add(self.v, velocity);
            self.a = add(self.a, add(carried, carried));
        } else {
            self.w = add(self.w, velocity);
            self.dw = add(self.dw, carried);
        }
    }

    /// A direction fixed in the body with its first and second derivatives.
    fn of_axis(&self, u: Vec3<T>) -> [Vec3<T>; 3] {
        let du = cross(self.w, u);
        [u, du, add(cross(self.dw, u), cross(self.w, du))]
    }

    /// The second derivative of u . x, with u fixed in the body and the derivatives of x
    /// given.
    fn product_bias(&self, u: Vec3<T>, x: [Vec3<T>; 3]) -> T {
        let u = self.of_axis(u);
        let middle = dot(u[1], x[1]);
        dot(u[2], x[0]) + middle + middle + dot(u[0], x[2])
    }
}
