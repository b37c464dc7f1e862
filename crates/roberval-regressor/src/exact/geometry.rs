//! From the description to a tree of bodies, over any numbers: the rules of placements
//! are written here once.

use roberval_mechanism::{
    Geometry, LinkDescription, MdhGeometry, Mechanism, Origin, ParameterSpace, Pose,
};
use roberval_scalar::{Quantity, Scalar};

use super::closure::coupled;
use crate::tree::next_variable;
use crate::vector::{Mat3, Vec3, add, apply, dot, product, scale};
use crate::{
    BaseState, Body, Constants, DenseRows, DynamicsWorkspace, EnergyWorkspace, JointMotion,
    JointStates, Layout, Model, Projected, Transmission, Tree, dynamics, energy,
};

/// Cosine and sine.
pub(crate) type Rotation<T> = (T, T);

/// How literals become numbers.
pub(crate) trait Numbers {
    type Number: Scalar;
    type Error;
    fn constants(&self) -> Constants<Self::Number>;
    /// Cosine and sine of an angle.
    fn rotation(&mut self, angle: &Quantity) -> Result<Rotation<Self::Number>, Self::Error>;
    /// A length, a component of an axis or of gravity.
    fn value(&mut self, quantity: &Quantity) -> Result<Self::Number, Self::Error>;
    /// 1/|a| of an axis as written, whose squared length is `squared`.
    fn inverse_length(
        &mut self,
        axis: &[Quantity; 3],
        squared: Self::Number,
    ) -> Result<Self::Number, Self::Error>;
}

/// The mechanism in these numbers.
pub(crate) fn tree<N: Numbers>(
    mechanism: &Mechanism,
    numbers: &mut N,
) -> Result<Tree<N::Number>, N::Error> {
    let description = &mechanism.description;
    let constants = numbers.constants();
    let mut build = Builder { numbers, constants };
    let coupled = coupled(mechanism);
    let mut dof = 0;
    let mut bodies = Vec::with_capacity(mechanism.links.len());
    for link in &mechanism.links {
        let variable = next_variable(link.joint, &mut dof);
        let written = &description.links[link.in_file];
        let mut body = build.body(written, link.antecedent, variable)?;
        if variable.is_some_and(|v| coupled[v]) {
            build.normalise(written, &mut body)?;
        }
        bodies.push(body);
    }
    let gravity = build.vector(&description.gravity)?;
    Ok(Tree {
        bodies,
        gravity,
        constants,
        dof,
    })
}

/// The placement of a frame written like a URDF origin.
pub(crate) fn pose<N: Numbers>(
    origin: &Origin,
    numbers: &mut N,
) -> Result<Pose<N::Number>, N::Error> {
    let constants = numbers.constants();
    let mut build = Builder { numbers, constants };
    let (rotation, origin) = build.chain(std::slice::from_ref(origin))?;
    Ok(Pose { rotation, origin })
}

/// Rotation to the antecedent's frame and origin in it.
type Placement<T> = (Mat3<T>, Vec3<T>);

struct Builder<'a, N: Numbers> {
    numbers: &'a mut N,
    constants: Constants<N::Number>,
}

