//! The exact engine: structural rank, choice and relations without a tolerance.
//!
//! The recursion runs over two prime fields with independent random states; elimination
//! in column order gives rank, choice and beta in one pass. A nonzero minor modulo a
//! prime is nonzero, so that the rank is never overestimated; it is underestimated with
//! a probability that is computed (Schwartz-Zippel). Both fields must agree.
//!
//! Decimal angles (0.3 rad) are powers of one random rotation, exactly as written. Those
//! with so many digits that the powers would be too high count as independent generic
//! angles, equal or commensurable literals together: if they are related otherwise, the rank
//! may be too high, and the diagnosis names them.

mod coefficients;
mod constraints;
mod decision;
mod field;
mod number;
mod rounded;
mod run;

pub use constraints::{LoopForm, held as constraints_held};
pub(crate) use constraints::{held, with_couples};

pub use decision::{ExactDecision, ExactError, choose_exactly, decide_exactly};
pub(crate) use field::in_some_field;
pub use number::ExactNumber;
pub(crate) use rounded::columns_of_w;
pub use run::{Run, eliminate};
