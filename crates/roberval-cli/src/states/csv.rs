//! States from CSV: columns `q_1`, `qd_elbow`, ... in any order.

use std::collections::HashMap;
use std::io::{self, Read};

use csv::{ErrorKind, ReaderBuilder, StringRecord, Trim};
use roberval_base::Model;
use roberval_mechanism::Mechanism;

use super::{ARRAYS, StateTable, needed, some, width};

/// A line with more bytes is no line of numbers: reading stops before memory is full.
const LONGEST_LINE: usize = 16 << 20;

/// The line, where there is one, and what is wrong.
type Fault = (Option<u64>, String);

/// Reads a table with a header line.
pub(super) fn read(
    file: impl Read,
    mechanism: &Mechanism,
    model: Model,
    note: &mut dyn FnMut(String),
) -> Result<StateTable, Fault> {
    let mut reader = ReaderBuilder::new()
        .trim(Trim::All)
        .from_reader(Lines { file, length: 0 });
    let header = reader.headers().map_err(fault)?.clone();
    let columns = columns(&header, mechanism, model, note).map_err(|what| (Some(1), what))?;
    let mut table = StateTable {
        q: Vec::new(),
        qd: Vec::new(),
        qdd: Vec::new(),
        count: 0,
    };
    let mut record = StringRecord::new();
    while reader.read_record(&mut record).map_err(fault)? {
        let line = record.position().map(csv::Position::line);
        let arrays = [&mut table.q, &mut table.qd, &mut table.qdd];
        for (array, columns) in arrays.into_iter().zip(&columns) {
            for column in columns {
                let value = column.map_or(Ok(0.0), |c| number(&record[c], &header[c]));
                array.push(value.map_err(|what| (line, what))?);
            }
        }
        table.count += 1;
    }
    if table.count == 0 {
        return Err((
            None,
            "there is a header line but no state below it".to_owned(),
        ));
    }
    Ok(table)
}

fn number(text: &str, column: &str) -> Result<f64, String> {
    let shown: String = text.chars().take(40).collect();
    match text.parse::<f64>() {
        Ok(x) if x.is_finite() => Ok(x),
        Ok(_) => Err(format!("column {column}: {shown:?} is not a finite number")),
        Err(_) => Err(format!("column {column}: {shown:?} is not a number")),
    }
}

/// For q, qd and qdd, the column of each coordinate; `None` where the model needs none.
fn columns(
    header: &StringRecord,
    mechanism: &Mechanism,
    model: Model,
    note: &mut dyn FnMut(String),
) -> Result<[Vec<Option<usize>>; 3], String> {
    let names = [0, 1, 2].map(|array| names(mechanism, array));
    let widths = [0, 1, 2].map(|array| width(mechanism, array));
    let mut columns = widths.map(|width| vec![None; width]);
    let mut ignored = Vec::new();
    for (at, title) in header.iter().enumerate() {
        let title = title.trim_start_matches('\u{feff}');
        let Some((array, joint)) = meaning(title, &names) else {
            ignored.push(title.to_owned());
            continue;
        };
        if let Some(first) = columns[array][joint].replace(at) {
            return Err(format!(
                "columns {} ({}) and {} ({title}) both give {} of {} {}",
                first + 1,
                &header[first],
                at + 1,
                ARRAYS[array],
                coordinates(mechanism),
                joint + 1
            ));
        }
    }
    let titles = mechanism.state_titles();
    let mut missing = Vec::new();
    for (array, needed) in needed(model).into_iter().enumerate() {
        let absent = (0..widths[array]).filter(|&j| needed && columns[array][j].is_none());
        missing.extend(absent.map(|j| titles[array][j].clone()));
        if !needed {
            columns[array].fill(None);
        }
    }
    if !missing.is_empty() {
        return Err(lacking(header, &missing, mechanism, model));
    }
    if !ignored.is_empty() {
        note(format!("columns that are not used: {}", some(&ignored)));
    }
    Ok(columns)
}

fn lacking(
    header: &StringRecord,
    missing: &[String],
    mechanism: &Mechanism,
    model: Model,
) -> String {
    let hint = if header.iter().all(|title| title.parse::<f64>().is_ok()) {
        "; the first line must name the columns"
    } else if header.iter().any(|title| title.contains([';', '\t'])) {
        "; columns must be separated by commas"
    } else {
        ""
    };
    let [q, qd, qdd] = mechanism.state_titles();
    let range = |titles: &[String]| match titles {
        [first, .., last] => format!("{first} .. {last}"),
        titles => titles.concat(),
    };
    let columns = match mechanism.is_floating() {
        true => format!("{}, {} and {}", range(&q), range(&qd), range(&qdd)),
        false => format!(
            "{} (also qd_, qdd_), with the joint's number, its name or its link's name",
            range(&q)
        ),
    };
    format!(
        "model {} needs a column for every {}, and there is no {}{hint}; columns are {columns}",
        model.name(),
        coordinates(mechanism),
        some(missing),
    )
}

/// What the numbers from 1 count.
fn coordinates(mechanism: &Mechanism) -> &'static str {
    if mechanism.is_floating() {
        "coordinate"
    } else {
        "joint"
    }
}

/// The array and the coordinate that a column's title means.
fn meaning(title: &str, names: &[HashMap<String, usize>; 3]) -> Option<(usize, usize)> {
    let (array, name) = title.split_once('_')?;
    let array = ARRAYS.iter().position(|a| *a == array)?;
    Some((array, *names[array].get(name)?))
}

/// What the coordinates may be called: by joint name (of a floating link, by their own
/// names), by link name, else by number from 1.
fn names(mechanism: &Mechanism, array: usize) -> HashMap<String, usize> {
    let own = match array {
        0 => mechanism.position_names(),
        _ => mechanism.velocity_names(),
    };
    let mut names: HashMap<String, usize> = HashMap::new();
    names.extend((0..own.len()).map(|j| ((j + 1).to_string(), j)));
    let joints = mechanism.independent_joints().into_iter();
    let links: Vec<&str> = joints
        .filter(|l| l.joint.has_axis())
        .map(|l| l.name.as_str())
        .collect();
    let places = own.len() - links.len()..own.len();
    names.extend(links.into_iter().map(str::to_owned).zip(places));
    names.extend(own.into_iter().zip(0..));
    names
}

fn fault(error: csv::Error) -> Fault {
    let line = error.position().map(csv::Position::line);
    let what = match error.kind() {
        ErrorKind::Io(error) => format!("cannot be read: {error}"),
        ErrorKind::Utf8 { .. } => "the text is not UTF-8".to_owned(),
        ErrorKind::UnequalLengths {
            expected_len, len, ..
        } => {
            format!("{len} values under {expected_len} columns (decimals are written with a point)")
        }
        _ => error.to_string(),
    };
    (line, what)
}

/// A reader that refuses endless lines.
struct Lines<R> {
    file: R,
    length: usize,
}

impl<R: Read> Read for Lines<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.file.read(buffer)?;
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
