//! The same robot as a careless file would write it.

use roberval_mechanism::{Geometry, JointKind, RobotDescription};
use roberval_scalar::{Quantity, SplitMix64};
use std::f64::consts::PI;

/// The robot with every angle written as a decimal with this many digits behind the point.
#[must_use]
pub fn literal_style(robot: &RobotDescription, decimals: usize) -> RobotDescription {
    let mut styled = robot.clone();
    for angle in angles_mut(&mut styled) {
        *angle = written(format!("{:.decimals$}", angle.value));
    }
    styled
}

/// The robot with every zero length and axis component (of a moving joint) replaced by
/// dust of 1e-17 to 1e-7, m or relative, of either sign.
#[must_use]
pub fn dusty(robot: &RobotDescription, seed: u64) -> RobotDescription {
    let mut random = SplitMix64::new(seed);
    let mut dusty = robot.clone();
    for number in lengths_mut(&mut dusty)
        .into_iter()
        .filter(|x| x.value == 0.0)
    {
        let sign = if random.below(2) == 0 { "" } else { "-" };
        let exponent = 7 + random.below(11);
        *number = written(format!("{sign}1.5e-{exponent}"));
    }
    dusty
}

/// The robot with every angle moved to a generic one, at least `least` rad from every
/// multiple of pi/12, written with six decimals.
#[must_use]
pub fn tilted(robot: &RobotDescription, seed: u64, least: f64) -> RobotDescription {
    let mut random = SplitMix64::new(seed);
    let mut tilted = robot.clone();
    for angle in angles_mut(&mut tilted) {
        let multiple = f64::from(random.below(25) as u32) - 12.0;
        let sign = if random.below(2) == 0 { 1.0 } else { -1.0 };
        // From `least` to half of pi/12, small distances as often as large ones; the
        // sixth decimal may round towards the multiple.
        let distance = (least + 1e-6) * (PI / 24.0 / (least + 2e-6)).powf(random.uniform(0.0, 1.0));
        *angle = written(format!("{:.6}", multiple * PI / 12.0 + sign * distance));
    }
    tilted
}

fn written(text: String) -> Quantity {
    Quantity::parse_decimal(&text).expect("a decimal")
}

/// Every angle of the geometry.
pub fn angles_mut(robot: &mut RobotDescription) -> Vec<&mut Quantity> {
    let mut angles = Vec::new();
    for link in &mut robot.links {
        match &mut link.geometry {
            Geometry::Mdh(g) => angles.extend([&mut g.gamma, &mut g.alpha, &mut g.theta]),
            Geometry::Placed { origins, .. } => {
                angles.extend(origins.iter_mut().flat_map(|o| &mut o.rpy));
            }
        }
    }
    angles
}

/// Every length of the geometry, and every component of a moving joint's axis.
pub fn lengths_mut(robot: &mut RobotDescription) -> Vec<&mut Quantity> {
    let mut lengths = Vec::new();
    for link in &mut robot.links {
        match &mut link.geometry {
            Geometry::Mdh(g) => lengths.extend([&mut g.b, &mut g.d, &mut g.r]),
            Geometry::Placed { origins, axis } => {
                lengths.extend(origins.iter_mut().flat_map(|o| &mut o.xyz));
                if link.joint != JointKind::Fixed {
                    lengths.extend(axis);
                }
            }
        }
    }
    lengths
}
