//! Inertial parameters as moments of a distribution of mass.

use roberval_scalar::Scalar;

pub(super) type Vec3<T> = [T; 3];
pub(super) type Mat3<T> = [[T; 3]; 3];

/// Moments about the origin of a frame, in that frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Moments<T> {
    /// The integral of x x'.
    pub second: Mat3<T>,
    /// First moments.
    pub first: Vec3<T>,
    pub mass: T,
}

impl<T: Scalar> Moments<T> {
    pub fn zero(zero: T) -> Self {
        Self {
            second: [[zero; 3]; 3],
            first: [zero; 3],
            mass: zero,
        }
    }

    /// XX XY XZ YY YZ ZZ MX MY MZ M.
    pub fn parameters(&self) -> [T; 10] {
        let [[xx, xy, xz], [_, yy, yz], [_, _, zz]] = self.second;
        let [mx, my, mz] = self.first;
        [
            yy + zz,
            -xy,
            -xz,
            xx + zz,
            -yz,
            xx + yy,
            mx,
            my,
            mz,
            self.mass,
        ]
    }

    /// The same distribution seen from a frame in which this one lies so.
    pub fn moved(&self, rotation: &Mat3<T>, origin: Vec3<T>) -> Self {
        let p = origin;
        let first = turned(rotation, self.first);
        // A S A': the rows of S turned, then its columns.
        let half: Mat3<T> = self.second.map(|row| turned(rotation, row));
        let second = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let column = [half[0][j], half[1][j], half[2][j]];
                dot(rotation[i], column)
                    + first[i] * p[j]
                    + p[i] * first[j]
                    + self.mass * p[i] * p[j]
            })
        });
        Self {
            second,
            first: std::array::from_fn(|i| first[i] + self.mass * p[i]),
            mass: self.mass,
        }
    }

    pub fn negative(&self) -> Self {
        Self {
            second: self.second.map(|row| row.map(|x| -x)),
            first: self.first.map(|x| -x),
            mass: -self.mass,
        }
    }
}

/// e' J e for the k-th of XX XY XZ YY YZ ZZ alone being 1.
pub(super) fn unit_inertia<T: Scalar>(k: usize, e: Vec3<T>, zero: T) -> T {
    match k {
        0 => e[0] * e[0],
        1 => e[0] * e[1] + e[0] * e[1],
        2 => e[0] * e[2] + e[0] * e[2],
        3 => e[1] * e[1],
        4 => e[1] * e[2] + e[1] * e[2],
        5 => e[2] * e[2],
        _ => zero,
    }
}

pub(super) fn dot<T: Scalar>(a: Vec3<T>, b: Vec3<T>) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross<T: Scalar>(a: Vec3<T>, b: Vec3<T>) -> Vec3<T> {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// A v
pub(super) fn turned<T: Scalar>(a: &Mat3<T>, v: Vec3<T>) -> Vec3<T> {
    [dot(a[0], v), dot(a[1], v), dot(a[2], v)]
}

/// A' v
pub(super) fn returned<T: Scalar>(a: &Mat3<T>, v: Vec3<T>) -> Vec3<T> {
    [0, 1, 2].map(|k| dot([a[0][k], a[1][k], a[2][k]], v))
}
