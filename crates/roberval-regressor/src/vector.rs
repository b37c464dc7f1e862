//! Three-vectors and rotations over any scalar.

pub use roberval_scalar::vector::{
    Mat3, Vec3, add, apply, apply_transposed, cross, dot, product, scale,
};
