//! Which column of a table is which coordinate: one rule for every reader of tables.

use std::collections::HashMap;

use roberval_base::Model;
use roberval_mechanism::Mechanism;

use super::{needed, some};

/// What is asked of a table.
#[derive(Debug, Clone)]
pub struct Wanted {
    /// The arrays that columns stand for, and whether they are needed.
    pub arrays: Vec<(&'static str, bool)>,
    /// Who needs them.
    pub asker: String,
}

/// For each array, the column of each coordinate.
#[derive(Debug, Clone)]
pub struct Columns {
    /// Columns from 0; `None` where none is needed.
    pub of: Vec<Vec<Option<usize>>>,
    /// Titles of the columns that are not used.
    pub ignored: Vec<String>,
}

impl Wanted {
    /// The states that a model looks at.
    #[must_use]
    pub fn states(model: Model) -> Self {
        Self {
            arrays: super::ARRAYS.into_iter().zip(needed(model)).collect(),
            asker: format!("model {}", model.name()),
        }
    }

    /// States with torques, and a weight w for each of these where it is asked for.
    #[must_use]
    pub fn samples(weights: bool) -> Self {
        let mut arrays = vec![("q", true), ("qd", true), ("qdd", true), ("tau", true)];
        if weights {
            arrays.push(("w", true));
        }
        Self {
            arrays,
            asker: "the reduction".to_owned(),
        }
    }
}

impl Columns {
    /// What the user should know.
    #[must_use]
    pub fn note(&self) -> Option<String> {
        // A comma at the end of every line makes a column without a title.
        let titles = self.ignored.iter().filter(|title| !title.is_empty());
        let titles: Vec<_> = titles.cloned().collect();
        let unused = || format!("columns that are not used: {}", some(&titles));
        (!titles.is_empty()).then(unused)
    }
}

/// Finds the columns by their titles: an array's name, `_`, and of a coordinate the joint's
/// name, else its link's, else its number.
///
/// # Errors
/// A column that is needed is not there; or two give the same coordinate.
pub fn columns(header: &[&str], mechanism: &Mechanism, wanted: &Wanted) -> Result<Columns, String> {
    let arrays = wanted.arrays.iter().map(|&(array, _)| array);
    let names: Vec<_> = arrays.map(|array| names(mechanism, array)).collect();
    let own = |array| mechanism.column_names(array).len();
    let mut of: Vec<Vec<Option<usize>>> = wanted
        .arrays
        .iter()
        .map(|&(array, _)| vec![None; own(array)])
        .collect();
    let mut ignored = Vec::new();
    for (at, title) in header.iter().enumerate() {
        let title = title.trim().trim_start_matches('\u{feff}');
        let Some((array, joint)) = meaning(title, wanted, &names) else {
            ignored.push(title.to_owned());
            continue;
        };
        if let Some(first) = of[array][joint].replace(at) {
            return Err(format!(
                "columns {} ({}) and {} ({title}) both give {} of {} {}",
                first + 1,
                &header[first],
                at + 1,
                wanted.arrays[array].0,
                coordinates(mechanism),
                joint + 1
            ));
        }
    }
    let mut missing = Vec::new();
    for (columns, &(array, needed)) in of.iter_mut().zip(&wanted.arrays) {
        if needed {
            let titles = mechanism.column_titles(array).into_iter().zip(&*columns);
            let absent = titles.filter(|(_, column)| column.is_none());
            missing.extend(absent.map(|(title, _)| title));
        } else {
            columns.fill(None);
        }
    }
    if missing.is_empty() {
        Ok(Columns { of, ignored })
    } else {
        Err(lacking(header, &missing, mechanism, wanted))
    }
}

fn lacking(header: &[&str], missing: &[String], mechanism: &Mechanism, wanted: &Wanted) -> String {
    let hint = if header.iter().all(|title| title.parse::<f64>().is_ok()) {
        "; the first line must name the columns"
    } else if header.iter().any(|title| title.contains([';', '\t'])) {
        "; columns must be separated by commas"
    } else {
        ""
    };
    let range = |array: &str| match &mechanism.column_titles(array)[..] {
        [first, .., last] => format!("{first} .. {last}"),
        titles => titles.concat(),
    };
    let arrays: Vec<&str> = wanted.arrays.iter().map(|&(array, _)| array).collect();
    let columns = if mechanism.is_floating() {
        let ranges: Vec<String> = arrays.iter().map(|array| range(array)).collect();
        let (last, others) = ranges.split_last().map_or(("", &[][..]), |(l, o)| (l, o));
        format!("{} and {last}", others.join(", "))
    } else {
        let others: Vec<String> = arrays[1..]
            .iter()
            .map(|array| format!("{array}_"))
            .collect();
        format!(
            "{} (also {}), with the joint's number, its name or its link's name",
            range(arrays[0]),
            others.join(", ")
        )
    };
    format!(
        "{} needs a column for every {}, and there is no {}{hint}; columns are {columns}",
        wanted.asker,
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
fn meaning(
    title: &str,
    wanted: &Wanted,
    names: &[HashMap<String, usize>],
) -> Option<(usize, usize)> {
    let (array, name) = title.split_once('_')?;
    let array = wanted.arrays.iter().position(|(a, _)| *a == array)?;
    Some((array, *names[array].get(name)?))
}

/// What the coordinates of an array may be called: by joint name (of a floating link, by their
/// own names), by link name, else by number from 1.
fn names(mechanism: &Mechanism, array: &str) -> HashMap<String, usize> {
    let own = mechanism.column_names(array);
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
