//! Joint states from files: CSV or NPZ. The rules for columns and the reader of CSV files are
//! Python's too, where logs have torques beside the states.

mod columns;
mod csv;
mod npy;
mod npz;

pub use columns::{Columns, Wanted, columns};
pub use csv::{Fault, Table};

use std::fs::File;
use std::io::{self, Read, Seek};
use std::path::{Path, PathBuf};

use roberval_base::Model;
use roberval_mechanism::Mechanism;
use roberval_regressor::States;

/// N states, row-major; what the model does not look at is zero.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct StateTable {
    pub q: Vec<f64>,
    pub qd: Vec<f64>,
    pub qdd: Vec<f64>,
    /// The number of states N.
    pub count: usize,
}

/// Why a file gives no states.
#[derive(Debug, thiserror::Error)]
#[error("{}{}: {what}", path.display(), line.map(|l| format!(":{l}")).unwrap_or_default())]
pub(crate) struct StatesError {
    pub path: PathBuf,
    pub line: Option<u64>,
    pub what: String,
}

/// q, qd and qdd.
pub(crate) const ARRAYS: [&str; 3] = ["q", "qd", "qdd"];

/// The independent coordinates of each of them.
pub(crate) fn width(mechanism: &Mechanism, array: usize) -> usize {
    if array == 0 {
        mechanism.positions()
    } else {
        mechanism.independent()
    }
}

/// Which of q, qd and qdd a model looks at.
pub(crate) fn needed(model: Model) -> [bool; 3] {
    match model {
        Model::D => [true, true, true],
        Model::D0 => [true, false, true],
        Model::H => [true, true, false],
    }
}

/// Reads states for a robot; `note` is called with what the user should know.
///
/// # Errors
/// What is wrong, with line and column or array and entry.
pub(crate) fn read(
    path: &Path,
    mechanism: &Mechanism,
    model: Model,
    note: &mut dyn FnMut(String),
) -> Result<StateTable, StatesError> {
    let refuse = |what: String| StatesError {
        path: path.to_owned(),
        line: None,
        what,
    };
    if path.is_dir() {
        return Err(refuse(
            "this is a folder; states are a CSV or NPZ file".to_owned(),
        ));
    }
    let unreadable = |e: io::Error| refuse(format!("cannot be read: {e}"));
    let mut file = File::open(path).map_err(unreadable)?;
    let mut magic = Vec::new();
    file.by_ref()
        .take(6)
        .read_to_end(&mut magic)
        .map_err(unreadable)?;
    if magic.starts_with(b"\x93NUMPY") {
        return Err(refuse(
            "this is one NumPy array; save three with np.savez(file, q=q, qd=qd, qdd=qdd)"
                .to_owned(),
        ));
    }
    file.rewind().map_err(unreadable)?;
    if magic.starts_with(b"PK") {
        npz::read(file, mechanism, model, note).map_err(refuse)
    } else {
        whole(file, mechanism, model, note).map_err(|fault| StatesError {
            line: fault.line,
            ..refuse(fault.what)
        })
    }
}

/// Reads a whole CSV file.
fn whole(
    file: File,
    mechanism: &Mechanism,
    model: Model,
    note: &mut dyn FnMut(String),
) -> Result<StateTable, Fault> {
    let mut table = Table::open(file, mechanism, &Wanted::states(model))?;
    if let Some(ignored) = table.columns().note() {
        note(ignored);
    }
    let mut arrays: [Vec<f64>; 3] = Default::default();
    let count = table.read(usize::MAX, &mut arrays)?;
    let [q, qd, qdd] = arrays;
    Ok(StateTable { q, qd, qdd, count })
}

impl StateTable {
    /// The states `from..to` as the regressor takes them.
    pub fn slice(&self, from: usize, to: usize, mechanism: &Mechanism) -> States<'_> {
        let part = |array| {
            let width = width(mechanism, array);
            &self.array(array)[from * width..to * width]
        };
        States {
            q: part(0),
            qd: part(1),
            qdd: part(2),
        }
    }

    fn array(&self, array: usize) -> &[f64] {
        [&self.q, &self.qd, &self.qdd][array]
    }
}

/// At most eight texts with commas between them.
fn some(texts: &[String]) -> String {
    const MOST: usize = 8;
    let shown = texts[..texts.len().min(MOST)].join(", ");
    match texts.len().checked_sub(MOST) {
        Some(more @ 1..) => format!("{shown} and {more} more"),
        _ => shown,
    }
}
