//! Three-vectors and rotations over any scalar.
//!
//! Written out, without closures: what is not inlined loses the processor's features.

use crate::{Lift, Scalar};

/// A vector in some frame.
pub type Vec3<T> = [T; 3];
/// Rows of a 3 x 3 matrix.
pub type Mat3<T> = [[T; 3]; 3];

/// a + b
#[inline(always)]
#[must_use]
pub fn add<T: Scalar>(a: Vec3<T>, b: Vec3<T>) -> Vec3<T> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// s a
#[inline(always)]
#[must_use]
pub fn scale<T: Scalar>(a: Vec3<T>, s: T) -> Vec3<T> {
    [a[0] * s, a[1] * s, a[2] * s]
}

/// a - b
#[inline(always)]
#[must_use]
pub fn sub<T: Scalar>(a: Vec3<T>, b: Vec3<T>) -> Vec3<T> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// -a
#[inline(always)]
#[must_use]
pub fn negative<T: Scalar>(a: Vec3<T>) -> Vec3<T> {
    [-a[0], -a[1], -a[2]]
}

/// A vector of constants.
#[inline(always)]
#[must_use]
pub fn lift3<C: Copy, T: Lift<C>>(v: &Vec3<C>) -> Vec3<T> {
    [T::lift(v[0]), T::lift(v[1]), T::lift(v[2])]
}

/// A matrix of constants.
#[inline(always)]
#[must_use]
pub fn lift9<C: Copy, T: Lift<C>>(a: &Mat3<C>) -> Mat3<T> {
    [lift3(&a[0]), lift3(&a[1]), lift3(&a[2])]
}

/// a . b
#[inline(always)]
#[must_use]
pub fn dot<T: Scalar>(a: Vec3<T>, b: Vec3<T>) -> T {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}

/// a x b
#[inline(always)]
#[must_use]
pub fn cross<T: Scalar>(a: Vec3<T>, b: Vec3<T>) -> Vec3<T> {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// A b
#[inline(always)]
#[must_use]
pub fn apply<T: Scalar>(a: &Mat3<T>, b: Vec3<T>) -> Vec3<T> {
    [dot(a[0], b), dot(a[1], b), dot(a[2], b)]
}

/// A' b
#[inline(always)]
#[must_use]
pub fn apply_transposed<T: Scalar>(a: &Mat3<T>, b: Vec3<T>) -> Vec3<T> {
    [
        dot([a[0][0], a[1][0], a[2][0]], b),
        dot([a[0][1], a[1][1], a[2][1]], b),
        dot([a[0][2], a[1][2], a[2][2]], b),
    ]
}

/// A B
#[inline(always)]
#[must_use]
pub fn product<T: Scalar>(a: &Mat3<T>, b: &Mat3<T>) -> Mat3<T> {
    [
        apply_transposed(b, a[0]),
        apply_transposed(b, a[1]),
        apply_transposed(b, a[2]),
    ]
}

/// Rodrigues' rotation about the vector a: `cos I + sin [a]x + versine a a'`. For a unit
/// vector `versine = 1 - cos`; for a longer one sine and versine are divided by its length
/// and by its square.
#[inline(always)]
#[must_use]
pub fn rotation_about<T: Scalar>(a: Vec3<T>, cos: T, sin: T, versine: T) -> Mat3<T> {
    let s = [sin * a[0], sin * a[1], sin * a[2]];
    let v = [versine * a[0], versine * a[1], versine * a[2]];
    [
        [
            v[0].mul_add(a[0], cos),
            v[0] * a[1] - s[2],
            v[0].mul_add(a[2], s[1]),
        ],
        [
            v[1].mul_add(a[0], s[2]),
            v[1].mul_add(a[1], cos),
            v[1] * a[2] - s[0],
        ],
        [
            v[2] * a[0] - s[1],
            v[2].mul_add(a[1], s[0]),
            v[2].mul_add(a[2], cos),
        ],
    ]
}
