//! Cleaned geometry: roundings of right angles and dust set right, every change listed.
//!
//! A file that says 1.5708 where it means pi/2 describes another robot, with more base
//! parameters. Which of the two is meant is a modelling decision: [`clean`] takes it by a
//! plain rule, lists what it changed and by how much, and every change can be taken back.
//!
//! * Angles within 1e-4 rad of k pi/12 become exactly that, unless they are written as a
//!   fraction of a turn (`pi/7`, `89.999 deg`): that is no rounding.
//! * Lengths of at most 1e-6 m become 0.
//! * Components of an axis, and of gravity, of at most 1e-6 of its length become 0. The
//!   others stay as written: the length of an axis is no direction, and [`crate::Mechanism`]
//!   takes it off.
//! * Angles up to 5.5e-3 rad away are shown and left alone.
//!
//! Inertial parameters, limits and mimic joints are never touched. Cleaning a cleaned
//! description changes nothing.

mod angle;
mod place;
mod policy;

use std::collections::HashMap;
use std::fmt;

use roberval_scalar::{Constants, Quantity};

use crate::RobotDescription;
use angle::Exact;
pub use place::{Field, Unit};
use place::{Literal, Place};
use policy::LAST_DIGIT;
pub use policy::{CleanMode, CleanPolicy};

/// A description with its roundings set right, and what that took.
#[derive(Debug, Clone, PartialEq)]
pub struct Cleaned {
    /// The cleaned description.
    pub description: RobotDescription,
    /// What was changed, in the order of the links.
    pub changes: Vec<Change>,
    /// What looks like a rounding and was left alone.
    pub near_misses: Vec<NearMiss>,
}

/// A number that was replaced (or, in a [`NearMiss`], that could be).
///
/// `Display`: `joint3 rpy[0] = 1.5708 is 3.7e-6 rad from pi/2`.
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    /// The link that the number places; `None` for gravity and for frames of loops. A fixed joint that was lumped
    /// may place several links: this is the first.
    pub link: Option<String>,
    /// The joint whose origin or axis it is, where the format has joint names.
    pub joint: Option<String>,
    /// Which number it is.
    pub field: Field,
    /// The number as written.
    pub written: Quantity,
    /// What it became.
    pub became: Quantity,
    /// How far the two are apart, in the unit of the field: rad, m, or relative to the
    /// length of the direction.
    pub size: f64,
    /// Where the number stands: more than one place for a joint that was lumped.
    places: Vec<Place>,
}

/// An angle that looks like a rounding of a multiple of pi/12 and was left alone: 1.57,
/// 3.14, 0.78.
///
/// `Display`: `joint3 rpy[0] = 1.57 is 8.0e-4 rad from pi/2: left as written`.
#[derive(Debug, Clone, PartialEq)]
pub struct NearMiss {
    /// The change that would set it right; [`apply`] makes it.
    pub change: Change,
}

/// Sets right what the policy takes for roundings and dust.
#[must_use]
pub fn clean(description: &RobotDescription, policy: &CleanPolicy) -> Cleaned {
    let mut changes = Vec::new();
    let mut near_misses = Vec::new();
    if policy.mode != CleanMode::Off {
        for literal in place::literals(description) {
            match judge(&literal, &description.constants, policy) {
                Verdict::Keep => {}
                Verdict::Change(became, size) => {
                    changes.push(change(description, &literal, became, size));
                }
                Verdict::NearMiss(became, size) => {
                    near_misses.push(change(description, &literal, became, size));
                }
            }
        }
    }
    let changes = merged(changes);
    let near_misses = merged(near_misses).into_iter();
    Cleaned {
        description: apply(description, &changes),
        changes,
        near_misses: near_misses.map(|change| NearMiss { change }).collect(),
    }
}

/// The description with some changes made: those of [`clean`] on it, or its near misses.
/// What is not as a change says it was written is left alone.
#[must_use]
pub fn apply(description: &RobotDescription, changes: &[Change]) -> RobotDescription {
    let mut changed = description.clone();
    for change in changes {
        replace(&mut changed, change, &change.written, &change.became);
    }
    changed
}

/// The cleaned description with all changes but one (all, where there is no such change).
#[must_use]
pub fn revert(cleaned: &Cleaned, index: usize) -> RobotDescription {
    let mut description = cleaned.description.clone();
    if let Some(change) = cleaned.changes.get(index) {
        replace(&mut description, change, &change.became, &change.written);
    }
    description
}

