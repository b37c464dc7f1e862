use std::ops::{Add, AddAssign};

use nalgebra::{Matrix3, Vector3};
use roberval_mechanism::Origin;
use roberval_scalar::{LiteralError, Quantity};

/// Mass, first moment and inertia tensor of a body about the origin of a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Inertia {
    /// M, kg.
    pub mass: f64,
    /// (MX, MY, MZ), kg m.
    pub first: Vector3<f64>,
    /// J about the origin, kg m^2; XY, XZ, YZ are its off-diagonal entries.
    pub tensor: Matrix3<f64>,
}

impl Inertia {
    /// A body whose centre of mass is the origin; moments in the order xx xy xz yy yz zz.
    pub fn central(mass: f64, [xx, xy, xz, yy, yz, zz]: [f64; 6]) -> Self {
        Self {
            mass,
            first: Vector3::zeros(),
            tensor: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
        }
    }

    /// The same body seen from the frame in which its own frame is placed at `origin`:
    /// with s = R (MX, MY, MZ) and the position p,
    /// J' = R J R' + 2 (p.s) 1 - p s' - s p' + M (p.p 1 - p p').
    pub fn placed(&self, origin: &Origin) -> Self {
        let (r, p) = origin.placement();
        let s = r * self.first;
        let one = Matrix3::identity();
        let steiner = (one * p.dot(&p) - p * p.transpose()) * self.mass;
        let mixed = one * (2.0 * p.dot(&s)) - p * s.transpose() - s * p.transpose();
        Self {
            mass: self.mass,
            first: s + p * self.mass,
            tensor: r * self.tensor * r.transpose() + mixed + steiner,
        }
    }

    /// XX XY XZ YY YZ ZZ MX MY MZ M; no rotor inertia.
    pub fn parameters(&self) -> Result<[Option<Quantity>; 11], LiteralError> {
        let (j, s) = (&self.tensor, &self.first);
        let numbers = [
            j[(0, 0)],
            j[(0, 1)],
            j[(0, 2)],
            j[(1, 1)],
            j[(1, 2)],
            j[(2, 2)],
            s[0],
            s[1],
            s[2],
            self.mass,
        ];
        let mut parameters: [Option<Quantity>; 11] = Default::default();
        for (parameter, number) in parameters.iter_mut().zip(numbers) {
            *parameter = Some(Quantity::from_f64(number)?);
        }
        Ok(parameters)
    }
}

impl Add for Inertia {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            mass: self.mass + other.mass,
            first: self.first + other.first,
            tensor: self.tensor + other.tensor,
        }
    }
}

impl AddAssign for Inertia {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
