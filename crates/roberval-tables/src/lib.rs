//! Answers as people and programs read them.
//!
//! One function a subcommand ([`base`], [`show`], [`compare`]), one [`Format`] a reader.
//! What is shown is collected once as a small document; the renderers of text, Markdown
//! and LaTeX know nothing about robots, and each escapes what comes from robot files in
//! its own way. JSON and CSV are for programs: they keep names and numbers as they are.

mod base;
mod catalogue;
mod compare;
mod counts;
mod couples;
mod document;
mod escape;
mod json;
mod latex;
mod lint;
mod loops;
mod markdown;
mod number;
mod orders;
mod relation;
mod report;
mod robot;
mod scale;
mod show;
mod symbolic;
mod text;

pub use loops::loop_couples;
use std::fmt;
use std::str::FromStr;

use roberval_base::{BaseParameters, Comparison, Scaling, ScalingOptions};
use roberval_code::Code;
use roberval_mechanism::{Convention, Mechanism};
use roberval_symbolic::SymbolicRelations;

use document::Document;

/// The version of the JSON that [`base`] writes.
pub(crate) const SCHEMA: u32 = 1;

/// The longest line of a text table, in columns of a terminal.
pub const WIDTH: usize = 100;

/// Who the answer is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Format {
    /// Plain text of at most [`WIDTH`] columns.
    #[default]
    Table,
    /// The same with colours, for a terminal: no name asks for it.
    Coloured,
    /// JSON; numbers read back exactly, no NaN or infinity (`null` instead).
    Json,
    /// One table with a header line; cells never start a spreadsheet formula.
    Csv,
    /// GitHub's Markdown.
    Markdown,
    /// LaTeX to `\input`; needs the packages booktabs, longtable and amsmath.
    Latex,
}

impl Format {
    /// All formats that have a name.
    pub const ALL: [Self; 5] = [
        Self::Table,
        Self::Json,
        Self::Csv,
        Self::Markdown,
        Self::Latex,
    ];

    /// `table`, `json`, `csv`, `markdown` or `latex`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Table | Self::Coloured => "table",
            Self::Json => "json",
            Self::Csv => "csv",
            Self::Markdown => "markdown",
            Self::Latex => "latex",
        }
    }

    /// A document for people, in one of their formats.
    fn prose(self, document: &Document) -> String {
        match self {
            Self::Markdown => markdown::render(document),
            Self::Latex => latex::render(document),
            Self::Coloured => text::render(document, true),
            Self::Table | Self::Json | Self::Csv => text::render(document, false),
        }
    }
}

/// A word that is no [`Format`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnknownFormat;

impl fmt::Display for UnknownFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "formats are {}",
            Format::ALL.map(Format::name).join(", ")
        )
    }
}

impl std::error::Error for UnknownFormat {}

impl FromStr for Format {
    type Err = UnknownFormat;

    fn from_str(name: &str) -> Result<Self, UnknownFormat> {
        Self::ALL
            .into_iter()
            .find(|format| format.name() == name)
            .ok_or(UnknownFormat)
    }
}

/// The base parameters of a robot.
///
/// CSV has one row for each standard parameter: `label`, `kind`, `link`, `class`
/// (`no_effect`, `unchanged`, `regrouped_into` or `regrouped`), `X` and `XB` where known,
/// `relation` where not trivial, then one column for each base parameter that others
/// regroup into, with the coefficients of its sum: `XB = sum(column * X)`.
#[must_use]
pub fn base(answer: &BaseParameters, format: Format) -> String {
    match format {
        Format::Json => base::json(answer),
        Format::Csv => base::csv(answer),
        _ => format.prose(&base::document(answer)),
    }
}

/// The relations of a robot in symbols. CSV has a row for each term of a sum.
#[must_use]
pub fn symbolic(answer: &SymbolicRelations, format: Format) -> String {
    match format {
        Format::Json => symbolic::json(answer),
        Format::Csv => symbolic::csv(answer),
        _ => format.prose(&symbolic::document(answer)),
    }
}

/// The relations of a robot in symbols as a Python module for SymPy.
#[must_use]
pub fn sympy(answer: &SymbolicRelations) -> String {
    symbolic::sympy(answer)
}

/// What code costs with standard and with base parameters, link by link.
#[must_use]
pub fn counts(standard: &Code, base: &Code, format: Format) -> String {
    match format {
        Format::Json => counts::json(standard, base),
        Format::Csv => counts::csv(standard, base),
        _ => format.prose(&counts::document(standard, base)),
    }
}

/// The base parameters of a robot as a page to look at: one HTML file, offline, with drawings,
/// typeset relations, and the CSV, JSON and certificate to save from it.
#[must_use]
pub fn report(answer: &BaseParameters) -> String {
    report::page(answer)
}

