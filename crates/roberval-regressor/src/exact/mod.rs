//! The recursion over a prime field: the robot's geometry exactly as written.
//!
//! Rational multiples of pi are powers of one rotation of finite order, lengths are
//! fractions, joints stand at random rational points of the circle. What has no exact
//! place in the field (the cosine of 0.3 rad) is a random value of its own: the answer
//! is then that of the robot with a generic value there, and says so.

mod angles;
mod closure;
mod geometry;
mod lengths;
mod model;
mod precise;

pub use angles::AngleOrder;
pub use geometry::RowsWorkspace;
pub use model::{ExactModel, ExactWorkspace, NotInField};
pub use precise::PreciseModel;
