//! How sure a rank is.

use roberval_linalg::RankDecision;
use roberval_mechanism::ParameterSpace;

use crate::engine::Judgement;
use crate::{Blame, Engine, ExactDecision, Literal, LoopForm, NullspaceDecision, Precision};

/// Of loops that were cleaned.
const UNCLOSED: &str = "with the angles as written, unrounded, the loops do not close or do not \
     move; this is the answer for the cleaned robot";

/// The dropped and the kept part of the spectrum must be this far apart, or the rank is
/// doubtful: clean geometry shows 1e10 and more.
const CLEAR_GAP: f64 = 1e6;

/// Dropped values of robots with clean geometry are below this part of the largest value:
/// 1.1e-13 was the most on 400 of them.
const DUST: f64 = 1e-12;

/// Coefficients without an exact form that are not known to this are no answer. Pairs of
/// doubles know them to 1e-22; roundings of pi/2 taken as written cost up to all of that.
const KNOWN_COEFFICIENT: f64 = 1e-9;

/// Rounding may leave this many units in the last place of the terms of a relation.
const ROUNDINGS: f64 = 1e3;

/// Relations hold at fresh samples to this, relative to the column, or the rank is
/// doubtful: rounding leaves 1e-12 on a 36-link chain.
pub(crate) const FRESH_RESIDUAL: f64 = 1e-9;

/// How sure a rank is.
#[derive(Debug, Clone, PartialEq)]
pub struct Diagnosis {
    /// Whether there is no doubt about the rank.
    pub clear: bool,
    /// What the rank was decided on: |T_ii| (QRII) or sigma_i (SVD), nonincreasing; or,
    /// for QR, what earlier columns leave of each column, relative to its norm.
    pub spectrum: Vec<f64>,
    /// The columns the spectrum's entries belong to; empty where they belong to none.
    pub spectrum_columns: Vec<usize>,
    /// Entries of the spectrum at or below it count as zero.
    pub tolerance: f64,
    /// Smallest kept over largest dropped entry; `None` if nothing was kept or dropped.
    pub gap: Option<f64>,
    /// The largest miss of the relations at samples that decided nothing, relative.
    pub residual: f64,
    /// What the user should know, in sentences.
    pub messages: Vec<String>,
    /// How the exact engine decided, if it did.
    pub structure: Option<Structure>,
    /// How pairs of doubles decided, if they did.
    pub precision: Option<Precision>,
    /// What the float engines make of the same robot.
    pub witnesses: Vec<Witness>,
    /// What the file as written gives, if it was cleaned.
    pub literal: Option<Literal>,
}

impl Diagnosis {
    /// Numbers of the file that look like roundings and were left as written, and what they
    /// would change, in sentences.
    pub(crate) fn warnings(&self) -> Vec<String> {
        let rank = match (&self.structure, &self.precision) {
            (Some(structure), _) => structure.rank,
            (None, Some(precision)) => precision.rank,
            (None, None) => return Vec::new(),
        };
        let near = self.literal.iter().flat_map(|literal| &literal.near_misses);
        let near = near.map(|near| near.warning(rank));
        let unclosed = self.literal.iter().filter(|literal| !literal.closes);
        let unclosed = unclosed.map(|_| UNCLOSED.to_owned());
        unclosed.chain(near).collect()
    }
}

/// The structural decision.
#[derive(Debug, Clone, PartialEq)]
pub struct Structure {
    /// b, decided without a tolerance.
    pub rank: usize,
    /// The rank by the parameter nullspace algorithm, which shares no code with the
    /// regressor: it must be the same. `None` with constraints, which it does not know.
    pub nullspace_rank: Option<usize>,
    /// The tree without its constraints, of a mechanism that has some.
    pub opened: Option<Opened>,
    /// How prime fields hold the robot's loops; `None` without.
    pub loops: Option<LoopForm>,
    /// The primes of the fields that agreed.
    pub primes: Vec<u64>,
    /// The seeds of their random values.
    pub seeds: Vec<u64>,
    /// An upper bound of the probability that the rank is too low.
    pub failure_probability: f64,
    /// Angles that stood for generic ones, as written.
    pub generic: Vec<String>,
}

