//! How sure a decision in pairs of doubles is.

use super::PreciseDecision;
use crate::diagnosis::{FRESH_RESIDUAL, Opened};
use crate::engine::Judgement;
use crate::{Diagnosis, Engine, Literal, NullspaceDecision, Witness};

/// A gap below this puts the rank in doubt: clean geometry leaves 1e15 and more.
const CLEAR_GAP: f64 = 1e10;

/// The smallest kept value below this puts the rank in doubt: roundings of angles and
/// lengths leave such values, robots do not.
const CLEARLY_KEPT: f64 = 1e-8;

/// A decision in high-precision floats.
#[derive(Debug, Clone, PartialEq)]
pub struct Precision {
    /// b.
    pub rank: usize,
    /// Why prime fields did not decide; `None` where they were not asked.
    pub reason: Option<String>,
    /// What counts as zero, relative to the column.
    pub tolerance: f64,
    /// The smallest kept value, relative to the column.
    pub smallest_kept: Option<f64>,
    /// The largest dropped value.
    pub largest_dropped: Option<f64>,
    /// Samples used.
    pub samples: usize,
    /// Configurations of loops that were redrawn.
    pub redrawn: usize,
    /// The tree without its constraints, of a mechanism that has some.
    pub opened: Option<Opened>,
}

impl Precision {
    /// The smallest kept over the largest dropped value; `None` if nothing is on one side.
    #[must_use]
    pub fn gap(&self) -> Option<f64> {
        Some(self.smallest_kept? / self.largest_dropped.filter(|x| *x > 0.0)?)
    }
}

impl Diagnosis {
    /// The diagnosis of a decision in pairs of doubles: the first witness shows its
    /// spectrum. `tree` is what the nullspace algorithm says of the tree without its
    /// constraints, of a mechanism that has some.
    pub(crate) fn precise(
        decision: &PreciseDecision,
        reason: Option<String>,
        tree: Option<&NullspaceDecision>,
        judgements: &[(Engine, Judgement)],
        literal: Option<Literal>,
        residual: f64,
    ) -> Self {
        let rank = decision.kept.len();
        let witnesses: Vec<Witness> = judgements
            .iter()
            .map(|(engine, judgement)| Witness::of(*engine, &judgement.decision, rank))
            .collect();
        let shown = judgements.first().map(|(_, judgement)| judgement);
        let mut messages = doubts(decision, residual);
        let clear = messages.is_empty();
        let dissent = witnesses.iter().filter(|w| w.rank != rank);
        messages.extend(dissent.map(|w| w.dissent(rank)));
        messages.extend(literal.iter().flat_map(|l| l.messages(rank)));
        Self {
            clear,
            spectrum: shown.map_or_else(Vec::new, |j| j.decision.spectrum.clone()),
            spectrum_columns: shown.map_or_else(Vec::new, |j| j.columns.clone()),
            tolerance: shown.map_or(0.0, |j| j.decision.tolerance),
            gap: witnesses.first().and_then(|w| w.gap_at_structural),
            residual,
            messages,
            structure: None,
            precision: Some(Precision {
                rank,
                reason,
                tolerance: decision.tolerance,
                smallest_kept: decision.smallest_kept,
                largest_dropped: decision.largest_dropped,
                samples: decision.samples,
                redrawn: decision.redrawn,
                opened: tree.map(|tree| Opened::of(tree, &decision.kept)),
            }),
            witnesses,
            literal,
        }
    }
}

fn doubts(decision: &PreciseDecision, residual: f64) -> Vec<String> {
    let mut doubts = Vec::new();
    if let Some(gap) = decision.gap().filter(|gap| *gap < CLEAR_GAP) {
        doubts.push(format!(
            "the gap between kept and dropped values is only {gap:.1e}: the rank is doubtful"
        ));
    }
    if let Some(kept) = decision.smallest_kept.filter(|x| *x < CLEARLY_KEPT) {
        doubts.push(format!(
            "a column counts as independent for {kept:.1e} of it: angles or lengths of the \
             robot file that are rounded do this"
        ));
    }
    if residual > FRESH_RESIDUAL || residual.is_nan() {
        doubts.push(format!(
            "at fresh samples the relations miss by {residual:.1e} of a column: the rank is doubtful"
        ));
    }
    doubts
}
