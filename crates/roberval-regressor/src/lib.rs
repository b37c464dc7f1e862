//! From joint states to regressor rows: one recursion, any scalar, any sink.
//!
//! * [`Tree`]: the robot's constants in the recursion's scalar.
//! * [`dynamics`]: the rows of the dynamic model d (and of d0, at rest).
//! * [`newton_euler`]: the torques themselves, with the forces carried inward.
//! * [`energy`]: the row of the energy model h.
//! * [`Sink`]: where the columns go: dense rows, torques, selected columns.
//! * [`Expansion`]: the state of all joints from that of the independent ones, and G;
//!   [`Projected`]: rows for the independent ones.
//! * [`Regressor`]: all of it for floats, over many samples and as many lanes of them as
//!   the processor has; [`PackedLayout`]: the nonzeros alone.

mod base;
mod batch;
mod dynamics;
mod energy;
mod exact;
mod expansion;
mod forces;
mod formulas;
mod frame;
mod inverse_dynamics;
mod lanes;
mod layout;
mod loops;
mod model;
mod moments;
mod motion;
mod newton_euler;
mod packed;
mod past;
mod scalar_path;
mod sink;
mod states;
mod tile;
mod tile_rows;
mod transmission;
mod tree;
mod tree_states;
mod vector;
mod workspace;

pub use base::{BaseState, squared_length};
pub use batch::{Columns, Regressor, STREAM_BYTES, Writing};
pub use dynamics::dynamics;
pub use energy::{EnergyWorkspace, energy};
pub use exact::{
    AngleOrder, AngleParts, AngleUnit, AngleUnits, CouplePowers, ExactModel, ExactWorkspace,
    NotClosed as LoopsNotInField, NotInField, PreciseModel, RowsWorkspace, Turn, coupled,
    couples_close_loops, whole_multiple,
};
pub use expansion::{Expansion, JointStates, NoValue};
pub use layout::{Aligned, Layout};
pub use model::Model;
pub use moments::{Moments, Shape};
pub use motion::JointMotion;
pub use newton_euler::newton_euler;
pub use packed::PackedLayout;
pub use sink::{DenseRows, Nonzero, SelectedRows, Sink, Torques};
pub use states::{RegressorError, States};
pub use tile_rows::{Slots, TileRows};
pub use transmission::{Projected, Transmission};
pub use tree::{Body, Constants, Tree};
pub use tree_states::{Expanded, TreeStates};
pub use workspace::DynamicsWorkspace;
