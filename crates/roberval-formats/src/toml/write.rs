use std::fmt::Write;

use roberval_mechanism::{
    Couple, Geometry, LinkDescription, ParameterKind, RobotDescription, SourceFormat, Term,
};
use roberval_scalar::Quantity;
use toml_edit::Value;

use super::BASE;
use crate::error::{Code, FormatError};
use crate::words::quoted;

/// Writes a description as robot TOML; [`super::parse_toml`] gives the same description
/// back, literals and all.
///
/// # Errors
/// When the description is no modified Denavit-Hartenberg description (a URDF robot has
/// frames that its parameters cannot hold), or has what the form cannot hold (joint
/// names, limits).
pub fn to_toml(robot: &RobotDescription) -> Result<String, FormatError> {
    let refuse = |what: String| FormatError::new(Code::NotWritable, robot.name.as_str(), what);
    if robot.format != SourceFormat::Mdh {
        return Err(refuse(
            "a URDF robot cannot be written as robot TOML: its frames need not follow the \
             modified Denavit-Hartenberg rules"
                .to_owned(),
        )
        .hint("keep the URDF file"));
    }
    let mut text = String::new();
    head(&mut text, robot);
    for description in &robot.links {
        let dependent = robot.couples.iter().any(|c| c.joint == description.name);
        link(&mut text, description, dependent).map_err(refuse)?;
    }
    for description in &robot.couples {
        couple(&mut text, description);
    }
    Ok(text)
}

fn head(text: &mut String, robot: &RobotDescription) {
    line(text, "name", &string(&robot.name));
    let gravity: Vec<String> = robot.gravity.iter().map(number).collect();
    line(text, "gravity", &format!("[{}]", gravity.join(", ")));
    if !robot.constants.is_empty() {
        text.push_str("\n[constants]\n");
    }
    for (name, value) in &robot.constants {
        line(text, name, &number(value));
    }
}

fn link(text: &mut String, link: &LinkDescription, dependent: bool) -> Result<(), String> {
    let Geometry::Mdh(geometry) = &link.geometry else {
        return Err(format!(
            "link {} has no modified Denavit-Hartenberg parameters",
            quoted(&link.name)
        ));
    };
    if link.joint_name.is_some() || link.limits.is_some() || link.massless {
        return Err(format!(
            "link {}: robot TOML has no joint names, limits or massless links",
            quoted(&link.name)
        ));
    }
    text.push_str("\n[[link]]\n");
    line(text, "name", &string(&link.name));
    let antecedent = link.antecedent.as_deref().unwrap_or(BASE);
    line(text, "antecedent", &string(antecedent));
    line(text, "joint", &string(link.joint.name()));
    if link.active != (link.joint.has_axis() && !dependent) {
        line(text, "active", &link.active.to_string());
    }
    if link.rotor != (link.active && link.joint.has_axis()) {
        line(text, "rotor", &link.rotor.to_string());
    }
    for (key, value) in [
        ("gamma", &geometry.gamma),
        ("b", &geometry.b),
        ("alpha", &geometry.alpha),
        ("d", &geometry.d),
        ("theta", &geometry.theta),
        ("r", &geometry.r),
    ] {
        line(text, key, &number(value));
    }
    inertia(text, link);
    Ok(())
}

fn inertia(text: &mut String, link: &LinkDescription) {
    let entries: Vec<String> = ParameterKind::ALL
        .iter()
        .zip(&link.inertia)
        .filter_map(|(kind, value)| Some(format!("{kind} = {}", number(value.as_ref()?))))
        .collect();
    if !entries.is_empty() {
        line(text, "inertia", &format!("{{ {} }}", entries.join(", ")));
    }
}

fn couple(text: &mut String, couple: &Couple) {
    let term = |t: &Term| format!("{} = {}", string(&t.joint), number(&t.multiplier));
    let terms: Vec<String> = couple.terms.iter().map(term).collect();
    text.push_str("\n[[couple]]\n");
    line(text, "joint", &string(&couple.joint));
    line(text, "equals", &format!("{{ {} }}", terms.join(", ")));
    line(text, "offset", &number(&couple.offset));
}

fn line(text: &mut String, key: &str, value: &str) {
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{key} = {value}");
}

fn string(text: &str) -> String {
    Value::from(text).to_string()
}

/// A number as it was written where TOML allows that, else as a string.
pub(super) fn number(quantity: &Quantity) -> String {
    let text = &quantity.text;
    let plain = text
        .bytes()
        .all(|b| b.is_ascii_digit() || b"+-.eE".contains(&b))
        && text
            .parse::<Value>()
            .is_ok_and(|value| value.is_integer() || value.is_float());
    if plain { text.clone() } else { string(text) }
}
