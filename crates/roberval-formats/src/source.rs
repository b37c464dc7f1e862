use std::cell::RefCell;
use std::ops::Range;

use roberval_scalar::LiteralError;

use crate::error::{Code, FormatError, Position};

/// The largest file that is read, in bytes.
pub const MAX_FILE_BYTES: usize = 64 << 20;

/// A text with its name: makes errors that know their line and column.
pub(crate) struct Source<'a> {
    pub name: &'a str,
    pub text: &'a str,
    /// Faults that were read over, a sentence each.
    pub warnings: RefCell<Vec<(Position, String)>>,
    /// All faults met, where more than the first is asked for.
    faults: Option<RefCell<Vec<FormatError>>>,
}

impl<'a> Source<'a> {
    /// Checks size and emptiness and takes off a byte order mark.
    pub fn new(name: &'a str, text: &'a str) -> Result<Self, FormatError> {
        check_size(name, text.len(), MAX_FILE_BYTES)?;
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        if text.trim().is_empty() {
            return Err(FormatError::new(Code::Empty, name, "the file is empty"));
        }
        let warnings = RefCell::default();
        Ok(Self {
            name,
            text,
            warnings,
            faults: None,
        })
    }

    /// The same text, of which all faults are asked for.
    pub fn collecting(mut self) -> Self {
        self.faults = Some(RefCell::default());
        self
    }

    /// Goes on with `value` in the place of a fault, where all faults are asked for.
    pub fn or_go_on<T>(
        &self,
        result: Result<T, FormatError>,
        value: impl FnOnce() -> T,
    ) -> Result<T, FormatError> {
        match (&self.faults, result) {
            (Some(faults), Err(fault)) => {
                faults.borrow_mut().push(fault);
                Ok(value())
            }
            (_, result) => result,
        }
    }

    /// Whether a fault was gone over: what follows from the whole cannot be told then.
    pub fn has_faults(&self) -> bool {
        let some = |faults: &RefCell<Vec<_>>| !faults.borrow().is_empty();
        self.faults.as_ref().is_some_and(some)
    }

    /// The faults that were gone over.
    pub fn take_faults(&self) -> Vec<FormatError> {
        self.faults.as_ref().map(RefCell::take).unwrap_or_default()
    }

    /// Line and column of a byte; a byte outside the text counts as its end.
    pub fn position(&self, offset: usize) -> Position {
        let mut end = offset.min(self.text.len());
        while !self.text.is_char_boundary(end) {
            end -= 1;
        }
        let before = &self.text[..end];
        let start = before.rfind('\n').map_or(0, |at| at + 1);
        let number = |count: usize| u32::try_from(count).unwrap_or(u32::MAX);
        Position {
            line: number(before.bytes().filter(|b| *b == b'\n').count() + 1),
            column: number(before[start..].chars().count() + 1),
        }
    }

    /// Notes a fault that was read over.
    pub fn warn(&self, offset: usize, place: &str, what: &str) {
        let slip = (self.position(offset), format!("{place}: {what}"));
        self.warnings.borrow_mut().push(slip);
    }

    pub fn error(&self, code: Code, offset: usize, what: impl Into<String>) -> FormatError {
        let mut error = FormatError::new(code, self.name, what);
        error.position = Some(self.position(offset));
        error
    }

    /// The error for a literal with the text `literal` that stands somewhere in `range`.
    pub fn literal(&self, range: Range<usize>, literal: &str, error: LiteralError) -> FormatError {
        let written = self.text.get(range.clone()).unwrap_or("");
        // Where escapes hide the literal, its beginning is all that is known.
        let start = range.start + written.find(literal).unwrap_or(0);
        let offset = start
            + error
                .offset
                .filter(|_| written.contains(literal))
                .unwrap_or(0);
        let result = self.error(error.fault.into(), offset, error.message);
        match error.hint {
            Some(hint) => result.hint(hint),
            None => result,
        }
    }
}

pub(crate) fn check_size(name: &str, bytes: usize, most: usize) -> Result<(), FormatError> {
    if bytes <= most {
        return Ok(());
    }
    let what = format!("the file has more than {} MiB", most >> 20);
    Err(FormatError::new(Code::TooLarge, name, what)
        .hint("a robot file has some kilobytes: is this the right file?"))
}

/// The text of a file's bytes.
pub(crate) fn decode<'a>(name: &str, bytes: &'a [u8]) -> Result<&'a str, FormatError> {
    let utf16 = bytes.starts_with(&[0xff, 0xfe])
        || bytes.starts_with(&[0xfe, 0xff])
        || bytes.starts_with(&[b'<', 0])
        || bytes.starts_with(&[0, b'<']);
    if utf16 {
        return Err(FormatError::new(Code::Encoding, name, "the text is UTF-16")
            .hint("save the file as UTF-8"));
    }
    std::str::from_utf8(bytes).map_err(|error| {
        let valid = std::str::from_utf8(&bytes[..error.valid_up_to()]).unwrap_or("");
        let source = Source {
            name,
            text: valid,
            warnings: RefCell::default(),
            faults: None,
        };
        let byte = bytes[valid.len()];
        source
            .error(
                Code::Encoding,
                valid.len(),
                format!("the byte 0x{byte:02x} is not UTF-8"),
            )
            .hint("save the file as UTF-8")
    })
}

/// The file's name without folders and extension, for a robot that has no name.
pub(crate) fn stem(name: &str) -> String {
    std::path::Path::new(name)
        .file_stem()
        .map_or_else(|| "robot".to_owned(), |s| s.to_string_lossy().into_owned())
}

/// Why a text is no name.
pub(crate) fn name_fault(name: &str) -> Option<&'static str> {
    /// Longer names would not fit any table.
    const LONGEST: usize = 1000;
    if name.trim().is_empty() {
        Some("a name must not be empty or blank")
    } else if name.chars().any(char::is_control) {
        Some("a name must not have control characters")
    } else if name.len() > LONGEST {
        Some("a name must not be longer than 1000 bytes")
    } else {
        None
    }
}