/// The tree that is left where couples are opened, with the same rotors.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Opened {
    /// Its number of base parameters.
    pub rank: usize,
    /// The columns that the paper's choice keeps in the tree and not in the mechanism,
    /// ascending: what the constraints remove beyond the tree.
    pub removed: Vec<usize>,
}

impl Opened {
    pub(crate) fn of(tree: &NullspaceDecision, kept: &[usize]) -> Self {
        let removed = tree.kept.iter().filter(|c| !kept.contains(c));
        Self {
            rank: tree.rank,
            removed: removed.copied().collect(),
        }
    }
}

/// Relations at samples that decided nothing.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Fresh {
    /// The largest |W2 - W1 beta|, relative to the column.
    pub residual: f64,
    /// The largest |W1| |beta|, likewise: what rounding is multiplied by.
    pub growth: f64,
}

/// What a float engine makes of the robot that the exact engine decided.
#[derive(Debug, Clone, PartialEq)]
pub struct Witness {
    /// The engine.
    pub engine: Engine,
    /// The rank it finds.
    pub rank: usize,
    /// Its own gap, at the rank it finds.
    pub gap: Option<f64>,
    /// The gap of its spectrum at the structural rank; `None` if nothing is on one side
    /// (or, for the staircase, where the spectrum is not in order).
    pub gap_at_structural: Option<f64>,
    /// What it decides on, nonincreasing.
    pub spectrum: Vec<f64>,
    /// Entries of the spectrum at or below it count as zero.
    pub tolerance: f64,
}

impl Diagnosis {
    /// The tree without constraints, of a mechanism that has some.
    #[must_use]
    pub fn opened(&self) -> Option<&Opened> {
        let exact = self.structure.as_ref().and_then(|s| s.opened.as_ref());
        let precise = self.precision.as_ref().and_then(|p| p.opened.as_ref());
        exact.or(precise)
    }

    /// The diagnosis of a float decision; `columns` are the robot's columns that the
    /// spectrum's entries belong to, or mostly do if they are `shared`; `effects` are those of
    /// [`crate::Observation`], one for each of the robot's columns.
    pub(crate) fn of(
        decision: &RankDecision,
        mut columns: Vec<usize>,
        shared: bool,
        space: &ParameterSpace,
        effects: &[f64],
        residual: f64,
    ) -> Self {
        let mut messages = Vec::new();
        messages.extend(residue_above_dust(decision, &columns, effects));
        if shared {
            columns.clear();
        }
        if !decision.ambiguous.is_empty() {
            messages.insert(0, ambiguity(decision, &columns, space));
        }
        if let Some(gap) = decision.gap.filter(|gap| *gap < CLEAR_GAP) {
            messages.push(format!(
                "the gap between kept and dropped values is only {gap:.1e}: the rank is doubtful"
            ));
        }
        if residual > FRESH_RESIDUAL || residual.is_nan() {
            messages.push(format!(
                "at fresh samples the relations miss by {residual:.1e} of a column: the rank is doubtful"
            ));
        }
        Self {
            clear: messages.is_empty(),
            spectrum: decision.spectrum.clone(),
            spectrum_columns: columns,
            tolerance: decision.tolerance,
            gap: decision.gap,
            residual,
            messages,
            structure: None,
            precision: None,
            witnesses: Vec::new(),
            literal: None,
        }
    }

