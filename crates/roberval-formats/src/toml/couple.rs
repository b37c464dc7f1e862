//! `[[couple]]`: joints that follow from others.

use roberval_mechanism::{
    Closure, Couple, CoupleError, Expression, JointKind, RobotDescription, Term,
};
use roberval_scalar::{Constants, Formula, Quantity};

use super::section::Section;
use super::{Tables, tables};
use crate::error::{Code, FormatError};
use crate::source::Source;
use crate::words::{nearest, quoted};

const COUPLE_KEYS: &[&str] = &["joint", "equals", "offset", "expression"];

/// The joints that follow from others, as far as names tell: they have no motor unless the
/// file says so.
pub(super) fn dependent_joints(robot: &Section) -> Result<Vec<String>, FormatError> {
    let tables = tables(robot, "couple")?;
    let joints = tables.iter().filter_map(|(table, _)| table.get("joint"));
    Ok(joints
        .filter_map(|j| j.as_str().map(str::to_owned))
        .collect())
}

/// The couples, once it is sure that they determine their joints.
pub(super) fn couples(
    robot: &Section,
    description: &mut RobotDescription,
) -> Result<(), FormatError> {
    let tables = tables(robot, "couple")?;
    for (number, (table, offset)) in (1..).zip(&tables) {
        let place = format!("couple {number}");
        let section = Section::new(robot.source, *table, &place, *offset);
        let couple = couple(&section, description)?;
        description.couples.push(couple);
    }
    let order: Vec<usize> = (0..description.links.len()).collect();
    match Closure::of(description, &order) {
        Ok(_) => Ok(()),
        Err(error) => Err(refused(robot.source, description, &tables, &error)),
    }
}

fn couple(section: &Section, robot: &RobotDescription) -> Result<Couple, FormatError> {
    section.only(COUPLE_KEYS)?;
    let missing = |section: &Section, key: &str, example: &str| {
        let what = format!("{key} is missing");
        section
            .here(Code::Missing, what)
            .hint(format!("write {key} = {example}"))
    };
    let joint = section
        .name("joint")?
        .ok_or_else(|| missing(section, "joint", "\"2\""))?;
    let place = format!("couple of joint {}", quoted(&joint));
    let section = section.renamed(&place);
    if let Some(expression) = expression(&section, &robot.constants)? {
        return Ok(Couple {
            joint,
            terms: Vec::new(),
            offset: Quantity::zero(),
            expression: Some(expression),
        });
    }
    let inside = format!("{place}, equals");
    let equals = section
        .table("equals", &inside)?
        .ok_or_else(|| missing(&section, "equals", "{ \"1\" = -1 }"))?;
    let mut terms = Vec::new();
    for (name, _) in equals.table.iter() {
        let multiplier = equals.quantity(name, Quantity::parse_number, &robot.constants)?;
        terms.extend(multiplier.map(|multiplier| Term {
            joint: name.to_owned(),
            multiplier,
        }));
    }
    let prismatic = |l: &roberval_mechanism::LinkDescription| {
        l.name == joint && l.joint == JointKind::Prismatic
    };
    let read: fn(&str, &Constants) -> _ = if robot.links.iter().any(prismatic) {
        Quantity::parse_length
    } else {
        Quantity::parse_angle
    };
    let offset = section.quantity("offset", read, &robot.constants)?;
    Ok(Couple {
        joint,
        terms,
        offset: offset.unwrap_or_else(Quantity::zero),
        expression: None,
    })
}

/// `expression = "atan2(sin(q.1), 2)"`, in place of equals and offset.
fn expression(section: &Section, constants: &Constants) -> Result<Option<Expression>, FormatError> {
    let Some(text) = section.string("expression")? else {
        return Ok(None);
    };
    for key in ["equals", "offset"] {
        if section.table.contains_key(key) {
            let what = format!("a couple has expression or {key}, not both");
            let hint = "write the offset into the expression, joints as q.NAME";
            return Err(section.fault(Code::Contradiction, key, what).hint(hint));
        }
    }
    let formula = Formula::parse(text, constants)
        .map_err(|error| section.literal("expression", text, error))?;
    let text = text.trim().to_owned();
    Ok(Some(Expression { text, formula }))
}

fn refused(
    source: &Source,
    robot: &RobotDescription,
    tables: &Tables,
    error: &CoupleError,
) -> FormatError {
    let (table, offset) = tables[error.couple()];
    let couple = &robot.couples[error.couple()];
    let by = match couple.expression {
        Some(_) => "expression",
        None => "equals",
    };
    let place = format!("couple of joint {}", quoted(&couple.joint));
    let section = Section::new(source, table, &place, offset);
    let joint = |name: &str| if couple.joint == name { "joint" } else { by };
    let at = |code, key: &str| section.fault(code, key, error.to_string());
    match error {
        CoupleError::Unknown { name, .. } => {
            let names = robot.links.iter().map(|l| l.name.as_str());
            let error = at(Code::CoupleUnknown, joint(name));
            match nearest(name, names) {
                Some(near) => error.hint(format!("did you mean {}?", quoted(near))),
                None => error.hint("write the name of the link that the joint moves"),
            }
        }
        CoupleError::NoAxis { name, .. } => at(Code::Contradiction, joint(name)),
        CoupleError::Twice { first, .. } => {
            let line = source.position(tables[*first].1).line;
            at(Code::Contradiction, "joint").hint(format!("the other one begins in line {line}"))
        }
        CoupleError::Still { .. } => at(Code::Contradiction, by),
        CoupleError::Cycle { .. } => {
            at(Code::CoupleCycle, by).hint("one of them must move by itself")
        }
        CoupleError::Loops { .. } => at(Code::Contradiction, by),
        CoupleError::TooLong { .. } => at(Code::LiteralTooLarge, by),
    }
}
