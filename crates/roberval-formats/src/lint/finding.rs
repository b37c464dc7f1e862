use std::fmt;

use crate::error::{Code, FormatError, Position, visible};

/// How bad a finding is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Severity {
    /// Readers refuse the file, or read what it does not mean.
    Error,
    /// It can be read and is most likely not meant so.
    Warning,
}

impl Severity {
    /// `error` or `warning`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Error => "error",
            Self::Warning => "warning",
        }
    }
}

/// What kind of thing was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Rule {
    /// What a reader refuses, by its code.
    Invalid(Code),
    /// A remark of the reader that has no rule of its own.
    Remark,
    /// No body has this inertia.
    Inertia,
    /// A moving link without inertial values.
    MissingInertial,
    /// An inertia, mass or centre of mass that is most likely in another unit.
    Units,
    /// An angle that is a rounding of a multiple of 15 degrees.
    RoundedAngle,
    /// A length or component that is the rest of a computation.
    Dust,
    /// An angle that is most likely in degrees.
    Degrees,
    /// A joint axis that is not of length 1.
    Axis,
    /// A mimic joint that copies nothing that moves, or by nothing.
    Mimic,
    /// Joint limits that are missing or exclude each other.
    Limits,
}

impl Rule {
    /// The rules that have a name.
    pub const NAMED: [Self; 10] = [
        Self::Remark,
        Self::Inertia,
        Self::MissingInertial,
        Self::Units,
        Self::RoundedAngle,
        Self::Dust,
        Self::Degrees,
        Self::Axis,
        Self::Mimic,
        Self::Limits,
    ];

    /// `inertia`, `missing-inertial`, ..., or the code of what a reader refuses: `E240`.
    #[must_use]
    pub fn name(self) -> String {
        match self {
            Self::Invalid(code) => return code.to_string(),
            Self::Remark => "remark",
            Self::Inertia => "inertia",
            Self::MissingInertial => "missing-inertial",
            Self::Units => "units",
            Self::RoundedAngle => "rounded-angle",
            Self::Dust => "dust",
            Self::Degrees => "degrees",
            Self::Axis => "axis",
            Self::Mimic => "mimic",
            Self::Limits => "limits",
        }
        .to_owned()
    }
}

/// Something wrong or suspicious in a robot file.
///
/// `Display`: `file:line:column: warning: joint "elbow": ... [rounded-angle]; remedy`, on
/// one line, control characters escaped.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Finding {
    /// How bad it is.
    pub severity: Severity,
    /// What kind of thing it is.
    pub rule: Rule,
    /// The file.
    pub file: String,
    /// Line and column, where known.
    pub position: Option<Position>,
    /// What is wrong, with the link, joint and field.
    pub what: String,
    /// What to do.
    pub remedy: String,
}

impl Finding {
    pub(super) fn new(rule: Rule, file: &str, what: String, remedy: impl Into<String>) -> Self {
        Self {
            severity: Severity::Warning,
            rule,
            file: file.to_owned(),
            position: None,
            what,
            remedy: remedy.into(),
        }
    }

    /// What a reader refuses.
    pub(super) fn refused(error: FormatError) -> Self {
        let what = match &error.place {
            Some(place) => format!("{place}: {}", error.what),
            None => error.what,
        };
        Self {
            severity: Severity::Error,
            rule: Rule::Invalid(error.code),
            file: error.file,
            position: error.position,
            what,
            remedy: error.hint.unwrap_or_default(),
        }
    }

    pub(super) fn at(mut self, position: Position) -> Self {
        self.position = Some(position);
        self
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let position = match self.position {
            Some(Position { line, column }) => format!(":{line}:{column}"),
            None => String::new(),
        };
        let remedy = match self.remedy.as_str() {
            "" => String::new(),
            remedy => format!("; {remedy}"),
        };
        let line = format!(
            "{}{position}: {}: {} [{}]{remedy}",
            self.file,
            self.severity.name(),
            self.what,
            self.rule.name()
        );
        f.write_str(&visible(&line))
    }
}
