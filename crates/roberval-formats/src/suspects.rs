//! What looks like a slip of the pen in a description: warnings, whatever the format.

use roberval_mechanism::{Geometry, LinkDescription, RobotDescription};
use roberval_scalar::{Expr, Quantity};

use crate::words::list;

/// A plain number of radians beyond a full turn: most likely degrees.
pub(crate) const MOST_RADIANS: f64 = 7.0;

/// The links whose angles look like degrees, in a sentence.
pub(crate) fn degrees(robot: &RobotDescription) -> Option<String> {
    let suspect = |link: &&LinkDescription| in_degrees(link).is_some();
    let names = robot.links.iter().filter(suspect);
    let names: Vec<&str> = names.map(|link| link.name.as_str()).collect();
    let count = names.len();
    (count > 0).then(|| {
        format!(
            "links with angles above {MOST_RADIANS} rad ({count}): {}; are they degrees? \
             angles are in radians",
            list(names)
        )
    })
}

/// The first angle of a link that looks like degrees, with its key in a robot TOML.
pub(crate) fn in_degrees(link: &LinkDescription) -> Option<(&'static str, &Quantity)> {
    let angles: Vec<_> = match &link.geometry {
        Geometry::Mdh(g) => vec![
            ("gamma", &g.gamma),
            ("alpha", &g.alpha),
            ("theta", &g.theta),
        ],
        Geometry::Placed { origins, .. } => {
            let angles = origins.iter().flat_map(|o| &o.rpy);
            angles.map(|angle| ("rpy", angle)).collect()
        }
    };
    let suspect = |q: &Quantity| q.value.abs() > MOST_RADIANS && matches!(q.expr, Expr::Number(_));
    angles.into_iter().find(|(_, angle)| suspect(angle))
}

#[cfg(test)]
mod tests {
    use crate::{UrdfOptions, parse_toml, parse_urdf};

    #[test]
    fn angles_that_look_like_degrees_are_warned_of() {
        let toml = "link = [{ alpha = 90, d = 0, theta = 0, r = 0 }]";
        let robot = parse_toml(toml, "robot.toml").expect("valid");
        assert!(
            robot.warnings.iter().any(|w| w.contains("degrees")),
            "{:?}",
            robot.warnings
        );
        let turned = "link = [{ alpha = \"3*pi\", d = 0, theta = 0, r = 0 }]";
        let robot = parse_toml(turned, "robot.toml").expect("valid");
        assert!(robot.warnings.is_empty(), "{:?}", robot.warnings);
        let urdf = r#"<robot name="r"><link name="a"/><link name="b"/>
            <joint name="j" type="revolute"><parent link="a"/><child link="b"/>
            <origin rpy="90 0 0"/><limit effort="1" velocity="1"/></joint></robot>"#;
        let robot = parse_urdf(urdf, "r.urdf", UrdfOptions::default()).expect("valid");
        assert!(
            robot.warnings.iter().any(|w| w.contains("degrees")),
            "{:?}",
            robot.warnings
        );
    }
}