    /// The diagnosis of an exact decision: the first witness shows its spectrum. `tree` is
    /// what the nullspace algorithm says of the tree, whose constraints are `opened`.
    pub(crate) fn structural(
        exact: &ExactDecision,
        tree: &NullspaceDecision,
        opened: bool,
        judgements: &[(Engine, Judgement)],
        literal: Option<Literal>,
        fresh: Fresh,
    ) -> Self {
        let rank = exact.kept.len();
        let witnesses: Vec<Witness> = judgements
            .iter()
            .map(|(engine, judgement)| Witness::of(*engine, &judgement.decision, rank))
            .collect();
        let shown = judgements.first().map(|(_, judgement)| judgement);
        let mut messages = coefficient_doubts(exact, fresh);
        messages.extend(contradiction(&witnesses, rank));
        let nullspace_rank = (!opened).then_some(tree.rank);
        if let Some(nullspace_rank) = nullspace_rank
            && nullspace_rank != rank
        {
            messages.push(format!(
                "the parameter nullspace algorithm counts {nullspace_rank} instead of {rank}: please report this robot"
            ));
        }
        let clear = messages.is_empty();
        messages.extend(
            witnesses
                .iter()
                .filter(|w| w.rank != rank)
                .map(|w| w.dissent(rank)),
        );
        if let Some(literal) = &literal {
            messages.extend(literal.messages(rank));
        }
        if !exact.generic.is_empty() {
            let known = exact.rounding_error.le(&KNOWN_COEFFICIENT);
            messages.push(generic_angles(&exact.generic, known));
        }
        Self {
            clear,
            spectrum: shown
                .map(|j| j.decision.spectrum.clone())
                .unwrap_or_default(),
            spectrum_columns: shown.map(|j| j.columns.clone()).unwrap_or_default(),
            tolerance: shown.map_or(0.0, |j| j.decision.tolerance),
            gap: witnesses.first().and_then(|w| w.gap_at_structural),
            residual: fresh.residual,
            messages,
            structure: Some(Structure {
                rank,
                nullspace_rank,
                opened: opened.then(|| Opened::of(tree, &exact.kept)),
                loops: exact.loops.clone(),
                primes: exact.primes.clone(),
                seeds: exact.seeds.clone(),
                failure_probability: exact.failure_probability,
                generic: exact.generic.clone(),
            }),
            precision: None,
            witnesses,
            literal,
        }
    }
}

impl Literal {
    /// What the user should know of the file as written.
    pub(crate) fn messages(&self, rank: usize) -> Vec<String> {
        if self.rank == rank {
            return Vec::new();
        }
        let causes: Vec<&str> = self.blame.iter().map(|b| b.what.as_str()).collect();
        let meant = match self.as_meant {
            meant if meant == self.rank => String::new(),
            meant if meant == rank => ", for last digits of doubles only".to_owned(),
            meant => format!(" ({meant} but for last digits of doubles)"),
        };
        vec![format!(
            "as written the file has {} base parameters instead of {rank}{meant}: {}",
            self.rank,
            causes.join("; ")
        )]
    }
}

impl Blame {
    fn warning(&self, rank: usize) -> String {
        let change = match self.rank {
            same if same == rank => format!("it would stay at {rank} base parameters"),
            other => format!("it would make {other} base parameters of {rank}"),
        };
        format!("{}: left as written; set right, {change}", self.what)
    }
}

impl Witness {
    pub(crate) fn of(engine: Engine, decision: &RankDecision, rank: usize) -> Self {
        let mut sorted = decision.spectrum.clone();
        sorted.sort_by(|a, b| b.total_cmp(a));
        let gap = (rank > 0 && rank < sorted.len()).then(|| sorted[rank - 1] / sorted[rank]);
        let gap = gap.filter(|gap| !gap.is_nan()); // 0/0
        Self {
            engine,
            rank: decision.rank,
            gap: decision.gap,
            gap_at_structural: gap,
            spectrum: sorted,
            tolerance: decision.tolerance,
        }
    }

    pub(crate) fn dissent(&self, rank: usize) -> String {
        let engine = self.engine.name();
        format!(
            "in floats, {engine} counts {} instead of {rank}: its gap is {} there and {} at {rank}",
            self.rank,
            size(self.gap),
            size(self.gap_at_structural)
        )
    }
}

