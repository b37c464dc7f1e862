use std::fmt::Write;

use roberval_mechanism::{
    Couple, Geometry, LinkDescription, LoopClosure, ParameterKind, RobotDescription, SourceFormat,
    Term,
};
use roberval_scalar::Quantity;
use toml_edit::{Key, Value};

use super::BASE;
use crate::error::{Code, FormatError};
use crate::words::quoted;

/// Writes a description as robot TOML; [`super::parse_toml`] gives the same description
/// back, literals and all.
///
/// # Errors
/// When the description comes from a URDF or has what the form cannot hold: several
/// placements of one link, limits.
pub fn to_toml(robot: &RobotDescription) -> Result<String, FormatError> {
    let refuse = |what: String| FormatError::new(Code::NotWritable, robot.name.as_str(), what);
    if robot.format == SourceFormat::Urdf {
        let what = "a URDF robot cannot be written as robot TOML, which has no limits and lumps \
                    no fixed joints";
        return Err(refuse(what.to_owned()).hint("keep the URDF file"));
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
    for description in &robot.loops {
        closure(&mut text, description);
    }
    Ok(text)
}

fn head(text: &mut String, robot: &RobotDescription) {
    line(text, "name", &string(&robot.name));
    let gravity: Vec<String> = robot.gravity.iter().map(number).collect();
    line(text, "gravity", &format!("[{}]", gravity.join(", ")));
    // What the reader notices itself it will notice again.
    let noticed = super::noticed(robot);
    let told = robot.warnings.iter().filter(|w| !noticed.contains(w));
    let told: Vec<String> = told.map(|w| string(w)).collect();
    if !told.is_empty() {
        line(text, "warnings", &format!("[{}]", told.join(", ")));
    }
    if !robot.constants.is_empty() {
        text.push_str("\n[constants]\n");
    }
    for (name, value) in &robot.constants {
        line(text, name, &number(value));
    }
}

fn link(text: &mut String, link: &LinkDescription, dependent: bool) -> Result<(), String> {
    if link.limits.is_some() {
        return Err(format!(
            "link {}: robot TOML has no joint limits",
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
    if link.massless {
        line(text, "massless", "true");
    }
    if link.rotor != (link.active && link.joint.has_axis() && !link.massless) {
        line(text, "rotor", &link.rotor.to_string());
    }
    if let Some(joint) = &link.joint_name {
        line(text, "joint_name", &string(joint));
    }
    geometry(text, link)?;
    inertia(text, link);
    Ok(())
}

fn closure(text: &mut String, closure: &LoopClosure) {
    text.push_str("\n[[loop]]\n");
    let name = |name: &Option<String>| string(name.as_deref().unwrap_or(BASE));
    let three = |v: &[Quantity; 3]| format!("[{}]", v.each_ref().map(number).join(", "));
    let pair = |[a, b]: [String; 2]| format!("[{a}, {b}]");
    let [a, b] = &closure.between;
    line(text, "between", &pair([name(a), name(b)]));
    let zero = Quantity::zero();
    if closure
        .frames
        .iter()
        .all(|f| f.rpy.iter().all(|x| *x == zero))
    {
        let at = closure.frames.each_ref().map(|f| three(&f.xyz));
        line(text, "at", &pair(at));
    } else {
        let frames = closure.frames.each_ref();
        let frames =
            frames.map(|f| format!("{{ xyz = {}, rpy = {} }}", three(&f.xyz), three(&f.rpy)));
        line(text, "frames", &pair(frames));
    }
    line(text, "cut", &string(closure.cut.name()));
    if !closure.near.is_empty() {
        let near = closure.near.iter();
        let near: Vec<String> = near
            .map(|(joint, x)| format!("{} = {}", key(joint), number(x)))
            .collect();
        line(text, "near", &format!("{{ {} }}", near.join(", ")));
    }
}

/// A key, quoted where TOML wants that.
fn key(name: &str) -> String {
    Key::new(name).to_string()
}

fn geometry(text: &mut String, link: &LinkDescription) -> Result<(), String> {
    let three = |numbers: &[Quantity; 3]| {
        let texts = numbers.each_ref().map(number);
        format!("[{}]", texts.join(", "))
    };
    match &link.geometry {
        Geometry::Mdh(g) => {
            for (key, value) in [
                ("gamma", &g.gamma),
                ("b", &g.b),
                ("alpha", &g.alpha),
                ("d", &g.d),
                ("theta", &g.theta),
                ("r", &g.r),
            ] {
                line(text, key, &number(value));
            }
        }
        Geometry::Placed { origins, axis } => {
            let [origin] = origins.as_slice() else {
                return Err(format!(
                    "link {} has {} placements, robot TOML has one",
                    quoted(&link.name),
                    origins.len()
                ));
            };
            line(text, "xyz", &three(&origin.xyz));
            line(text, "rpy", &three(&origin.rpy));
            line(text, "axis", &three(axis));
        }
    }
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
    let key = |name: &str| Key::new(name).to_string();
    let term = |t: &Term| format!("{} = {}", key(&t.joint), number(&t.multiplier));
    let terms: Vec<String> = couple.terms.iter().map(term).collect();
    text.push_str("\n[[couple]]\n");
    line(text, "joint", &string(&couple.joint));
    if let Some(expression) = &couple.expression {
        line(text, "expression", &string(&expression.text));
        return;
    }
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
