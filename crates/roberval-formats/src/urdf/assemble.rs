use roberval_mechanism::{
    Couple, Geometry, JointKind, LinkDescription, Origin, RobotDescription, SourceFormat, Term,
};
use roberval_scalar::Quantity;

use super::UrdfOptions;
use super::inertia::Inertia;
use super::joint::Joint;
use super::link::Link;
use super::planar;
use super::tree::Tree;
use crate::error::{Code, FormatError, Position};
use crate::source::Source;
use crate::suspects;
use crate::words::{list, quoted};

/// The most placements that a description holds: a long chain of fixed joints with a
/// moving joint on each link would need the square of their number.
const MAX_PLACEMENTS: usize = 200_000;

/// The description of a checked tree: one link for each joint that is kept.
pub(super) fn description(
    source: &Source,
    name: String,
    links: &[Link],
    joints: &[Joint],
    tree: &Tree,
    options: UrdfOptions,
) -> Result<RobotDescription, FormatError> {
    let kept = |j: usize| options.keep_fixed || joints[j].kind != JointKind::Fixed;
    let inertias = lumped(links, joints, tree, kept);
    let floating = floating_root(source, joints, tree, kept, options)?;
    let mut described = Vec::new();
    if let Some(root) = floating {
        let inertia = parameters(source, &links[root], inertias[root])?;
        described.push(floating_link(&links[root], inertia));
    }
    let mut placements = 0;
    for &j in tree.order.iter().filter(|j| kept(**j)) {
        let (parent, child) = tree.ends[j];
        let (antecedent, chain) = fixed_chain(tree, kept, parent);
        placements += chain.len() + 1;
        if placements > MAX_PLACEMENTS {
            let what = format!("lumping fixed joints needs more than {MAX_PLACEMENTS} placements");
            return Err(source
                .error(Code::TooMany, joints[j].offset, what)
                .hint("keep the fixed joints as links of their own"));
        }
        let origins = chain.iter().rev().chain([&j]).map(|c| &joints[*c].origin);
        let antecedent = antecedent.or(floating).map(|l| links[l].name.clone());
        let link = link_description(
            &links[child],
            &joints[j],
            antecedent,
            origins.cloned().collect(),
            parameters(source, &links[child], inertias[child])?,
        );
        if joints[j].planar {
            described.extend(planar::chain(link, &joints[j].axis));
        } else {
            described.push(link);
        }
    }
    let warnings = warnings(links, joints, &described);
    let mut robot = RobotDescription {
        warnings,
        couples: couples(links, joints, tree),
        ..robot(name, described)
    };
    robot.warnings.extend(suspects::degrees(&robot));
    let slips = source.warnings.take().into_iter();
    let line = |(at, what): (Position, String)| format!("line {}, {what}", at.line);
    robot.warnings.extend(slips.map(line));
    Ok(robot)
}

fn robot(name: String, links: Vec<LinkDescription>) -> RobotDescription {
    let down = Quantity::parse_decimal("-9.81").unwrap_or_else(|_| Quantity::zero());
    RobotDescription {
        name,
        gravity: [Quantity::zero(), Quantity::zero(), down],
        constants: Vec::new(),
        couples: Vec::new(),
        loops: Vec::new(),
        links,
        format: SourceFormat::Urdf,
        warnings: Vec::new(),
    }
}

/// The numbers of joints without the tree they form, to look at one by one.
pub(crate) fn of_joints<'a>(
    pairs: impl Iterator<Item = (&'a Link, &'a Joint)>,
) -> RobotDescription {
    let link = |(link, joint): (&Link, &Joint)| {
        let origins = vec![joint.origin.clone()];
        link_description(link, joint, None, origins, Default::default())
    };
    robot(String::new(), pairs.map(link).collect())
}

/// The root link, if it is to float. A file with a floating joint says what floats; the
/// joint must be on the root or on what is fixed to it.
fn floating_root(
    source: &Source,
    joints: &[Joint],
    tree: &Tree,
    kept: impl Fn(usize) -> bool,
    options: UrdfOptions,
) -> Result<Option<usize>, FormatError> {
    let Some(j) = joints.iter().position(|j| j.kind == JointKind::Floating) else {
        let root = tree.above.iter().position(Option::is_none);
        return Ok(root.filter(|_| options.floating));
    };
    match fixed_chain(tree, kept, tree.ends[j].0) {
        (None, _) => Ok(None),
        (Some(_), _) => {
            let what = "a floating joint can only be the root link's";
            Err(source
                .error(Code::JointType, joints[j].offset, what)
                .place(format!("joint {}", quoted(&joints[j].name)))
                .hint("make it fixed, or analyse its child as a robot of its own"))
        }
    }
}

fn parameters(
    source: &Source,
    link: &Link,
    inertia: Option<Inertia>,
) -> Result<[Option<Quantity>; 11], FormatError> {
    let parameters = inertia.map_or(Ok(Default::default()), |i| i.parameters());
    parameters.map_err(|error| {
        source
            .error(error.fault.into(), link.offset, "its inertia is too large")
            .place(format!("link {}", quoted(&link.name)))
    })
}

