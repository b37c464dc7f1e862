//! Joints of a URDF: axes, limits, angles in degrees, mimics.

use std::collections::HashMap;

use roberval_mechanism::JointKind;

use super::{Finding, Rule};
use crate::suspects::MOST_RADIANS;
use crate::urdf::{Element, Joint, is_unit};
use crate::words::quoted;

/// Limits of more radians than this are degrees: some joints turn three times, none ten.
const MOST_TURNS: f64 = 60.0;

/// A joint has its place nearer to its link than this, m.
const FARTHEST_JOINT: f64 = 20.0;

/// What is wrong with one joint that can be read.
pub(super) fn findings(element: &Element, joint: &Joint) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut found = |rule, tag: &str, key: &str, what: String, remedy: String| {
        let at = match element.child(tag) {
            Ok(Some(child)) => child.attribute_offset(key),
            _ => element.offset(),
        };
        let what = format!("{}: {what}", element.place);
        let finding = Finding::new(rule, element.source.name, what, remedy);
        findings.push(finding.at(element.source.position(at)));
    };
    let moves = joint.kind != JointKind::Fixed;
    if moves && !is_unit(&joint.axis) {
        let axis = joint.axis.each_ref().map(|x| x.value);
        let length = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
        let unit = axis.map(|x| (x / length).to_string()).join(" ");
        let what = format!("its axis has the length {length}, not 1");
        found(Rule::Axis, "axis", "xyz", what, format!("write {unit}"));
    }
    let far = joint
        .origin
        .xyz
        .iter()
        .find(|x| x.value.abs() > FARTHEST_JOINT);
    if let Some(far) = far {
        let what = format!("its place is {} m away", far.text);
        let remedy = "is it in millimetres? URDF wants m".to_owned();
        found(Rule::Units, "origin", "xyz", what, remedy);
    }
    let degrees = joint
        .origin
        .rpy
        .iter()
        .find(|q| q.value.abs() > MOST_RADIANS);
    if let Some(angle) = degrees {
        let what = format!("the angle {} is more than a full turn", angle.text);
        let remedy = format!(
            "is it in degrees? URDF wants radians: {:?}",
            angle.value.to_radians()
        );
        found(Rule::Degrees, "origin", "rpy", what, remedy);
    }
    let limited = matches!(
        element.attribute("type"),
        Ok(Some("revolute" | "prismatic"))
    );
    match joint.limits {
        Some((lower, upper)) if lower > upper => {
            let what = format!("its lower limit {lower} is above the upper one, {upper}");
            found(
                Rule::Limits,
                "limit",
                "lower",
                what,
                "exchange them".to_owned(),
            );
        }
        Some((lower, upper))
            if joint.kind == JointKind::Revolute && lower.abs().max(upper.abs()) > MOST_TURNS =>
        {
            let what = format!("its limits are {lower} and {upper} rad");
            let remedy = "are they in degrees? URDF wants radians".to_owned();
            found(Rule::Degrees, "limit", "lower", what, remedy);
        }
        None if limited && matches!(element.child("limit"), Ok(None)) => {
            let what = "it has no <limit>, which URDF wants of this type".to_owned();
            let remedy = "add <limit lower upper effort velocity/>, or make it continuous";
            found(Rule::Limits, "limit", "", what, remedy.to_owned());
        }
        _ => {}
    }
    findings
}

/// Mimic joints that copy nothing that moves, or by nothing. Those that no reader takes
/// (unknown joints, circles) are errors, told elsewhere.
pub(super) fn mimics(joints: &[(Element, Joint)]) -> Vec<Finding> {
    let kinds: HashMap<&str, JointKind> = joints
        .iter()
        .map(|(_, j)| (j.name.as_str(), j.kind))
        .collect();
    let mut findings = Vec::new();
    for (element, joint) in joints {
        let Some((copied, multiplier)) = joint.copies() else {
            continue;
        };
        let trouble = if kinds.get(copied) == Some(&JointKind::Fixed) {
            let what = format!("it copies the joint {}, which is fixed", quoted(copied));
            Some((what, "name the joint that drives it"))
        } else if multiplier == 0.0 {
            let what = "it copies a joint with the multiplier 0, so that it does not move";
            Some((
                what.to_owned(),
                "make it fixed, or give it another multiplier",
            ))
        } else {
            None
        };
        if let Some((what, remedy)) = trouble {
            let at = match element.child("mimic") {
                Ok(Some(mimic)) => mimic.offset(),
                _ => element.offset(),
            };
            let what = format!("{}: {what}", element.place);
            let finding = Finding::new(Rule::Mimic, element.source.name, what, remedy);
            findings.push(finding.at(element.source.position(at)));
        }
    }
    findings
}