/// What is wrong with the coefficients of an exact decision.
fn coefficient_doubts(exact: &ExactDecision, fresh: Fresh) -> Vec<String> {
    let Fresh { residual, growth } = fresh;
    let mut doubts = Vec::new();
    // Not a number counts as too large.
    let known = exact.rounding_error.le(&KNOWN_COEFFICIENT);
    if !known {
        doubts.push(
            "448 binary digits do not tell the base columns from dependent ones: angles are \
             related that count as unrelated, or all but related"
                .to_owned(),
        );
    }
    let missed = residual > FRESH_RESIDUAL || residual.is_nan();
    if known && missed {
        doubts.push(if residual <= ROUNDINGS * f64::EPSILON * growth {
            "the coefficients are right, but of no use in doubles: numbers of the description \
             all but cancel, as roundings of pi/2 do; let them be set right (--snap default)"
                .to_owned()
        } else {
            format!(
                "at fresh samples the relations miss by {residual:.1e} of a column: please report this robot"
            )
        });
    }
    doubts
}

/// All float engines see another rank, and clearly.
fn contradiction(witnesses: &[Witness], rank: usize) -> Option<String> {
    let seen = witnesses.first()?.rank;
    let clear = |w: &Witness| w.rank == seen && w.gap.is_some_and(|gap| gap >= CLEAR_GAP);
    (seen != rank && witnesses.iter().all(clear)).then(|| {
        format!(
            "all float engines count {seen} instead of {rank}, with a clear gap: numbers of the \
             description are rounded, as 1.57079632679 for pi/2, or all but cancel"
        )
    })
}

fn size(gap: Option<f64>) -> String {
    gap.map_or("none".to_owned(), |gap| format!("{gap:.1e}"))
}

fn generic_angles(texts: &[String], confirmed: bool) -> String {
    const MOST_NAMED: usize = 8;
    let named = texts[..texts.len().min(MOST_NAMED)].join(", ");
    let more = if texts.len() > MOST_NAMED {
        ", ..."
    } else {
        ""
    };
    let confirmed = if confirmed {
        "; 448 binary digits confirm the rank"
    } else {
        ""
    };
    format!(
        "decided as if the angles {named}{more} (rad) were not related: they have too many digits \
         for a common unit{confirmed}"
    )
}

/// Values that count as zero but are not: a file with angles of eleven digits leaves
/// 1e-11 where rounding leaves 1e-16.
///
/// Rounding is relative to what a column's entries would be if nothing cancelled. Of a
/// column whose effect is 1e-5 of that, rounding leaves 1e5 times as much, relative to the
/// column.
fn residue_above_dust(
    decision: &RankDecision,
    columns: &[usize],
    effects: &[f64],
) -> Option<String> {
    let effect = |i: usize| columns.get(i).map_or(1.0, |&c| effects[c].min(1.0));
    let mut sorted: Vec<(f64, f64)> = (0..decision.spectrum.len())
        .map(|i| (decision.spectrum[i], effect(i)))
        .collect();
    sorted.sort_by(|(a, _), (b, _)| b.total_cmp(a));
    let largest = sorted.first()?.0;
    let (value, effect) = sorted
        .into_iter()
        .skip(decision.rank)
        .find(|(value, effect)| {
            let dust = DUST * largest / effect;
            *value > dust
        })?;
    Some(format!(
        "values up to {value:.1e} count as zero, but rounding leaves less than {:.0e}: \
         angles or lengths of the robot file that are rounded do this",
        DUST * largest / effect
    ))
}

fn ambiguity(decision: &RankDecision, columns: &[usize], space: &ParameterSpace) -> String {
    let count = decision.ambiguous.len();
    let values = decision.ambiguous.iter().map(|&i| decision.spectrum[i]);
    let smallest = values.fold(f64::INFINITY, f64::min);
    let at = decision.ambiguous.iter().filter_map(|&i| columns.get(i));
    let names: Vec<&str> = at.map(|&c| space.labels()[c].as_str()).collect();
    let which = match names.as_slice() {
        [] => String::new(),
        names => format!(" ({})", names.join(", ")),
    };
    format!(
        "{count} {}{which} {} neither zero nor clearly not, down to {smallest:.1e}: \
         angles or lengths of the robot file that are rounded (1.5708 for pi/2) do this",
        if count == 1 {
            "direction of W"
        } else {
            "directions of W"
        },
        if count == 1 { "is" } else { "are" },
    )
}
