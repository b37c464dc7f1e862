//! Relations in symbols: beta as polynomials in the robot's lengths and in the cosines and
//! sines of its constant angles.
//!
//! [`Named`] says which constants are symbols. The exact engine is asked for beta at random
//! values of them in a prime field; coefficients follow by interpolation, and the result is
//! verified at fresh random values in other fields ([`symbolic_relations`]).

mod factored;
mod field;
mod interpolation;
mod lines;
mod naming;
mod polynomial;
mod relations;
mod rules;
mod samples;
mod sparse;
mod special;
mod verification;

pub use factored::{Factored, Notation};
pub use naming::{Named, Naming, Symbol, SymbolKind};
pub use polynomial::{Monomial, Polynomial, Variable};
pub use relations::{
    Coefficient, Open, Route, SymbolicError, SymbolicOptions, SymbolicRelations, symbolic_relations,
};
pub use rules::Origin;
pub use special::Special;
pub use verification::Verification;
