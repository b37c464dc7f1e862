use std::collections::HashMap;

use roberval_mechanism::{JointKind, find_cycle};

use super::joint::Joint;
use super::link::Link;
use crate::error::{Code, FormatError};
use crate::source::Source;
use crate::words::{list, nearest, quoted};

/// The tree that joints make of links, by index.
pub(super) struct Tree {
    /// Parent and child link of each joint.
    pub ends: Vec<(usize, usize)>,
    /// The joint above each link; `None` for the root.
    pub above: Vec<Option<usize>>,
    /// The joints depth first, those of one link in file order.
    pub order: Vec<usize>,
    /// The joint that each joint copies.
    pub copied: Vec<Option<usize>>,
}

impl Tree {
    /// Checks that links and joints are one tree.
    pub fn new(source: &Source, links: &[Link], joints: &[Joint]) -> Result<Self, FormatError> {
        if links.is_empty() {
            return Err(source
                .error(Code::NoLink, 0, "the robot has no link")
                .hint("a URDF has <link> and <joint> elements in <robot>"));
        }
        let names: Names = by_name(links.iter().map(|l| l.name.as_str()));
        let ends = joints
            .iter()
            .map(|joint| ends(source, joint, &names))
            .collect::<Result<Vec<_>, _>>()?;
        let above = above(source, links, joints, &ends)?;
        check_connected(source, links, joints, &ends, &above)?;
        Ok(Self {
            order: depth_first(&ends, &above),
            copied: copied(source, joints)?,
            ends,
            above,
        })
    }
}

type Names<'a> = HashMap<&'a str, usize>;

fn by_name<'a>(names: impl Iterator<Item = &'a str>) -> Names<'a> {
    names
        .enumerate()
        .map(|(index, name)| (name, index))
        .collect()
}

fn fault(source: &Source, joint: &Joint, code: Code, what: String) -> FormatError {
    source
        .error(code, joint.offset, what)
        .place(format!("joint {}", quoted(&joint.name)))
}

fn ends(source: &Source, joint: &Joint, names: &Names) -> Result<(usize, usize), FormatError> {
    let find = |end: &str, name: &str| {
        names.get(name).copied().ok_or_else(|| {
            let what = format!("its {end} link {} does not exist", quoted(name));
            let error = fault(source, joint, Code::UnknownLink, what);
            match nearest(name, sorted(names)) {
                Some(near) => error.hint(format!("did you mean {}?", quoted(near))),
                None => error,
            }
        })
    };
    let ends = (find("parent", &joint.parent)?, find("child", &joint.child)?);
    if ends.0 == ends.1 {
        let what = format!("it joins link {} to itself", quoted(&joint.child));
        return Err(fault(source, joint, Code::Cycle, what));
    }
    Ok(ends)
}

/// Names in file order, so that messages do not depend on the hashing.
fn sorted<'a>(names: &Names<'a>) -> Vec<&'a str> {
    let mut all: Vec<(usize, &str)> = names.iter().map(|(name, index)| (*index, *name)).collect();
    all.sort_unstable();
    all.into_iter().map(|(_, name)| name).collect()
}

fn above(
    source: &Source,
    links: &[Link],
    joints: &[Joint],
    ends: &[(usize, usize)],
) -> Result<Vec<Option<usize>>, FormatError> {
    let mut above: Vec<Option<usize>> = vec![None; links.len()];
    for (joint, (_, child)) in ends.iter().enumerate() {
        if let Some(first) = above[*child].replace(joint) {
            let what = format!(
                "link {} is also the child of joint {}",
                quoted(&links[*child].name),
                quoted(&joints[first].name)
            );
            return Err(fault(source, &joints[joint], Code::TwoParents, what)
                .hint("a link has one parent; a closed loop is a [[loop]] of a robot TOML"));
        }
    }
    Ok(above)
}

fn check_connected(
    source: &Source,
    links: &[Link],
    joints: &[Joint],
    ends: &[(usize, usize)],
    above: &[Option<usize>],
) -> Result<(), FormatError> {
    let parents: Vec<Option<usize>> = above.iter().map(|j| j.map(|j| ends[j].0)).collect();
    if let Some(circle) = find_cycle(&parents) {
        let names = list(circle.iter().map(|l| links[*l].name.as_str()));
        let what = format!("links are parents of each other in a circle: {names}");
        let joint = above[circle[0]].unwrap_or_default();
        return Err(fault(source, &joints[joint], Code::Cycle, what));
    }
    let roots: Vec<&Link> = links
        .iter()
        .zip(above)
        .filter_map(|(link, joint)| joint.is_none().then_some(link))
        .collect();
    if let [_, second, ..] = roots[..] {
        let names = list(roots.iter().map(|l| l.name.as_str()));
        let what = format!("more than one link has no parent: {names}");
        return Err(source
            .error(Code::TwoRoots, second.offset, what)
            .place(format!("link {}", quoted(&second.name)))
            .hint("every link but the base must be the child of a joint"));
    }
    Ok(())
}

/// The joints depth first from the root, without recursion: chains may be long.
fn depth_first(ends: &[(usize, usize)], above: &[Option<usize>]) -> Vec<usize> {
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); above.len()];
    for (joint, (parent, _)) in ends.iter().enumerate() {
        children[*parent].push(joint);
    }
    let root = above.iter().position(Option::is_none).unwrap_or_default();
    let mut order = Vec::with_capacity(ends.len());
    let mut stack: Vec<usize> = children[root].iter().rev().copied().collect();
    while let Some(joint) = stack.pop() {
        order.push(joint);
        stack.extend(children[ends[joint].1].iter().rev());
    }
    order
}

/// Which joint each mimic joint copies; chains are allowed, circles are not.
fn copied(source: &Source, joints: &[Joint]) -> Result<Vec<Option<usize>>, FormatError> {
    let names = by_name(joints.iter().map(|j| j.name.as_str()));
    let mut copied = vec![None; joints.len()];
    for (index, joint) in joints.iter().enumerate() {
        let Some(mimic) = &joint.mimic else { continue };
        let Some(target) = names.get(mimic.joint.as_str()) else {
            let what = format!(
                "it mimics joint {}, which does not exist",
                quoted(&mimic.joint)
            );
            let error = fault(source, joint, Code::CoupleUnknown, what);
            return Err(match nearest(&mimic.joint, sorted(&names)) {
                Some(near) => error.hint(format!("did you mean {}?", quoted(near))),
                None => error,
            });
        };
        let name = quoted(&mimic.joint);
        let held = if joints[*target].kind == JointKind::Fixed {
            format!("it mimics joint {name}, which is fixed")
        } else if mimic.multiplier.value == 0.0 {
            format!("it mimics joint {name} with the multiplier 0")
        } else {
            copied[index] = Some(*target);
            continue;
        };
        let what = format!("{held}, so that it does not move");
        return Err(fault(source, joint, Code::Contradiction, what).hint("make it a fixed joint"));
    }
    match find_cycle(&copied) {
        None => Ok(copied),
        Some(circle) => {
            let names = list(circle.iter().map(|j| joints[*j].name.as_str()));
            let what = format!("mimic joints copy each other in a circle: {names}");
            Err(fault(source, &joints[circle[0]], Code::CoupleCycle, what)
                .hint("one of them must move by itself"))
        }
    }
}
