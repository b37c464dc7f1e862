use roberval_scalar::{Constants, LiteralError, Quantity};
use toml_edit::{Array, Item, TableLike, Value};

use crate::error::{Code, FormatError};
use crate::source::{Source, name_fault};
use crate::words::{nearest, quoted};

/// How to read a number of some kind from its text.
pub(super) type Read = fn(&str, &Constants) -> Result<Quantity, LiteralError>;

/// A table of the file with its name in messages.
pub(super) struct Section<'s, 'd> {
    pub source: &'s Source<'s>,
    pub table: &'d dyn TableLike,
    pub place: &'s str,
    start: usize,
}

impl<'s, 'd> Section<'s, 'd> {
    pub fn new(
        source: &'s Source<'s>,
        table: &'d dyn TableLike,
        place: &'s str,
        start: usize,
    ) -> Self {
        Self {
            source,
            table,
            place,
            start,
        }
    }

    /// The same table under another name in messages.
    pub fn renamed<'t>(&self, place: &'t str) -> Section<'t, 'd>
    where
        's: 't,
    {
        Section::new(self.source, self.table, place, self.start)
    }

    /// An error at the beginning of the table.
    pub fn here(&self, code: Code, what: impl Into<String>) -> FormatError {
        self.source.error(code, self.start, what).place(self.place)
    }

    /// An error at a key of the table (at the table where it has no such key).
    pub fn fault(&self, code: Code, key: &str, what: impl Into<String>) -> FormatError {
        let key = self.table.get_key_value(key).and_then(|(k, _)| k.span());
        let offset = key.map_or(self.start, |span| span.start);
        self.source.error(code, offset, what).place(self.place)
    }

    /// Refuses keys that are not in the list.
    pub fn only(&self, known: &[&str]) -> Result<(), FormatError> {
        let unknown = self.table.iter().filter(|(key, _)| !known.contains(key));
        for (key, _) in unknown {
            self.source.or_go_on(Err(self.unknown(key, known)), || ())?;
        }
        Ok(())
    }

    fn unknown(&self, key: &str, known: &[&str]) -> FormatError {
        let what = format!("unknown key {}", quoted(key));
        let error = self.fault(Code::UnknownKey, key, what);
        let all = known.join(", ");
        match nearest(key, known.iter().copied()) {
            Some(near) => error.hint(format!("did you mean {near}? known keys: {all}")),
            None => error.hint(format!("known keys: {all}")),
        }
    }

    pub fn wrong_type(&self, key: &str, item: &Item, wanted: &str) -> FormatError {
        let found = match item.type_name() {
            name @ ("array" | "integer" | "array of tables" | "inline table") => {
                format!("an {name}")
            }
            name => format!("a {name}"),
        };
        self.fault(
            Code::WrongType,
            key,
            format!("{key} must be {wanted}, not {found}"),
        )
    }

    pub fn string(&self, key: &str) -> Result<Option<&'d str>, FormatError> {
        let Some(item) = self.table.get(key) else {
            return Ok(None);
        };
        match item.as_str() {
            Some(text) => Ok(Some(text)),
            None => Err(self
                .wrong_type(key, item, "a string")
                .hint("write it in quotes")),
        }
    }

    /// The texts of an array.
    pub fn strings(&self, key: &str) -> Result<Vec<String>, FormatError> {
        let Some(item) = self.table.get(key) else {
            return Ok(Vec::new());
        };
        let text = |value: &Value| value.as_str().map(str::to_owned);
        let texts = item.as_array().and_then(|a| a.iter().map(text).collect());
        let texts = texts.ok_or_else(|| {
            self.wrong_type(key, item, "an array of strings")
                .hint(format!("write {key} = [\"...\", \"...\"]"))
        });
        self.source.or_go_on(texts, Vec::new)
    }

    /// The error for the text of a key that is no expression.
    pub fn literal(&self, key: &str, text: &str, error: LiteralError) -> FormatError {
        let value = self.table.get(key).and_then(Item::as_value);
        let range = value.and_then(Value::span);
        let place = format!("{}, {key}", self.place);
        let range = range.unwrap_or(self.start..self.start);
        self.source.literal(range, text, error).place(place)
    }

    /// A string that is a valid name.
    pub fn name(&self, key: &str) -> Result<Option<String>, FormatError> {
        let name = self
            .string(key)
            .and_then(|name| match name.and_then(name_fault) {
                None => Ok(name.map(str::to_owned)),
                Some(what) => Err(self.fault(Code::BadName, key, what)),
            });
        self.source.or_go_on(name, || None)
    }

    pub fn boolean(&self, key: &str) -> Result<Option<bool>, FormatError> {
        let Some(item) = self.table.get(key) else {
            return Ok(None);
        };
        let flag = item.as_bool().map(Some).ok_or_else(|| {
            self.wrong_type(key, item, "true or false")
                .hint("write it without quotes")
        });
        self.source.or_go_on(flag, || None)
    }

    /// A table inside this one.
    pub fn table<'t>(
        &self,
        key: &str,
        place: &'t str,
    ) -> Result<Option<Section<'t, 'd>>, FormatError>
    where
        's: 't,
    {
        let Some((name, item)) = self.table.get_key_value(key) else {
            return Ok(None);
        };
        let Some(table) = item.as_table_like() else {
            return Err(self.wrong_type(key, item, "a table"));
        };
        let span = name.span().or_else(|| item.span());
        let start = span.map_or(self.start, |s| s.start);
        Ok(Some(Section::new(self.source, table, place, start)))
    }

    /// A number, or a string with an expression.
    pub fn quantity(
        &self,
        key: &str,
        read: Read,
        constants: &Constants,
    ) -> Result<Option<Quantity>, FormatError> {
        let number = match self.table.get(key) {
            None => Ok(None),
            Some(Item::Value(value)) => self.number(key, value, read, constants).map(Some),
            Some(item) => Err(self.not_a_number(key, item)),
        };
        self.source.or_go_on(number, || Some(one()))
    }

    /// Three numbers or expressions.
    pub fn vector(
        &self,
        key: &str,
        read: Read,
        constants: &Constants,
    ) -> Result<Option<[Quantity; 3]>, FormatError> {
        let Some(item) = self.table.get(key) else {
            return Ok(None);
        };
        let three = match item.as_array() {
            Some(array) => self.three(key, array, read, constants),
            None => Err(self
                .wrong_type(key, item, "three numbers")
                .hint(format!("write {key} = [0, 0, 1]"))),
        };
        self.source
            .or_go_on(three, || [(); 3].map(|()| one()))
            .map(Some)
    }

    /// The three numbers of an array.
    pub fn three(
        &self,
        key: &str,
        array: &Array,
        read: Read,
        constants: &Constants,
    ) -> Result<[Quantity; 3], FormatError> {
        let values = array
            .iter()
            .map(|value| self.number(key, value, read, constants))
            .collect::<Result<Vec<_>, _>>()?;
        <[Quantity; 3]>::try_from(values).map_err(|v| {
            let what = format!("{key} must have three numbers, not {}", v.len());
            self.fault(Code::WrongType, key, what)
        })
    }

    fn not_a_number(&self, key: &str, item: &Item) -> FormatError {
        self.wrong_type(key, item, "a number or a string with an expression")
    }

    /// A number keeps the text that stands in the file.
    fn number(
        &self,
        key: &str,
        value: &Value,
        read: Read,
        constants: &Constants,
    ) -> Result<Quantity, FormatError> {
        let range = value.span().unwrap_or(self.start..self.start);
        let written = self.source.text.get(range.clone()).unwrap_or("");
        let text = match value {
            Value::String(text) => text.value().trim().to_owned(),
            // TOML groups digits with _; hexadecimal and the like are left to the reader,
            // which refuses them.
            Value::Integer(_) | Value::Float(_) if !written.contains(['x', 'o']) => {
                written.trim().replace('_', "")
            }
            Value::Integer(_) | Value::Float(_) => written.trim().to_owned(),
            other => return Err(self.not_a_number(key, &Item::Value(other.clone()))),
        };
        read(&text, constants).map_err(|error| {
            let place = format!("{}, {key}", self.place);
            self.source.literal(range, &text, error).place(place)
        })
    }
}

/// The number 1, which is allowed wherever a number is.
pub(super) fn one() -> Quantity {
    Quantity::parse_decimal("1").unwrap_or_else(|_| Quantity::zero())
}
