//! A look at the raw text before the XML reader sees it: the reader recurses, so that
//! deeply nested input would end the process.

use crate::error::{Code, FormatError};
use crate::source::Source;

/// The deepest nesting of elements; a URDF needs about six.
const MAX_DEPTH: usize = 256;
/// The most attributes of one element: the reader compares them pair by pair.
const MAX_ATTRIBUTES: usize = 1000;
/// The most namespace declarations: the reader copies them from element to element.
const MAX_NAMESPACES: usize = 1000;

/// Refuses web pages, document type definitions, deep nesting and floods of attributes.
///
/// Exact on well-formed text. On any other text the XML reader stops at the first fault,
/// and up to there this count is exact too.
pub(super) fn check(source: &Source) -> Result<(), FormatError> {
    let text = source.text;
    check_page(source)?;
    if text.matches("xmlns").nth(MAX_NAMESPACES).is_some() {
        let what = format!("more than {MAX_NAMESPACES} namespace declarations");
        return Err(FormatError::new(Code::TooMany, source.name, what));
    }
    let (mut at, mut depth) = (0, 0usize);
    while let Some(open) = text[at..].find('<') {
        let start = at + open;
        let rest = &text[start..];
        let length = if rest.starts_with("<!--") {
            length_to(rest, 4, "-->")
        } else if rest.starts_with("<![CDATA[") {
            length_to(rest, 9, "]]>")
        } else if rest.starts_with("<?") {
            length_to(rest, 2, "?>")
        } else if rest.starts_with("<!") {
            return doctype(source, start);
        } else {
            let tag = Tag::scan(rest);
            if tag.attributes > MAX_ATTRIBUTES {
                let what = format!("more than {MAX_ATTRIBUTES} attributes in one element");
                return Err(source.error(Code::TooMany, start, what));
            }
            depth = tag.depth_after(depth);
            tag.length
        };
        if depth > MAX_DEPTH {
            let what = format!("elements are nested more than {MAX_DEPTH} deep");
            return Err(source.error(Code::TooDeep, start, what));
        }
        match length {
            Some(length) => at = start + length,
            None => return Ok(()),
        }
    }
    Ok(())
}

/// A page saved from a browser is the most common wrong file.
fn check_page(source: &Source) -> Result<(), FormatError> {
    let head: String = source.text.trim_start().chars().take(20).collect();
    let head = head.to_ascii_lowercase();
    if head.starts_with("<!doctype html") || head.starts_with("<html") {
        let what = "this is a web page, not a robot file";
        return Err(source
            .error(Code::WrongFormat, 0, what)
            .hint("download the raw file"));
    }
    Ok(())
}

fn doctype(source: &Source, start: usize) -> Result<(), FormatError> {
    let head = source.text[start..].get(..9).unwrap_or("");
    if head.eq_ignore_ascii_case("<!DOCTYPE") {
        let what = "document type definitions are refused";
        return Err(source
            .error(Code::Dtd, start, what)
            .hint("delete <!DOCTYPE ...>: a URDF needs none"));
    }
    // Malformed: the XML reader says so.
    Ok(())
}

/// Length of a piece up to and with its end mark, sought from byte `from`.
fn length_to(rest: &str, from: usize, end: &str) -> Option<usize> {
    rest[from..].find(end).map(|at| from + at + end.len())
}

/// What stands between `<` and `>`.
struct Tag {
    /// Bytes with both brackets; `None` where the text ends before.
    length: Option<usize>,
    attributes: usize,
    closes: bool,
    empty: bool,
}

impl Tag {
    fn scan(rest: &str) -> Self {
        let bytes = rest.as_bytes();
        let mut tag = Self {
            length: None,
            attributes: 0,
            closes: bytes.get(1) == Some(&b'/'),
            empty: false,
        };
        let mut quote = None;
        for (at, &byte) in bytes.iter().enumerate().skip(1) {
            match (quote, byte) {
                (Some(mark), _) if mark == byte => quote = None,
                (Some(_), _) => {}
                (None, b'"' | b'\'') => quote = Some(byte),
                (None, b'=') => tag.attributes += 1,
                (None, b'>') => {
                    tag.empty = bytes[at - 1] == b'/';
                    tag.length = Some(at + 1);
                    break;
                }
                _ => {}
            }
        }
        tag
    }

    fn depth_after(&self, depth: usize) -> usize {
        match (self.closes, self.empty) {
            (true, _) => depth.saturating_sub(1),
            (false, true) => depth,
            (false, false) => depth + 1,
        }
    }
}
