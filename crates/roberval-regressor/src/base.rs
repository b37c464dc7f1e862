use roberval_scalar::{Magnitude, Scalar};

use crate::vector::{Mat3, Vec3, add, apply_transposed, cross, dot};
use crate::{Constants, Tree};

/// Where the base of a floating robot is and how it moves, all but the place in its own
/// frame: Pinocchio's free flyer.
#[derive(Debug, Clone, Copy)]
pub struct BaseState<T> {
    /// Rotation from the base's frame to that of its joint.
    pub attitude: Mat3<T>,
    /// Origin in the frame of its joint.
    pub position: Vec3<T>,
    /// Velocity of the origin.
    pub v: Vec3<T>,
    /// Angular velocity.
    pub w: Vec3<T>,
    /// Rate of `v`: the spatial acceleration. The origin accelerates by `dv + w x v`.
    pub dv: Vec3<T>,
    /// Angular acceleration.
    pub dw: Vec3<T>,
}

impl<T: Scalar> BaseState<T> {
    /// The same with the velocities zero, for d0.
    pub(crate) fn at_rest(self, zero: T) -> Self {
        Self {
            v: [zero; 3],
            w: [zero; 3],
            ..self
        }
    }

    /// Gravity in the base's frame.
    pub(crate) fn gravity(&self, tree: &Tree<T>) -> Vec3<T> {
        apply_transposed(&self.attitude, tree.base_gravity())
    }

    /// Gravity times the place of the origin.
    pub(crate) fn height(&self, tree: &Tree<T>) -> T {
        dot(tree.gravity, tree.bodies[0].origin) + dot(tree.base_gravity(), self.position)
    }

    /// Acceleration of the origin, gravity entering as that of the world, -g.
    pub(crate) fn acceleration(&self, tree: &Tree<T>) -> Vec3<T> {
        let a = add(self.dv, cross(self.w, self.v));
        let g = self.gravity(tree);
        [a[0] - g[0], a[1] - g[1], a[2] - g[2]]
    }
}

impl<T: Scalar> Tree<T> {
    /// Gravity in the frame of the first body's joint, the one that floats.
    fn base_gravity(&self) -> Vec3<T> {
        apply_transposed(&self.bodies[0].rotation, self.gravity)
    }
}

/// The rotation of a quaternion (x, y, z, w) of any length, given the inverse of its
/// squared length: `1 + 2 (w [v]x + [v]x [v]x) / |q|^2`.
pub(crate) fn attitude<T: Scalar>(
    [x, y, z, w]: [T; 4],
    inverse_square: T,
    constants: Constants<T>,
) -> Mat3<T> {
    let one = constants.one;
    let twice = inverse_square + inverse_square;
    let entry = |a: T, b: T, c: T, d: T| twice * (a * b + c * d);
    let diagonal = |a: T, b: T| one - entry(a, a, b, b);
    [
        [diagonal(y, z), entry(x, y, -w, z), entry(x, z, w, y)],
        [entry(x, y, w, z), diagonal(x, z), entry(y, z, -w, x)],
        [entry(x, z, -w, y), entry(y, z, w, x), diagonal(x, y)],
    ]
}

pub(crate) fn squared_length<T: Scalar>([x, y, z, w]: [T; 4]) -> T {
    x * x + y * y + z * z + w * w
}

impl<T: Scalar + From<f64>> BaseState<T> {
    /// The state in the coordinates of the user: q begins with x y z qx qy qz qw, qd with
    /// the velocities `v w`, qdd with `dv dw`. The quaternion may have any length.
    pub(crate) fn read(
        [q, qd, qdd]: [&[f64]; 3],
        constants: Constants<T>,
        inverse: impl Fn(T) -> T,
    ) -> Self {
        let three = |x: &[f64], at: usize| [x[at], x[at + 1], x[at + 2]].map(T::from);
        let quaternion = [q[3], q[4], q[5], q[6]].map(T::from);
        let inverse_square = inverse(squared_length(quaternion));
        Self {
            attitude: attitude(quaternion, inverse_square, constants),
            position: three(q, 0),
            v: three(qd, 0),
            w: three(qd, 3),
            dv: three(qdd, 0),
            dw: three(qdd, 3),
        }
    }
}

impl BaseState<f64> {
    /// The magnitudes of the state, for error bounds.
    #[must_use]
    pub fn magnitude(&self) -> BaseState<Magnitude> {
        let vector = |v: Vec3<f64>| v.map(Magnitude::of);
        BaseState {
            attitude: self.attitude.map(vector),
            position: vector(self.position),
            v: vector(self.v),
            w: vector(self.w),
            dv: vector(self.dv),
            dw: vector(self.dw),
        }
    }
}