fn replace(description: &mut RobotDescription, change: &Change, from: &Quantity, to: &Quantity) {
    for place in &change.places {
        if let Some(number) = place::at(description, *place).filter(|n| *n == from) {
            *number = to.clone();
        }
    }
}

/// What to do with a number, and how far it is from what it would become.
enum Verdict {
    Keep,
    Change(Quantity, f64),
    NearMiss(Quantity, f64),
}

fn judge(literal: &Literal, constants: &Constants, policy: &CleanPolicy) -> Verdict {
    let size = literal.quantity.value.abs() / literal.norm;
    let dust = match literal.place.field.unit() {
        Unit::Angle => return judge_angle(literal.quantity, constants, policy),
        Unit::Length => size <= policy.length,
        Unit::Direction => size <= policy.direction,
    };
    let zero = || {
        let exact = angle::compare(&literal.quantity.expr, constants, 0) == Exact::Same;
        exact && literal.quantity.value == 0.0
    };
    if dust && !zero() {
        Verdict::Change(Quantity::zero(), size)
    } else {
        Verdict::Keep
    }
}

fn judge_angle(written: &Quantity, constants: &Constants, policy: &CleanPolicy) -> Verdict {
    let Some((k, size)) = angle::nearest(written.value) else {
        return Verdict::Keep;
    };
    if size > policy.angle.max(policy.near_miss) {
        return Verdict::Keep;
    }
    let Some(became) = angle::multiple(k) else {
        return Verdict::Keep;
    };
    let intended = match angle::compare(&written.expr, constants, k) {
        Exact::Same => return Verdict::Keep,
        Exact::Fraction => size > LAST_DIGIT,
        Exact::Other => false,
    };
    let rounding = size <= policy.angle || policy.mode == CleanMode::Aggressive;
    if rounding && !intended {
        Verdict::Change(became, size)
    } else {
        Verdict::NearMiss(became, size)
    }
}

fn change(
    description: &RobotDescription,
    literal: &Literal,
    became: Quantity,
    size: f64,
) -> Change {
    let Place {
        link,
        field,
        in_loop,
        ..
    } = literal.place;
    let link = match field {
        Field::Gravity(_) => None,
        _ if in_loop => None,
        _ => description.links.get(link),
    };
    let joint = match literal.origin {
        Some(origin) => Some(origin.joint.clone()),
        None => link.and_then(|l| l.joint_name.clone()),
    };
    Change {
        link: link.map(|l| l.name.clone()),
        joint,
        field,
        written: literal.quantity.clone(),
        became,
        size,
        places: vec![literal.place],
    }
}

/// One change for each number of the file: the origin of a lumped joint stands in the
/// chain of every link behind it.
fn merged(changes: Vec<Change>) -> Vec<Change> {
    let mut first: HashMap<(String, Field, String), usize> = HashMap::new();
    let mut merged: Vec<Change> = Vec::new();
    for change in changes {
        let shared = matches!(change.field, Field::Xyz(_) | Field::Rpy(_));
        if let (true, Some(joint)) = (shared, &change.joint) {
            let key = (joint.clone(), change.field, change.written.text.clone());
            let index = *first.entry(key).or_insert(merged.len());
            if let Some(same) = merged.get_mut(index) {
                same.places.extend(change.places);
                continue;
            }
        }
        merged.push(change);
    }
    merged
}

impl Change {
    /// The loop whose frame the number places, from 0, and which of its two frames.
    #[must_use]
    pub fn loop_frame(&self) -> Option<(usize, usize)> {
        let place = self.places.first().filter(|p| p.in_loop)?;
        Some((place.link, place.origin))
    }

    /// Whether only the last digit of a double changes: 1.5707963267948966 to pi/2, a
    /// length of 1e-17 m to 0. Such changes need no reader's attention.
    #[must_use]
    pub fn is_last_digit(&self) -> bool {
        self.size <= LAST_DIGIT
    }
}

impl fmt::Display for Change {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (&self.joint, &self.link) {
            (Some(joint), _) => write!(f, "{joint} ")?,
            (None, Some(link)) => write!(f, "link {link} ")?,
            (None, None) => {}
        }
        write!(f, "{} = {} is {:.1e} ", self.field, self.written, self.size)?;
        match self.field {
            Field::Gravity(_) => f.write_str("of gravity, taken as 0"),
            Field::Axis(_) => f.write_str("of the axis' length, taken as 0"),
            field if field.unit() == Unit::Length => f.write_str("m from 0"),
            _ => write!(f, "rad from {}", self.became),
        }
    }
}

impl fmt::Display for NearMiss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: left as written", self.change)
    }
}
