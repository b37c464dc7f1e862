//! The exact engine: structural rank, choice and relations without a tolerance.
//!
//! The recursion runs over two prime fields with independent random states; elimination
//! in column order gives rank, choice and beta in one pass. A nonzero minor modulo a
//! prime is nonzero, so that the rank is never overestimated; it is underestimated with
//! a probability that is computed (Schwartz-Zippel). Both fields must agree.
//!
//! Angles that are no rational part of a turn (0.3 rad) have no place in a field: the
//! answer is that of the robot with generic angles there, equal literals being equal.
//! Literals that are related otherwise (0.3 + 0.3 - 0.6 rad along a chain) are not known to
//! be, and the rank may then be too high; the diagnosis names such angles.

mod coefficients;
mod decision;
mod field;
mod number;
mod rounded;
mod run;

pub(crate) use decision::structural_rank;
pub use decision::{ExactDecision, ExactError, decide_exactly};
pub(crate) use field::in_some_field;
pub use number::ExactNumber;
pub(crate) use rounded::columns_of_w;
