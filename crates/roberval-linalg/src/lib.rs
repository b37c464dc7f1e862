//! Matrices without robots: the numerical steps of Gautier 1991 over `f64`.
//!
//! `W` (r x c) is an observation matrix. Its rank `b`, the columns that can go and the relations
//! `W2 = W1 beta` between the deleted columns `W2` and the kept ones `W1` are found on three roads
//! that must meet:
//!
//! * [`staircase_qr`]: QR from left to right; a column that depends on the kept ones before it takes no row,
//! * [`qrii`]: QR with column pivoting, eq. (14); [`PivotedQr::leftmost`] then applies the paper's rule,
//! * [`svd`]: eq. (21); [`deleted_from_null_space`] works up from the last row of `V2`, eq. (26).
//!
//! [`relations_qr`] (eq. (17)) and [`relations_svd`] (eq. (27)) give `beta` with an entrywise error bound.
//!
//! faer does the pivoted QR and the SVD, on one thread; every result of it is checked here
//! (residual and orthogonality) and replaced by this crate's own slower factorisation if it fails.

mod check;
mod echelon;
mod error;
mod faer_calls;
mod householder;
mod jacobi;
mod matrix;
mod null_space;
mod qrii;
mod reconstruct;
mod relations;
mod scale;
mod staircase;
mod svd;
mod tolerance;

pub use check::RATIO_BAR;
pub use echelon::Echelon;
pub use error::LinalgError;
pub use matrix::Matrix;
pub use null_space::{deleted_from_null_space, v22_condition};
pub use qrii::{PivotedQr, qrii};
pub use reconstruct::{ChineseRemainder, rational_from_residue};
pub use relations::{Relations, relations_qr, relations_svd};
pub use scale::{equilibrate, unscale_relations};
pub use staircase::{Staircase, plain_qr_diagonal, staircase_qr};
pub use svd::{Svd, condition, svd};
pub use tolerance::{PAPER_EPS_VAX, RankDecision, Tolerance};
