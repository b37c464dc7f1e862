//! A URDF, element by element: one fault does not hide the others.

use std::collections::{HashMap, HashSet};

use roberval_mechanism::{Change, Field, JointKind};

use super::{Finding, Rule, inertial, joints, rounded};
use crate::error::{Code, FormatError, Position};
use crate::source::Source;
use crate::urdf::{Element, Joint, Link, UrdfOptions, of_joints, parse_urdf, with_robot};
use crate::words::quoted;

/// A file with more findings than these has one reason for them all.
const MOST: usize = 1000;

/// The numbers of links and joints: path of tags, attributes, numbers in each.
const NUMBERS: [(&[&str], &[&str], usize); 8] = [
    (&["inertial", "origin"], &["xyz", "rpy"], 3),
    (&["inertial", "mass"], &["value"], 1),
    (
        &["inertial", "inertia"],
        &["ixx", "ixy", "ixz", "iyy", "iyz", "izz"],
        1,
    ),
    (&["origin"], &["xyz", "rpy"], 3),
    (&["axis"], &["xyz"], 3),
    (&["limit"], &["lower", "upper", "effort", "velocity"], 1),
    (&["mimic"], &["multiplier", "offset"], 1),
    (&["dynamics"], &["damping", "friction"], 1),
];

pub(super) fn findings(text: &str, name: &str) -> Result<Vec<Finding>, FormatError> {
    let source = Source::new(name, text)?;
    let mut findings = with_robot(&source, |robot| Ok(elements(robot)))?;
    for (position, what) in source.warnings.take() {
        let remedy = "this program reads over it, others may not";
        push(
            &mut findings,
            Finding::new(Rule::Remark, name, what, remedy).at(position),
        );
    }
    // What only the whole robot shows: the tree, circles of mimic joints.
    if let Err(error) = parse_urdf(text, name, UrdfOptions::default()) {
        push(&mut findings, Finding::refused(error));
    }
    Ok(findings)
}

fn push(findings: &mut Vec<Finding>, finding: Finding) {
    if !findings.contains(&finding) {
        findings.push(finding);
    }
}

fn elements(robot: &Element) -> Vec<Finding> {
    let mut findings = Vec::new();
    let link_places = places(robot, "link");
    let links = each(robot, "link", &link_places, Link::read, &mut findings);
    let joint_places = places(robot, "joint");
    let joints = each(robot, "joint", &joint_places, Joint::read, &mut findings);
    for (element, _) in &links {
        findings.extend(inertial::findings(element));
    }
    for (element, joint) in &joints {
        findings.extend(joints::findings(element, joint));
    }
    findings.extend(joints::mimics(&joints));
    findings.extend(without_inertial(&links, &joints));
    findings.extend(weightless_ends(&links, &joints));
    findings.extend(roundings(robot.source, &links, &joints));
    findings.truncate(MOST);
    findings
}

/// What elements of a kind are called in messages.
fn places(robot: &Element, tag: &str) -> Vec<String> {
    let nodes = robot.children(tag).zip(1..);
    nodes
        .map(|(node, number)| match node.attribute("name") {
            Some(name) => format!("{tag} {}", quoted(name)),
            None => format!("{tag} {number}"),
        })
        .collect()
}

/// Reads all elements of a kind; what is wrong with some does not stop the others.
fn each<'e, 'd, T>(
    robot: &Element<'e, 'd>,
    tag: &str,
    places: &'e [String],
    read: fn(&Element, &str) -> Result<T, FormatError>,
    findings: &mut Vec<Finding>,
) -> Vec<(Element<'e, 'd>, T)> {
    let mut all = Vec::new();
    let mut first: HashMap<&str, u32> = HashMap::new();
    for ((number, node), place) in (1..).zip(robot.children(tag)).zip(places) {
        if findings.len() >= MOST {
            break;
        }
        let unnamed = format!("{tag} {number}");
        let element = Element::new(robot.source, node, place);
        for error in malformed(&element) {
            push(findings, Finding::refused(error));
        }
        // As the reader says it, which meets the first of these as well.
        let name = match Element::new(robot.source, node, &unnamed).required("name") {
            Ok(name) => name,
            Err(error) => {
                push(findings, Finding::refused(error));
                continue;
            }
        };
        let here = robot.source.position(element.offset());
        if let Some(line) = first.insert(name, here.line) {
            let what = format!("two {tag}s have this name");
            let hint = format!("the other one is in line {line}");
            let error = element.fault(Code::DuplicateName, what).hint(hint);
            push(findings, Finding::refused(error));
        }
        match read(&element, name) {
            Ok(item) => all.push((element, item)),
            Err(error) => push(findings, Finding::refused(error)),
        }
    }
    all
}

