//! All models by all engines, side by side.

use roberval_base::{Comparison, Route};
use serde_json::{Value, json};

use crate::document::{Block, Column, Document, Item, Table};
use crate::json::pretty;
use crate::number::{exact, size};
use crate::{base, csv_text, robot};

/// The comparison for people.
pub(crate) fn document(comparison: &Comparison) -> Document {
    let Some(first) = comparison.routes.first() else {
        return Vec::new();
    };
    let answer = &first.answer;
    let rows = comparison.routes.iter().map(|route| {
        let texts = texts(route);
        texts.into_iter().map(Item::Number).collect()
    });
    let mut blocks = vec![
        Block::Title(answer.mechanism.name.clone()),
        Block::Lines(vec![
            robot::joints_and_gravity(&answer.mechanism),
            format!("choice {}, seed {}", answer.choice.name(), answer.seed),
        ]),
        Block::Heading("Routes".to_owned()),
        Block::Table(Table {
            columns: vec![
                Column::left("model"),
                Column::left("engine"),
                Column::right("c"),
                Column::right("b"),
                Column::right("gap"),
                Column::right("tolerance"),
                Column::right("same columns"),
                Column::right("beta differs"),
                Column::right("residual"),
                Column::right("clear"),
            ],
            rows: rows.collect(),
            folded: false,
        }),
        Block::Heading(verdict(comparison)),
    ];
    let doubts: Vec<String> = doubts(comparison);
    if !doubts.is_empty() {
        blocks.push(Block::Lines(doubts));
    }
    blocks
}

/// A route's cells, in the order of the table's columns.
fn texts(route: &Route) -> Vec<String> {
    let answer = &route.answer;
    let yes = |yes: bool| if yes { "yes" } else { "NO" }.to_owned();
    vec![
        answer.model.name().to_owned(),
        answer.engine.name().to_owned(),
        with_effect(route).to_string(),
        answer.rank().to_string(),
        answer.diagnosis.gap.map_or("-".to_owned(), size),
        size(answer.diagnosis.tolerance),
        yes(route.same_columns),
        match route.beta_difference {
            x if x.is_finite() => size(x),
            _ => "-".to_owned(),
        },
        size(answer.diagnosis.residual),
        yes(answer.diagnosis.clear),
    ]
}

fn with_effect(route: &Route) -> usize {
    route.answer.parameters.len() - route.answer.no_effect.len()
}

/// One sentence.
pub(crate) fn verdict(comparison: &Comparison) -> String {
    let count = comparison.routes.len();
    let ranks: Vec<usize> = comparison.routes.iter().map(|r| r.answer.rank()).collect();
    let (least, most) = (ranks.iter().min(), ranks.iter().max());
    match (least, most) {
        (Some(b), _) if comparison.agree => {
            format!("All {count} routes agree: {b} base parameters.")
        }
        (Some(least), Some(most)) if least != most => {
            format!("The routes disagree: from {least} to {most} base parameters.")
        }
        (Some(b), _) if comparison.routes.iter().all(|r| r.same_columns) => {
            format!("The routes give the same {b} base parameters, but not beyond doubt.")
        }
        (Some(b), _) => format!("The routes disagree on which {b} parameters are kept."),
        _ => "There is no route to compare.".to_owned(),
    }
}

/// Every route's doubts, said once each.
pub(crate) fn doubts(comparison: &Comparison) -> Vec<String> {
    let mut doubts = Vec::new();
    let unclear = comparison
        .routes
        .iter()
        .filter(|r| !r.answer.diagnosis.clear);
    for Route { answer, .. } in unclear {
        for message in &answer.diagnosis.messages {
            let (model, engine) = (answer.model.name(), answer.engine.name());
            doubts.push(format!("{model} by {engine}: {message}"));
        }
    }
    doubts
}

/// The comparison for programs.
pub(crate) fn json(comparison: &Comparison) -> String {
    let robot = comparison
        .routes
        .first()
        .map(|r| robot::json(&r.answer.mechanism));
    let routes: Vec<Value> = comparison.routes.iter().map(route).collect();
    let first = comparison.routes.first().map(|r| &r.answer);
    pretty(&json!({
        "schema": 1,
        "robot": robot,
        "choice": first.map(|a| a.choice.name()),
        "seed": first.map(|a| a.seed),
        "agree": comparison.agree,
        "verdict": verdict(comparison),
        "routes": routes,
        "warnings": first.map(|a| &a.mechanism.description.warnings),
    }))
}

fn route(route: &Route) -> Value {
    let answer = &route.answer;
    json!({
        "model": answer.model.name(),
        "engine": answer.engine.name(),
        "rows": answer.rows,
        "with_effect": with_effect(route),
        "rank": answer.rank(),
        "same_columns": route.same_columns,
        "beta_difference": route.beta_difference,
        "no_effect": answer.labels(&answer.no_effect),
        "base": answer.labels(&answer.base),
        "regrouped": answer.labels(&answer.regrouped),
        "diagnosis": base::diagnosis(answer),
    })
}

/// The comparison as a table for programs.
pub(crate) fn csv(comparison: &Comparison) -> String {
    let header = [
        "model",
        "engine",
        "with_effect",
        "rank",
        "gap",
        "tolerance",
        "same_columns",
        "beta_difference",
        "residual",
        "clear",
    ];
    let rows = comparison.routes.iter().map(|route| {
        let diagnosis = &route.answer.diagnosis;
        vec![
            route.answer.model.name().to_owned(),
            route.answer.engine.name().to_owned(),
            with_effect(route).to_string(),
            route.answer.rank().to_string(),
            diagnosis.gap.map_or(String::new(), exact),
            exact(diagnosis.tolerance),
            route.same_columns.to_string(),
            exact(route.beta_difference),
            exact(diagnosis.residual),
            diagnosis.clear.to_string(),
        ]
    });
    csv_text(std::iter::once(header.map(str::to_owned).to_vec()).chain(rows))
}
