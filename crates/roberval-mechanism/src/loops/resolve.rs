//! The loops of a description with their links and joints found.

use std::collections::HashMap;

use super::LoopClosure;
use crate::{JointKind, RobotDescription};

/// A loop by indices instead of names.
#[derive(Debug, Clone, PartialEq)]
pub struct ResolvedLoop {
    /// The links A and B in the file; `None` is the base.
    pub links: [Option<usize>; 2],
    /// The joints that move one of them against the other (by the links they move, in
    /// the file).
    pub joints: Vec<usize>,
    /// The links whose joints have a value to be near.
    pub near: Vec<usize>,
}

/// Why a loop is none. `number` is its place in the description's list, from 0.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum LoopError {
    /// A side of the loop does not exist.
    #[error("loop {} is closed on the link {name:?}, which does not exist", number + 1)]
    UnknownLink {
        /// The loop.
        number: usize,
        /// The name that no link has.
        name: String,
    },
    /// Both sides are one link.
    #[error("loop {} is closed between {name:?} and itself: name two links", number + 1)]
    SameLink {
        /// The loop.
        number: usize,
        /// The link, or "base".
        name: String,
    },
    /// No joint lies between the two sides.
    #[error(
        "loop {} has no moving joint between {} and {}: leave it out", number + 1, names[0], names[1]
    )]
    NoJoint {
        /// The loop.
        number: usize,
        /// The two sides.
        names: [String; 2],
    },
    /// `near` names a joint that does not exist.
    #[error("loop {}: near names the joint {name:?}, which does not exist", number + 1)]
    UnknownJoint {
        /// The loop.
        number: usize,
        /// The name that no joint has.
        name: String,
    },
    /// `near` names a joint that is fixed or floats.
    #[error("loop {}: near names the joint {name:?}, which is fixed or floats", number + 1)]
    FixedJoint {
        /// The loop.
        number: usize,
        /// The joint.
        name: String,
    },
    /// Two values for one joint.
    #[error("loop {}: near gives the joint {name:?} another value than loop {}", number + 1, first + 1)]
    TwoValues {
        /// The loop.
        number: usize,
        /// The loop that gave the first value.
        first: usize,
        /// The joint.
        name: String,
    },
}

impl LoopError {
    /// The loop's place in the description's list.
    #[must_use]
    pub fn number(&self) -> usize {
        match self {
            Self::UnknownLink { number, .. }
            | Self::SameLink { number, .. }
            | Self::NoJoint { number, .. }
            | Self::UnknownJoint { number, .. }
            | Self::FixedJoint { number, .. }
            | Self::TwoValues { number, .. } => *number,
        }
    }

    /// The key of the loop's table that is wrong.
    #[must_use]
    pub fn key(&self) -> &'static str {
        match self {
            Self::UnknownLink { .. } | Self::SameLink { .. } | Self::NoJoint { .. } => "between",
            Self::UnknownJoint { .. } | Self::FixedJoint { .. } | Self::TwoValues { .. } => "near",
        }
    }
}

impl ResolvedLoop {
    /// The loops of a description whose links form a tree with these antecedents.
    ///
    /// # Errors
    /// The first [`LoopError`].
    pub fn all(
        robot: &RobotDescription,
        antecedents: &[Option<usize>],
    ) -> Result<Vec<Self>, LoopError> {
        let names = robot.links.iter().enumerate();
        let index: HashMap<&str, usize> = names.map(|(i, l)| (l.name.as_str(), i)).collect();
        let resolve = |(number, written)| Self::of(robot, antecedents, &index, number, written);
        let all: Vec<Self> = (0..)
            .zip(&robot.loops)
            .map(resolve)
            .collect::<Result<_, _>>()?;
        one_value_each(robot, &all)?;
        Ok(all)
    }

    fn of(
        robot: &RobotDescription,
        antecedents: &[Option<usize>],
        index: &HashMap<&str, usize>,
        number: usize,
        written: &LoopClosure,
    ) -> Result<Self, LoopError> {
        let side =
            |name: &Option<String>| match name {
                None => Ok(None),
                Some(name) => index.get(name.as_str()).copied().map(Some).ok_or_else(|| {
                    LoopError::UnknownLink {
                        number,
                        name: name.clone(),
                    }
                }),
            };
        let label = |name: &Option<String>| name.clone().unwrap_or_else(|| "base".to_owned());
        let [a, b] = &written.between;
        let links = [side(a)?, side(b)?];
        if links[0] == links[1] {
            return Err(LoopError::SameLink {
                number,
                name: label(a),
            });
        }
        let joints = joints_between(robot, antecedents, links);
        if joints.is_empty() {
            return Err(LoopError::NoJoint {
                number,
                names: [label(a), label(b)],
            });
        }
        let near = written.near.iter().map(|(name, _)| {
            let joint = index.get(name.as_str()).copied();
            let name = name.clone();
            match joint {
                None => Err(LoopError::UnknownJoint { number, name }),
                Some(j) if !robot.links[j].joint.has_axis() => {
                    Err(LoopError::FixedJoint { number, name })
                }
                Some(j) => Ok(j),
            }
        });
        let near = near.collect::<Result<_, _>>()?;
        Ok(Self {
            links,
            joints,
            near,
        })
    }
}

/// The moving joints on one of the two paths to the base but not on both.
fn joints_between(
    robot: &RobotDescription,
    antecedents: &[Option<usize>],
    links: [Option<usize>; 2],
) -> Vec<usize> {
    let path = |link: Option<usize>| std::iter::successors(link, |l| antecedents[*l]);
    let mut on = vec![0_u8; robot.links.len()];
    links
        .iter()
        .for_each(|&link| path(link).for_each(|l| on[l] += 1));
    (0..on.len())
        .filter(|&l| on[l] == 1 && robot.links[l].joint != JointKind::Fixed)
        .collect()
}

fn one_value_each(robot: &RobotDescription, all: &[ResolvedLoop]) -> Result<(), LoopError> {
    let mut first: HashMap<usize, (usize, f64)> = HashMap::new();
    for (number, resolved) in all.iter().enumerate() {
        for (&joint, (name, value)) in resolved.near.iter().zip(&robot.loops[number].near) {
            let (before, other) = *first.entry(joint).or_insert((number, value.value));
            if other != value.value {
                return Err(LoopError::TwoValues {
                    number,
                    first: before,
                    name: name.clone(),
                });
            }
        }
    }
    Ok(())
}
