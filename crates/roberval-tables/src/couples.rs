//! Joints that follow from others, in words.

use roberval_base::{BaseParameters, Opened};
use roberval_mechanism::{Couple, Link, Mechanism};
use roberval_scalar::Quantity;
use serde_json::{Value, json};

use crate::loops;

/// Longer lists of couples and parameters end with their number.
const MOST_SHOWN: usize = 12;

/// `5 of 7 joints are independent: 1, 3, ...` and `q(2) = q(3) - q(4)`, where joints follow
/// from others.
pub(crate) fn lines(mechanism: &Mechanism) -> Vec<String> {
    if mechanism.closure.is_none() {
        return Vec::new();
    }
    let independent = independent(mechanism);
    let names: Vec<String> = independent.map(|l| l.label().to_owned()).collect();
    let couples = &mechanism.description.couples;
    let couples: Vec<String> = couples.iter().map(|c| equation(mechanism, c)).collect();
    let mut lines = vec![format!(
        "{} of {} joints {} independent: {}",
        names.len(),
        mechanism.moving().filter(|l| l.joint.has_axis()).count(),
        if names.len() == 1 { "is" } else { "are" },
        shortened(&names)
    )];
    if !couples.is_empty() {
        lines.push(format!("Couples: {}", shortened(&couples)));
    }
    lines.extend(loops::lines(mechanism));
    lines
}

/// What couples and loops remove beyond the tree.
pub(crate) fn removed(answer: &BaseParameters) -> Option<String> {
    let Opened { rank, removed } = answer.diagnosis.opened()?;
    let constraints = match answer.mechanism.assembly {
        None => "couples",
        Some(_) => "loops",
    };
    let space = answer.mechanism.parameters();
    let labels: Vec<String> = removed.iter().map(|&c| space.labels()[c].clone()).collect();
    Some(format!(
        "The tree without {constraints} has {rank} base parameters; they remove {}: {}",
        labels.len(),
        shortened(&labels)
    ))
}

/// `{"independent": [joint], "couples": [{"joint", "equation"}], "loops"}`; null where all joints are
/// independent.
pub(crate) fn json(mechanism: &Mechanism) -> Value {
    if mechanism.closure.is_none() {
        return Value::Null;
    }
    let couples = mechanism.description.couples.iter();
    let couples = couples.map(|c| json!({"joint": c.joint, "equation": equation(mechanism, c)}));
    json!({
        "independent": independent(mechanism).map(|link| &link.name).collect::<Vec<_>>(),
        "couples": couples.collect::<Vec<_>>(),
        "loops": loops::json(mechanism),
    })
}

/// The links on independent joints, without a base that floats.
fn independent(mechanism: &Mechanism) -> impl Iterator<Item = &Link> {
    let joints = mechanism.independent_joints().into_iter();
    joints.filter(|link| link.joint.has_axis())
}

/// `q(2) = q(3) - 1/2 q(4) + 3*pi`, as written.
pub(crate) fn equation(mechanism: &Mechanism, couple: &Couple) -> String {
    let name = |name: &str| {
        let link = mechanism.links.iter().find(|link| link.name == name);
        format!("q({})", link.map_or(name, Link::label))
    };
    if let Some(expression) = &couple.expression {
        return format!("{} = {}", name(&couple.joint), expression.text);
    }
    let mut sum = String::new();
    for term in &couple.terms {
        let joint = name(&term.joint);
        let text = factor(&term.multiplier);
        append(
            &mut sum,
            &text.map_or(joint.clone(), |f| format!("{f} {joint}")),
            &term.multiplier,
        );
    }
    if couple.offset.value != 0.0 {
        append(&mut sum, &unsigned(&couple.offset), &couple.offset);
    }
    format!("{} = {sum}", name(&couple.joint))
}

/// A factor without its sign; `None` for 1.
fn factor(x: &Quantity) -> Option<String> {
    let text = unsigned(x);
    (x.value.abs() != 1.0).then(|| {
        if text.contains(['+', '-', ' ']) && !text.contains('e') {
            format!("({text})")
        } else {
            text
        }
    })
}

/// The text without a leading sign; texts that are sums keep it.
fn unsigned(x: &Quantity) -> String {
    let text = x.text.trim();
    match text.strip_prefix('-') {
        Some(rest) if !rest.contains(['+', '-']) => rest.trim().to_owned(),
        _ => text.to_owned(),
    }
}

fn append(sum: &mut String, text: &str, x: &Quantity) {
    let minus = x.text.trim().starts_with('-') && !x.text.trim()[1..].contains(['+', '-']);
    sum.push_str(match (sum.is_empty(), minus) {
        (true, true) => "-",
        (true, false) => "",
        (false, true) => " - ",
        (false, false) => " + ",
    });
    sum.push_str(text);
}

pub(crate) fn shortened(texts: &[String]) -> String {
    let shown = texts[..texts.len().min(MOST_SHOWN)].join(", ");
    match texts.len().saturating_sub(MOST_SHOWN) {
        0 => shown,
        n => format!("{shown}, and {n} more"),
    }
}
