//! The reduced model as code.
//!
//! The regressor's recursions run over an expression recorder ([`Recorded`]); what comes
//! out is a [`Program`]: straight-line code without allocation, customised to the robot.
//! [`Code`] is a program with its parameters; [`Code::text`] writes it in a [`Language`].

mod code;
mod composite;
mod coordinates;
mod emit;
mod graph;
mod names;
mod program;
mod record;
mod turns;
mod what;

pub use code::{Code, CodeError, Request};
pub use emit::{Language, UnknownLanguage};
pub use graph::{Graph, Op, Recorded, Signed};
pub use names::{identifier, plain};
pub use program::{Count, Input, Program};
pub use what::{UnknownWhat, What};
