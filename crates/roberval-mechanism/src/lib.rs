//! The robot as data.
//!
//! * [`RobotDescription`]: what a robot file says, with its numbers as written.
//! * [`Mechanism`]: the valid robot with numbers, links in an order in which every
//!   antecedent comes before its successors.
//! * [`ParameterSpace`]: the one place that knows the order of the parameters.

mod description;
mod mechanism;
mod order;
mod parameters;
mod placement;

pub use description::{
    Geometry, JointKind, LinkDescription, MdhGeometry, Mimic, Origin, RobotDescription,
    SourceFormat, TreeError, find_cycle,
};
pub use mechanism::{Link, Mechanism, MechanismError};
pub use parameters::{ParameterId, ParameterKind, ParameterSpace};
