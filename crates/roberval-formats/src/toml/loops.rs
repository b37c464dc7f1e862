//! Loops: `[[loop]]` tables.

use std::ops::Range;

use roberval_mechanism::{
    Cut, Field, LoopClosure, LoopError, Origin, ResolvedLoop, RobotDescription,
};
use roberval_scalar::{Constants, Quantity};
use toml_edit::{Array, Value};

use super::section::{Read, Section};
use super::{BASE, tables};
use crate::error::{Code, FormatError};
use crate::words::{nearest, quoted};

const LOOP_KEYS: &[&str] = &["between", "at", "frames", "cut", "near"];
const FRAME_KEYS: &[&str] = &["xyz", "rpy"];

/// The loops of a robot whose links have been read.
pub(super) fn read(
    robot: &Section,
    description: &RobotDescription,
) -> Result<Vec<LoopClosure>, FormatError> {
    let tables = tables(robot, "loop")?;
    let mut loops = Vec::with_capacity(tables.len());
    for (number, (table, offset)) in (1..).zip(&tables) {
        let place = format!("loop {number}");
        let section = Section::new(robot.source, *table, &place, *offset);
        loops.push(closure(&section, number, description)?);
    }
    if loops.is_empty() {
        return Ok(loops);
    }
    let with_loops = RobotDescription {
        loops,
        ..description.clone()
    };
    let antecedents = with_loops.antecedents().unwrap_or_default();
    match ResolvedLoop::all(&with_loops, &antecedents) {
        Ok(_) => Ok(with_loops.loops),
        Err(error) => {
            let (table, offset) = tables[error.number()];
            let place = format!("loop {}", error.number() + 1);
            let section = Section::new(robot.source, table, &place, offset);
            Err(unresolved(&section, &error, description))
        }
    }
}

/// Where a number of a loop's frame stands in the text.
pub(super) fn span(
    robot: &Section,
    (number, side): (usize, usize),
    field: Field,
) -> Option<Range<usize>> {
    let tables = tables(robot, "loop").ok()?;
    let (table, _) = tables.get(number)?;
    let (key, k) = match field {
        Field::Xyz(k) => ("xyz", k),
        Field::Rpy(k) => ("rpy", k),
        _ => return None,
    };
    let vector = match table.get("at") {
        Some(at) => at.as_array()?.get(side)?,
        None => {
            let frames = table.get("frames")?.as_array()?;
            frames.get(side)?.as_inline_table()?.get(key)?
        }
    };
    vector.as_array()?.get(k)?.span()
}

fn unresolved(section: &Section, error: &LoopError, robot: &RobotDescription) -> FormatError {
    let (code, name) = match error {
        LoopError::UnknownLink { name, .. } | LoopError::UnknownJoint { name, .. } => {
            (Code::UnknownLink, Some(name))
        }
        LoopError::SameLink { .. } | LoopError::NoJoint { .. } => (Code::Contradiction, None),
        LoopError::FixedJoint { .. } | LoopError::TwoValues { .. } => (Code::Contradiction, None),
    };
    let fault = section.fault(code, error.key(), error.to_string());
    let names = robot.links.iter().map(|l| l.name.as_str());
    match name.map(|name| nearest(name, names.chain([BASE]))) {
        None => fault,
        Some(Some(near)) => fault.hint(format!("did you mean {}?", quoted(near))),
        Some(None) => fault.hint("write the name of a link"),
    }
}

fn closure(
    section: &Section,
    number: usize,
    robot: &RobotDescription,
) -> Result<LoopClosure, FormatError> {
    section.only(LOOP_KEYS)?;
    let name = |value: &Value| match value.as_str() {
        Some(BASE) => Some(None),
        name => name.map(|name| Some(name.to_owned())),
    };
    let array = pair(section, "between")?;
    let names: Option<Vec<_>> = array.and_then(|a| a.iter().map(name).collect());
    let between = match names.as_deref() {
        Some([a, b]) => [a.clone(), b.clone()],
        _ => {
            let what = "between must be the names of two links";
            return Err(fault_or_missing(section, "between", what)
                .hint("write between = [\"link2\", \"link3\"]; \"base\" is the base"));
        }
    };
    Ok(LoopClosure {
        between,
        frames: frames(section, number, &robot.constants)?,
        cut: cut(section)?,
        near: near(section, &robot.constants)?,
    })
}

