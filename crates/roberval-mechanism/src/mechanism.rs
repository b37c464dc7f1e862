use nalgebra::{Matrix3, Vector3};

use crate::{JointKind, ParameterSpace};

/// A valid robot with numbers: a chain or tree of links, each after its antecedent.
#[derive(Debug, Clone, PartialEq)]
pub struct Mechanism {
    /// The robot's name.
    pub name: String,
    /// Acceleration of gravity in the base frame, m/s^2.
    pub gravity: Vector3<f64>,
    /// The links in parameter order; a link's antecedent has a smaller index.
    pub links: Vec<Link>,
}

/// One link of a [`Mechanism`].
#[derive(Debug, Clone, PartialEq)]
pub struct Link {
    /// The link's name, unique in the robot.
    pub name: String,
    /// The joint's name where the format has one.
    pub joint_name: Option<String>,
    /// Index of the antecedent link; `None` is the base.
    pub antecedent: Option<usize>,
    /// What the joint allows.
    pub joint: JointKind,
    /// mu: whether the joint is driven.
    pub active: bool,
    /// Whether there is an Ia column.
    pub rotor: bool,
    /// Constant rotation from the antecedent's frame to this link's at joint variable 0.
    pub rotation: Matrix3<f64>,
    /// Origin of the link's frame at joint variable 0, in the antecedent's frame, m.
    pub origin: Vector3<f64>,
    /// Unit joint axis in the link's frame.
    pub axis: Vector3<f64>,
    /// XX XY XZ YY YZ ZZ MX MY MZ M Ia where known.
    pub inertia: [Option<f64>; 11],
}

/// Why a description is not a mechanism.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MechanismError {
    /// A placeholder until the checks are written.
    #[error("{0}")]
    Invalid(String),
}

impl Mechanism {
    /// Number of joint variables n (fixed joints have none).
    #[must_use]
    pub fn dof(&self) -> usize {
        self.links
            .iter()
            .filter(|l| l.joint != JointKind::Fixed)
            .count()
    }

    /// The standard parameters as columns.
    #[must_use]
    pub fn parameters(&self) -> ParameterSpace {
        ParameterSpace::new(self.links.iter().map(|l| (l.name.as_str(), l.rotor)))
    }
}
