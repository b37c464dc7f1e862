//! The numbers roberval computes with.
//!
//! * [`Scalar`]: the few operations that the regressor's recursion needs, so that one
//!   source runs over floats, magnitudes (error bounds), finite fields and expressions.
//! * [`Decimal`], [`Expr`], [`Quantity`]: numbers as the user wrote them, kept exactly.

mod literal;
mod magnitude;
mod random;
mod scalar;

pub use literal::{Decimal, Expr, LiteralError, Quantity};
pub use magnitude::Magnitude;
pub use random::SplitMix64;
pub use scalar::Scalar;
