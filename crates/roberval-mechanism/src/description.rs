use crate::placement::cos_sin;
use std::collections::HashMap;

use nalgebra::{Matrix3, Vector3};
use roberval_scalar::Quantity;

use crate::{Couple, LoopClosure};

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
    /// Joints whose positions follow from others'.
    pub couples: Vec<Couple>,
    /// Joints that were cut to make a tree of the links.
    pub loops: Vec<LoopClosure>,
    /// Where the description comes from.
    pub format: SourceFormat,
    /// What the reader noticed and the user should know (missing inertias, unnormalised
    /// axes, ...).
    pub warnings: Vec<String>,
}

impl RobotDescription {
    /// What messages call the joint that moves a link: its own name, or else the link's.
    #[must_use]
    pub fn joint_label(&self, link: usize) -> &str {
        let link = &self.links[link];
        link.joint_name.as_deref().unwrap_or(&link.name)
    }

    /// The same robot without rotor inertias: ten parameters a link, the rigid bodies'
    /// own.
    #[must_use]
    pub fn without_rotors(mut self) -> Self {
        for link in &mut self.links {
            link.rotor = false;
            link.inertia[10] = None;
        }
        self
    }

    /// The same robot on a base that floats: links that stood on the base stand on a link
    /// "0" that moves freely and of whose inertia nothing is known. A robot that floats
    /// already stays as it is.
    #[must_use]
    pub fn with_floating_base(mut self) -> Self {
        if self.links.iter().any(|l| l.joint == JointKind::Floating) {
            return self;
        }
        for link in self.links.iter_mut().filter(|l| l.antecedent.is_none()) {
            link.antecedent = Some(FLOATING_BASE.to_owned());
        }
        self.links.insert(0, LinkDescription::floating(self.format));
        self
    }

    /// The index of each link's antecedent, `None` for the base, once it is sure that
    /// names are unique, that every antecedent exists and that there is no cycle.
    ///
    /// # Errors
    /// The first of these rules that a link breaks.
    pub fn antecedents(&self) -> Result<Vec<Option<usize>>, TreeError> {
        let mut index = HashMap::with_capacity(self.links.len());
        for (link, description) in self.links.iter().enumerate() {
            if let Some(first) = index.insert(description.name.as_str(), link) {
                let name = description.name.clone();
                return Err(TreeError::DuplicateName { name, first, link });
            }
        }
        let mut antecedents = Vec::with_capacity(self.links.len());
        for (link, description) in self.links.iter().enumerate() {
            antecedents.push(match &description.antecedent {
                None => None,
                Some(antecedent) => Some(*index.get(antecedent.as_str()).ok_or_else(|| {
                    TreeError::UnknownAntecedent {
                        name: description.name.clone(),
                        antecedent: antecedent.clone(),
                        link,
                    }
                })?),
            });
        }
        match find_cycle(&antecedents) {
            None => Ok(antecedents),
            Some(links) => Err(TreeError::Cycle {
                names: links.iter().map(|l| self.links[*l].name.clone()).collect(),
                link: links[0],
            }),
        }
    }
}

/// A circle in which every index points to the next one and the last to the first, if
/// there is one. Used for links that stand on links and for joints that copy joints.
#[must_use]
pub fn find_cycle(next: &[Option<usize>]) -> Option<Vec<usize>> {
    // 0: not seen; else the number of the walk that saw the index first.
    let mut seen = vec![0; next.len()];
    for start in 0..next.len() {
        let mut at = start;
        while seen[at] == 0 {
            seen[at] = start + 1;
            match next[at] {
                Some(after) => at = after,
                None => break,
            }
        }
        if seen[at] == start + 1 && next[at].is_some() {
            let mut circle = vec![at];
            while let Some(after) = next[circle[circle.len() - 1]].filter(|i| *i != at) {
                circle.push(after);
            }
            return Some(circle);
        }
    }
    None
}

/// Why the links of a description are no tree.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum TreeError {
    /// Two links have one name.
    #[error("two links are named {name:?} (links {} and {})", first + 1, link + 1)]
    DuplicateName {
        /// The name.
        name: String,
        /// Index of the first of the two, from 0.
        first: usize,
        /// Index of the second.
        link: usize,
    },
    /// A link stands on a link that does not exist.
    #[error("link {name:?} has the antecedent {antecedent:?}, which does not exist")]
    UnknownAntecedent {
        /// The link.
        name: String,
        /// The name that no link has.
        antecedent: String,
        /// Index of the link.
        link: usize,
    },
    /// Links that stand on each other in a circle.
    #[error("links stand on each other in a circle: {}", circle(names))]
    Cycle {
        /// The links, each followed by its antecedent; the last one's is the first.
        names: Vec<String>,
        /// Index of the first of them.
        link: usize,
    },
}

/// `"a" on "b" on "a"`, shortened in the middle.
fn circle(names: &[String]) -> String {
    let shown = names.iter().take(8).map(|name| format!("{name:?}"));
    let dots = (names.len() > 8).then(|| "...".to_owned());
    let again = names.first().map(|name| format!("{name:?}"));
    let all: Vec<String> = shown.chain(dots).chain(again).collect();
    all.join(" on ")
}

/// The kind of file a description was read from: it decides the links' frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SourceFormat {
    /// Modified Denavit-Hartenberg frames of Khalil and Kleinfinger.
    Mdh,
    /// Robot TOML with links placed as in URDF.
    Placed,
    /// URDF link frames.
    Urdf,
}

