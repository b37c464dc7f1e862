//! Tables from CSV, some rows at a time: columns `q_1`, `qd_elbow`, ... in any order.

use std::io::{self, Read};

use csv::{ErrorKind, Reader, ReaderBuilder, StringRecord, Trim};
use roberval_mechanism::Mechanism;

use super::columns::{Columns, Wanted, columns};

/// A line with more bytes is no line of numbers: reading stops before memory is full.
const LONGEST_LINE: usize = 16 << 20;

/// Bytes read at a time.
const BUFFER: usize = 1 << 17;

/// What is wrong, and in which line, where there is one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault {
    /// The line, from 1.
    pub line: Option<u64>,
    /// What is wrong.
    pub what: String,
}

/// A CSV file with a header line, and what its columns are.
pub struct Table<R> {
    reader: Reader<Lines<R>>,
    header: StringRecord,
    columns: Columns,
    record: StringRecord,
    rows: u64,
}

impl<R: Read> Table<R> {
    /// Reads the header line.
    ///
    /// # Errors
    /// A column that is wanted is not there, or there twice; the text is not UTF-8, or cannot
    /// be read.
    pub fn open(file: R, mechanism: &Mechanism, wanted: &Wanted) -> Result<Self, Fault> {
        let mut reader = ReaderBuilder::new()
            .trim(Trim::Headers)
            .buffer_capacity(BUFFER)
            .from_reader(Lines::of(file));
        let header = match reader.headers() {
            Ok(header) => header.clone(),
            Err(error) => return Err(fault(&reader, &error)),
        };
        let titles: Vec<&str> = header.iter().collect();
        let columns = columns(&titles, mechanism, wanted).map_err(|what| Fault {
            line: Some(line(&reader)),
            what,
        })?;
        Ok(Self {
            reader,
            header,
            columns,
            record: StringRecord::new(),
            rows: 0,
        })
    }

    /// Which column is which coordinate.
    pub fn columns(&self) -> &Columns {
        &self.columns
    }

    /// Reads at most so many rows to the ends of the arrays, in the order of those wanted; zero
    /// in columns that are not needed. Gives their number: 0 after the last.
    ///
    /// # Errors
    /// A line has more or fewer values than the header, or no finite number where one is
    /// needed; there is no row at all; the text is not UTF-8, or cannot be read.
    pub fn read(&mut self, most: usize, arrays: &mut [Vec<f64>]) -> Result<usize, Fault> {
        let mut count = 0;
        while count < most {
            match self.reader.read_record(&mut self.record) {
                Ok(true) => {}
                Ok(false) => break,
                Err(error) => return Err(fault(&self.reader, &error)),
            }
            self.take(arrays).map_err(|what| Fault {
                line: Some(line(&self.reader)),
                what,
            })?;
            count += 1;
        }
        self.rows += count as u64;
        if self.rows == 0 && most > 0 {
            let what = "there is a header line but no state below it".to_owned();
            return Err(Fault { line: None, what });
        }
        Ok(count)
    }

    /// Puts the record's numbers to the ends of the arrays.
    fn take(&self, arrays: &mut [Vec<f64>]) -> Result<(), String> {
        for (array, columns) in arrays.iter_mut().zip(&self.columns.of) {
            for column in columns {
                array.push(match *column {
                    Some(c) => number(self.record[c].trim(), &self.header[c])?,
                    None => 0.0,
                });
            }
        }
        Ok(())
    }
}

/// The line that the last record ended with. (A record's own position is before the empty
/// lines above it.)
fn line<R: Read>(reader: &Reader<Lines<R>>) -> u64 {
    reader.position().line().saturating_sub(1).max(1)
}

fn fault<R: Read>(reader: &Reader<Lines<R>>, error: &csv::Error) -> Fault {
    let what = match error.kind() {
        ErrorKind::Io(error) => {
            return Fault {
                line: None,
                what: format!("cannot be read: {error}"),
            };
        }
        ErrorKind::Utf8 { .. } => "the text is not UTF-8".to_owned(),
        ErrorKind::UnequalLengths {
            expected_len,
            len: 1,
            ..
        } => {
            format!("1 value, or spaces alone, under {expected_len} columns (separate by commas)")
        }
        ErrorKind::UnequalLengths {
            expected_len, len, ..
        } => {
            format!("{len} values under {expected_len} columns (decimals are written with a point)")
        }
        _ => error.to_string(),
    };
    Fault {
        line: Some(line(reader)),
        what,
    }
}

fn number(text: &str, column: &str) -> Result<f64, String> {
    let shown = || text.chars().take(40).collect::<String>();
    match text.parse::<f64>() {
        Ok(x) if x.is_finite() => Ok(x),
        Ok(_) => Err(format!(
            "column {column}: {:?} is not a finite number",
            shown()
        )),
        Err(_) => Err(format!("column {column}: {:?} is not a number", shown())),
    }
}

/// A reader whose lines end with a line feed each, so that they can be counted, and that
/// refuses endless ones.
struct Lines<R> {
    file: R,
    /// Bytes of the line so far.
    length: usize,
    /// The last byte that was read.
    last: u8,
}

impl<R> Lines<R> {
    fn of(file: R) -> Self {
        Self {
            file,
            length: 0,
            last: b'\n',
        }
    }

    /// Makes each of CR LF, CR and LF a line feed; gives the number of bytes.
    fn unify(&mut self, bytes: &mut [u8]) -> usize {
        let mut kept = 0;
        for at in 0..bytes.len() {
            let byte = bytes[at];
            if byte != b'\n' || self.last != b'\r' {
                bytes[kept] = if byte == b'\r' { b'\n' } else { byte };
                kept += 1;
            }
            self.last = byte;
        }
        kept
    }
}

impl<R: Read> Read for Lines<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let mut count = 0;
        while count == 0 && !buffer.is_empty() {
            let read = self.file.read(buffer)?;
            if read == 0 {
                if !matches!(self.last, b'\n' | b'\r') {
                    buffer[0] = b'\n';
                    self.last = b'\n';
                    count = 1;
                }
                break;
            }
            let bytes = &mut buffer[..read];
            count = if self.last == b'\r' || bytes.contains(&b'\r') {
                self.unify(bytes)
            } else {
                self.last = bytes[read - 1];
                read
            };
        }
        match buffer[..count].iter().rposition(|b| *b == b'\n') {
            Some(end) => self.length = count - end - 1,
            None => self.length += count,
        }
        if self.length > LONGEST_LINE {
            let what = format!("a line is longer than {} MiB", LONGEST_LINE >> 20);
            return Err(io::Error::new(io::ErrorKind::InvalidData, what));
        }
        Ok(count)
    }
}
