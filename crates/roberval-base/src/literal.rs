//! What the robot file says when it is taken literally, and what its doubtful angles
//! would change.

use roberval_mechanism::{Change, Cleaning, Mechanism, RobotDescription, apply};
use roberval_regressor::Model;

use crate::{BaseError, choose_exactly, decide_precisely};

/// Groups of equal numbers that are tried one by one to find those to blame.
const MOST_GROUPS: usize = 24;

/// How the cleaned robot differs from the file as written.
#[derive(Debug, Clone, PartialEq)]
pub struct Literal {
    /// The structural rank of the file as written, decimals taken exactly.
    pub rank: usize,
    /// The numbers that alone bring more base parameters when they are taken as written,
    /// with the rank they bring; all numbers that were changed, if none does alone.
    pub blame: Vec<Blame>,
    /// Numbers left as written that would bring another rank if they were changed.
    pub near_misses: Vec<Blame>,
}

/// Numbers of one text, and the rank they bring.
#[derive(Debug, Clone, PartialEq)]
pub struct Blame {
    /// `joint3 rpy[0] = 1.5708 is 3.7e-6 rad from pi/2 (and 2 more)`.
    pub what: String,
    /// The rank with these numbers the other way.
    pub rank: usize,
}

/// Compares the mechanism, whose rank is `rank`, with what was written; `None` if it was
/// taken literally or nothing was to be cleaned.
pub(crate) fn literal(
    mechanism: &Mechanism,
    model: Model,
    rank: usize,
    seed: u64,
) -> Result<Option<Literal>, BaseError> {
    let Some(cleaning) = &mechanism.cleaning else {
        return Ok(None);
    };
    let Cleaning { written, cleaned } = cleaning.as_ref();
    let rank_of = |description: &RobotDescription| rank_of(description, model, seed);
    let mut found = Literal {
        rank,
        blame: Vec::new(),
        near_misses: Vec::new(),
    };
    // A decimal that is the nearest double of pi/2 says pi/2 as well as a URDF can.
    let (exact, changes): (Vec<Change>, Vec<Change>) = cleaned
        .changes
        .iter()
        .cloned()
        .partition(Change::is_last_digit);
    if !changes.is_empty() {
        let written = &apply(written, &exact);
        found.rank = rank_of(written)?;
        if found.rank != rank {
            found.blame = blame(written, &changes, rank, found.rank, rank_of)?;
        }
    }
    let near: Vec<Change> = cleaned
        .near_misses
        .iter()
        .map(|n| n.change.clone())
        .collect();
    for group in groups(&near).into_iter().take(MOST_GROUPS) {
        let other = rank_of(&apply(&cleaned.description, &group))?;
        if other != rank {
            found.near_misses.push(Blame::of(&group, other));
        }
    }
    Ok(Some(found))
}

fn rank_of(description: &RobotDescription, model: Model, seed: u64) -> Result<usize, BaseError> {
    let mechanism = Mechanism::new(description)?;
    let order: Vec<usize> = (0..mechanism.parameters().len()).collect();
    let kept = if mechanism.is_affine() {
        choose_exactly(&mechanism, model, &order, seed)?
    } else {
        decide_precisely(&mechanism, model, &order, seed)?.kept
    };
    Ok(kept.len())
}

/// The groups that alone make a difference; all, if none does.
fn blame(
    written: &RobotDescription,
    changes: &[Change],
    rank: usize,
    literal: usize,
    rank_of: impl Fn(&RobotDescription) -> Result<usize, BaseError>,
) -> Result<Vec<Blame>, BaseError> {
    let groups = groups(changes);
    let mut blame = Vec::new();
    for group in groups.iter().take(MOST_GROUPS) {
        let others: Vec<Change> = changes
            .iter()
            .filter(|c| !group.contains(c))
            .cloned()
            .collect();
        let without = rank_of(&apply(written, &others))?;
        if without != rank {
            blame.push(Blame::of(group, without));
        }
    }
    if blame.is_empty() {
        blame.push(Blame::of(changes, literal));
    }
    Ok(blame)
}

/// Changes of numbers that are written alike, up to the sign: most of them together
/// (3.1416 here and -3.1416 there) cancel or only turn a frame.
fn groups(changes: &[Change]) -> Vec<Vec<Change>> {
    let mut groups: Vec<Vec<Change>> = Vec::new();
    for change in changes {
        let text = |c: &Change| c.written.text.trim_start_matches('-').to_owned();
        match groups.iter_mut().find(|g| text(&g[0]) == text(change)) {
            Some(group) => group.push(change.clone()),
            None => groups.push(vec![change.clone()]),
        }
    }
    groups
}

impl Blame {
    fn of(group: &[Change], rank: usize) -> Self {
        let more = match group.len() {
            0 | 1 => String::new(),
            n => format!(" (and {} more)", n - 1),
        };
        let first = group.first().map(Change::to_string).unwrap_or_default();
        Self {
            what: format!("{first}{more}"),
            rank,
        }
    }
}
