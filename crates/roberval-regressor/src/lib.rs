//! From joint states to regressor rows: one recursion, any scalar, any sink.
//!
//! * [`Tree`]: the robot's constants in the recursion's scalar.
//! * [`dynamics`]: the rows of the dynamic model d (and of d0, at rest).
//! * [`energy`]: the row of the energy model h.
//! * [`Sink`]: where the columns go: dense rows, torques, selected columns.
//! * [`Regressor`]: all of it for floats, over many samples and as many lanes of them as
//!   the processor has; [`PackedLayout`]: the nonzeros alone.

mod batch;
mod dynamics;
mod energy;
mod exact;
mod frame;
mod lanes;
mod motion;
mod packed;
mod sink;
mod tile;
mod tree;
mod vector;

pub use batch::{Model, Regressor, RegressorError, States};
pub use dynamics::{DynamicsWorkspace, dynamics};
pub use energy::{EnergyWorkspace, energy};
pub use exact::{AngleOrder, ExactModel, ExactWorkspace, NotInField, PreciseModel, RowsWorkspace};
pub use frame::{Aligned, Layout};
pub use motion::JointMotion;
pub use packed::PackedLayout;
pub use sink::{DenseRows, SelectedRows, Sink, Torques};
pub use tree::{Body, Constants, Tree};
