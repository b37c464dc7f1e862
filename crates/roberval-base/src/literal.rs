//! What the robot file says when it is taken literally, and what its doubtful angles
//! would change.

use roberval_mechanism::{Change, Cleaned, Cleaning, Mechanism, RobotDescription, apply};
use roberval_regressor::Model;

use crate::{BaseError, ExactError, choose_exactly, decide_precisely};

/// Groups of equal numbers that are tried one by one to find those to blame.
const MOST_GROUPS: usize = 24;

/// Numbers of a group that are tried one by one.
const MOST_SUSPECTS: usize = 64;

/// How the cleaned robot differs from the file as written.
#[derive(Debug, Clone, PartialEq)]
pub struct Literal {
    /// Whether the robot as written has a rank: loops may close or move only without
    /// roundings. If not, the ranks here are the cleaned robot's.
    pub closes: bool,
    /// The structural rank of the file as written, every decimal taken exactly: what
    /// [`roberval_mechanism::CleanMode::Off`] decides.
    pub rank: usize,
    /// The same where numbers that only miss the last digit of a double
    /// ([`Change::is_last_digit`]) mean what they are next to: 1.5707963267948966 is pi/2 as
    /// well as a URDF can say it.
    pub as_meant: usize,
    /// The numbers that alone bring more base parameters when they are taken as written,
    /// with the rank they bring; all numbers that were changed, if none does alone. Those
    /// that were changed most come first.
    pub blame: Vec<Blame>,
    /// Numbers left as written that look like roundings, with the rank that they would bring
    /// if they were set right, one text at a time and, where there are several, all of them.
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
        closes: true,
        rank,
        as_meant: rank,
        blame: Vec::new(),
        near_misses: near_misses(cleaned, rank_of)?,
    };
    if !cleaned.changes.is_empty() {
        let as_written = rank_of(written)?;
        found.closes = as_written.is_some();
        found.rank = as_written.unwrap_or(rank);
    }
    if found.rank != rank {
        let digits = cleaned.changes.iter().filter(|c| c.is_last_digit());
        let digits: Vec<Change> = digits.cloned().collect();
        found.as_meant = rank_of(&apply(written, &digits))?.unwrap_or(found.rank);
        found.blame = blame(written, &cleaned.changes, rank, found.rank, rank_of)?;
    }
    Ok(Some(found))
}

/// What each group of near misses would change, and all of them.
fn near_misses(
    cleaned: &Cleaned,
    rank_of: impl Fn(&RobotDescription) -> Result<Option<usize>, BaseError>,
) -> Result<Vec<Blame>, BaseError> {
    let near = cleaned.near_misses.iter().map(|n| n.change.clone());
    let near: Vec<Change> = near.collect();
    let mut groups = groups(&near);
    groups.truncate(MOST_GROUPS);
    if groups.len() > 1 {
        groups.push(near);
    }
    let blame = |group: &Vec<Change>| {
        let rank = rank_of(&apply(&cleaned.description, group))?;
        Ok(rank.map(|rank| Blame::of(group, rank)))
    };
    groups
        .iter()
        .filter_map(|group| blame(group).transpose())
        .collect()
}

/// `None` where loops do not close or do not move.
fn rank_of(
    description: &RobotDescription,
    model: Model,
    seed: u64,
) -> Result<Option<usize>, BaseError> {
    match decided_rank(description, model, seed) {
        Err(_) if !description.loops.is_empty() => Ok(None),
        decided => decided.map(Some),
    }
}

fn decided_rank(
    description: &RobotDescription,
    model: Model,
    seed: u64,
) -> Result<usize, BaseError> {
    let mechanism = Mechanism::new(description)?;
    let order: Vec<usize> = (0..mechanism.parameters().len()).collect();
    let kept = match choose_exactly(&mechanism, model, &order, seed) {
        Err(ExactError::Constraints { .. }) => {
            decide_precisely(&mechanism, model, &order, seed)?.kept
        }
        other => other?,
    };
    Ok(kept.len())
}

/// The groups that alone make a difference (all together, if none does), without those of
/// their numbers that have no part in it.
fn blame(
    written: &RobotDescription,
    changes: &[Change],
    rank: usize,
    literal: usize,
    rank_of: impl Fn(&RobotDescription) -> Result<Option<usize>, BaseError>,
) -> Result<Vec<Blame>, BaseError> {
    let as_written = |left: &[Change]| {
        let others = changes.iter().filter(|c| !left.contains(c));
        let others: Vec<Change> = others.cloned().collect();
        rank_of(&apply(written, &others))
    };
    let mut groups = groups(changes);
    groups.sort_by(|a, b| b[0].size.total_cmp(&a[0].size));
    let mut blame = Vec::new();
    for group in groups.iter().take(MOST_GROUPS) {
        if let Some(without) = as_written(group)?.filter(|&without| without != rank) {
            blame.push(Blame::of(&guilty(group, without, as_written)?, without));
        }
    }
    if blame.is_empty() {
        let all = groups.concat();
        blame.push(Blame::of(&guilty(&all, literal, as_written)?, literal));
    }
    Ok(blame)
}

/// The numbers without which those left as written do not bring this rank.
fn guilty(
    group: &[Change],
    rank: usize,
    as_written: impl Fn(&[Change]) -> Result<Option<usize>, BaseError>,
) -> Result<Vec<Change>, BaseError> {
    let mut guilty = group.to_vec();
    for suspect in group.iter().rev().take(MOST_SUSPECTS) {
        let rest: Vec<Change> = guilty.iter().filter(|c| *c != suspect).cloned().collect();
        if !rest.is_empty() && as_written(&rest)? == Some(rank) {
            guilty = rest;
        }
    }
    Ok(guilty)
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
        let alike = groups(group).len() == 1;
        let more = match (group.len(), alike) {
            (0 | 1, _) => String::new(),
            (n, true) => format!(" (and {} more)", n - 1),
            (n, false) => format!(" (with {} other numbers)", n - 1),
        };
        let first = group.first().map(Change::to_string).unwrap_or_default();
        Self {
            what: format!("{first}{more}"),
            rank,
        }
    }
}
