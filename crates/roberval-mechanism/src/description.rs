use roberval_scalar::Quantity;

/// What a robot file says, with its numbers as written. Links stand in file order.
#[derive(Debug, Clone, PartialEq)]
pub struct RobotDescription {
    /// The robot's name.
    pub name: String,
    /// Acceleration of gravity in the base frame, m/s^2.
    pub gravity: [Quantity; 3],
    /// Named values that expressions may use, in file order.
    pub constants: Vec<(String, Quantity)>,
    /// The moving links (and the fixed ones that were kept), in file order.
    pub links: Vec<LinkDescription>,
    /// Where the description comes from.
    pub format: SourceFormat,
    /// What the reader noticed and the user should know (missing inertias, unnormalised
    /// axes, mimic joints that are not applied, ...).
    pub warnings: Vec<String>,
}

/// The kind of file a description was read from: it decides the links' frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SourceFormat {
    /// Modified Denavit-Hartenberg frames of Khalil and Kleinfinger.
    Mdh,
    /// URDF link frames.
    Urdf,
}

/// One link and the joint that moves it.
#[derive(Debug, Clone, PartialEq)]
pub struct LinkDescription {
    /// The link's name, unique in the robot.
    pub name: String,
    /// The joint's name where the format has one.
    pub joint_name: Option<String>,
    /// The antecedent link's name; `None` is the base.
    pub antecedent: Option<String>,
    /// What the joint allows.
    pub joint: JointKind,
    /// mu: whether the joint is driven.
    pub active: bool,
    /// Whether the joint has a rotor inertia Ia of its own.
    pub rotor: bool,
    /// Where the link's frame lies on its antecedent.
    pub geometry: Geometry,
    /// The standard parameters XX XY XZ YY YZ ZZ MX MY MZ M Ia about the origin of the
    /// link's frame and in that frame, where the file gives them.
    pub inertia: [Option<Quantity>; 11],
    /// Lower and upper joint limit (rad or m), where the file gives them.
    pub limits: Option<(f64, f64)>,
    /// The joint that this one copies.
    pub mimic: Option<Mimic>,
}

/// sigma: what a joint allows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointKind {
    /// sigma = 0: rotation about the axis.
    Revolute,
    /// sigma = 1: translation along the axis.
    Prismatic,
    /// sigma = 2: no motion.
    Fixed,
}

/// Where a link's frame lies on its antecedent.
#[derive(Debug, Clone, PartialEq)]
pub enum Geometry {
    /// Modified Denavit-Hartenberg parameters.
    Mdh(Box<MdhGeometry>),
    /// URDF: a chain of constant placements (those of lumped fixed joints first, the
    /// joint's own last), then the motion about or along `axis` in the link's frame.
    Placed {
        /// Constant placements, applied left to right.
        origins: Vec<Origin>,
        /// The joint axis in the link's frame, as written (not normalised).
        axis: [Quantity; 3],
    },
}

/// Rot(z, gamma) Trans(z, b) Rot(x, alpha) Trans(x, d) Rot(z, theta) Trans(z, r).
#[derive(Debug, Clone, PartialEq)]
pub struct MdhGeometry {
    /// gamma, rad.
    pub gamma: Quantity,
    /// b, m.
    pub b: Quantity,
    /// alpha, rad.
    pub alpha: Quantity,
    /// d, m.
    pub d: Quantity,
    /// theta, rad; the variable of a revolute joint is added to it.
    pub theta: Quantity,
    /// r, m; the variable of a prismatic joint is added to it.
    pub r: Quantity,
}

/// A URDF `<origin>`: Trans(xyz) Rot(z, yaw) Rot(y, pitch) Rot(x, roll).
#[derive(Debug, Clone, PartialEq)]
pub struct Origin {
    /// The joint the placement comes from, for messages.
    pub joint: String,
    /// Position, m.
    pub xyz: [Quantity; 3],
    /// Roll, pitch, yaw about fixed axes, rad.
    pub rpy: [Quantity; 3],
}

/// q = multiplier * q(joint) + offset.
#[derive(Debug, Clone, PartialEq)]
pub struct Mimic {
    /// Name of the joint that is copied.
    pub joint: String,
    /// Factor, default 1.
    pub multiplier: Quantity,
    /// Offset, default 0.
    pub offset: Quantity,
}
