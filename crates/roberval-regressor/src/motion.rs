use roberval_scalar::{Magnitude, Scalar};

use roberval_scalar::vector::rotation_about;

use crate::vector::{Mat3, Vec3};

/// Where a joint is and how it moves, as the recursion takes it: trigonometry is done
/// outside, because a prime field and an expression recorder have their own.
#[derive(Debug, Clone, Copy)]
pub struct JointMotion<T> {
    /// Cosine of the joint's angle (1 for a prismatic joint).
    pub cos: T,
    /// Sine of the joint's angle, divided by the length of the axis vector.
    pub sin: T,
    /// `1 - cos`, divided by the squared length of the axis vector.
    pub versine: T,
    /// Displacement along the axis of a prismatic joint; not looked at for a revolute one.
    pub q: T,
    /// Joint velocity, in units of the axis vector.
    pub qd: T,
    /// Joint acceleration, in units of the axis vector.
    pub qdd: T,
}

impl<T: Copy> JointMotion<T> {
    /// The motion of a fixed joint: zeros, and one the cosine.
    #[must_use]
    pub fn still(zero: T, one: T) -> Self {
        Self {
            cos: one,
            sin: zero,
            versine: zero,
            q: zero,
            qd: zero,
            qdd: zero,
        }
    }
}

impl JointMotion<f64> {
    /// The motion of a revolute joint about a unit axis.
    #[must_use]
    pub fn revolute(q: f64, qd: f64, qdd: f64) -> Self {
        let (sin, cos) = q.sin_cos();
        Self {
            cos,
            sin,
            versine: 1.0 - cos,
            q: 0.0,
            qd,
            qdd,
        }
    }

    /// The motion of a prismatic joint along a unit axis.
    #[must_use]
    pub fn prismatic(q: f64, qd: f64, qdd: f64) -> Self {
        Self {
            q,
            qd,
            qdd,
            ..Self::still(0.0, 1.0)
        }
    }

    /// The magnitudes of the motion, for error bounds.
    #[must_use]
    pub fn magnitude(&self) -> JointMotion<Magnitude> {
        JointMotion {
            cos: Magnitude::of(self.cos),
            sin: Magnitude::of(self.sin),
            versine: Magnitude::of(self.versine),
            q: Magnitude::of(self.q),
            qd: Magnitude::of(self.qd),
            qdd: Magnitude::of(self.qdd),
        }
    }
}

impl<T: Scalar> JointMotion<T> {
    /// Rodrigues' rotation about `axis`: `cos I + sin [a]x + versine a a'`.
    #[inline(always)]
    pub(crate) fn rotation(&self, a: Vec3<T>) -> Mat3<T> {
        rotation_about(a, self.cos, self.sin, self.versine)
    }
}
