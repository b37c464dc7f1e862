use std::ops::Range;

use roberval_scalar::Quantity;
use roxmltree::{Attribute, Node};

use super::XACRO_HINT;
use crate::error::{Code, FormatError};
use crate::source::Source;
use crate::words::quoted;

/// An XML element with its name in messages.
#[derive(Clone, Copy)]
pub(crate) struct Element<'s, 'd> {
    pub source: &'s Source<'s>,
    pub node: Node<'d, 'd>,
    pub place: &'s str,
}

impl<'s, 'd> Element<'s, 'd> {
    pub fn new(source: &'s Source<'s>, node: Node<'d, 'd>, place: &'s str) -> Self {
        Self {
            source,
            node,
            place,
        }
    }

    /// Where the element begins.
    pub fn offset(&self) -> usize {
        self.node.range().start
    }

    /// The child elements with this tag, in the robot's own namespace.
    pub fn children(&self, tag: &str) -> impl Iterator<Item = Node<'d, 'd>> {
        let space = self.node.tag_name().namespace();
        self.node.children().filter(move |node| {
            let name = node.tag_name();
            node.is_element() && name.name() == tag && name.namespace() == space
        })
    }

    /// The child element with this tag; a second one would be ambiguous.
    pub fn child(&self, tag: &str) -> Result<Option<Self>, FormatError> {
        let mut found = self.children(tag);
        let first = found
            .next()
            .map(|node| Self::new(self.source, node, self.place));
        match found.next() {
            None => Ok(first),
            Some(second) => Err(Self::new(self.source, second, self.place)
                .fault(Code::DuplicateName, format!("a second <{tag}>"))),
        }
    }

    /// Where an attribute begins (the element, where it has no such attribute).
    pub fn attribute_offset(&self, key: &str) -> usize {
        let at = self.node.attribute_node(key).map(|a| a.range().start);
        at.unwrap_or_else(|| self.offset())
    }

    /// The first child element with this tag, as ROS reads it; others are warned of.
    pub fn first_child(&self, tag: &str) -> Option<Self> {
        let mut found = self.children(tag);
        let first = found.next()?;
        if let Some(second) = found.next() {
            let what = format!("a second <{tag}>: the first is taken");
            self.source.warn(second.range().start, self.place, &what);
        }
        Some(Self::new(self.source, first, self.place))
    }

    /// An error where the element begins.
    pub fn fault(&self, code: Code, what: impl Into<String>) -> FormatError {
        self.source
            .error(code, self.offset(), what)
            .place(self.place)
    }

    /// An error at an attribute (at the element where it has no such attribute).
    pub fn attribute_fault(&self, key: &str, code: Code, what: impl Into<String>) -> FormatError {
        self.source
            .error(code, self.attribute_offset(key), what)
            .place(self.place)
    }

    /// An attribute that is a text.
    pub fn attribute(&self, key: &str) -> Result<Option<&'d str>, FormatError> {
        Ok(self.raw(key)?.map(|(value, _)| value))
    }

    /// An attribute that must be there.
    pub fn required(&self, key: &str) -> Result<&'d str, FormatError> {
        self.attribute(key)?.ok_or_else(|| self.missing(key))
    }

    fn missing(&self, key: &str) -> FormatError {
        let tag = self.node.tag_name().name();
        let what = format!("<{tag}> has no attribute {key}");
        self.fault(Code::Missing, what)
    }

    /// An attribute's value and where that stands in the text.
    fn raw(&self, key: &str) -> Result<Option<(&'d str, Range<usize>)>, FormatError> {
        let Some(attribute) = self.node.attribute_node(key) else {
            return Ok(None);
        };
        let value: &'d str = attribute.value();
        if value.contains("${") || value.contains("$(") {
            let what = format!("{key} = {} is xacro, not URDF", quoted(value));
            return Err(self
                .attribute_fault(key, Code::Xacro, what)
                .hint(XACRO_HINT));
        }
        Ok(Some((value, value_range(self.source, &attribute))))
    }

    /// An attribute that is one number.
    pub fn number(&self, key: &str) -> Result<Option<Quantity>, FormatError> {
        Ok(self.numbers::<1>(key)?.map(|[x]| x))
    }

    /// An attribute that is a number and must be there.
    pub fn required_number(&self, key: &str) -> Result<Quantity, FormatError> {
        self.number(key)?.ok_or_else(|| self.missing(key))
    }

    /// An attribute of exactly N numbers with spaces between them.
    pub fn numbers<const N: usize>(&self, key: &str) -> Result<Option<[Quantity; N]>, FormatError> {
        let Some((value, range)) = self.raw(key)? else {
            return Ok(None);
        };
        let place = format!("{}, {} {key}", self.place, self.node.tag_name().name());
        let mut numbers = Vec::with_capacity(N);
        let mut commas = false;
        for written in value.split_whitespace().take(N + 1) {
            // A comma after a number of several is clear enough.
            let word = written.strip_suffix(',').filter(|_| N > 1);
            commas |= word.is_some();
            let word = word.unwrap_or(written);
            // Exact unless the file hides characters behind entities.
            let start = range.start + (word.as_ptr() as usize - value.as_ptr() as usize);
            let here = start..(start + word.len()).min(range.end);
            numbers.push(
                Quantity::parse_decimal(word)
                    .map_err(|e| self.source.literal(here, word, e).place(place.as_str()))?,
            );
        }
        if commas {
            let what = format!("commas in {} are taken for blanks", quoted(value));
            self.source.warn(range.start, &place, &what);
        }
        <[Quantity; N]>::try_from(numbers).map(Some).map_err(|_| {
            let found = value.split_whitespace().count();
            let numbers = if N == 1 { "number" } else { "numbers" };
            let what = format!("{N} {numbers} wanted, {found} found in {}", quoted(value));
            self.source
                .error(Code::WrongType, range.start, what)
                .place(place.as_str())
        })
    }
}

fn value_range(source: &Source, attribute: &Attribute) -> Range<usize> {
    let range = attribute.range_value();
    debug_assert!(range.end <= source.text.len());
    range
}
