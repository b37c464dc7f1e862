//! Three-vectors and rotations over any scalar.
//!
//! Written out, without closures: what is not inlined loses the processor's features.

pub use roberval_scalar::vector::{
    Mat3, Vec3, add, apply, apply_transposed, cross, dot, lift3, lift9, negative, product, scale,
};