impl<N: Numbers> Builder<'_, N> {
    fn body(
        &mut self,
        link: &LinkDescription,
        antecedent: Option<usize>,
        variable: Option<usize>,
    ) -> Result<Body<N::Number>, N::Error> {
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
            massless: link.massless,
            rotation,
            origin,
            axis,
            axis_squared: dot(axis, axis),
            layout: Layout::General,
        })
    }

    /// Gives the joint of a body an axis of length 1.
    fn normalise(
        &mut self,
        link: &LinkDescription,
        body: &mut Body<N::Number>,
    ) -> Result<(), N::Error> {
        if let Geometry::Placed { axis, .. } = &link.geometry {
            let inverse = self.numbers.inverse_length(axis, body.axis_squared)?;
            body.axis = scale(body.axis, inverse);
            body.axis_squared = self.constants.one;
        }
        Ok(())
    }

    /// Rot(z, gamma) Trans(z, b) Rot(x, alpha) Trans(x, d) Rot(z, theta) Trans(z, r).
    fn mdh(&mut self, g: &MdhGeometry) -> Result<Placement<N::Number>, N::Error> {
        let Constants { zero, one, .. } = self.constants;
        let z = [zero, zero, one];
        let twist = product(&self.rot_z(&g.gamma)?, &self.rot_x(&g.alpha)?);
        let theta = self.rot_z(&g.theta)?;
        let arm = [self.numbers.value(&g.d)?, zero, self.numbers.value(&g.r)?];
        let origin = add(scale(z, self.numbers.value(&g.b)?), apply(&twist, arm));
        Ok((product(&twist, &theta), origin))
    }

    /// Trans(xyz) Rot(z, yaw) Rot(y, pitch) Rot(x, roll), one after the other.
    fn chain(&mut self, origins: &[Origin]) -> Result<Placement<N::Number>, N::Error> {
        let Constants { zero, one, .. } = self.constants;
        let mut rotation = [[one, zero, zero], [zero, one, zero], [zero, zero, one]];
        let mut position = [zero; 3];
        for origin in origins {
            position = add(position, apply(&rotation, self.vector(&origin.xyz)?));
            let [roll, pitch, yaw] = &origin.rpy;
            for turn in [self.rot_z(yaw)?, self.rot_y(pitch)?, self.rot_x(roll)?] {
                rotation = product(&rotation, &turn);
            }
        }
        Ok((rotation, position))
    }

    fn vector(&mut self, v: &[Quantity; 3]) -> Result<Vec3<N::Number>, N::Error> {
        let [x, y, z] = v;
        let numbers = &mut self.numbers;
        Ok([numbers.value(x)?, numbers.value(y)?, numbers.value(z)?])
    }

    fn rot_x(&mut self, angle: &Quantity) -> Result<Mat3<N::Number>, N::Error> {
        let Constants { zero, one, .. } = self.constants;
        let (c, s) = self.numbers.rotation(angle)?;
        Ok([[one, zero, zero], [zero, c, -s], [zero, s, c]])
    }

    fn rot_y(&mut self, angle: &Quantity) -> Result<Mat3<N::Number>, N::Error> {
        let Constants { zero, one, .. } = self.constants;
        let (c, s) = self.numbers.rotation(angle)?;
        Ok([[c, zero, s], [zero, one, zero], [-s, zero, c]])
    }

    fn rot_z(&mut self, angle: &Quantity) -> Result<Mat3<N::Number>, N::Error> {
        let Constants { zero, one, .. } = self.constants;
        let (c, s) = self.numbers.rotation(angle)?;
        Ok([[c, -s, zero], [s, c, zero], [zero, zero, one]])
    }
}

/// Working memory for the rows of a tree.
#[derive(Debug, Clone)]
pub struct RowsWorkspace<T> {
    /// The joints of a mechanism with constraints, where they were last.
    pub(super) joints: Option<JointStates<T>>,
    motion: Vec<JointMotion<T>>,
    dynamics: DynamicsWorkspace<T>,
    energy: EnergyWorkspace<T>,
}

impl<T: Scalar> RowsWorkspace<T> {
    pub(crate) fn new(tree: &Tree<T>) -> Self {
        Self {
            joints: None,
            motion: Vec::with_capacity(tree.bodies.len()),
            dynamics: DynamicsWorkspace::new(tree),
            energy: EnergyWorkspace::new(tree),
        }
    }

    /// Where the base of a floating robot is and how it moves from now on.
    pub(crate) fn move_base(&mut self, tree: &Tree<T>, base: &BaseState<T>) {
        self.dynamics.move_base(tree, base);
        self.energy.move_base(tree, base);
    }

    /// The model's rows (rows of a sample x C) of bodies that move as `motion` says; with
    /// G, those of the independent joints. Rows of h are not yet differences.
    pub(crate) fn fill(
        &mut self,
        tree: &Tree<T>,
        space: &ParameterSpace,
        model: Model,
        motion: impl FnMut(&Body<T>) -> JointMotion<T>,
        transmission: Option<&Transmission<T>>,
        rows: &mut [T],
    ) {
        rows.fill(tree.constants.zero);
        self.motion.clear();
        self.motion.extend(tree.bodies.iter().map(motion));
        let mut sink = DenseRows { space, rows };
        match (model, transmission) {
            (Model::H, _) => energy(tree, &self.motion, &mut self.energy, &mut sink),
            (_, None) => dynamics(tree, &self.motion, &mut self.dynamics, &mut sink),
            (_, Some(transmission)) => {
                let inner = &mut sink;
                let mut sink = Projected {
                    transmission,
                    inner,
                };
                dynamics(tree, &self.motion, &mut self.dynamics, &mut sink);
            }
        }
    }
}
