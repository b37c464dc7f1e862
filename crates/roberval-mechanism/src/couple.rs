use roberval_scalar::{Formula, Quantity};

use crate::JointKind;

/// A joint whose variable follows from others': q = sum of multiplier * q(term) + offset,
/// a gear, a parallelogram or a URDF `mimic`; or an expression of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Couple {
    /// Name of the link that the dependent joint moves.
    pub joint: String,
    /// The joints it follows from.
    pub terms: Vec<Term>,
    /// Its position where those stand at 0 (rad or m).
    pub offset: Quantity,
    /// In place of terms and offset, an expression of other joints' variables.
    pub expression: Option<Expression>,
}

/// An expression of joint variables, which are named by the links that the joints move.
#[derive(Debug, Clone, PartialEq)]
pub struct Expression {
    /// As written.
    pub text: String,
    /// As understood.
    pub formula: Formula<String>,
}

/// A multiple of a joint's variable.
#[derive(Debug, Clone, PartialEq)]
pub struct Term {
    /// Name of the link that the joint moves.
    pub joint: String,
    /// The factor (rad or m per rad or m).
    pub multiplier: Quantity,
}

/// Why couples determine nothing. `couple` is the place in the description's list.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CoupleError {
    /// A couple names a joint that the robot does not have.
    #[error("a couple names the joint {name:?}, which does not exist")]
    Unknown {
        /// The couple.
        couple: usize,
        /// The name that no joint has.
        name: String,
    },
    /// A couple names a joint that is fixed or floats.
    #[error("a couple names the joint {name:?}, which is {}: couple joints with an axis", kind.name())]
    NoAxis {
        /// The couple.
        couple: usize,
        /// The joint.
        name: String,
        /// What it is.
        kind: JointKind,
    },
    /// Two couples determine one joint.
    #[error("the joint {name:?} has two couples (numbers {} and {})", first + 1, couple + 1)]
    Twice {
        /// The second.
        couple: usize,
        /// The first.
        first: usize,
        /// The joint.
        name: String,
    },
    /// A couple without terms, or with the multiplier 0.
    #[error(
        "the couple of the joint {name:?} {what}, so that the joint does not move: make it fixed instead"
    )]
    Still {
        /// The couple.
        couple: usize,
        /// The joint.
        name: String,
        /// What is wrong with it.
        what: String,
    },
    /// Joints that follow from each other in a circle, or one from itself.
    #[error("joints follow from each other in a circle: {}", circle(names))]
    Cycle {
        /// A couple of the circle.
        couple: usize,
        /// The joints, each followed by one that it follows from; the last one's is the
        /// first.
        names: Vec<String>,
    },
    /// A couple by an expression in a mechanism with loops.
    #[error(
        "the joint {name:?} follows others by an expression, which a robot with loops cannot have: describe it as a loop, or by multipliers"
    )]
    Loops {
        /// The couple.
        couple: usize,
        /// The joint.
        name: String,
    },
    /// A chain of couples whose joint multiplier is too long to be kept exactly, or no
    /// finite number.
    #[error(
        "the multipliers or offsets on the way to the joint {name:?} have no finite value of reasonable length"
    )]
    TooLong {
        /// The couple.
        couple: usize,
        /// The joint.
        name: String,
    },
}

impl CoupleError {
    /// The couple's place in the description's list.
    #[must_use]
    pub fn couple(&self) -> usize {
        match self {
            Self::Unknown { couple, .. }
            | Self::NoAxis { couple, .. }
            | Self::Twice { couple, .. }
            | Self::Still { couple, .. }
            | Self::Cycle { couple, .. }
            | Self::Loops { couple, .. }
            | Self::TooLong { couple, .. } => *couple,
        }
    }
}

/// `"a" from "b" from "a"`, shortened in the middle.
fn circle(names: &[String]) -> String {
    let shown = names.iter().take(8).map(|name| format!("{name:?}"));
    let dots = (names.len() > 8).then(|| "...".to_owned());
    let again = names.first().map(|name| format!("{name:?}"));
    let all: Vec<String> = shown.chain(dots).chain(again).collect();
    all.join(" from ")
}
