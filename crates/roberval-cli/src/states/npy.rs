//! The NPY format: one array, a text header and the numbers.

use std::io::Read;

/// What an array's header says.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Header {
    pub number: Number,
    pub big_endian: bool,
    pub fortran_order: bool,
    pub shape: Vec<usize>,
}

/// The types of numbers that are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Number {
    Float(usize),
    Signed(usize),
    Unsigned(usize),
}

/// Longer headers have no array of numbers below them.
const LONGEST_HEADER: usize = 1 << 16;

impl Header {
    /// Reads magic, version and header; `source` then stands at the numbers.
    pub fn read(source: &mut impl Read) -> Result<Self, String> {
        let short = |_| "the array ends within its header".to_owned();
        let mut start = [0; 8];
        source.read_exact(&mut start).map_err(short)?;
        if start[..6] != *b"\x93NUMPY" {
            return Err("not a NumPy array".to_owned());
        }
        let mut size = [0; 4];
        let bytes = match start[6] {
            1 => 2,
            2 | 3 => 4,
            version => return Err(format!("NPY version {version} is not known")),
        };
        source.read_exact(&mut size[..bytes]).map_err(short)?;
        let size = u32::from_le_bytes(size) as usize;
        if size > LONGEST_HEADER {
            return Err(format!("a header of {size} bytes is too long"));
        }
        let mut text = vec![0; size];
        source.read_exact(&mut text).map_err(short)?;
        let text = String::from_utf8(text).map_err(|_| "the header is not UTF-8".to_owned())?;
        Self::parse(&text)
    }

    /// Reads `{'descr': '<f8', 'fortran_order': False, 'shape': (3, 6), }`.
    fn parse(text: &str) -> Result<Self, String> {
        let bad = || format!("the header {:?} is not of an array", text.trim());
        let descr = value_of(text, "descr").ok_or_else(bad)?;
        if descr.starts_with('[') {
            return Err("an array of records; it must be an array of numbers".to_owned());
        }
        let descr = descr.strip_prefix('\'').ok_or_else(bad)?;
        let descr = &descr[..descr.find('\'').ok_or_else(bad)?];
        let order = value_of(text, "fortran_order").ok_or_else(bad)?;
        let shape = value_of(text, "shape").ok_or_else(bad)?;
        let shape = shape.strip_prefix('(').ok_or_else(bad)?;
        let shape = &shape[..shape.find(')').ok_or_else(bad)?];
        let lengths = shape.split(',').map(str::trim).filter(|s| !s.is_empty());
        Ok(Self {
            number: Number::parse(descr)?,
            big_endian: descr.starts_with('>'),
            fortran_order: order.starts_with("True"),
            shape: lengths
                .map(str::parse)
                .collect::<Result<_, _>>()
                .map_err(|_| bad())?,
        })
    }

    /// The bytes that the numbers take; `None` if no file can have so many.
    pub fn bytes(&self) -> Option<u64> {
        let size = self.number.size() as u64;
        let mut lengths = self.shape.iter().map(|&n| n as u64);
        lengths.try_fold(size, u64::checked_mul)
    }

    /// The numbers, of `bytes()` bytes, as doubles in C order; two dimensions at most.
    pub fn numbers(&self, bytes: &[u8]) -> Vec<f64> {
        let one = |b: &[u8]| self.number.decode(b, self.big_endian);
        let stored: Vec<f64> = bytes.chunks_exact(self.number.size()).map(one).collect();
        match self.shape[..] {
            [rows, columns] if self.fortran_order => (0..stored.len())
                .map(|at| stored[at % columns * rows + at / columns])
                .collect(),
            _ => stored,
        }
    }
}

/// What follows `'key':` in the header.
fn value_of<'a>(text: &'a str, key: &str) -> Option<&'a str> {
    let (_, rest) = text.split_once(&format!("'{key}'"))?;
    Some(rest.trim_start().strip_prefix(':')?.trim_start())
}

impl Number {
    fn parse(descr: &str) -> Result<Self, String> {
        let kind = descr.trim_start_matches(['<', '>', '|', '=']);
        let refuse = |what: &str| {
            Err(format!(
                "{what} (type {descr:?}); it must be an array of real numbers such as float64"
            ))
        };
        match kind {
            "f8" => Ok(Self::Float(8)),
            "f4" => Ok(Self::Float(4)),
            "i1" | "i2" | "i4" | "i8" => Ok(Self::Signed(size(kind))),
            "u1" | "u2" | "u4" | "u8" => Ok(Self::Unsigned(size(kind))),
            _ if kind.starts_with('O') => refuse("an array of Python objects (pickled)"),
            _ if kind.starts_with('c') => refuse("an array of complex numbers"),
            _ if kind.starts_with(['U', 'S']) => refuse("an array of texts"),
            _ => refuse("an array of another type"),
        }
    }

    fn size(self) -> usize {
        match self {
            Self::Float(size) | Self::Signed(size) | Self::Unsigned(size) => size,
        }
    }

    /// One number from its bytes.
    fn decode(self, bytes: &[u8], big_endian: bool) -> f64 {
        let mut word = [0_u8; 8];
        for (i, byte) in bytes.iter().enumerate() {
            word[if big_endian { bytes.len() - 1 - i } else { i }] = *byte;
        }
        let bits = u64::from_le_bytes(word);
        let unused = 64 - 8 * bytes.len() as u32;
        match self {
            Self::Float(4) => f64::from(f32::from_bits(bits as u32)),
            Self::Float(_) => f64::from_bits(bits),
            // Shifting up and down again spreads the sign.
            Self::Signed(_) => ((bits << unused) as i64 >> unused) as f64,
            Self::Unsigned(_) => bits as f64,
        }
    }
}

fn size(kind: &str) -> usize {
    kind[1..].parse().unwrap_or(8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_of_numpy_are_read() {
        let text = "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 6), }   \n";
        let header = Header::parse(text).expect("valid");
        assert_eq!(header.number, Number::Float(8));
        assert_eq!(header.shape, [3, 6]);
        assert_eq!(header.bytes(), Some(144));
        let scalar = "{'shape': (), 'fortran_order': True, 'descr': '>i2'}";
        let header = Header::parse(scalar).expect("valid");
        assert!(header.big_endian && header.fortran_order && header.shape.is_empty());
    }

    #[test]
    fn sizes_beyond_every_file_are_no_number_of_bytes() {
        let text = "{'descr': '<f8', 'fortran_order': False, 'shape': (4294967296, 4294967296), }";
        assert_eq!(Header::parse(text).expect("valid").bytes(), None);
    }

    #[test]
    fn numbers_of_every_type_and_order_are_decoded() {
        assert_eq!(Number::Signed(2).decode(&[0xff, 0xfe], true), -2.0);
        assert_eq!(Number::Signed(1).decode(&[0x80], false), -128.0);
        assert_eq!(Number::Unsigned(1).decode(&[0x80], false), 128.0);
        assert_eq!(
            Number::Signed(8).decode(&(-3_i64).to_le_bytes(), false),
            -3.0
        );
        assert_eq!(Number::Float(4).decode(&1.5_f32.to_be_bytes(), true), 1.5);
        assert_eq!(Number::Float(8).decode(&0.1_f64.to_le_bytes(), false), 0.1);
    }

    #[test]
    fn fortran_order_is_turned_into_c_order() {
        let text = "{'descr': '|u1', 'fortran_order': True, 'shape': (2, 3), }";
        let header = Header::parse(text).expect("valid");
        let numbers = header.numbers(&[1, 4, 2, 5, 3, 6]);
        assert_eq!(numbers, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    }
}
