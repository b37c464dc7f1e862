use std::collections::HashMap;

use roberval_mechanism::{Change, CleanPolicy, Field, NearMiss, clean};
use roberval_scalar::Quantity;
use roxmltree::{Attribute, Node};

use super::{UrdfOptions, parse_urdf, with_robot};
use crate::error::FormatError;
use crate::source::Source;
use crate::splice::{Edit, splice};

/// Cleans the text of a URDF as [`roberval_mechanism::clean()`] cleans its description:
/// the text with only the changed numbers replaced (comments, order and everything else
/// stay byte for byte), what was changed, and what looks like a rounding and was left.
///
/// New numbers are the decimals that read back as the nearest double. So a cleaned text
/// cleaned again has changes, but only of the last digit. Fixed joints that no moving
/// joint stands on (tool and sensor frames) place no link and stay as written.
///
/// # Errors
/// As [`parse_urdf`].
pub fn clean_urdf(
    text: &str,
    source_name: &str,
    policy: &CleanPolicy,
) -> Result<(String, Vec<Change>, Vec<NearMiss>), FormatError> {
    let description = parse_urdf(text, source_name, UrdfOptions::default())?;
    let cleaned = clean(&description, policy);
    let source = Source::new(source_name, text)?;
    let mut by_joint: HashMap<&str, Vec<&Change>> = HashMap::new();
    for change in &cleaned.changes {
        let joint = change.joint.as_deref().unwrap_or_default();
        by_joint.entry(joint).or_default().push(change);
    }
    let edits = with_robot(&source, |robot| {
        let mut edits = Vec::new();
        for joint in children(robot.node, "joint") {
            let changes = joint.attribute("name").and_then(|name| by_joint.get(name));
            if let Some(changes) = changes {
                edit_joint(&mut edits, &source, joint, changes);
            }
        }
        Ok(edits)
    })?;
    let mark = &text[..text.len() - source.text.len()];
    let spliced = format!("{mark}{}", splice(source.text, edits));
    Ok((spliced, cleaned.changes, cleaned.near_misses))
}

fn children<'d>(node: Node<'d, 'd>, tag: &'static str) -> impl Iterator<Item = Node<'d, 'd>> {
    let space = node.tag_name().namespace();
    node.children().filter(move |child| {
        let name = child.tag_name();
        child.is_element() && name.name() == tag && name.namespace() == space
    })
}

/// The new components of a vector, `None` where they stay.
type Components = [Option<String>; 3];

fn edit_joint(edits: &mut Vec<Edit>, source: &Source, joint: Node, changes: &[&Change]) {
    let (mut xyz, mut rpy, mut axis) = <(Components, Components, Components)>::default();
    let mut offset = Components::default();
    for change in changes {
        let component = match change.field {
            Field::Xyz(k) => xyz.get_mut(k),
            Field::Rpy(k) => rpy.get_mut(k),
            Field::Axis(k) => axis.get_mut(k),
            Field::Offset => offset.get_mut(0),
            _ => None,
        };
        if let Some(component) = component {
            *component = Some(decimal(&change.became));
        }
    }
    for (tag, key, components) in [
        ("origin", "xyz", xyz),
        ("origin", "rpy", rpy),
        ("axis", "xyz", axis),
        ("mimic", "offset", offset),
    ] {
        let first = children(joint, tag).next();
        let attribute = first.and_then(|node| node.attribute_node(key));
        if let Some(attribute) = attribute {
            edit_vector(edits, source, &attribute, &components);
        }
    }
}

/// The shortest decimal that reads back as the same double.
fn decimal(quantity: &Quantity) -> String {
    Quantity::from_f64(quantity.value).map_or_else(|_| quantity.text.clone(), |q| q.text)
}

fn edit_vector(edits: &mut Vec<Edit>, source: &Source, attribute: &Attribute, new: &Components) {
    if new.iter().all(Option::is_none) {
        return;
    }
    let range = attribute.range_value();
    let raw = source.text.get(range.clone()).unwrap_or_default();
    let (old, written) = (attribute.value(), || raw.split_whitespace());
    if old.split_whitespace().ne(written()) {
        // Characters hide behind entities: the attribute is written anew.
        let words = old.split_whitespace().zip(new);
        let words: Vec<&str> = words
            .map(|(old, new)| new.as_deref().unwrap_or(old))
            .collect();
        edits.push((range, words.join(" ")));
        return;
    }
    for (word, new) in written().zip(new) {
        if let Some(new) = new {
            let start = range.start + (word.as_ptr() as usize - raw.as_ptr() as usize);
            edits.push((start..start + word.len(), new.clone()));
        }
    }
}
