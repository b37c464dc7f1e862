//! The numbers roberval computes with.
//!
//! * [`Scalar`]: the few operations that the regressor's recursion needs, so that one
//!   source runs over floats, magnitudes (error bounds), finite fields and expressions.
//! * [`Formula`]: expressions of joint variables, with their derivatives ([`Jet`]).
//! * [`DoubleDouble`], [`Wide`]: numbers of 104 bits, and of 448 behind the point.
//! * [`Lanes`]: several floats side by side, as many as the processor can take.
//! * [`Decimal`], [`Expr`], [`Quantity`]: numbers as the user wrote them, kept exactly.

mod cancel;
mod double_double;
mod field;
mod fixed_point;
mod formula;
mod lanes;
mod linear;
mod literal;
mod magnitude;
mod nearest;
mod primes;
mod random;
mod real;
mod scalar;
pub mod vector;
mod wide;
mod written;

pub use cancel::{Cancelled, cancellable, cancellation_point};
pub use double_double::DoubleDouble;
pub use field::{Fp, Modulus};
pub use formula::{Formula, Jet};
pub use lanes::{LINE, Lanes, MAX_LANES, Task, Width, dispatch, dispatch_one};
pub use linear::LinearInPi;
pub use literal::{
    Constants, Decimal, Expr, LiteralError, LiteralFault, MAX_LITERAL_BYTES, MAX_LITERAL_DEPTH,
    Quantity, is_constant_name,
};
pub use magnitude::Magnitude;
pub use nearest::nearest_double;
pub use primes::{is_prime, random_prime};
pub use random::SplitMix64;
pub use real::{Analytic, Real};
pub use scalar::{Lift, Scalar};
pub use wide::Wide;
