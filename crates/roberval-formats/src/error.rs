use std::fmt::{self, Write};

use roberval_scalar::LiteralFault;

/// Stable number of a fault: E1xx the text, E2xx the robot, E6xx limits.
///
/// `Display` gives `E101` and so on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Code {
    /// The file cannot be read, or neither file nor built-in robot has this name.
    NotFound = 100,
    /// The text is empty.
    Empty = 101,
    /// The bytes are not UTF-8.
    Encoding = 102,
    /// Not well-formed XML.
    Xml = 103,
    /// Not well-formed TOML.
    Toml = 104,
    /// A number or expression does not follow the grammar.
    Literal = 105,
    /// An XML document type definition: always refused.
    Dtd = 110,
    /// Unexpanded xacro.
    Xacro = 115,
    /// Another format: SDF, MJCF, a web page, ...
    WrongFormat = 116,
    /// A key that robot files do not have.
    UnknownKey = 130,
    /// A value of the wrong type or with the wrong number of elements.
    WrongType = 131,
    /// Something required is missing.
    Missing = 132,
    /// A robot without links.
    NoLink = 200,
    /// A name that is empty, blank, reserved or has control characters.
    BadName = 201,
    /// Two links, joints or constants have one name.
    DuplicateName = 202,
    /// An antecedent, parent or child that does not exist.
    UnknownLink = 203,
    /// Links that stand on each other in a circle.
    Cycle = 204,
    /// A link with two parents.
    TwoParents = 205,
    /// More than one root link.
    TwoRoots = 206,
    /// A joint type that does not exist or is not supported.
    JointType = 210,
    /// Flags or values that contradict each other.
    Contradiction = 211,
    /// An expression uses a name that is not among the constants.
    UnknownConstant = 220,
    /// Joints that follow from each other in a circle (mimic joints, couples).
    CoupleCycle = 230,
    /// A mimic joint or couple names a joint that does not exist.
    CoupleUnknown = 231,
    /// A number that is not finite, or an expression without a finite value.
    NotFinite = 240,
    /// A joint axis of length zero.
    ZeroAxis = 241,
    /// The robot cannot be written in the asked form.
    NotWritable = 270,
    /// Elements or brackets nested too deeply.
    TooDeep = 601,
    /// The file is too large.
    TooLarge = 602,
    /// Too many elements.
    TooMany = 604,
    /// A number or expression that is too long or too deeply nested.
    LiteralTooLarge = 605,
}

impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "E{:03}", *self as u16)
    }
}

impl From<LiteralFault> for Code {
    fn from(fault: LiteralFault) -> Self {
        match fault {
            LiteralFault::Syntax => Self::Literal,
            LiteralFault::UnknownName => Self::UnknownConstant,
            LiteralFault::NotFinite => Self::NotFinite,
            LiteralFault::TooLarge => Self::LiteralTooLarge,
        }
    }
}

/// A place in a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Position {
    /// Line, from 1.
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
}

/// What is wrong with a robot file, where, and what would be right.
///
/// `Display`: `file:line:column: [E240] joint "elbow", origin xyz: "nan" is not a finite
/// number; hint`, on one line, control characters escaped.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FormatError {
    /// Stable number of the fault.
    pub code: Code,
    /// The file's name or another name of the source.
    pub file: String,
    /// Line and column, where known.
    pub position: Option<Position>,
    /// The link, joint and field it concerns, where known.
    pub place: Option<String>,
    /// What is wrong.
    pub what: String,
    /// What would be right, where known.
    pub hint: Option<String>,
}

impl std::error::Error for FormatError {}

impl FormatError {
    pub(crate) fn new(code: Code, file: impl Into<String>, what: impl Into<String>) -> Self {
        Self {
            code,
            file: file.into(),
            position: None,
            place: None,
            what: clipped(what.into()),
            hint: None,
        }
    }

    pub(crate) fn place(mut self, place: impl Into<String>) -> Self {
        self.place = Some(clipped(place.into()));
        self
    }

    pub(crate) fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(clipped(hint.into()));
        self
    }
}

/// A part of a message, cut where a text from the file makes it very long.
fn clipped(mut text: String) -> String {
    const LONGEST: usize = 400;
    if let Some((end, _)) = text.char_indices().nth(LONGEST) {
        text.truncate(end);
        text.push_str("...");
    }
    text
}

impl fmt::Display for FormatError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut line = self.file.clone();
        if let Some(Position { line: row, column }) = self.position {
            write!(line, ":{row}:{column}")?;
        }
        write!(line, ": [{}] ", self.code)?;
        if let Some(place) = &self.place {
            write!(line, "{place}: ")?;
        }
        line.push_str(&self.what);
        if let Some(hint) = &self.hint {
            write!(line, "; {hint}")?;
        }
        f.write_str(&visible(&line))
    }
}

/// Texts from files reach terminals and logs through here.
pub(crate) fn visible(line: &str) -> String {
    line.chars().fold(String::new(), |mut text, c| {
        if c.is_control() || matches!(c, '\u{2028}' | '\u{2029}' | '\u{202a}'..='\u{202e}') {
            text.extend(c.escape_unicode());
        } else {
            text.push(c);
        }
        text
    })
}
