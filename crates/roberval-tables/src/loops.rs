//! Loops in words: the joints that were cut, the mobility, the branch, and how pairs of
//! doubles decided.

use roberval_base::{BaseParameters, Precision};
use roberval_mechanism::{Assembly, LoopClosure, Mechanism};
use serde_json::{Value, json};

use crate::number::{shortest, size};

/// Joint values shown at most.
const MOST_SHOWN: usize = 12;

/// `Loop 1: revolute joint between 2 and 3` and what closing the loops told.
pub(crate) fn lines(mechanism: &Mechanism) -> Vec<String> {
    let Some(assembly) = &mechanism.assembly else {
        return Vec::new();
    };
    let loops = (1..).zip(&mechanism.description.loops);
    let mut lines: Vec<String> = loops
        .map(|(number, closure)| {
            let [a, b] = sides(closure);
            format!("Loop {number}: {} joint between {a} and {b}", closure.cut)
        })
        .collect();
    lines.push(format!(
        "Mobility {}: {} joints less {} independent of {} equations ({} redundant)",
        assembly.mobility(),
        mechanism.dof(),
        assembly.rank,
        assembly.linkage.equations(),
        assembly.redundant()
    ));
    lines.push(format!("Branch closed at {}", start(mechanism, assembly)));
    lines
}

fn sides(closure: &LoopClosure) -> [&str; 2] {
    closure
        .between
        .each_ref()
        .map(|name| name.as_deref().unwrap_or("base"))
}

/// `q(1) = 0.3, q(2) = -1.1`
fn start(mechanism: &Mechanism, assembly: &Assembly) -> String {
    let values = mechanism.moving().zip(&assembly.start);
    let mut texts: Vec<String> = values
        .take(MOST_SHOWN)
        .map(|(link, q)| {
            let joint = link.joint_name.as_ref().unwrap_or(&link.name);
            format!("q({joint}) = {}", shortest((q * 1e4).round() / 1e4))
        })
        .collect();
    if mechanism.dof() > MOST_SHOWN {
        texts.push("...".to_owned());
    }
    texts.join(", ")
}

/// The loops for programs; null without.
pub(crate) fn json(mechanism: &Mechanism) -> Value {
    let Some(assembly) = &mechanism.assembly else {
        return Value::Null;
    };
    let loops = mechanism.description.loops.iter();
    let loops = loops.map(|closure| {
        let three = |v: &[roberval_scalar::Quantity; 3]| v.each_ref().map(|x| x.text.clone());
        let frames = closure
            .frames
            .each_ref()
            .map(|frame| json!({"xyz": three(&frame.xyz), "rpy": three(&frame.rpy)}));
        let near = closure.near.iter();
        let near = near.map(|(joint, x)| (joint.clone(), Value::from(x.text.clone())));
        json!({
            "between": sides(closure),
            "cut": closure.cut.name(),
            "frames": frames,
            "near": Value::Object(near.collect()),
        })
    });
    json!({
        "loops": loops.collect::<Vec<_>>(),
        "mobility": assembly.mobility(),
        "equations": assembly.linkage.equations(),
        "rank": assembly.rank,
        "redundant": assembly.redundant(),
        "start": assembly.start,
    })
}

/// How pairs of doubles decided.
pub(crate) fn decided(answer: &BaseParameters) -> Option<Vec<String>> {
    let precision = answer.diagnosis.precision.as_ref()?;
    let value = |x: Option<f64>| x.map_or("none".to_owned(), size);
    let mut lines = vec![format!(
        "Rank {} in high-precision floats (pairs of doubles; not an exact decision): smallest \
         kept {}, largest dropped {}, gap {}",
        precision.rank,
        value(precision.smallest_kept),
        value(precision.largest_dropped),
        value(precision.gap())
    )];
    if answer.mechanism.assembly.is_some() {
        lines.push(format!(
            "{} samples, {} configurations redrawn (singular or on another branch)",
            precision.samples, precision.redrawn
        ));
    }
    Some(lines)
}

/// The decision for programs; null if another engine decided.
pub(crate) fn precision(answer: &BaseParameters) -> Value {
    let labels = answer.parameters.labels();
    let precision = answer.diagnosis.precision.as_ref();
    json!(precision.map(|p: &Precision| json!({
        "rank": p.rank,
        "tolerance": p.tolerance,
        "smallest_kept": p.smallest_kept,
        "largest_dropped": p.largest_dropped,
        "gap": p.gap(),
        "samples": p.samples,
        "redrawn": p.redrawn,
        "opened": p.opened.as_ref().map(|o| json!({
            "rank": o.rank,
            "removed": o.removed.iter().map(|&c| &labels[c]).collect::<Vec<_>>(),
        })),
    })))
}
