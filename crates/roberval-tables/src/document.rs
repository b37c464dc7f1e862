//! What is shown, before it is known to whom: a small document without markup.

use crate::relation::{Label, Sum};
use crate::symbolic::Formula;

/// A piece of a line or a cell.
#[derive(Debug, Clone)]
pub(crate) enum Item {
    /// Words, ours or a robot file's: every renderer escapes them.
    Text(String),
    /// A number as it is to be shown.
    Number(String),
    /// A parameter.
    Label(Label),
    /// A sign of ours, coloured where there are colours.
    Mark(&'static str, Tint),
}

/// A colour of a terminal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Tint {
    Title,
    Heading,
    Keep,
    Into,
    Away,
    Faint,
    Bad,
}

impl Tint {
    /// The text in this colour.
    pub fn paint(self, text: &str) -> String {
        let code = match self {
            Self::Title => "1",
            Self::Heading => "1;36",
            Self::Keep => "32",
            Self::Into => "94",
            Self::Away => "33",
            Self::Faint => "2",
            Self::Bad => "31",
        };
        format!("\x1b[{code}m{text}\x1b[0m")
    }
}

impl Item {
    pub fn text(text: impl Into<String>) -> Self {
        Self::Text(text.into())
    }
}

/// A column of a [`Table`].
#[derive(Debug, Clone)]
pub(crate) struct Column {
    pub title: &'static str,
    pub right: bool,
}

impl Column {
    pub fn left(title: &'static str) -> Self {
        Self {
            title,
            right: false,
        }
    }

    pub fn right(title: &'static str) -> Self {
        Self { title, right: true }
    }
}

#[derive(Debug, Clone)]
pub(crate) struct Table {
    pub columns: Vec<Column>,
    pub rows: Vec<Vec<Item>>,
    /// Whether text sets the rows in several columns side by side.
    pub folded: bool,
}

/// A part of a document.
#[derive(Debug, Clone)]
pub(crate) enum Block {
    Title(String),
    Heading(String),
    /// Lines that belong together.
    Lines(Vec<String>),
    Table(Table),
    /// A line across a table, with words in it: the gap.
    Rule(String),
    /// Words, then parameters with commas between them.
    List(String, Vec<Label>),
    Relations(Vec<Sum>),
    /// Relations in symbols.
    Formulas(Vec<Formula>),
}

pub(crate) type Document = Vec<Block>;
