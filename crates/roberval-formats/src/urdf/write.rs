use std::collections::HashSet;
use std::fmt::Write;

use nalgebra::Matrix3;
use roberval_mechanism::{Convention, JointKind, Link, Mechanism};

use crate::error::{Code, FormatError};
use crate::words::quoted;

/// The link that a robot's base becomes, if no link has this name.
const BASE: &str = "base_link";

/// Writes a robot as URDF: links with the same frames, joints, known inertias, and joints
/// that copy one other as `mimic`. Reading it gives the same robot, but for rotor inertias
/// and gravity, which URDF does not have; a comment tells them. Numbers are written in full.
///
/// # Errors
/// When a joint follows from several others, an inertia has no centre of mass, or a link
/// has no body.
pub fn to_urdf(mechanism: &Mechanism) -> Result<String, FormatError> {
    let refuse = |what: String| FormatError::new(Code::NotWritable, mechanism.name.as_str(), what);
    if !mechanism.description.loops.is_empty() {
        let what = "a URDF holds trees only: the robot's loops would be lost";
        return Err(refuse(what.to_owned()).hint("keep the robot TOML"));
    }
    let mut text = String::new();
    // Writing to a string does not fail.
    let _ = writeln!(text, "<?xml version=\"1.0\"?>");
    let _ = writeln!(text, "<robot name=\"{}\">", escaped(&mechanism.name));
    let g = mechanism.gravity;
    let _ = writeln!(text, "  <!-- gravity {} {} {} -->", g.x, g.y, g.z);
    let names: HashSet<&str> = mechanism.links.iter().map(|l| l.name.as_str()).collect();
    let mut base = BASE.to_owned();
    while names.contains(base.as_str()) {
        base.push('_');
    }
    let _ = writeln!(text, "  <link name=\"{base}\"/>");
    for link in &mechanism.links {
        body(&mut text, link).map_err(&refuse)?;
    }
    for (j, link) in mechanism.links.iter().enumerate() {
        let parent = match link.antecedent {
            Some(a) => mechanism.links[a].name.as_str(),
            None => base.as_str(),
        };
        joint(&mut text, mechanism, j, parent).map_err(&refuse)?;
    }
    text.push_str("</robot>\n");
    Ok(text)
}

fn body(text: &mut String, link: &Link) -> Result<(), String> {
    if link.massless {
        let name = quoted(&link.name);
        return Err(format!(
            "link {name} has no body, which URDF cannot tell from an unknown one"
        ));
    }
    let name = escaped(&link.name);
    let Some(ten) = link.ten_parameters() else {
        let _ = writeln!(text, "  <link name=\"{name}\"/>");
        return Ok(());
    };
    let Some(numbers) = Convention::Urdf.of_paper(&ten) else {
        let name = quoted(&link.name);
        return Err(format!("link {name} has a first moment without mass"));
    };
    let _ = writeln!(text, "  <link name=\"{name}\">\n    <inertial>");
    let [mass, x, y, z, moments @ ..] = numbers.as_slice() else {
        return Ok(());
    };
    let _ = writeln!(text, "      <origin xyz=\"{x} {y} {z}\"/>");
    let _ = writeln!(text, "      <mass value=\"{mass}\"/>");
    text.push_str("      <inertia");
    for (key, moment) in ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"]
        .iter()
        .zip(moments)
    {
        let _ = write!(text, " {key}=\"{moment}\"");
    }
    text.push_str("/>\n    </inertial>\n");
    if let Some(rotor) = link.inertia[10] {
        let _ = writeln!(text, "    <!-- rotor inertia {rotor} -->");
    }
    text.push_str("  </link>\n");
    Ok(())
}

fn joint(text: &mut String, mechanism: &Mechanism, j: usize, parent: &str) -> Result<(), String> {
    let link = &mechanism.links[j];
    let limits = mechanism.description.links[link.in_file].limits;
    let kind = match (link.joint, limits) {
        (JointKind::Revolute, Some(_)) => "revolute",
        (JointKind::Revolute, None) => "continuous",
        (JointKind::Prismatic, _) => "prismatic",
        (JointKind::Fixed, _) => "fixed",
        (JointKind::Floating, _) => "floating",
    };
    let name = joint_name(link);
    let _ = writeln!(
        text,
        "  <joint name=\"{}\" type=\"{kind}\">",
        escaped(&name)
    );
    let _ = writeln!(text, "    <parent link=\"{}\"/>", escaped(parent));
    let _ = writeln!(text, "    <child link=\"{}\"/>", escaped(&link.name));
    let (p, [roll, pitch, yaw]) = (link.origin, roll_pitch_yaw(&link.rotation));
    let _ = writeln!(
        text,
        "    <origin xyz=\"{} {} {}\" rpy=\"{roll} {pitch} {yaw}\"/>",
        p.x, p.y, p.z
    );
    if link.joint.has_axis() {
        let a = link.axis;
        let _ = writeln!(text, "    <axis xyz=\"{} {} {}\"/>", a.x, a.y, a.z);
    }
    if let Some((lower, upper)) = limits {
        let _ = writeln!(
            text,
            "    <limit lower=\"{lower}\" upper=\"{upper}\" effort=\"0\" velocity=\"0\"/>"
        );
    }
    let mut couples = mechanism.description.couples.iter();
    if let Some(couple) = couples.find(|c| c.joint == link.name) {
        let [term] = couple.terms.as_slice() else {
            let what = "follows from several joints, a mimic joint of URDF from one";
            return Err(format!("the joint of link {} {what}", quoted(&link.name)));
        };
        let copied = mechanism.links.iter().find(|l| l.name == term.joint);
        let _ = writeln!(
            text,
            "    <mimic joint=\"{}\" multiplier=\"{}\" offset=\"{}\"/>",
            escaped(&copied.map_or_else(|| term.joint.clone(), joint_name)),
            term.multiplier.value,
            couple.offset.value
        );
    }
    text.push_str("  </joint>\n");
    Ok(())
}

/// The joint's name, or one made of the link's.
fn joint_name(link: &Link) -> String {
    let own = || format!("{}_joint", link.name);
    link.joint_name.clone().unwrap_or_else(own)
}

/// Rot(z, yaw) Rot(y, pitch) Rot(x, roll). Where x points along z, roll is taken as 0.
fn roll_pitch_yaw(r: &Matrix3<f64>) -> [f64; 3] {
    /// Nearer to the pole than this, roll and yaw are one angle.
    const POLE: f64 = 1e-12;
    let level = r[(0, 0)].hypot(r[(1, 0)]);
    let pitch = (-r[(2, 0)]).atan2(level);
    if level < POLE {
        let yaw = (-r[(0, 1)]).atan2(r[(1, 1)]);
        return [0.0, pitch, yaw];
    }
    let roll = r[(2, 1)].atan2(r[(2, 2)]);
    [roll, pitch, r[(1, 0)].atan2(r[(0, 0)])]
}

/// A name in an attribute.
fn escaped(name: &str) -> String {
    name.chars().fold(String::new(), |mut text, c| {
        match c {
            '&' => text.push_str("&amp;"),
            '<' => text.push_str("&lt;"),
            '>' => text.push_str("&gt;"),
            '"' => text.push_str("&quot;"),
            _ => text.push(c),
        }
        text
    })
}