/// The root link, moving freely.
fn floating_link(link: &Link, inertia: [Option<Quantity>; 11]) -> LinkDescription {
    LinkDescription {
        name: link.name.clone(),
        inertia,
        ..LinkDescription::floating(SourceFormat::Urdf)
    }
}

/// The mimic joints, by the links that joints move.
fn couples(links: &[Link], joints: &[Joint], tree: &Tree) -> Vec<Couple> {
    let moved = |joint: usize| links[tree.ends[joint].1].name.clone();
    let couple = |&j: &usize| {
        let (mimic, copied) = (joints[j].mimic.as_ref()?, tree.copied[j]?);
        Some(Couple {
            joint: moved(j),
            terms: vec![Term {
                joint: moved(copied),
                multiplier: mimic.multiplier.clone(),
            }],
            offset: mimic.offset.clone(),
            expression: None,
        })
    };
    tree.order.iter().filter_map(couple).collect()
}

/// The link into which a link is lumped (`None`: the base), and the fixed joints on the
/// way there, nearest first.
fn fixed_chain(
    tree: &Tree,
    kept: impl Fn(usize) -> bool,
    link: usize,
) -> (Option<usize>, Vec<usize>) {
    let mut chain = Vec::new();
    let mut at = link;
    while let Some(joint) = tree.above[at] {
        if kept(joint) {
            return (Some(at), chain);
        }
        chain.push(joint);
        at = tree.ends[joint].0;
    }
    (None, chain)
}

/// The inertia of each link with those lumped into it; `None` where no file gives any.
fn lumped(
    links: &[Link],
    joints: &[Joint],
    tree: &Tree,
    kept: impl Fn(usize) -> bool,
) -> Vec<Option<Inertia>> {
    let mut inertias: Vec<Option<Inertia>> = links.iter().map(|link| link.inertia).collect();
    // Depth first, backwards: a link is complete before its parent takes it.
    for &j in tree.order.iter().rev().filter(|j| !kept(**j)) {
        let (parent, child) = tree.ends[j];
        if let Some(inertia) = inertias[child] {
            let placed = inertia.placed(&joints[j].origin);
            inertias[parent] = Some(inertias[parent].map_or(placed, |own| own + placed));
        }
    }
    inertias
}

/// A mimic joint is not driven by itself, so it has no rotor of its own, and nothing drives
/// a floating one.
fn link_description(
    link: &Link,
    joint: &Joint,
    antecedent: Option<String>,
    origins: Vec<Origin>,
    inertia: [Option<Quantity>; 11],
) -> LinkDescription {
    let active = joint.kind.has_axis() && joint.mimic.is_none();
    LinkDescription {
        name: link.name.clone(),
        joint_name: Some(joint.name.clone()),
        antecedent,
        joint: joint.kind,
        active,
        rotor: active,
        massless: false,
        geometry: Geometry::Placed {
            origins,
            axis: joint.axis.clone(),
        },
        inertia,
        limits: joint.limits,
    }
}

/// What the user should know, one sentence for each kind of remark.
fn warnings(links: &[Link], joints: &[Joint], described: &[LinkDescription]) -> Vec<String> {
    let mut warnings = Vec::new();
    if described.iter().all(|l| l.joint == JointKind::Fixed) {
        warnings.push("no joint of the robot moves".to_owned());
    }
    let mut warn = |names: Vec<&str>, what: &str| {
        if !names.is_empty() {
            warnings.push(format!("{what} ({}): {}", names.len(), list(names)));
        }
    };
    let moving = |j: &&Joint| j.kind != JointKind::Fixed;
    let named = |keep: &dyn Fn(&Joint) -> bool| {
        let kept = joints.iter().filter(moving).filter(|j| keep(j));
        kept.map(|j| j.name.as_str()).collect()
    };
    warn(
        described
            .iter()
            .filter(|l| l.inertia[9].as_ref().is_some_and(|mass| mass.value < 0.0))
            .map(|l| l.name.as_str())
            .collect(),
        "links with a negative mass",
    );
    warn(
        links
            .iter()
            .filter(|l| l.unphysical.is_some())
            .map(|l| l.name.as_str())
            .collect(),
        "links with an inertia that no body has",
    );
    warn(
        named(&|j| !is_unit(&j.axis)),
        "joints whose axis is not of length 1, normalised",
    );
    warn(
        named(&|j| j.limits.is_some_and(|(lower, upper)| lower > upper)),
        "joints whose lower limit is above the upper one",
    );
    warnings
}

pub(crate) fn is_unit(axis: &[Quantity; 3]) -> bool {
    /// Decimals such as 0.707107 are rounded directions, not worth a word.
    const ROUNDING: f64 = 1e-5;
    let square: f64 = axis.iter().map(|x| x.value * x.value).sum();
    (square - 1.0).abs() <= ROUNDING
}
