//! How sure a rank is.

use roberval_linalg::RankDecision;
use roberval_mechanism::ParameterSpace;

use crate::{Engine, ExactDecision, Literal};

/// The dropped and the kept part of the spectrum must be this far apart, or the rank is
/// doubtful: clean geometry shows 1e10 and more.
const CLEAR_GAP: f64 = 1e6;

/// Relations hold at fresh samples to this, relative to the column, or the rank is
/// doubtful: rounding leaves 1e-12 on a 36-link chain.
const FRESH_RESIDUAL: f64 = 1e-9;

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
    /// What the float engines make of the same robot.
    pub witnesses: Vec<Witness>,
    /// What the file as written gives, if it was cleaned.
    pub literal: Option<Literal>,
}

/// The structural decision.
#[derive(Debug, Clone, PartialEq)]
pub struct Structure {
    /// b, decided without a tolerance.
    pub rank: usize,
    /// The primes of the fields that agreed.
    pub primes: Vec<u64>,
    /// The seeds of their random values.
    pub seeds: Vec<u64>,
    /// An upper bound of the probability that the rank is too low.
    pub failure_probability: f64,
    /// Angles that stood for generic ones, as written.
    pub generic: Vec<String>,
}

/// What a float engine makes of the robot that the exact engine decided.
#[derive(Debug, Clone, Copy, PartialEq)]
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
}

impl Diagnosis {
    pub(crate) fn of(
        decision: &RankDecision,
        order: &[usize],
        space: &ParameterSpace,
        residual: f64,
    ) -> Self {
        let by_column = decision.spectrum.len() == order.len()
            && decision.spectrum.windows(2).any(|pair| pair[0] < pair[1]);
        let mut messages = Vec::new();
        if !decision.ambiguous.is_empty() {
            messages.push(ambiguity(decision, by_column, order, space));
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
            spectrum_columns: if by_column {
                order.to_vec()
            } else {
                Vec::new()
            },
            tolerance: decision.tolerance,
            gap: decision.gap,
            residual,
            messages,
            structure: None,
            witnesses: Vec::new(),
            literal: None,
        }
    }

    /// The diagnosis of an exact decision: the first witness shows its spectrum.
    pub(crate) fn structural(
        exact: &ExactDecision,
        decisions: &[(Engine, RankDecision)],
        literal: Option<Literal>,
        residual: f64,
    ) -> Self {
        let rank = exact.kept.len();
        let witnesses: Vec<Witness> = decisions
            .iter()
            .map(|(engine, decision)| Witness::of(*engine, decision, rank))
            .collect();
        let shown = decisions.first().map(|(_, decision)| decision);
        let mut messages = Vec::new();
        if residual > FRESH_RESIDUAL || residual.is_nan() {
            messages.push(format!(
                "at fresh samples the relations miss by {residual:.1e} of a column: please report this robot"
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
            messages.push(generic_angles(&exact.generic));
        }
        Self {
            clear,
            spectrum: shown.map(|d| d.spectrum.clone()).unwrap_or_default(),
            spectrum_columns: Vec::new(),
            tolerance: shown.map_or(0.0, |d| d.tolerance),
            gap: witnesses.first().and_then(|w| w.gap_at_structural),
            residual,
            messages,
            structure: Some(Structure {
                rank,
                primes: exact.primes.clone(),
                seeds: exact.seeds.clone(),
                failure_probability: exact.failure_probability,
                generic: exact.generic.clone(),
            }),
            witnesses,
            literal,
        }
    }
}

impl Literal {
    /// What the user should know of the file as written.
    fn messages(&self, rank: usize) -> Vec<String> {
        let mut messages = Vec::new();
        if self.rank != rank {
            let causes: Vec<&str> = self.blame.iter().map(|b| b.what.as_str()).collect();
            messages.push(format!(
                "as written the file has {} base parameters instead of {rank}: {}",
                self.rank,
                causes.join("; ")
            ));
        }
        messages.extend(self.near_misses.iter().map(|near| {
            format!(
                "{}: left as written; changed, it would make {}",
                near.what, near.rank
            )
        }));
        messages
    }
}

impl Witness {
    fn of(engine: Engine, decision: &RankDecision, rank: usize) -> Self {
        let mut sorted = decision.spectrum.clone();
        sorted.sort_by(|a, b| b.total_cmp(a));
        let gap = (rank > 0 && rank < sorted.len()).then(|| sorted[rank - 1] / sorted[rank]);
        Self {
            engine,
            rank: decision.rank,
            gap: decision.gap,
            gap_at_structural: gap,
        }
    }

    fn dissent(&self, rank: usize) -> String {
        let engine = self.engine.name();
        format!(
            "in floats, {engine} counts {} instead of {rank}: its gap is {} there and {} at {rank}",
            self.rank,
            size(self.gap),
            size(self.gap_at_structural)
        )
    }
}

fn size(gap: Option<f64>) -> String {
    gap.map_or("none".to_owned(), |gap| format!("{gap:.1e}"))
}

fn generic_angles(texts: &[String]) -> String {
    const MOST_NAMED: usize = 8;
    let named = texts[..texts.len().min(MOST_NAMED)].join(", ");
    let more = if texts.len() > MOST_NAMED {
        ", ..."
    } else {
        ""
    };
    format!(
        "decided for generic values of the angles {named}{more} (rad), which have no exact cosine"
    )
}

fn ambiguity(
    decision: &RankDecision,
    by_column: bool,
    order: &[usize],
    space: &ParameterSpace,
) -> String {
    let count = decision.ambiguous.len();
    let smallest = decision
        .ambiguous
        .iter()
        .map(|&i| decision.spectrum[i])
        .fold(f64::INFINITY, f64::min);
    let names: Vec<&str> = decision
        .ambiguous
        .iter()
        .filter(|_| by_column)
        .map(|&i| space.labels()[order[i]].as_str())
        .collect();
    let which = if names.is_empty() {
        String::new()
    } else {
        format!(" ({})", names.join(", "))
    };
    format!(
        "{count} direction{} of W{which} are neither zero nor clearly not, down to {smallest:.1e}: \
         angles or lengths of the robot file that are rounded (1.5708 for pi/2) do this",
        if count == 1 { "" } else { "s" }
    )
}
