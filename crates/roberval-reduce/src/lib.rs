//! From joint states and torques to the R factor of least squares, in one pass.
//!
//! * [`Reduction`]: takes samples in, in memory that does not grow with them.
//! * [`Factor`]: R, Q'tau and the residual norm; factors of parts merge into that of the
//!   whole.

mod annihilate;
mod checkpoint;
mod factor;
mod layout;
mod plan;
mod range;
mod samples;
mod stream;
mod tiles;

pub use checkpoint::CheckpointError;
pub use factor::{Factor, Unsolvable};
pub use plan::Friction;
pub use samples::{Place, ReduceError, Samples, Weights};
pub use stream::Reduction;
