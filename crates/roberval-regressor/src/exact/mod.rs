//! The recursion over a prime field: the robot's geometry exactly as written.
//!
//! Rational multiples of pi are powers of one rotation of finite order, lengths are
//! fractions, joints stand at random rational points of the circle. Decimal angles are
//! powers of one random rotation, which holds for the file as written; where they have too
//! many digits for that, the answer is that of a robot with generic angles, and says so.

mod angles;
mod closure;
mod geometry;
mod lengths;
mod linear;
mod loops;
mod model;
mod named;
mod precise;
mod units;

pub use angles::AngleOrder;
pub use closure::{CouplePowers, coupled};
pub use geometry::RowsWorkspace;
pub(crate) use loops::link_frames;
pub use loops::{NotClosed, couples_close_loops};
pub use model::{ExactModel, ExactWorkspace, NotInField, Turn};
pub use named::whole_multiple;
pub use precise::PreciseModel;
pub use units::{AngleParts, AngleUnit, AngleUnits};
