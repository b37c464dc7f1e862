use roberval_scalar::{Lift, Magnitude, Scalar};

use crate::vector::{Mat3, Vec3, add, apply_transposed, cross, dot, lift3};
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
    #[inline(always)]
    pub(crate) fn gravity<C: Scalar>(&self, tree: &Tree<C>) -> Vec3<T>
    where
        T: Lift<C>,
    {
        apply_transposed(&self.attitude, lift3(&tree.base_gravity()))
    }

    /// Gravity times the place of the origin.
    #[inline(always)]
    pub(crate) fn height<C: Scalar>(&self, tree: &Tree<C>) -> T
    where
        T: Lift<C>,
    {
        let of_joint = T::lift(dot(tree.gravity, tree.bodies[0].origin));
        of_joint + dot(lift3(&tree.base_gravity()), self.position)
    }

    /// Acceleration of the origin, gravity entering as that of the world, -g.
    #[inline(always)]
    pub(crate) fn acceleration<C: Scalar>(&self, tree: &Tree<C>) -> Vec3<T>
    where
        T: Lift<C>,
    {
        let a = add(self.dv, cross(self.w, self.v));
        let g = self.gravity(tree);
        [a[0] - g[0], a[1] - g[1], a[2] - g[2]]
    }
}

impl<T: Scalar> Tree<T> {
    /// Gravity in the frame of the first body's joint, the one that floats.
    #[inline(always)]
    fn base_gravity(&self) -> Vec3<T> {
        apply_transposed(&self.bodies[0].rotation, self.gravity)
    }
}

/// The rotation of a quaternion (x, y, z, w) of any length, given the inverse of its
/// squared length: `1 + 2 (w [v]x + [v]x [v]x) / |q|^2`.
#[inline(always)]
pub(crate) fn attitude<T: Scalar>(
    [x, y, z, w]: [T; 4],
    inverse_square: T,
    constants: Constants<T>,
) -> Mat3<T> {
    let one = constants.one;
    let twice = inverse_square + inverse_square;
    [
        [
            one - twice * pairs(y, y, z, z),
            twice * pairs(x, y, -w, z),
            twice * pairs(x, z, w, y),
        ],
        [
            twice * pairs(x, y, w, z),
            one - twice * pairs(x, x, z, z),
            twice * pairs(y, z, -w, x),
        ],
        [
            twice * pairs(x, z, -w, y),
            twice * pairs(y, z, w, x),
            one - twice * pairs(x, x, y, y),
        ],
    ]
}

/// `a b + c d`, no closure: see [`roberval_scalar::vector`].
#[inline(always)]
fn pairs<T: Scalar>(a: T, b: T, c: T, d: T) -> T {
    a * b + c * d
}

#[inline(always)]
/// The squared length of a quaternion.
#[must_use]
pub fn squared_length<T: Scalar>([x, y, z, w]: [T; 4]) -> T {
    x * x + y * y + z * z + w * w
}

impl<T: Scalar> BaseState<T> {
    /// The state in the coordinates of the user: q begins with x y z qx qy qz qw, qd with
    /// the velocities `v w`, qdd with `dv dw`. The quaternion may have any length, whose
    /// square's inverse is given.
    #[inline(always)]
    pub fn of([q, qd, qdd]: [&[T]; 3], constants: Constants<T>, inverse_square: T) -> Self {
        Self {
            attitude: attitude([q[3], q[4], q[5], q[6]], inverse_square, constants),
            position: [q[0], q[1], q[2]],
            v: [qd[0], qd[1], qd[2]],
            w: [qd[3], qd[4], qd[5]],
            dv: [qdd[0], qdd[1], qdd[2]],
            dw: [qdd[3], qdd[4], qdd[5]],
        }
    }
}

impl<T: Scalar + From<f64>> BaseState<T> {
    /// As [`BaseState::of`], from doubles.
    pub(crate) fn read(
        [q, qd, qdd]: [&[f64]; 3],
        constants: Constants<T>,
        inverse: impl Fn(T) -> T,
    ) -> Self {
        let q: [T; 7] = std::array::from_fn(|k| T::from(q[k]));
        let [qd, qdd] = [qd, qdd].map(|x| -> [T; 6] { std::array::from_fn(|k| T::from(x[k])) });
        let inverse_square = inverse(squared_length([q[3], q[4], q[5], q[6]]));
        Self::of([&q, &qd, &qdd], constants, inverse_square)
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
