//! Samples that scale W, and what they gain.

use roberval_base::{Grade, Scaling, ScalingOptions};
use roberval_mechanism::Mechanism;
use serde_json::{Value, json};

use crate::document::{Block, Column, Document, Item, Table};
use crate::json::pretty;
use crate::number::{exact, size};
use crate::{csv_text, robot};

/// The gain for people.
pub(crate) fn document(
    mechanism: &Mechanism,
    options: &ScalingOptions,
    scaling: &Scaling,
) -> Document {
    let (before, after) = (&scaling.before, &scaling.after);
    let row = |name: &str, number: &dyn Fn(&Grade) -> String| {
        vec![
            Item::text(name),
            Item::Number(number(before)),
            Item::Number(number(after)),
        ]
    };
    let mut row_s = scaling.row_s.clone();
    row_s.sort_by(f64::total_cmp);
    let median = row_s.get(row_s.len() / 2).copied().unwrap_or(1.0);
    let largest = row_s.last().copied().unwrap_or(1.0);
    vec![
        Block::Title(mechanism.name.clone()),
        Block::Lines(vec![
            robot::joints_and_gravity(mechanism),
            format!(
                "model {}, seed {}: W is {} x {}, from {} samples",
                scaling.model.name(),
                options.seed,
                scaling.w.rows(),
                scaling.w.cols(),
                scaling.samples.count
            ),
        ]),
        Block::Heading("Scaling of W".to_owned()),
        Block::Table(Table {
            columns: vec![
                Column::left(""),
                Column::right("random"),
                Column::right("found"),
            ],
            rows: vec![
                row("S = max|Wij| / min|Wij|", &|g| size(g.s)),
                row("||W||_F", &|g| size(g.norm)),
                row("J = l1 ||W||_F + l2 S", &|g| size(g.j)),
                row("rank b", &|g| g.rank.to_string()),
                row("gap |Tbb| / |Tb+1,b+1|", &|g| {
                    g.gap.map_or("-".to_owned(), size)
                }),
            ],
            folded: false,
        }),
        Block::Lines(vec![format!(
            "S of a row alone: median {}, largest {}",
            size(median),
            size(largest)
        )]),
    ]
}

/// Everything for programs: grades, samples, columns of W.
pub(crate) fn json(mechanism: &Mechanism, options: &ScalingOptions, scaling: &Scaling) -> String {
    let space = mechanism.parameters();
    let columns: Vec<&String> = scaling
        .columns
        .iter()
        .map(|&c| &space.labels()[c])
        .collect();
    let (samples, dof) = (&scaling.samples, mechanism.independent());
    let rows = |array: &[f64], width: usize| {
        array
            .chunks_exact(width.max(1))
            .map(|row| json!(row))
            .collect::<Value>()
    };
    pretty(&json!({
        "schema": 1,
        "robot": robot::json(mechanism),
        "model": scaling.model.name(),
        "seed": options.seed,
        "target": options.target,
        "weights": options.weights,
        "before": grade(&scaling.before),
        "after": grade(&scaling.after),
        "row_S": scaling.row_s,
        "columns": columns,
        "samples": {
            "q": rows(&samples.q, mechanism.positions()),
            "qd": rows(&samples.qd, dof),
            "qdd": rows(&samples.qdd, dof),
        },
        "warnings": mechanism.description.warnings,
    }))
}

fn grade(grade: &Grade) -> Value {
    json!({
        "S": grade.s,
        "norm": grade.norm,
        "J": grade.j,
        "rank": grade.rank,
        "gap": grade.gap,
    })
}

/// The samples, as `roberval regressor` reads states.
pub(crate) fn csv(mechanism: &Mechanism, scaling: &Scaling) -> String {
    let (samples, dof) = (&scaling.samples, mechanism.independent());
    let arrays = [
        (&samples.q, mechanism.positions()),
        (&samples.qd, dof),
        (&samples.qdd, dof),
    ];
    let rows = (0..samples.count).map(|i| {
        arrays
            .iter()
            .flat_map(|(array, width)| array[i * width..(i + 1) * width].to_vec())
            .map(exact)
            .collect()
    });
    let titles = mechanism.state_titles().concat();
    csv_text(std::iter::once(titles).chain(rows))
}