/// A robot as it is understood: links, geometry as written, known inertial parameters.
#[must_use]
pub fn show(mechanism: &Mechanism, format: Format) -> String {
    match format {
        Format::Json => show::json(mechanism),
        Format::Csv => show::csv(mechanism),
        _ => format.prose(&show::document(mechanism)),
    }
}

/// All models by all engines, side by side, and whether they agree.
#[must_use]
pub fn compare(comparison: &Comparison, format: Format) -> String {
    match format {
        Format::Json => compare::json(comparison),
        Format::Csv => compare::csv(comparison),
        _ => format.prose(&compare::document(comparison)),
    }
}

/// Why a comparison is not clear: the verdict and every route's doubts. Empty if it is.
#[must_use]
pub fn doubts(comparison: &Comparison) -> Vec<String> {
    if comparison.agree {
        return Vec::new();
    }
    let mut sentences = vec![compare::verdict(comparison)];
    sentences.extend(compare::doubts(comparison));
    sentences
}

/// What a search for well scaled samples gained.
///
/// CSV has the samples, one a row: `q_1`.., `qd_1`.., `qdd_1`.., for h the reference
/// first.
#[must_use]
pub fn scale(
    mechanism: &Mechanism,
    options: &ScalingOptions,
    scaling: &Scaling,
    format: Format,
) -> String {
    match format {
        Format::Json => scale::json(mechanism, options, scaling),
        Format::Csv => scale::csv(mechanism, scaling),
        _ => format.prose(&scale::document(mechanism, options, scaling)),
    }
}

/// A built-in robot, as [`catalogue`] lists it.
#[derive(Debug, Clone, Copy)]
pub struct RobotEntry<'a> {
    /// Its name for the command line.
    pub name: &'a str,
    /// What robot it is.
    pub title: &'a str,
    /// Where its numbers come from.
    pub source: &'a str,
}

/// The known inertial parameters of a robot's links in somebody's order, a row a link.
#[must_use]
pub fn parameters(mechanism: &Mechanism, convention: Convention, format: Format) -> String {
    match format {
        Format::Json => orders::json(mechanism, convention),
        Format::Csv => orders::csv(mechanism, convention),
        _ => format.prose(&orders::document(mechanism, convention)),
    }
}

/// Something found in a robot file, as [`lint`] lists it.
#[derive(Debug, Clone)]
pub struct FindingRow {
    /// The file.
    pub file: String,
    /// Line, from 1.
    pub line: Option<u32>,
    /// Column, from 1.
    pub column: Option<u32>,
    /// `error` or `warning`.
    pub severity: &'static str,
    /// The rule's name.
    pub rule: String,
    /// What is wrong.
    pub what: String,
    /// What to do.
    pub remedy: String,
    /// All of it in a line.
    pub line_of_text: String,
}

/// What was found in robot files; as text a line each.
#[must_use]
pub fn lint(findings: &[FindingRow], format: Format) -> String {
    match format {
        Format::Table => lint::text(findings, false),
        Format::Coloured => lint::text(findings, true),
        Format::Json => lint::json(findings),
        Format::Csv => lint::csv(findings),
        Format::Markdown | Format::Latex => format.prose(&lint::document(findings)),
    }
}

/// The list of built-in robots.
#[must_use]
pub fn catalogue(robots: &[RobotEntry<'_>], format: Format) -> String {
    match format {
        Format::Json => catalogue::json(robots),
        Format::Csv => catalogue::csv(robots),
        _ => format.prose(&catalogue::document(robots)),
    }
}

/// Text with control characters and invisible ones as escapes such as `\u{1b}`: what a
/// terminal or a log may see of a name from a robot file.
#[must_use]
pub fn printable(text: &str) -> String {
    escape::plain(text)
}

/// The relations that are not trivial, in the field's notation: `XXR_6 = XX_6 - YY_6`.
///
/// Numbers are rounded to twelve significant digits, names with spaces or operators are
/// put in quotes.
#[must_use]
pub fn relations(answer: &BaseParameters) -> Vec<String> {
    relation::of(answer)
        .iter()
        .map(|relation| relation.pieces().join(" "))
        .collect()
}

/// Records as CSV (RFC 4180, but lines end with a line feed).
fn csv_text(records: impl IntoIterator<Item = Vec<String>>) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for record in records {
        // Writing to memory does not fail, and all records have the header's length.
        let written = writer.write_record(&record);
        debug_assert!(written.is_ok(), "{written:?}");
    }
    let bytes = writer.into_inner().unwrap_or_default();
    String::from_utf8(bytes).unwrap_or_default()
}
