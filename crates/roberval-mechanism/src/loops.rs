//! Loops that are closed by a cut joint, as written.

mod assemble;
mod couples;
mod linkage;
mod pivoted_qr;
mod resolve;
mod search;
mod solution;
mod walk;

use std::fmt;

use roberval_scalar::Quantity;

use crate::Origin;
pub use assemble::in_linkage;
pub use couples::{CoupleLaw, couple_laws};
pub use linkage::{Configuration, LinkFrame, Linkage, LoopFrames, Pose};
pub use resolve::{LoopError, ResolvedLoop};
pub use search::{Assembly, AssemblyError};
pub use solution::{LoopMotion, NotClosed};
pub use walk::Walk;

/// A joint of the robot that is cut to make a tree of it: two frames, one on each of two
/// links, between which the cut joint holds.
#[derive(Debug, Clone, PartialEq)]
pub struct LoopClosure {
    /// The links A and B; `None` is the base.
    pub between: [Option<String>; 2],
    /// The two frames, each in its link's own; the joint's axis is their z axes.
    pub frames: [Origin; 2],
    /// What the cut joint allows.
    pub cut: Cut,
    /// Joint variables (rad or m), by the names of the links they move, near which the
    /// loop is to be closed: they choose among its assembly modes.
    pub near: Vec<(String, Quantity)>,
}

/// What a cut joint allows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Cut {
    /// Rotation about the common z axis.
    Revolute,
    /// Every rotation about the common origin.
    Spherical,
    /// Nothing.
    Fixed,
    /// Translation along the common z axis.
    Prismatic,
    /// Rotations about the z axis of either frame, which are at right angles and meet in
    /// the common origin.
    Universal,
}

/// A scalar equation that a cut joint imposes on the frames A and B; axes are numbered
/// x, y, z = 0, 1, 2.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Condition {
    /// u_A . (p_B - p_A) = 0 with this axis u of A.
    Point(usize),
    /// u_A . w_B = 0 with these axes of A and B.
    Axes(usize, usize),
}

impl Cut {
    /// All kinds.
    pub const ALL: [Self; 5] = [
        Self::Revolute,
        Self::Spherical,
        Self::Fixed,
        Self::Prismatic,
        Self::Universal,
    ];

    /// As in robot files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Revolute => "revolute",
            Self::Spherical => "spherical",
            Self::Fixed => "fixed",
            Self::Prismatic => "prismatic",
            Self::Universal => "universal",
        }
    }

    /// What the joint forbids.
    pub(crate) fn conditions(self) -> &'static [Condition] {
        use Condition::{Axes, Point};
        match self {
            Self::Spherical => &[Point(0), Point(1), Point(2)],
            Self::Revolute => &[Point(0), Point(1), Point(2), Axes(0, 2), Axes(1, 2)],
            Self::Universal => &[Point(0), Point(1), Point(2), Axes(2, 2)],
            Self::Prismatic => &[Point(0), Point(1), Axes(0, 1), Axes(1, 2), Axes(2, 0)],
            Self::Fixed => &[
                Point(0),
                Point(1),
                Point(2),
                Axes(0, 1),
                Axes(1, 2),
                Axes(2, 0),
            ],
        }
    }

    /// The axes that must point the same way, where the conditions leave open which.
    pub(crate) fn aligned(self) -> &'static [usize] {
        match self {
            Self::Spherical | Self::Universal => &[],
            Self::Revolute => &[2],
            Self::Prismatic | Self::Fixed => &[0, 1, 2],
        }
    }
}

impl fmt::Display for Cut {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
