use roberval_base::{BaseParameters, Engine};
use roberval_mechanism::ParameterKind;

use super::{Class, rounded_values};
use crate::document::{Block, Column, Document, Item, Table, Tint};
use crate::number::{scientific, shortest, size};
use crate::relation::{self, Label};
use crate::robot;
use crate::{couples, loops};

/// A spectrum longer than this is shown around the gap only.
const LONGEST_SPECTRUM: usize = 120;

/// More changed numbers than these are counted only.
const MOST_CHANGES: usize = 6;

/// How many values of a long spectrum are shown on either side of the gap.
const AROUND_GAP: usize = 24;

/// The answer for people.
pub(crate) fn document(answer: &BaseParameters) -> Document {
    let mut blocks = head(answer);
    blocks.extend(spectrum(answer));
    blocks.extend(classification(answer));
    blocks.extend(relations(answer));
    blocks.extend(values_table(answer));
    blocks
}

fn head(answer: &BaseParameters) -> Document {
    let tally = answer.tally();
    let with_effect = tally.base + tally.regrouped;
    let diagnosis = &answer.diagnosis;
    let mut lines = vec![
        robot::joints_and_gravity(&answer.mechanism),
        format!(
            "model {}, engine {}, choice {}, seed {}, {} rows",
            answer.model.name(),
            answer.engine.name(),
            answer.choice.name(),
            answer.seed,
            answer.rows
        ),
        format!(
            "{} standard parameters = {} without effect + {with_effect} with an effect",
            tally.standard, tally.no_effect
        ),
        format!(
            "{} base parameters = {} unchanged + {} regrouped into; {} regrouped away",
            tally.base, tally.unchanged, tally.regrouped_into, tally.regrouped
        ),
    ];
    lines.extend(couples::lines(&answer.mechanism));
    lines.extend(certainty(answer));
    lines.extend(couples::removed(answer));
    let word = if diagnosis.clear { "note" } else { "doubt" };
    lines.extend(diagnosis.messages.iter().map(|m| format!("{word}: {m}")));
    vec![
        Block::Title(answer.mechanism.name.clone()),
        Block::Lines(lines),
    ]
}

/// How the rank was decided and how sure it is.
fn certainty(answer: &BaseParameters) -> Vec<String> {
    let diagnosis = &answer.diagnosis;
    let fresh = format!(
        "the relations hold at fresh samples to {}",
        size(diagnosis.residual)
    );
    if let Some(mut lines) = loops::decided(answer) {
        lines[0] = format!("{}; {fresh}", lines[0]);
        lines.push(format!("In floats: {}", witnesses(answer)));
        lines.extend(cleaning(answer));
        return lines;
    }
    let Some(structure) = &diagnosis.structure else {
        let clear = if diagnosis.clear { "clear" } else { "DOUBTFUL" };
        return vec![format!("The rank is {clear}: {}; {fresh}", gap(answer))];
    };
    let witnesses = witnesses(answer);
    vec![
        format!(
            "Structural rank {} (exact, {} primes, failure probability below {}); {fresh}",
            structure.rank,
            structure.primes.len(),
            size(structure.failure_probability)
        ),
        match structure.nullspace_rank {
            Some(rank) => format!("Nullspace algorithm {rank}; in floats: {witnesses}"),
            None => format!("In floats: {witnesses}"),
        },
    ]
    .into_iter()
    .chain(cleaning(answer))
    .collect()
}

/// `svd 40 (gap 1.0e13), ...`
fn witnesses(answer: &BaseParameters) -> String {
    let witnesses = answer.diagnosis.witnesses.iter();
    let texts: Vec<String> = witnesses
        .map(|w| {
            let gap = w.gap_at_structural.map_or("none".to_owned(), size);
            format!("{} {} (gap {gap})", w.engine.name(), w.rank)
        })
        .collect();
    texts.join(", ")
}

/// What was set right before.
fn cleaning(answer: &BaseParameters) -> Vec<String> {
    let Some(cleaning) = &answer.mechanism.cleaning else {
        return Vec::new();
    };
    let changes = &cleaning.cleaned.changes;
    let listed: Vec<String> = changes
        .iter()
        .filter(|c| !c.is_last_digit())
        .map(ToString::to_string)
        .collect();
    if listed.is_empty() {
        return Vec::new();
    }
    let shown = &listed[..listed.len().min(MOST_CHANGES)];
    let more = match listed.len() - shown.len() {
        0 => String::new(),
        n => format!("; and {n} more (all of them in JSON)"),
    };
    vec![format!("Set right before: {}{more}", shown.join("; "))]
}

fn gap(answer: &BaseParameters) -> String {
    let gap = match answer.diagnosis.gap {
        Some(gap) => format!("gap {}", size(gap)),
        None => "no value counts as zero".to_owned(),
    };
    format!("{gap}, tolerance {}", size(answer.diagnosis.tolerance))
}

