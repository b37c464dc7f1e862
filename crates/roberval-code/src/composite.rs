//! The mass matrix by composite bodies (Walker and Orin 1982).
//!
//! A body and all that it carries are one composite body to the joint below it: its mass
//! moments go inward, joint by joint, and its momentum at unit velocity of that joint, seen
//! by a joint further in, is the entry of both. Second moments `S = tr(J)/2 - J` in place of
//! inertias: a shift by p adds `p ms' + ms p'` alone, and what lies along the axis is never
//! turned.

use roberval_mechanism::JointKind;
use roberval_regressor::{Body, JointMotion, Moments, Shape, Tree};
use roberval_scalar::vector::{Mat3, Vec3, add, apply, cross, dot, product, rotation_about, scale};

use crate::graph::Graph;
use crate::recorded::Recorded;
use crate::turns::{congruent, symmetric, turned_about, turns};

/// How momenta meet the joints further in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Meeting {
    /// Carried from body to body: cheap where geometry has zeros.
    Carried,
    /// In the frame of the first body, for all joints beyond the next: six multiplications
    /// each, whatever the geometry.
    Root,
}

/// Linear and angular momentum in a body's frame, about its origin; or a velocity, of its
/// origin and angular.
#[derive(Clone, Copy)]
struct Pair<'g> {
    linear: Vec3<Recorded<'g>>,
    angular: Vec3<Recorded<'g>>,
}

/// A body's place in the frame of the first body of its branch.
#[derive(Clone, Copy)]
struct Pose<'g> {
    rotation: Mat3<Recorded<'g>>,
    origin: Vec3<Recorded<'g>>,
}

/// A tree at a configuration.
pub(crate) struct Composite<'a, 'g> {
    pub graph: &'g Graph,
    pub tree: &'a Tree<Recorded<'g>>,
    pub shapes: &'a [Shape],
    pub motion: &'a [JointMotion<Recorded<'g>>],
}

