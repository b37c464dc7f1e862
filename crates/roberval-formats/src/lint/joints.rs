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

/// A finding at an attribute of an element in a joint, or where the joint begins.
fn found(
    joint: &Element,
    rule: Rule,
    [tag, key]: [&str; 2],
    what: &str,
    remedy: impl Into<String>,
) -> Finding {
    let at = match joint.child(tag) {
        Ok(Some(child)) => child.attribute_offset(key),
        _ => joint.offset(),
    };
    let what = format!("{}: {what}", joint.place);
    Finding::new(rule, joint.source.name, what, remedy).at(joint.source.position(at))
}

/// What is wrong with one joint that can be read.
pub(super) fn findings(element: &Element, joint: &Joint) -> Vec<Finding> {
    let checks = [axis, distance, angle, limits];
    checks
        .iter()
        .filter_map(|check| check(element, joint))
        .collect()
}

fn axis(element: &Element, joint: &Joint) -> Option<Finding> {
    if joint.kind == JointKind::Fixed || is_unit(&joint.axis) {
        return None;
    }
    let axis = joint.axis.each_ref().map(|x| x.value);
    let length = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
    let unit = axis.map(|x| (x / length).to_string()).join(" ");
    let what = format!("its axis has the length {length}, not 1");
    let remedy = format!("write {unit}");
    Some(found(element, Rule::Axis, ["axis", "xyz"], &what, remedy))
}

fn distance(element: &Element, joint: &Joint) -> Option<Finding> {
    let mut xyz = joint.origin.xyz.iter();
    let far = xyz.find(|x| x.value.abs() > FARTHEST_JOINT)?;
    let what = format!("its place is {} m away", far.text);
    let remedy = "is it in millimetres? URDF wants m";
    let at = ["origin", "xyz"];
    Some(found(element, Rule::Units, at, &what, remedy))
}

fn angle(element: &Element, joint: &Joint) -> Option<Finding> {
    let mut rpy = joint.origin.rpy.iter();
    let angle = rpy.find(|q| q.value.abs() > MOST_RADIANS)?;
    let what = format!("the angle {} is more than a full turn", angle.text);
    let radians = angle.value.to_radians();
    let remedy = format!("is it in degrees? URDF wants radians: {radians:?}");
    let at = ["origin", "rpy"];
    Some(found(element, Rule::Degrees, at, &what, remedy))
}

fn limits(element: &Element, joint: &Joint) -> Option<Finding> {
    let limit = |rule, key, what: &str, remedy| found(element, rule, ["limit", key], what, remedy);
    let turns = |limit: f64| joint.kind == JointKind::Revolute && limit.abs() > MOST_TURNS;
    match joint.limits {
        Some((lower, upper)) if lower > upper => {
            let what = format!("its lower limit {lower} is above the upper one, {upper}");
            Some(limit(Rule::Limits, "lower", &what, "exchange them"))
        }
        Some((lower, upper)) if turns(lower) || turns(upper) => {
            let what = format!("its limits are {lower} and {upper} rad");
            let remedy = "are they in degrees? URDF wants radians";
            Some(limit(Rule::Degrees, "lower", &what, remedy))
        }
        None if matches!(
            element.attribute("type"),
            Ok(Some("revolute" | "prismatic"))
        ) && matches!(element.child("limit"), Ok(None)) =>
        {
            let what = "it has no <limit>, which URDF wants of this type";
            let remedy = "add <limit lower upper effort velocity/>, or make it continuous";
            Some(limit(Rule::Limits, "", what, remedy))
        }
        _ => None,
    }
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
        let (what, remedy) = if kinds.get(copied) == Some(&JointKind::Fixed) {
            let what = format!("it copies the joint {}, which is fixed", quoted(copied));
            (what, "name the joint that drives it")
        } else if multiplier == 0.0 {
            let what = "it copies a joint with the multiplier 0, so that it does not move";
            let remedy = "make it fixed, or give it another multiplier";
            (what.to_owned(), remedy)
        } else {
            continue;
        };
        findings.push(found(element, Rule::Mimic, ["mimic", ""], &what, remedy));
    }
    findings
}
