//! Masses of bodies as moments, and what of them may be another body's.
//!
//! Mass on a revolute joint's axis belongs to either body that the joint connects; that of a
//! body which does not turn against its antecedent has the antecedent's turns. With the
//! second moments `S = tr(J)/2 - J` such parts are single numbers, which can be moved inward.

use roberval_mechanism::{JointKind, ParameterSpace};
use roberval_scalar::Scalar;

use crate::vector::{Mat3, Vec3, add, apply, product, scale};
use crate::{Body, Tree};

/// What about a body is zero or one, which a scalar cannot be asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shape {
    /// The coordinate axis along or against which a revolute joint's axis points.
    pub along: Option<usize>,
    /// Whether the constant rotation only permutes the axes and their signs.
    pub right: bool,
}

impl Shape {
    /// The shapes of a tree's bodies.
    #[must_use]
    pub fn of(tree: &Tree<f64>) -> Vec<Self> {
        let whole = |x: &f64| *x == 0.0 || x.abs() == 1.0;
        let shape = |body: &Body<f64>| Self {
            along: match body.joint {
                JointKind::Revolute => body.axis.iter().position(|x| x.abs() == 1.0),
                _ => None,
            },
            right: body.rotation.iter().flatten().all(whole),
        };
        tree.bodies.iter().map(shape).collect()
    }
}

/// The inertial parameters of a body as mass moments about its frame's origin.
#[derive(Debug, Clone, Copy)]
pub struct Moments<T> {
    /// Second moments: the integral of x x'.
    pub second: Mat3<T>,
    /// First moments.
    pub first: Vec3<T>,
    /// The mass.
    pub mass: T,
}

impl<T: Scalar> Moments<T> {
    /// Those of no mass.
    #[must_use]
    pub fn nothing(zero: T) -> Self {
        Self {
            second: [[zero; 3]; 3],
            first: [zero; 3],
            mass: zero,
        }
    }

    /// The moments of a tree's bodies whose parameters are `x`, one number a column of the
    /// space; with `regroup`, all that no motion can tell from the antecedent's is moved
    /// there.
    #[must_use]
    pub fn of(
        tree: &Tree<T>,
        shapes: &[Shape],
        (space, x): (&ParameterSpace, &[T]),
        regroup: bool,
    ) -> Vec<Self> {
        let constants = tree.constants;
        let of_body = |(j, body): (usize, &Body<T>)| match body.massless {
            true => Self::nothing(constants.zero),
            false => Self::of_parameters(&x[space.first_column(j)..][..10], constants.half),
        };
        let mut moments: Vec<Self> = tree.bodies.iter().enumerate().map(of_body).collect();
        for (j, body) in tree.bodies.iter().enumerate().rev().filter(|_| regroup) {
            let moved = moments[j].taken(body.joint, shapes[j].along, constants.zero);
            if let Some(antecedent) = body.antecedent {
                let moved = moved.in_antecedent(&body.rotation, body.origin);
                moments[antecedent] = moments[antecedent].plus(&moved);
            }
        }
        moments
    }

    /// From XX, XY, XZ, YY, YZ, ZZ, MX, MY, MZ, M.
    fn of_parameters(x: &[T], half: T) -> Self {
        let &[xx, xy, xz, yy, yz, zz, mx, my, mz, mass] = x else {
            unreachable!("ten parameters");
        };
        let half = |x: T| x * half;
        Self {
            second: [
                [half(yy + zz - xx), -xy, -xz],
                [-xy, half(xx + zz - yy), -yz],
                [-xz, -yz, half(xx + yy - zz)],
            ],
            first: [mx, my, mz],
            mass,
        }
    }

    /// Takes away what is the antecedent's as well, at whatever place of the joint.
    fn taken(&mut self, joint: JointKind, along: Option<usize>, zero: T) -> Self {
        let mut moved = Self::nothing(zero);
        let take = |from: &mut T, to: &mut T| std::mem::swap(from, to);
        match (joint, along) {
            (JointKind::Floating, _) => {}
            (JointKind::Fixed, _) => std::mem::swap(self, &mut moved),
            (JointKind::Prismatic, _) => std::mem::swap(&mut self.second, &mut moved.second),
            (JointKind::Revolute, along) => {
                take(&mut self.mass, &mut moved.mass);
                if let Some(k) = along {
                    take(&mut self.first[k], &mut moved.first[k]);
                    take(&mut self.second[k][k], &mut moved.second[k][k]);
                }
            }
        }
        moved
    }

    /// In the frame of the antecedent, whose origin is at -p: `S + p ms' + ms p' + m p p'`
    /// after turning.
    fn in_antecedent(&self, rotation: &Mat3<T>, p: Vec3<T>) -> Self {
        let first = apply(rotation, self.first);
        let moved = add(first, scale(p, self.mass));
        let second = product(rotation, &self.second).map(|row| apply(rotation, row));
        let entry = |i: usize, k: usize| second[i][k] + p[i] * moved[k] + first[i] * p[k];
        Self {
            second: std::array::from_fn(|i| {
                // One expression for both of a pair.
                std::array::from_fn(|k| entry(i.min(k), i.max(k)))
            }),
            first: moved,
            mass: self.mass,
        }
    }

    /// Of both together.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        let (a, b) = (&self.second, &other.second);
        Self {
            second: [0, 1, 2].map(|i| add(a[i], b[i])),
            first: add(self.first, other.first),
            mass: self.mass + other.mass,
        }
    }
}
