//! The robot as data.
//!
//! * [`RobotDescription`]: what a robot file says, with its numbers as written.
//! * [`clean()`]: the same with rounded angles and dust set right, every change listed.
//! * [`Mechanism`]: the valid robot with numbers, links in an order in which every
//!   antecedent comes before its successors.
//! * [`Couple`]: a joint that follows from others; [`Closure`]: all joints from the
//!   independent ones.
//! * [`LoopClosure`]: a joint that was cut; [`Assembly`]: the loops closed, and how all
//!   joints then follow from the independent ones.
//! * [`ParameterSpace`]: the one place that knows the order of the parameters.

mod clean;
mod closure;
mod conventions;
mod couple;
mod description;
mod loops;
mod mechanism;
mod names;
mod order;
mod parameters;
mod physical;
mod placement;

pub use clean::{
    Change, CleanMode, CleanPolicy, Cleaned, Field, NearMiss, Unit, apply, clean, revert,
};
pub use closure::{AffineLaw, Closure, VariableLaw};
pub use conventions::{Central, Convention};
pub use couple::{Couple, CoupleError, Expression, Term};
pub use description::{
    Geometry, JointKind, LinkDescription, MdhGeometry, Motion, Origin, RobotDescription,
    SourceFormat, TreeError, find_cycle,
};
pub use loops::{
    Assembly, AssemblyError, Configuration, CoupleLaw, Cut, LinkFrame, Linkage, LoopClosure,
    LoopError, LoopFrames, LoopMotion, NotClosed, Pose, ResolvedLoop, Walk, couple_laws,
};
pub use mechanism::{Cleaning, Link, Mechanism, MechanismError};
pub use parameters::{ParameterId, ParameterKind, ParameterSpace};
pub use physical::{Unphysical, unphysical};