/// An array of two values; `None` if the key is missing or holds something else.
fn pair<'d>(section: &Section<'_, 'd>, key: &str) -> Result<Option<&'d Array>, FormatError> {
    let Some(item) = section.table.get(key) else {
        return Ok(None);
    };
    match item.as_array() {
        None => Err(section.wrong_type(key, item, "an array of two")),
        Some(array) if array.len() == 2 => Ok(Some(array)),
        Some(array) => {
            let what = format!("{key} must have two elements, not {}", array.len());
            Err(section.fault(Code::WrongType, key, what))
        }
    }
}

fn fault_or_missing(section: &Section, key: &str, what: &str) -> FormatError {
    if section.table.contains_key(key) {
        section.fault(Code::WrongType, key, what)
    } else {
        section.here(Code::Missing, format!("{key} is missing"))
    }
}

fn cut(section: &Section) -> Result<Cut, FormatError> {
    let known: Vec<String> = Cut::ALL.iter().map(|c| format!("\"{c}\"")).collect();
    let hint = format!("the joint that was cut is one of {}", known.join(", "));
    let Some(kind) = section.string("cut")? else {
        return Err(section.here(Code::Missing, "cut is missing").hint(hint));
    };
    let cut = Cut::ALL.into_iter().find(|c| c.name() == kind);
    cut.ok_or_else(|| {
        let what = format!("unknown kind of cut joint {}", quoted(kind));
        section.fault(Code::JointType, "cut", what).hint(hint)
    })
}

/// `at` gives points of frames with their links' axes; `frames` gives orientations too.
fn frames(
    section: &Section,
    number: usize,
    constants: &Constants,
) -> Result<[Origin; 2], FormatError> {
    let origin = |side: usize, xyz, rpy| Origin {
        joint: format!("loop {number}, frame {}", side + 1),
        xyz,
        rpy,
    };
    let frame = |side, value: &Value| {
        let Some(table) = value.as_inline_table() else {
            let what = "frames must be two tables";
            return Err(section
                .fault(Code::WrongType, "frames", what)
                .hint("write frames = [{ xyz = [0, 0, 0], rpy = [0, 0, 0] }, { ... }]"));
        };
        let start = value.span().map_or(0, |s| s.start);
        let frame = Section::new(section.source, table, section.place, start);
        frame.only(FRAME_KEYS)?;
        let part = |key: &str, read: Read| match table.get(key) {
            None => Ok(zeros()),
            Some(value) => numbers(&frame, key, value, read, constants),
        };
        let xyz = part("xyz", Quantity::parse_length)?;
        Ok(origin(side, xyz, part("rpy", Quantity::parse_angle)?))
    };
    let point = |side, value: &Value| {
        let xyz = numbers(section, "at", value, Quantity::parse_length, constants)?;
        Ok(origin(side, xyz, zeros()))
    };
    match (pair(section, "at")?, pair(section, "frames")?) {
        (Some(at), None) => both(at, point),
        (None, Some(frames)) => both(frames, frame),
        (Some(_), Some(_)) => {
            let what = "at and frames both say where the cut joint is";
            Err(section
                .fault(Code::Contradiction, "frames", what)
                .hint("leave one of them out"))
        }
        (None, None) => Err(section.here(Code::Missing, "at is missing").hint(
            "write at = [[x, y, z], [x, y, z]], the cut joint in the frames of the two links",
        )),
    }
}

fn both<T>(
    array: &Array,
    read: impl Fn(usize, &Value) -> Result<T, FormatError>,
) -> Result<[T; 2], FormatError> {
    let mut values = array
        .iter()
        .enumerate()
        .map(|(side, value)| read(side, value));
    let mut next = || values.next().expect("an array of two");
    Ok([next()?, next()?])
}

fn numbers(
    section: &Section,
    key: &str,
    value: &Value,
    read: Read,
    constants: &Constants,
) -> Result<[Quantity; 3], FormatError> {
    match value.as_array() {
        Some(array) => section.three(key, array, read, constants),
        None => Err(section.fault(
            Code::WrongType,
            key,
            format!("{key} must have three numbers"),
        )),
    }
}

fn zeros() -> [Quantity; 3] {
    std::array::from_fn(|_| Quantity::zero())
}

fn near(section: &Section, constants: &Constants) -> Result<Vec<(String, Quantity)>, FormatError> {
    let place = format!("{}, near", section.place);
    let Some(near) = section.table("near", &place)? else {
        return Ok(Vec::new());
    };
    let names = near.table.iter().map(|(name, _)| name.to_owned());
    let value = |name: String| {
        let value = near.quantity(&name, Quantity::parse_angle, constants)?;
        Ok((name, value.unwrap_or_else(Quantity::zero)))
    };
    names.map(value).collect()
}
