//! Inertial values of a URDF link: possible ones, in the right unit.

use nalgebra::Matrix3;
use roberval_mechanism::unphysical;

use super::{Finding, Rule};
use crate::urdf::Element;

/// A robot's link with a radius of gyration outside this range, m, is in another unit or a
/// placeholder: a motor's rotor has millimetres, an excavator's boom some metres.
const GYRATION: (f64, f64) = (1e-4, 5.0);

/// A link has its centre of mass nearer to its frame than this, m.
const FARTHEST_CENTRE: f64 = 10.0;

/// A link has less mass than this, kg.
const LARGEST_MASS: f64 = 10_000.0;

/// Below this, kg, a link is a dummy whose inertia nobody looks at.
const DUMMY_MASS: f64 = 1e-3;

/// What is wrong with the inertial values of a link; what cannot be read is told
/// elsewhere.
pub(super) fn findings(link: &Element) -> Vec<Finding> {
    let Ok(Some(inertial)) = link.child("inertial") else {
        return Vec::new();
    };
    let number = |tag: &str, key: &str| inertial.child(tag).ok()??.number(key).ok()?;
    let Some(mass) = number("mass", "value").map(|m| m.value) else {
        return Vec::new();
    };
    let moment = |key: &str| number("inertia", key).map(|x| x.value);
    let moments = ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"].map(moment);
    let found = |rule, tag: &str, what: String, remedy: &str| {
        let at = match inertial.child(tag) {
            Ok(Some(element)) => element,
            _ => inertial,
        };
        Finding::new(
            rule,
            link.source.name,
            format!("{}: {what}", link.place),
            remedy,
        )
        .at(at.source.position(at.offset()))
    };
    let mut findings = Vec::new();
    if mass > LARGEST_MASS {
        let what = format!("its mass is {mass} kg");
        findings.push(found(
            Rule::Units,
            "mass",
            what,
            "is it in grams? URDF wants kg",
        ));
    }
    if let [Some(xx), Some(xy), Some(xz), Some(yy), Some(yz), Some(zz)] = moments {
        let tensor = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        if let Some(fault) = unphysical(mass, &tensor) {
            let tag = if mass < 0.0 { "mass" } else { "inertia" };
            let remedy = "no body is like this, and simulators may fail: take mass and inertia \
                          about the centre of mass from CAD again";
            findings.push(found(Rule::Inertia, tag, fault.to_string(), remedy));
        } else if mass > DUMMY_MASS {
            let gyration = (tensor.trace() / (2.0 * mass)).sqrt();
            if let Some(remedy) = unit(gyration) {
                let what = format!("its radius of gyration is {gyration:.3e} m");
                findings.push(found(Rule::Units, "inertia", what, remedy));
            }
        }
    }
    let centre = inertial.child("origin").ok().flatten();
    if let Some(Ok(Some(xyz))) = centre.map(|o| o.numbers::<3>("xyz")) {
        let distance = xyz.iter().map(|x| x.value * x.value).sum::<f64>().sqrt();
        if distance > FARTHEST_CENTRE {
            let what = format!("its centre of mass is {distance} m away");
            let remedy = "is it in millimetres? URDF wants m";
            findings.push(found(Rule::Units, "origin", what, remedy));
        }
    }
    findings
}

/// What to say to a radius of gyration that no link has.
fn unit(gyration: f64) -> Option<&'static str> {
    if gyration > GYRATION.1 {
        Some("is the inertia in g mm^2 or kg mm^2? URDF wants kg m^2")
    } else if gyration < GYRATION.0 {
        Some("is the inertia a placeholder, or in another unit? URDF wants kg m^2")
    } else {
        None
    }
}