/// The numbers of an element that are none.
fn malformed(element: &Element) -> Vec<FormatError> {
    let mut errors = Vec::new();
    for (path, keys, count) in NUMBERS {
        let inner = path
            .iter()
            .try_fold(*element, |at, tag| at.child(tag).ok()?);
        let Some(inner) = inner else { continue };
        for key in keys {
            let read = match count {
                1 => inner.number(key).map(drop),
                _ => inner.numbers::<3>(key).map(drop),
            };
            errors.extend(read.err());
        }
    }
    errors
}

/// Moving links that have no inertial values.
fn without_inertial(links: &[(Element, Link)], joints: &[(Element, Joint)]) -> Vec<Finding> {
    let moving = joints.iter().filter(|(_, j)| j.kind != JointKind::Fixed);
    let moved: HashMap<&str, &str> = moving
        .map(|(_, j)| (j.child.as_str(), j.name.as_str()))
        .collect();
    let empty = links.iter().filter(|(_, link)| link.inertia.is_none());
    empty
        .filter_map(|(element, link)| {
            let joint = moved.get(link.name.as_str())?;
            let what = format!(
                "{}: it moves with joint {} and has no <inertial>",
                element.place,
                quoted(joint)
            );
            let remedy = "base parameters need none, simulators do: add mass and inertia";
            let source = element.source;
            let finding = Finding::new(Rule::MissingInertial, source.name, what, remedy);
            Some(finding.at(source.position(element.offset())))
        })
        .collect()
}

/// Moving links of mass zero and inertia zero with nothing on them: no motion of theirs has an
/// effect, and simulators fail.
fn weightless_ends(links: &[(Element, Link)], joints: &[(Element, Joint)]) -> Vec<Finding> {
    let parents: HashSet<&str> = joints.iter().map(|(_, j)| j.parent.as_str()).collect();
    let moving = joints.iter().filter(|(_, j)| j.kind != JointKind::Fixed);
    let moved: HashSet<&str> = moving.map(|(_, j)| j.child.as_str()).collect();
    let weightless = |link: &Link| {
        let body = link.inertia.as_ref();
        body.is_some_and(|body| body.mass == 0.0 && body.tensor.iter().all(|x| *x == 0.0))
    };
    let ends = links.iter().filter(|(_, link)| {
        let name = link.name.as_str();
        moved.contains(name) && !parents.contains(name) && weightless(link)
    });
    ends.map(|(element, _)| {
        let what = format!(
            "{}: it moves, has mass and inertia 0, and carries nothing",
            element.place
        );
        let remedy = "base parameters need no values, simulators do: give mass and inertia";
        let source = element.source;
        let finding = Finding::new(Rule::MissingInertial, source.name, what, remedy);
        finding.at(source.position(element.offset()))
    })
    .collect()
}

/// Rounded numbers of all joints, those of tool frames as well.
fn roundings(
    source: &Source,
    links: &[(Element, Link)],
    joints: &[(Element, Joint)],
) -> Vec<Finding> {
    let by_name: HashMap<&str, &Link> = links.iter().map(|(_, l)| (l.name.as_str(), l)).collect();
    let pairs = joints
        .iter()
        .filter_map(|(_, joint)| Some((*by_name.get(joint.child.as_str())?, joint)));
    let elements: HashMap<&str, &Element> =
        joints.iter().map(|(e, j)| (j.name.as_str(), e)).collect();
    let position = |change: &Change| -> Option<Position> {
        let element = elements.get(change.joint.as_deref()?)?;
        let (tag, key) = match change.field {
            Field::Xyz(_) => ("origin", "xyz"),
            Field::Rpy(_) => ("origin", "rpy"),
            Field::Offset => ("mimic", "offset"),
            _ => ("axis", "xyz"),
        };
        let child = element.child(tag).ok()??;
        Some(source.position(child.attribute_offset(key)))
    };
    rounded(source.name, &of_joints(pairs), position)
}