/// The name of a floating base for which the robot file has none.
const FLOATING_BASE: &str = "0";

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
    /// Whether there is no body: the link only stands between two motions of one joint
    /// and has no parameters.
    pub massless: bool,
    /// Where the link's frame lies on its antecedent.
    pub geometry: Geometry,
    /// The standard parameters XX XY XZ YY YZ ZZ MX MY MZ M Ia about the origin of the
    /// link's frame and in that frame, where the file gives them.
    pub inertia: [Option<Quantity>; 11],
    /// Lower and upper joint limit (rad or m), where the file gives them.
    pub limits: Option<(f64, f64)>,
}

impl LinkDescription {
    /// A base that floats, named "0" and of unknown inertia.
    #[must_use]
    pub fn floating(format: SourceFormat) -> Self {
        let zero = Quantity::zero;
        let geometry = match format {
            SourceFormat::Mdh => Geometry::Mdh(Box::new(MdhGeometry {
                gamma: zero(),
                b: zero(),
                alpha: zero(),
                d: zero(),
                theta: zero(),
                r: zero(),
            })),
            SourceFormat::Urdf | SourceFormat::Placed => Geometry::Placed {
                origins: vec![Origin::here(FLOATING_BASE)],
                axis: [zero(), zero(), zero()],
            },
        };
        Self {
            name: FLOATING_BASE.to_owned(),
            joint_name: None,
            antecedent: None,
            joint: JointKind::Floating,
            active: false,
            rotor: false,
            massless: false,
            geometry,
            inertia: Default::default(),
            limits: None,
        }
    }
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
    /// All motions: the base of a robot that stands on nothing. Its axis has no meaning.
    Floating,
}

impl JointKind {
    /// All kinds.
    pub const ALL: [Self; 4] = [Self::Revolute, Self::Prismatic, Self::Fixed, Self::Floating];

    /// `revolute`, `prismatic`, `fixed` or `floating`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Revolute => "revolute",
            Self::Prismatic => "prismatic",
            Self::Fixed => "fixed",
            Self::Floating => "floating",
        }
    }

    /// Whether there is an axis about or along which the joint moves.
    #[must_use]
    pub fn has_axis(self) -> bool {
        matches!(self, Self::Revolute | Self::Prismatic)
    }

    /// The motions it allows, each a coordinate of the velocity: those of a floating base
    /// are along x, y, z and about x, y, z of its own frame.
    #[must_use]
    pub fn motions(self) -> &'static [Motion] {
        use Motion::{Rotation, Translation};
        match self {
            Self::Revolute => &[Rotation],
            Self::Prismatic => &[Translation],
            Self::Fixed => &[],
            Self::Floating => &[
                Translation,
                Translation,
                Translation,
                Rotation,
                Rotation,
                Rotation,
            ],
        }
    }

    /// Degrees of freedom.
    #[must_use]
    pub fn dof(self) -> usize {
        self.motions().len()
    }
}

/// What a coordinate of the velocity measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Motion {
    /// rad/s, its row being a moment.
    Rotation,
    /// m/s, its row being a force.
    Translation,
}

/// Where a link's frame lies on its antecedent.
#[derive(Debug, Clone, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "a robot has few links")]
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

impl Origin {
    /// The placement that changes nothing.
    #[must_use]
    pub fn here(joint: &str) -> Self {
        let zeros = || [(); 3].map(|()| Quantity::zero());
        Self {
            joint: joint.to_owned(),
            xyz: zeros(),
            rpy: zeros(),
        }
    }

    /// The placement in doubles: rotation R and position p, so that a point x of the
    /// placed frame is at R x + p.
    #[must_use]
    pub fn placement(&self) -> (Matrix3<f64>, Vector3<f64>) {
        let [(cr, sr), (cp, sp), (cy, sy)] = [0, 1, 2].map(|k| cos_sin(self.rpy[k].value));
        let rotation = Matrix3::new(
            cy * cp,
            cy * sp * sr - sy * cr,
            cy * sp * cr + sy * sr,
            sy * cp,
            sy * sp * sr + cy * cr,
            sy * sp * cr - cy * sr,
            -sp,
            cp * sr,
            cp * cr,
        );
        let position = Vector3::from_fn(|k, _| self.xyz[k].value);
        (rotation, position)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Rotation3, Unit};

    use super::*;

    #[test]
    fn a_circle_is_found_and_a_tree_has_none() {
        assert_eq!(find_cycle(&[None, Some(0), Some(0), Some(2)]), None);
        assert_eq!(find_cycle(&[Some(0)]), Some(vec![0]));
        assert_eq!(
            find_cycle(&[None, Some(3), Some(1), Some(4), Some(1)]),
            Some(vec![1, 3, 4])
        );
    }

    #[test]
    fn an_origin_turns_about_fixed_x_then_y_then_z() {
        let number = |x: f64| Quantity::from_f64(x).unwrap();
        let origin = Origin {
            joint: "j".into(),
            xyz: [1.0, 2.0, 3.0].map(number),
            rpy: [0.3, -0.7, 1.9].map(number),
        };
        let about = |axis: Vector3<f64>, angle| {
            *Rotation3::from_axis_angle(&Unit::new_normalize(axis), angle).matrix()
        };
        let expected =
            about(Vector3::z(), 1.9) * about(Vector3::y(), -0.7) * about(Vector3::x(), 0.3);
        let (rotation, position) = origin.placement();
        assert!((rotation - expected).amax() < 1e-15);
        assert_eq!(position, Vector3::new(1.0, 2.0, 3.0));
    }
}
