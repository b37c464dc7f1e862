//! The reduced model as code.
//!
//! The regressor's recursions run over an expression recorder ([`Recorded`]); what comes
//! out is a [`Program`]: straight-line code without allocation, customised to the robot.
//! [`Code`] is a program with its parameters; [`Code::text`] writes it in a [`Language`].

mod code;
mod composite;
mod coordinates;
mod emit;
mod factor;
mod fold;
mod frames;
mod graph;
mod linear;
mod names;
mod program;
mod record;
mod recorded;
mod turns;
mod way;
mod what;

pub use code::{Code, CodeError, Request};
pub use emit::{Language, UnknownLanguage};
pub use graph::{Graph, Op, Signed};
pub use names::{comment, identifier};
pub use program::{Count, Input, Program};
pub use recorded::Recorded;
pub use what::{UnknownWhat, What};
