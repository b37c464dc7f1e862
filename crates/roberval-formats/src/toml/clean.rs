use std::collections::HashMap;
use std::ops::Range;

use roberval_mechanism::{Change, CleanPolicy, Field, NearMiss, RobotDescription, clean};
use toml_edit::{Document, Item, Value};

use super::{Section, link_tables, loops, parse_toml, syntax, write};
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
    let edits = with_spans(&source, &description, |span| {
        let edit = |change: &Change| {
            let (key, index) = change_key(change);
            let range = match change.loop_frame() {
                Some(frame) => loops::span(&robot, frame, change.field),
                None => span(change.link.as_deref(), &key, index),
            }?;
            Some((range, write::number(&change.became)))
        };
        cleaned.changes.iter().filter_map(edit).collect()
    })?;
    let spliced = splice(source.text, edits);
    let mark = &text[..text.len() - source.text.len()];
    Ok((
        format!("{mark}{spliced}"),
        cleaned.changes,
        cleaned.near_misses,
    ))
}

/// Finds values in the text: of a link (`None`: of the robot) by their key, and by their
/// place where they are one of several.
pub(crate) type Span<'a> = &'a dyn Fn(Option<&str>, &str, Option<usize>) -> Option<Range<usize>>;

/// Hands on a [`Span`] for the text that the description was read from.
pub(crate) fn with_spans<T>(
    source: &Source,
    description: &RobotDescription,
    use_spans: impl FnOnce(Span<'_>) -> T,
) -> Result<T, FormatError> {
    let document = Document::parse(source.text).map_err(|error| syntax(source, &error))?;
    let robot = Section::new(source, document.as_table(), "robot", 0);
    let names = description.links.iter().map(|link| link.name.as_str());
    let tables = link_tables(&robot)?.into_iter().map(|(table, _)| table);
    let tables: HashMap<_, _> = names.zip(tables).collect();
    let find = |link: Option<&str>, key: &str, index: Option<usize>| {
        let table = match link {
            None => robot.table,
            Some(link) => *tables.get(link)?,
        };
        let value = table.get(key).and_then(Item::as_value)?;
        match index {
            None => value.span(),
            Some(k) => value.as_array()?.get(k).and_then(Value::span),
        }
    };
    Ok(use_spans(&find))
}

/// The key of a changed number, and its place where it is one of several.
pub(crate) fn change_key(change: &Change) -> (String, Option<usize>) {
    match change.field {
        Field::Gravity(k) => ("gravity".to_owned(), Some(k)),
        field => (field.to_string(), None),
    }
}
