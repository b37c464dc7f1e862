//! A link's constant placement on its antecedent, as numbers.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Matrix3, Vector3};
use roberval_scalar::Quantity;

use crate::{Geometry, Link, LinkDescription, MdhGeometry, MechanismError, Origin};

/// How far, in units of eps, an angle may lie from a multiple of pi/2 and still be the
/// double nearest to it after a decimal or degree conversion.
const RIGHT_ANGLE_ULPS: f64 = 4.0;

/// A product of rotations has errors of some eps in entries that should be 0 or +-1.
const ROTATION_DUST: f64 = 16.0 * f64::EPSILON;

pub(crate) fn link(
    written: &LinkDescription,
    in_file: usize,
    antecedent: Option<usize>,
) -> Result<Link, MechanismError> {
    let (rotation, origin, axis) = match &written.geometry {
        Geometry::Mdh(g) => mdh(g),
        Geometry::Placed { origins, axis } => {
            let (rotation, origin) = chain(origins);
            (rotation, origin, Vector3::from_fn(|i, _| axis[i].value))
        }
    };
    finite(rotation.iter(), &written.name, "the frame's orientation")?;
    finite(origin.iter(), &written.name, "the frame's position")?;
    finite(axis.iter(), &written.name, "the joint axis")?;
    if axis.norm() == 0.0 && written.joint.has_axis() {
        return Err(MechanismError::ZeroAxis {
            link: written.name.clone(),
        });
    }
    let inertia = written
        .inertia
        .each_ref()
        .map(|x| x.as_ref().map(|quantity| quantity.value));
    finite(
        inertia.iter().flatten(),
        &written.name,
        "an inertial parameter",
    )?;
    Ok(Link {
        in_file,
        name: written.name.clone(),
        joint_name: written.joint_name.clone(),
        antecedent,
        joint: written.joint,
        active: written.active,
        rotor: written.rotor && !written.massless,
        massless: written.massless,
        rotation: without_dust(rotation),
        origin,
        axis: axis.try_normalize(0.0).unwrap_or_else(Vector3::z),
        inertia,
    })
}

pub(crate) fn finite<'a>(
    mut numbers: impl Iterator<Item = &'a f64>,
    link: &str,
    field: &str,
) -> Result<(), MechanismError> {
    match numbers.find(|x| !x.is_finite()) {
        None => Ok(()),
        Some(&value) => Err(MechanismError::NotFinite {
            link: link.to_owned(),
            field: field.to_owned(),
            value,
        }),
    }
}

/// Rot(z, gamma) Trans(z, b) Rot(x, alpha) Trans(x, d) Rot(z, theta) Trans(z, r).
fn mdh(g: &MdhGeometry) -> (Matrix3<f64>, Vector3<f64>, Vector3<f64>) {
    let twist = rot_z(&g.gamma) * rot_x(&g.alpha);
    let origin = Vector3::z() * g.b.value + twist * Vector3::new(g.d.value, 0.0, g.r.value);
    (twist * rot_z(&g.theta), origin, Vector3::z())
}

/// Constant placements, one after the other.
fn chain(origins: &[Origin]) -> (Matrix3<f64>, Vector3<f64>) {
    let start = (Matrix3::identity(), Vector3::zeros());
    origins.iter().fold(start, |(rotation, position), origin| {
        let (turn, shift) = origin.placement();
        (without_dust(rotation * turn), position + rotation * shift)
    })
}

/// Cosine and sine, exact at the doubles nearest to multiples of pi/2.
pub(crate) fn cos_sin(angle: f64) -> (f64, f64) {
    let quarters = (angle / FRAC_PI_2).round();
    let error = (angle - quarters * FRAC_PI_2).abs();
    if error <= RIGHT_ANGLE_ULPS * f64::EPSILON * angle.abs() {
        return [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)]
            [(quarters.rem_euclid(4.0)) as usize];
    }
    (angle.cos(), angle.sin())
}

fn rot_x(angle: &Quantity) -> Matrix3<f64> {
    let (c, s) = cos_sin(angle.value);
    Matrix3::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c)
}

fn rot_z(angle: &Quantity) -> Matrix3<f64> {
    let (c, s) = cos_sin(angle.value);
    Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0)
}

fn without_dust(rotation: Matrix3<f64>) -> Matrix3<f64> {
    rotation.map(|x| {
        let whole = x.round();
        if (x - whole).abs() <= ROTATION_DUST {
            whole
        } else {
            x
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn right_angles_have_exact_cosines() {
        for k in -9_i32..9 {
            let (c, s) = cos_sin(f64::from(k) * FRAC_PI_2);
            assert_eq!(c.abs() + s.abs(), 1.0, "k = {k}");
            assert!((c - (f64::from(k) * FRAC_PI_2).cos()).abs() < 1e-14);
        }
        assert_eq!(cos_sin(-90.0 * (PI / 180.0)), (0.0, -1.0));
    }

    #[test]
    fn rounded_right_angles_are_left_as_written() {
        assert_eq!(cos_sin(1.57).0, 1.57_f64.cos());
        assert_eq!(cos_sin(1e-15), (1e-15_f64.cos(), 1e-15_f64.sin()));
    }
}
