//! How the count was decided, and what was made of the robot file.

use roberval_base::BaseParameters;

use super::html::{list, text};
use crate::number::size;
use crate::{couples, loops};

pub(super) fn section(answer: &BaseParameters) -> String {
    let messages = &answer.diagnosis.messages;
    let remarks = match messages.as_slice() {
        [] => String::new(),
        messages => format!("<h3>Remarks</h3>{}", list(messages)),
    };
    format!(
        "<section><h2>How it was decided</h2>{}{remarks}</section><section><h2>The robot file</h2>{}</section>",
        list(&decided(answer)),
        file(answer)
    )
}

fn decided(answer: &BaseParameters) -> Vec<String> {
    let diagnosis = &answer.diagnosis;
    let mut lines = vec![format!(
        "Model {}, engine {}, choice {}, seed {}, {} rows; roberval {}.",
        answer.model.name(),
        answer.engine.name(),
        answer.choice.name(),
        answer.seed,
        answer.rows,
        env!("CARGO_PKG_VERSION")
    )];
    if let Some(structure) = &diagnosis.structure {
        lines.push(format!(
            "Rank {} by exact elimination in {} prime fields; the probability that it is too low is below {}.",
            structure.rank,
            structure.primes.len(),
            size(structure.failure_probability)
        ));
        lines.extend(structure.nullspace_rank.map(|rank| {
            format!(
                "The parameter nullspace algorithm, which shares no code with the regressor, counts {rank}."
            )
        }));
        lines.extend(couples::lines(&answer.mechanism));
        lines.extend(couples::removed(answer));
    }
    if let Some(precise) = loops::decided(answer) {
        lines.extend(precise.into_iter().map(|line| format!("{line}.")));
        lines.extend(couples::lines(&answer.mechanism));
        lines.extend(couples::removed(answer));
    }
    for witness in &diagnosis.witnesses {
        let gap = witness.gap_at_structural.map_or("none".to_owned(), size);
        lines.push(format!(
            "In floating point {} counts {} (gap {gap}).",
            witness.engine.name(),
            witness.rank
        ));
    }
    lines.push(format!(
        "At fresh samples, which decided nothing, the relations hold to {}.",
        size(diagnosis.residual)
    ));
    lines.push(match answer.certificate() {
        Ok(_) => {
            "The certificate above is checked by python -m roberval.check_certificate FILE, a \
                  program of plain Python that shares nothing with roberval."
                .to_owned()
        }
        Err(error) => format!("There is no certificate: {error}."),
    });
    lines
}

/// What was set right in the robot file, left alone, and worth a warning.
fn file(answer: &BaseParameters) -> String {
    let mut parts = String::new();
    let mut part = |title: &str, sentences: Vec<String>| {
        if !sentences.is_empty() {
            parts.push_str(&format!("<h3>{title}</h3>{}", list(&sentences)));
        }
    };
    part("Warnings", answer.mechanism.description.warnings.clone());
    if let Some(cleaning) = &answer.mechanism.cleaning {
        let cleaned = &cleaning.cleaned;
        let worth = |c: &&roberval_mechanism::Change| !c.is_last_digit();
        let changes = cleaned.changes.iter().filter(worth);
        part(
            "Set right before",
            changes.map(ToString::to_string).collect(),
        );
        let near = cleaned.near_misses.iter();
        part("Left as written", near.map(ToString::to_string).collect());
    }
    if parts.is_empty() {
        return "<p>Nothing to remark: its numbers were taken as they stand.</p>".to_owned();
    }
    if answer
        .diagnosis
        .literal
        .as_ref()
        .is_some_and(|l| l.rank != answer.rank())
    {
        let note = "Taken as written, the file has another number of base parameters: see the remarks above.";
        parts.insert_str(0, &format!("<p>{}</p>", text(note)));
    }
    parts
}
