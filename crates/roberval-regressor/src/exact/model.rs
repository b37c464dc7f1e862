use std::cell::Cell;

use roberval_mechanism::{
    Geometry, JointKind, LinkDescription, MdhGeometry, Mechanism, Origin, ParameterSpace,
};
use roberval_scalar::{Fp, Modulus, Quantity, SplitMix64};

use super::angles::{AngleOrder, Angles, Rotation};
use super::lengths::Lengths;
use crate::vector::{Mat3, Vec3, add, apply, dot, product, scale};
use crate::{
    Body, Constants, DenseRows, DynamicsWorkspace, EnergyWorkspace, JointMotion, Model, Tree,
    dynamics, energy,
};

/// A number of the description has no place in this field: try another prime.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum NotInField {
    /// The field has no such square root.
    #[error("a square root of the description is not in this prime field")]
    Root,
    /// A denominator of the description is zero in the field.
    #[error("a denominator of the description is zero in this prime field")]
    Inverse,
}

/// A robot in a prime field: gives regressor rows at random states.
#[derive(Debug, Clone)]
pub struct ExactModel<'m> {
    modulus: &'m Modulus,
    tree: Tree<Fp<'m>>,
    space: ParameterSpace,
    generic: Vec<String>,
    rotations: usize,
    roots: [Fp<'m>; 2],
    has_roots: bool,
}

impl<'m> ExactModel<'m> {
    /// The mechanism's description in this field. `modulus` must be -1 modulo `order`.
    /// Rational angles are taken `conjugate` times: 1 for the robot itself; a number that
    /// has no factor in common with `order` gives the robot whose square roots have other
    /// signs.
    ///
    /// # Errors
    /// [`NotInField`] if a square root or an inverse is missing: another prime has it.
    pub fn new(
        mechanism: &Mechanism,
        modulus: &'m Modulus,
        order: AngleOrder,
        conjugate: u64,
        seed: u64,
    ) -> Result<Self, NotInField> {
        let description = &mechanism.description;
        let mut random = SplitMix64::new(seed);
        let pi = modulus.random(&mut random);
        let mut build = Builder {
            angles: Angles::new(modulus, order, conjugate, random),
            lengths: Lengths {
                modulus,
                constants: &description.constants,
                pi,
                roots: Cell::new(false),
            },
            constants: Constants {
                zero: modulus.integer(0),
                one: modulus.integer(1),
                half: modulus.integer(2).inverse().ok_or(NotInField::Inverse)?,
            },
        };
        let mut dof = 0;
        let mut bodies = Vec::with_capacity(mechanism.links.len());
        for link in &mechanism.links {
            let variable = (link.joint != JointKind::Fixed).then_some(dof);
            dof += usize::from(variable.is_some());
            let written = &description.links[link.in_file];
            bodies.push(build.body(written, link.antecedent, variable)?);
        }
        Ok(Self {
            modulus,
            tree: Tree {
                bodies,
                gravity: build.vector(&description.gravity)?,
                constants: build.constants,
                dof,
            },
            space: mechanism.parameters(),
            roots: build.angles.roots(),
            has_roots: build.lengths.roots.get(),
            generic: build.angles.generic_texts,
            rotations: build.angles.generic_rotations,
        })
    }

    /// The field.
    #[must_use]
    pub fn modulus(&self) -> &'m Modulus {
        self.modulus
    }

    /// The robot's constants in the field.
    #[must_use]
    pub fn tree(&self) -> &Tree<Fp<'m>> {
        &self.tree
    }

    /// The angles that stand for generic ones, as written.
    #[must_use]
    pub fn generic(&self) -> &[String] {
        &self.generic
    }

    /// The square root of 2 that the angles mean by cos 45 degrees.
    #[must_use]
    pub fn sqrt2(&self) -> Fp<'m> {
        self.roots[0]
    }

    /// The square root of 3 that the angles mean by cos 30 degrees.
    #[must_use]
    pub fn sqrt3(&self) -> Fp<'m> {
        self.roots[1]
    }

    /// Whether numbers of the description have square roots that are no fractions.
    #[must_use]
    pub fn has_roots(&self) -> bool {
        self.has_roots
    }

    /// An upper bound of the degree of a row's entries, denominators cleared, in the
    /// random values: a rotation enters at most three times, twice by `w x w` and once by
    /// transport, each with degree 2 in its half-angle tangent; velocities add 2.
    #[must_use]
    pub fn degree(&self) -> usize {
        6 * (self.tree.dof + self.rotations) + 2
    }

    /// Fills `rows` (rows of a sample x C) at a random state. Rows of h are not yet
    /// differences.
    ///
    /// # Panics
    /// If `rows` does not have this size.
    pub fn fill(
        &self,
        model: Model,
        random: &mut SplitMix64,
        work: &mut ExactWorkspace<'m>,
        rows: &mut [Fp<'m>],
    ) {
        rows.fill(self.tree.constants.zero);
        work.motion.clear();
        for body in &self.tree.bodies {
            work.motion.push(self.motion(body, model, random));
        }
        let mut sink = DenseRows {
            space: &self.space,
            rows,
        };
        match model {
            Model::D | Model::D0 => {
                dynamics(&self.tree, &work.motion, &mut work.dynamics, &mut sink)
            }
            Model::H => energy(&self.tree, &work.motion, &mut work.energy, &mut sink),
        }
    }

    /// Working memory for [`ExactModel::fill`].
    #[must_use]
    pub fn workspace(&self) -> ExactWorkspace<'m> {
        ExactWorkspace {
            motion: Vec::with_capacity(self.tree.bodies.len()),
            dynamics: DynamicsWorkspace::new(&self.tree),
            energy: EnergyWorkspace::new(&self.tree),
        }
    }

    /// A random motion: a rational point of the circle for a revolute joint, in units of
    /// its axis vector a: `t = tan(q/2)/|a|`.
    fn motion(
        &self,
        body: &Body<Fp<'m>>,
        model: Model,
        random: &mut SplitMix64,
    ) -> JointMotion<Fp<'m>> {
        let Constants { zero, one, .. } = self.tree.constants;
        let mut draw = || self.modulus.random(random);
        let (mut cos, mut sin, mut versine, mut q) = (one, zero, zero, zero);
        match body.joint {
            JointKind::Revolute => loop {
                let t = draw();
                let t2 = t * t * body.axis_squared;
                let Some(inverse) = (one + t2).inverse() else {
                    continue;
                };
                cos = (one - t2) * inverse;
                sin = (t + t) * inverse;
                versine = sin * t;
                break;
            },
            JointKind::Prismatic => q = draw(),
            JointKind::Fixed => {}
        }
        let qd = if model == Model::D0 { zero } else { draw() };
        JointMotion {
            cos,
            sin,
            versine,
            q,
            qd,
            qdd: draw(),
        }
    }
}

