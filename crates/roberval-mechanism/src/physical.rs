//! Whether some body could have the inertia that a robot file gives.

use std::fmt;

use nalgebra::Matrix3;

use crate::{Central, Link};

/// Decimals of a file are rounded: this much, of the largest entry, may be missing.
const ROUNDING: f64 = 1e-6;

/// Why no body has an inertia. `Display` gives a sentence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Unphysical {
    /// The mass is below zero, kg.
    NegativeMass(f64),
    /// An inertia or a first moment without mass.
    Massless,
    /// A principal moment about the centre of mass is below zero, kg m^2.
    NegativeMoment(f64),
    /// The largest principal moment is more than the sum of the other two, kg m^2; ascending.
    Triangle([f64; 3]),
}

/// What is wrong with the inertia `tensor` about the centre of mass of a body of this mass.
/// Mass is nowhere negative just if the second moments tr(J)/2 1 - J are not.
#[must_use]
pub fn unphysical(mass: f64, tensor: &Matrix3<f64>) -> Option<Unphysical> {
    judge(mass, tensor, tensor.amax())
}

impl Link {
    /// What is wrong with this link's inertial parameters; `None` as well where the file
    /// does not give all ten.
    #[must_use]
    pub fn unphysical(&self) -> Option<Unphysical> {
        let known = self.ten_parameters()?;
        let size = known[..6].iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        match Central::of(&known) {
            None => Some(Unphysical::Massless),
            // What is lost by cancelling is relative to J about the frame's origin.
            Some(body) => judge(body.mass, &body.tensor, size),
        }
    }

    /// XX XY XZ YY YZ ZZ MX MY MZ M where the file gives them all.
    #[must_use]
    pub fn ten_parameters(&self) -> Option<[f64; 10]> {
        let mut known = [0.0; 10];
        for (known, given) in known.iter_mut().zip(&self.inertia) {
            *known = (*given)?;
        }
        Some(known)
    }
}

fn judge(mass: f64, central: &Matrix3<f64>, size: f64) -> Option<Unphysical> {
    if mass < 0.0 {
        return Some(Unphysical::NegativeMass(mass));
    }
    if size == 0.0 {
        return None;
    }
    if mass == 0.0 {
        return Some(Unphysical::Massless);
    }
    let mut moments: [f64; 3] = (central / size).symmetric_eigenvalues().into();
    moments.sort_by(f64::total_cmp);
    let [a, b, c] = moments;
    if a < -ROUNDING {
        Some(Unphysical::NegativeMoment(a * size))
    } else if a + b < c - ROUNDING {
        Some(Unphysical::Triangle(moments.map(|x| x * size)))
    } else {
        None
    }
}

impl fmt::Display for Unphysical {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NegativeMass(mass) => write!(f, "its mass is {mass} kg, below zero"),
            Self::Massless => f.write_str("it has an inertia but no mass"),
            Self::NegativeMoment(moment) => write!(
                f,
                "about the centre of mass a principal moment of inertia is {moment:.3e} kg m^2, below zero"
            ),
            Self::Triangle([a, b, c]) => write!(
                f,
                "about the centre of mass the principal moments of inertia are {a:.3e}, {b:.3e} and {c:.3e} kg m^2: the largest is more than the sum of the others"
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    fn diagonal(a: f64, b: f64, c: f64) -> Matrix3<f64> {
        Matrix3::from_diagonal(&Vector3::new(a, b, c))
    }

    #[test]
    fn a_rod_a_plate_and_a_point_are_bodies() {
        assert_eq!(unphysical(1.0, &diagonal(1.0, 1.0, 0.0)), None);
        assert_eq!(unphysical(1.0, &diagonal(1.0, 2.0, 3.0)), None);
        assert_eq!(unphysical(2.0, &Matrix3::zeros()), None);
        assert_eq!(unphysical(0.0, &Matrix3::zeros()), None);
        // Rounded decimals of a rod.
        assert_eq!(unphysical(1.0, &diagonal(1.0, 0.999_999_5, 0.0)), None);
    }

    #[test]
    fn each_fault_has_its_name() {
        use Unphysical::*;
        assert_eq!(
            unphysical(-1.0, &diagonal(1.0, 1.0, 1.0)),
            Some(NegativeMass(-1.0))
        );
        assert_eq!(unphysical(0.0, &diagonal(1.0, 1.0, 1.0)), Some(Massless));
        assert!(matches!(
            unphysical(1.0, &diagonal(1.0, -1.0, 1.0)),
            Some(NegativeMoment(x)) if (x + 1.0).abs() < 1e-12
        ));
        assert!(matches!(
            unphysical(1.0, &diagonal(3.0, 1.0, 1.0)),
            Some(Triangle([_, _, c])) if (c - 3.0).abs() < 1e-12
        ));
    }
}
