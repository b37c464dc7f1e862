use std::collections::HashMap;

use roberval_mechanism::{Change, CleanPolicy, Field, NearMiss, clean};
use toml_edit::{Document, Item, Value};

use super::{Section, link_tables, parse_toml, syntax, write};
use crate::error::FormatError;
use crate::source::Source;
use crate::splice::splice;

/// Cleans the text of a robot TOML as [`roberval_mechanism::clean()`] cleans its
/// description: the text with only the changed numbers replaced (comments, order and
/// everything else stay byte for byte), what was changed, and what looks like a rounding
/// and was left. The cleaned text reads as the cleaned description.
///
/// # Errors
/// As [`parse_toml`].
pub fn clean_toml(
    text: &str,
    source_name: &str,
    policy: &CleanPolicy,
) -> Result<(String, Vec<Change>, Vec<NearMiss>), FormatError> {
    let description = parse_toml(text, source_name)?;
    let cleaned = clean(&description, policy);
    let source = Source::new(source_name, text)?;
    let document = Document::parse(source.text).map_err(|error| syntax(&source, &error))?;
    let robot = Section::new(&source, document.as_table(), "robot", 0);
    let names = description.links.iter().map(|link| link.name.as_str());
    let tables = link_tables(&robot)?.into_iter().map(|(table, _)| table);
    let tables: HashMap<_, _> = names.zip(tables).collect();
    let edits = cleaned.changes.iter().filter_map(|change| {
        let value = match (&change.link, change.field) {
            (None, Field::Gravity(k)) => robot.table.get("gravity")?.as_array()?.get(k),
            (Some(link), field) => {
                let item = tables.get(link.as_str())?.get(&field.to_string());
                item.and_then(Item::as_value)
            }
            (None, _) => None,
        };
        let range = value.and_then(Value::span)?;
        Some((range, write::number(&change.became)))
    });
    let spliced = splice(source.text, edits.collect());
    let mark = &text[..text.len() - source.text.len()];
    Ok((
        format!("{mark}{spliced}"),
        cleaned.changes,
        cleaned.near_misses,
    ))
}
