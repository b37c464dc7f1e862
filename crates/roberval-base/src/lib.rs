//! Gautier's method: the base inertial parameters of a mechanism.
//!
//! The straight line of [`base_parameters`]: samples -> observation matrix W -> columns
//! without effect out -> rank b -> choice of columns -> beta -> [`BaseParameters`].

mod certificate;
mod choice;
mod compare;
mod diagnosis;
mod engine;
mod error;
mod exact;
mod literal;
mod method;
mod nullspace;
mod observation;
mod precise;
mod result;
mod sample;
mod scaling;

pub use certificate::{
    CertificateError, CertificateNotes, certificate, certificate_text, robot_sha256,
};
pub use choice::Choice;
pub use compare::{Comparison, Failure, Route, compare};
pub use diagnosis::{Diagnosis, Opened, Structure, Witness};
pub use engine::Engine;
pub use error::BaseError;
pub use exact::{
    ExactDecision, ExactError, ExactNumber, LoopForm, Run, choose_exactly, constraints_held,
    decide_exactly, eliminate,
};
pub use literal::{Blame, Literal};
pub use method::{Options, base_parameters, base_parameters_at};
pub use nullspace::{NullspaceDecision, nullspace_rank};
pub use observation::{Observation, observe};
pub use precise::{PreciseDecision, Precision, decide_precisely};
pub use result::{BaseParameters, Relation, Tally};
pub use roberval_linalg::{Matrix, PAPER_EPS_VAX, Tolerance};
pub use roberval_regressor::Model;
pub use sample::{SampleError, Samples};
pub use scaling::{Grade, Scaling, ScalingOptions, ScalingProgress, scale};
