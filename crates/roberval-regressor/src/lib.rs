//! From joint states to regressor rows: one recursion, any scalar, any sink.
//!
//! * [`Tree`]: the robot's constants in the recursion's scalar.
//! * [`dynamics`]: the rows of the dynamic model d (and of d0, at rest).
//! * [`energy`]: the row of the energy model h.
//! * [`Sink`]: where the columns go: dense rows, torques, selected columns.
//! * [`Regressor`]: all of it for floats, over many samples.

mod base;
mod batch;
mod dynamics;
mod energy;
mod exact;
mod motion;
mod sink;
mod tree;
mod vector;

pub use base::BaseState;
pub use batch::{Model, Regressor, RegressorError, States};
pub use dynamics::{DynamicsWorkspace, dynamics};
pub use energy::{EnergyWorkspace, energy};
pub use exact::{AngleOrder, ExactModel, ExactWorkspace, NotInField, PreciseModel, RowsWorkspace};
pub use motion::JointMotion;
pub use sink::{DenseRows, SelectedRows, Sink, Torques};
pub use tree::{Body, Constants, Tree};
