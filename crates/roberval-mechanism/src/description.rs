use std::collections::HashMap;

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

impl RobotDescription {
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
        match cycle(&antecedents) {
            None => Ok(antecedents),
            Some(links) => Err(TreeError::Cycle {
                names: links.iter().map(|l| self.links[*l].name.clone()).collect(),
                link: links[0],
            }),
        }
    }
}

/// Some links, each the antecedent of the one before and the first that of the last,
/// if there are such.
fn cycle(antecedents: &[Option<usize>]) -> Option<Vec<usize>> {
    // 0: not seen; else the number of the walk that saw the link first.
    let mut seen = vec![0; antecedents.len()];
    for start in 0..antecedents.len() {
        let mut at = start;
        while seen[at] == 0 {
            seen[at] = start + 1;
            match antecedents[at] {
                Some(next) => at = next,
                None => break,
            }
        }
        if seen[at] == start + 1 && antecedents[at].is_some() {
            let mut links = vec![at];
            while let Some(next) = antecedents[links[links.len() - 1]].filter(|l| *l != at) {
                links.push(next);
            }
            return Some(links);
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
