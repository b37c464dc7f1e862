use std::collections::HashMap;
use std::ops::Range;

use roberval_mechanism::{Change, CleanPolicy, Field, NearMiss, clean};
use toml_edit::{Document, Item, TableLike, Value};

use super::{Section, couple, link_tables, loops, parse_toml, syntax, write};
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
    let edits = with_places(&source, |places| {
        let edit = |change: &Change| Some((places.change(change)?, write::number(&change.became)));
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

/// Finds values in a text.
pub(crate) struct Places<'s, 'd> {
    robot: Section<'s, 'd>,
    /// The links by their names, not by number: one with faults may be missing in the
    /// description.
    links: HashMap<String, &'d dyn TableLike>,
}

impl Places<'_, '_> {
    /// The value of a link (`None`: of the robot) by its key, and by its place where it is
    /// one of several.
    pub fn value(
        &self,
        link: Option<&str>,
        key: &str,
        index: Option<usize>,
    ) -> Option<Range<usize>> {
        let table = match link {
            None => self.robot.table,
            Some(link) => *self.links.get(link)?,
        };
        let value = table.get(key).and_then(Item::as_value)?;
        match index {
            None => value.span(),
            Some(k) => value.as_array()?.get(k).and_then(Value::span),
        }
    }

    /// A number that was changed.
    pub fn change(&self, change: &Change) -> Option<Range<usize>> {
        if let Some(frame) = change.loop_frame() {
            return loops::span(&self.robot, frame, change.field);
        }
        if let Some(number) = change.couple() {
            return couple::offset_span(&self.robot, number);
        }
        let name = change.field.to_string();
        let (key, index) = match change.field {
            Field::Gravity(k) => ("gravity", Some(k)),
            Field::Xyz(k) => ("xyz", Some(k)),
            Field::Rpy(k) => ("rpy", Some(k)),
            Field::Axis(k) => ("axis", Some(k)),
            _ => (name.as_str(), None),
        };
        self.value(change.link.as_deref(), key, index)
    }
}

/// Hands on the [`Places`] of a text.
pub(crate) fn with_places<T>(
    source: &Source,
    use_places: impl FnOnce(&Places) -> T,
) -> Result<T, FormatError> {
    let document = Document::parse(source.text).map_err(|error| syntax(source, &error))?;
    let robot = Section::new(source, document.as_table(), "robot", 0);
    let name = |number: usize, table: &dyn TableLike| {
        let name = table.get("name").and_then(Item::as_str);
        name.map_or_else(|| number.to_string(), str::to_owned)
    };
    let links = (1..)
        .zip(link_tables(&robot)?)
        .map(|(number, (table, _))| (name(number, table), table))
        .collect();
    Ok(use_places(&Places { robot, links }))
}