/// Working memory of [`ExactModel::fill`].
#[derive(Debug, Clone)]
pub struct ExactWorkspace<'m> {
    motion: Vec<JointMotion<Fp<'m>>>,
    dynamics: DynamicsWorkspace<Fp<'m>>,
    energy: EnergyWorkspace<Fp<'m>>,
}

/// Rotation to the antecedent's frame and origin in it.
type Placement<T> = (Mat3<T>, Vec3<T>);

/// Builds the bodies from what is written.
struct Builder<'m, 'd> {
    angles: Angles<'m>,
    lengths: Lengths<'m, 'd>,
    constants: Constants<Fp<'m>>,
}

impl<'m> Builder<'m, '_> {
    fn body(
        &mut self,
        link: &LinkDescription,
        antecedent: Option<usize>,
        variable: Option<usize>,
    ) -> Result<Body<Fp<'m>>, NotInField> {
        let Constants { zero, one, .. } = self.constants;
        let (rotation, origin, axis) = match &link.geometry {
            Geometry::Mdh(g) => {
                let (rotation, origin) = self.mdh(g)?;
                (rotation, origin, [zero, zero, one])
            }
            Geometry::Placed { origins, axis } => {
                let (rotation, origin) = self.chain(origins)?;
                (rotation, origin, self.vector(axis)?)
            }
        };
        Ok(Body {
            antecedent,
            joint: link.joint,
            variable,
            rotor: link.rotor,
            rotation,
            origin,
            axis,
            axis_squared: dot(axis, axis),
        })
    }

    /// Rot(z, gamma) Trans(z, b) Rot(x, alpha) Trans(x, d) Rot(z, theta) Trans(z, r).
    fn mdh(&mut self, g: &MdhGeometry) -> Result<Placement<Fp<'m>>, NotInField> {
        let Constants { zero, one, .. } = self.constants;
        let z = [zero, zero, one];
        let gamma = self.rot_z(&g.gamma);
        let alpha = self.rot_x(&g.alpha);
        let twist = product(&gamma, &alpha);
        let theta = self.rot_z(&g.theta);
        let arm = [self.length(&g.d)?, zero, self.length(&g.r)?];
        let origin = add(scale(z, self.length(&g.b)?), apply(&twist, arm));
        Ok((product(&twist, &theta), origin))
    }

    /// Trans(xyz) Rot(z, yaw) Rot(y, pitch) Rot(x, roll), one after the other.
    fn chain(&mut self, origins: &[Origin]) -> Result<Placement<Fp<'m>>, NotInField> {
        let Constants { zero, one, .. } = self.constants;
        let mut rotation = [[one, zero, zero], [zero, one, zero], [zero, zero, one]];
        let mut position = [zero; 3];
        for origin in origins {
            position = add(position, apply(&rotation, self.vector(&origin.xyz)?));
            let [roll, pitch, yaw] = &origin.rpy;
            for turn in [self.rot_z(yaw), self.rot_y(pitch), self.rot_x(roll)] {
                rotation = product(&rotation, &turn);
            }
        }
        Ok((rotation, position))
    }

    fn length(&self, quantity: &Quantity) -> Result<Fp<'m>, NotInField> {
        self.lengths.value(quantity, &self.angles)
    }

    fn vector(&self, v: &[Quantity; 3]) -> Result<Vec3<Fp<'m>>, NotInField> {
        Ok([
            self.length(&v[0])?,
            self.length(&v[1])?,
            self.length(&v[2])?,
        ])
    }

    fn angle(&mut self, angle: &Quantity) -> Rotation<Fp<'m>> {
        self.angles.rotation(angle, self.lengths.constants)
    }

    fn rot_x(&mut self, angle: &Quantity) -> Mat3<Fp<'m>> {
        let Constants { zero, one, .. } = self.constants;
        let (c, s) = self.angle(angle);
        [[one, zero, zero], [zero, c, -s], [zero, s, c]]
    }

    fn rot_y(&mut self, angle: &Quantity) -> Mat3<Fp<'m>> {
        let Constants { zero, one, .. } = self.constants;
        let (c, s) = self.angle(angle);
        [[c, zero, s], [zero, one, zero], [-s, zero, c]]
    }

    fn rot_z(&mut self, angle: &Quantity) -> Mat3<Fp<'m>> {
        let Constants { zero, one, .. } = self.constants;
        let (c, s) = self.angle(angle);
        [[c, -s, zero], [s, c, zero], [zero, zero, one]]
    }
}