impl<'g> Composite<'_, 'g> {
    /// The mass matrix of all joint variables, n x n: that of the bodies' own moments.
    pub fn mass_matrix(
        &self,
        own: &[Moments<Recorded<'g>>],
        meeting: Meeting,
    ) -> Vec<Vec<Recorded<'g>>> {
        let bodies = &self.tree.bodies;
        let mut composite = own.to_vec();
        for j in (0..bodies.len()).rev() {
            self.graph.set_link(j);
            if let Some(a) = bodies[j].antecedent {
                composite[a] = self.with(&composite[a], j, &composite[j]);
            }
        }
        let poses = self.poses();
        let n = self.tree.dof;
        let mut matrix = vec![vec![self.tree.constants.zero; n]; n];
        for j in (0..bodies.len()).rev() {
            self.graph.set_link(j);
            for (column, velocity) in self.velocities(j) {
                let momentum = self.momentum(&composite[j], velocity);
                let set = |row: usize, entry| {
                    matrix[row][column] = entry;
                    matrix[column][row] = entry;
                };
                self.meet(j, momentum, set, &poses, meeting);
            }
        }
        matrix
    }

    fn zeros(&self) -> Vec3<Recorded<'g>> {
        [self.tree.constants.zero; 3]
    }

    /// The unit velocities that a body's own variables give it.
    fn velocities(&self, j: usize) -> Vec<(usize, Pair<'g>)> {
        let (body, zero) = (&self.tree.bodies[j], self.zeros());
        let Some(first) = body.variable else {
            return Vec::new();
        };
        let (slide, turn) = (
            |linear| Pair {
                linear,
                angular: zero,
            },
            |angular| Pair {
                linear: zero,
                angular,
            },
        );
        match body.joint {
            JointKind::Floating => (0..6)
                .map(|k| {
                    let mut unit = zero;
                    unit[k % 3] = self.tree.constants.one;
                    (first + k, if k < 3 { slide(unit) } else { turn(unit) })
                })
                .collect(),
            JointKind::Prismatic => vec![(first, slide(body.axis))],
            _ => vec![(first, turn(body.axis))],
        }
    }

    /// `p = m v + w x ms`, `L = J w + ms x v`.
    fn momentum(&self, c: &Moments<Recorded<'g>>, velocity: Pair<'g>) -> Pair<'g> {
        let (v, w, s) = (velocity.linear, velocity.angular, &c.second);
        let inertia = [0, 1, 2].map(|i| {
            let mut row = s[i].map(|x| -x);
            row[i] = s[(i + 1) % 3][(i + 1) % 3] + s[(i + 2) % 3][(i + 2) % 3];
            row
        });
        Pair {
            linear: add(scale(v, c.mass), cross(w, c.first)),
            angular: add(apply(&inertia, w), cross(c.first, v)),
        }
    }

    /// Every entry that a momentum of body j makes: with its own joint and all further in.
    fn meet(
        &self,
        j: usize,
        mut momentum: Pair<'g>,
        mut set: impl FnMut(usize, Recorded<'g>),
        poses: &[Pose<'g>],
        meeting: Meeting,
    ) {
        let mut at = j;
        let mut steps = 0;
        loop {
            for (row, velocity) in self.velocities(at) {
                set(row, power(momentum, velocity));
            }
            let Some(a) = self.tree.bodies[at].antecedent else {
                return;
            };
            if meeting == Meeting::Root && steps == 1 {
                break;
            }
            momentum = self.in_antecedent(at, momentum);
            (at, steps) = (a, steps + 1);
        }
        let momentum = poses[at].momentum(momentum);
        while let Some(a) = self.tree.bodies[at].antecedent {
            for (row, velocity) in self.velocities(a) {
                set(row, power(momentum, poses[a].velocity(velocity)));
            }
            at = a;
        }
    }

    /// Momentum about the antecedent's origin, in its frame.
    fn in_antecedent(&self, j: usize, momentum: Pair<'g>) -> Pair<'g> {
        let body = &self.tree.bodies[j];
        let linear = self.turned(j, momentum.linear);
        let angular = self.turned(j, momentum.angular);
        let lever = cross(lever(body, &self.motion[j]), linear);
        Pair {
            linear,
            angular: add(angular, lever),
        }
    }

    /// A vector in the antecedent's frame.
    fn turned(&self, j: usize, v: Vec3<Recorded<'g>>) -> Vec3<Recorded<'g>> {
        let body = &self.tree.bodies[j];
        match body.joint {
            JointKind::Revolute => apply(&body.rotation, apply(&self.turn(j), v)),
            _ => apply(&body.rotation, v),
        }
    }

    /// The rotation of a revolute joint.
    fn turn(&self, j: usize) -> Mat3<Recorded<'g>> {
        let motion = &self.motion[j];
        rotation_about(
            self.tree.bodies[j].axis,
            motion.cos,
            motion.sin,
            motion.versine,
        )
    }

    fn poses(&self) -> Vec<Pose<'g>> {
        let (zero, one) = (self.tree.constants.zero, self.tree.constants.one);
        let identity = [[one, zero, zero], [zero, one, zero], [zero, zero, one]];
        let mut poses: Vec<Pose<'g>> = Vec::with_capacity(self.tree.bodies.len());
        for (j, body) in self.tree.bodies.iter().enumerate() {
            self.graph.set_link(j);
            poses.push(match body.antecedent.map(|a| &poses[a]) {
                None => Pose {
                    rotation: identity,
                    origin: [zero; 3],
                },
                Some(antecedent) => {
                    let before = product(&antecedent.rotation, &body.rotation);
                    let p = apply(&antecedent.rotation, lever(body, &self.motion[j]));
                    Pose {
                        rotation: match body.joint {
                            JointKind::Revolute => product(&before, &self.turn(j)),
                            _ => before,
                        },
                        origin: add(antecedent.origin, p),
                    }
                }
            });
        }
        poses
    }

    /// The composite of the antecedent with that of body j.
    fn with(
        &self,
        antecedent: &Moments<Recorded<'g>>,
        j: usize,
        carried: &Moments<Recorded<'g>>,
    ) -> Moments<Recorded<'g>> {
        let body = &self.tree.bodies[j];
        let second = self.turned_moments(j, &carried.second);
        let (first, mass) = (self.turned(j, carried.first), carried.mass);
        let p = lever(body, &self.motion[j]);
        let moved = add(first, scale(p, mass));
        let sum = |i: usize, k: usize| {
            let own = antecedent.second[i][k] + second[i][k];
            match p[i].value().and(p[k].value()) {
                // Numbers times masses are known before.
                Some(_) => own + p[i] * p[k] * mass + (p[i] * first[k] + p[k] * first[i]),
                None => own + (p[i] * moved[k] + p[k] * first[i]),
            }
        };
        Moments {
            second: symmetric(sum),
            first: add(antecedent.first, moved),
            mass: antecedent.mass + mass,
        }
    }

    /// Second moments in the antecedent's frame, about the body's origin.
    fn turned_moments(&self, j: usize, s: &Mat3<Recorded<'g>>) -> Mat3<Recorded<'g>> {
        let (body, shape, motion) = (&self.tree.bodies[j], self.shapes[j], &self.motion[j]);
        let s = match (body.joint, shape.along) {
            (JointKind::Revolute, None) => congruent(&self.turn(j), s),
            (JointKind::Revolute, Some(k)) => {
                turned_about(k, motion.cos, motion.sin * body.axis[k], s)
            }
            _ => *s,
        };
        if shape.right {
            return congruent(&body.rotation, &s);
        }
        let number = |x: f64| Recorded::constant(self.graph, x);
        let value = body
            .rotation
            .map(|row| row.map(|x| x.value().unwrap_or_default()));
        let turns = turns(&value).into_iter().rev();
        turns.fold(s, |s, (k, [cos, sin])| {
            turned_about(k, number(cos), number(sin), &s)
        })
    }
}

/// The power of a momentum's rate along a velocity.
fn power<'g>(momentum: Pair<'g>, velocity: Pair<'g>) -> Recorded<'g> {
    dot(velocity.linear, momentum.linear) + dot(velocity.angular, momentum.angular)
}

impl<'g> Pose<'g> {
    /// Momentum about the first body's origin, in its frame.
    fn momentum(&self, p: Pair<'g>) -> Pair<'g> {
        let linear = apply(&self.rotation, p.linear);
        let angular = apply(&self.rotation, p.angular);
        Pair {
            linear,
            angular: add(angular, cross(self.origin, linear)),
        }
    }

    /// Velocity of the body's point at the first body's origin, in its frame.
    fn velocity(&self, v: Pair<'g>) -> Pair<'g> {
        let linear = apply(&self.rotation, v.linear);
        let angular = apply(&self.rotation, v.angular);
        Pair {
            linear: add(linear, cross(self.origin, angular)),
            angular,
        }
    }
}

/// The body's origin in the antecedent's frame.
fn lever<'g>(body: &Body<Recorded<'g>>, motion: &JointMotion<Recorded<'g>>) -> Vec3<Recorded<'g>> {
    match body.joint {
        JointKind::Prismatic => add(
            body.origin,
            apply(&body.rotation, scale(body.axis, motion.q)),
        ),
        _ => body.origin,
    }
}