/// Table II: what the rank was decided on, with the gap marked.
fn spectrum(answer: &BaseParameters) -> Document {
    let diagnosis = &answer.diagnosis;
    let mut entries: Vec<(f64, Option<usize>)> = diagnosis
        .spectrum
        .iter()
        .enumerate()
        .map(|(i, &value)| (value, diagnosis.spectrum_columns.get(i).copied()))
        .collect();
    entries.sort_by(|a, b| b.0.total_cmp(&a.0));
    let b = answer.rank().min(entries.len());
    let long = entries.len() > LONGEST_SPECTRUM;
    let margin = if long { AROUND_GAP } else { entries.len() };
    let (first, last) = (b.saturating_sub(margin), (b + margin).min(entries.len()));
    let mut blocks = vec![Block::Heading(spectrum_heading(answer.engine).to_owned())];
    if first > 0 {
        blocks.push(Block::Lines(vec![format!("({first} larger values)")]));
    }
    blocks.push(spectrum_part(answer, &entries, first..b));
    if b < entries.len() {
        blocks.push(Block::Rule(gap(answer)));
        blocks.push(spectrum_part(answer, &entries, b..last));
    }
    if last < entries.len() {
        let rest = entries.len() - last;
        blocks.push(Block::Lines(vec![format!("({rest} smaller values)")]));
    }
    blocks
}

fn spectrum_heading(engine: Engine) -> &'static str {
    match engine {
        Engine::Qrii | Engine::Exact | Engine::Precise => {
            "Diagonal |T_ii| of QR with column pivoting"
        }
        Engine::Svd => "Singular values sigma_i",
        Engine::Qr => "Diagonal of QR: what the kept columns before it leave of each column",
    }
}

fn spectrum_part(
    answer: &BaseParameters,
    entries: &[(f64, Option<usize>)],
    range: std::ops::Range<usize>,
) -> Block {
    let with_labels = entries.iter().any(|(_, column)| column.is_some());
    let mut columns = vec![Column::right("i"), Column::right("value")];
    if with_labels {
        columns.push(Column::left("of"));
    }
    let rows = range.map(|i| {
        let (value, column) = entries[i];
        let mut row = vec![
            Item::Number((i + 1).to_string()),
            Item::Number(scientific(value)),
        ];
        row.extend(column.map(|c| Item::Label(Label::of(answer, c))));
        row
    });
    Block::Table(Table {
        columns,
        rows: rows.collect(),
        folded: true,
    })
}

/// Links by kinds.
fn classification(answer: &BaseParameters) -> Document {
    let classes = Class::all(answer);
    let mut columns = vec![Column::left("link")];
    columns.extend(ParameterKind::ALL.map(|kind| Column::right(kind.name())));
    columns.push(Column::right("kept"));
    let kept = |class: &Class| matches!(class, Class::Unchanged | Class::RegroupedInto);
    let links = answer.mechanism.links.iter().enumerate();
    let rows = links.filter(|(_, l)| !l.massless).map(|(j, link)| {
        let first = answer.parameters.first_column(j);
        let classes = &classes[first..first + link.columns()];
        let mut row = vec![Item::text(&link.name)];
        row.extend((0..11).map(|k| {
            classes
                .get(k)
                .map_or(Item::text(""), |c| Item::Mark(c.mark(), tint(*c)))
        }));
        row.push(Item::Number(
            classes.iter().filter(|c| kept(c)).count().to_string(),
        ));
        row
    });
    vec![
        Block::Heading(
            "Classification: = unchanged, + regrouped into, o regrouped away, . no effect"
                .to_owned(),
        ),
        Block::Table(Table {
            columns,
            rows: rows.collect(),
            folded: false,
        }),
    ]
}

fn tint(class: Class) -> Tint {
    match class {
        Class::NoEffect => Tint::Faint,
        Class::Unchanged => Tint::Keep,
        Class::RegroupedInto => Tint::Into,
        Class::Regrouped => Tint::Away,
    }
}

/// Table V: the relations and what stays out of them.
fn relations(answer: &BaseParameters) -> Document {
    let tally = answer.tally();
    let relations = relation::of(answer);
    let mut blocks = Vec::new();
    if !relations.is_empty() {
        blocks.push(Block::Heading("Relations".to_owned()));
        blocks.push(Block::Relations(relations));
    }
    let lists = [
        (tally.unchanged, &answer.unchanged, "unchanged"),
        (tally.regrouped, &answer.regrouped, "regrouped away"),
        (tally.no_effect, &answer.no_effect, "without effect"),
    ];
    for (count, columns, what) in lists {
        if count > 0 {
            let labels = columns.iter().map(|&c| Label::of(answer, c)).collect();
            blocks.push(Block::List(format!("{count} {what}:"), labels));
        }
    }
    blocks
}

/// Table III: X and XB.
fn values_table(answer: &BaseParameters) -> Document {
    let Some(values) = rounded_values(answer) else {
        return Vec::new();
    };
    let rows = values.into_iter().map(|(label, x, xb)| {
        vec![
            Item::Label(label),
            Item::Number(shortest(x)),
            Item::Number(shortest(xb)),
        ]
    });
    vec![
        Block::Heading(
            "Values in SI units (what the robot file does not give counts as 0)".to_owned(),
        ),
        Block::Table(Table {
            columns: vec![
                Column::left("parameter"),
                Column::right("X"),
                Column::right("XB"),
            ],
            rows: rows.collect(),
            folded: true,
        }),
    ]
}
