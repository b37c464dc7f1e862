//! The robot an answer is about.

use roberval_mechanism::{JointKind, Mechanism, ParameterSpace};
use serde_json::{Value, json};

use crate::number::shortest;

/// `6 joints (6 revolute), gravity (0, 0, -9.81) m/s^2`
pub(crate) fn joints_and_gravity(mechanism: &Mechanism) -> String {
    let count = |kind| mechanism.links.iter().filter(|l| l.joint == kind).count();
    let kinds = JointKind::ALL.map(|kind| match count(kind) {
        0 => None,
        n => Some(format!("{n} {}", kind.name())),
    });
    let kinds: Vec<String> = kinds.into_iter().flatten().collect();
    let links = mechanism.links.len();
    let gravity: Vec<String> = mechanism.gravity.iter().map(|&g| shortest(g)).collect();
    format!(
        "{links} link{} ({}), gravity ({}) m/s^2",
        if links == 1 { "" } else { "s" },
        kinds.join(", "),
        gravity.join(", ")
    )
}

/// `{"name", "gravity", "links": [{"index", "name", "joint", "type", "antecedent"}]}`;
/// `joint` is null where joints have no names, `antecedent` is null for the base.
pub(crate) fn json(mechanism: &Mechanism) -> Value {
    let links = mechanism.links.iter().enumerate().map(|(j, link)| {
        json!({
            "index": j + 1,
            "name": link.name,
            "joint": link.joint_name,
            "type": link.joint.name(),
            "antecedent": link.antecedent.map(|a| &mechanism.links[a].name),
        })
    });
    json!({
        "name": mechanism.name,
        "gravity": mechanism.gravity.as_slice(),
        "links": links.collect::<Vec<_>>(),
    })
}

/// `[{"label", "kind", "link"}]`, the link by its name.
pub(crate) fn parameters(mechanism: &Mechanism, space: &ParameterSpace) -> Value {
    let pairs = space.ids().iter().zip(space.labels());
    let rows = pairs.map(|(id, label)| {
        json!({
            "label": label,
            "kind": id.kind.name(),
            "link": mechanism.links[id.link].name,
        })
    });
    Value::Array(rows.collect())
}
