//! What generated code costs.

use roberval_code::{Code, Count};
use serde_json::{Value, json};

use crate::csv_text;
use crate::document::{Block, Column, Document, Item, Table};
use crate::escape::csv_cell;
use crate::json::pretty;

/// Standard and reduced model side by side, link by link.
pub(crate) fn document(standard: &Code, base: &Code) -> Document {
    let mut columns = vec![Column::left("link")];
    let titles = [
        "standard mul",
        "standard add",
        "standard trig",
        "base mul",
        "base add",
        "base trig",
    ];
    columns.extend(titles.map(Column::right));
    let row = |name: &str, counts: [Count; 2]| {
        let numbers = counts.into_iter().flat_map(|c| [c.mul, c.add, c.trig]);
        let numbers = numbers.map(|n| Item::Number(n.to_string()));
        std::iter::once(Item::text(name)).chain(numbers).collect()
    };
    let links = standard
        .count_by_link()
        .into_iter()
        .zip(base.count_by_link());
    let mut rows: Vec<Vec<Item>> = base
        .links
        .iter()
        .zip(links)
        .map(|(name, (a, b))| row(name, [a, b]))
        .collect();
    rows.push(row("a state", [standard.count(), base.count()]));
    rows.push(row("once", [standard.count_once(), base.count_once()]));
    let (a, b) = (standard.count().arithmetic(), base.count().arithmetic());
    vec![
        Block::Title(base.robot.clone()),
        Block::Lines(vec![
            format!("Operations of {}", base.what.name()),
            format!(
                "{} standard parameters: {a} multiplications and additions a state",
                standard.parameters.len()
            ),
            format!(
                "{} base parameters: {b} multiplications and additions a state",
                base.parameters.len()
            ),
            "\"once\" is done once for a set of parameters, not at every state".to_owned(),
        ]),
        Block::Table(Table {
            columns,
            rows,
            folded: false,
        }),
    ]
}

/// The same with a row for each link, then for all of a state and once.
pub(crate) fn csv(standard: &Code, base: &Code) -> String {
    let mut header = vec!["part".to_owned(), "link".to_owned()];
    for model in ["standard", "reduced"] {
        header.extend(["mul", "add", "trig"].map(|what| format!("{model}_{what}")));
    }
    let row = |part: &str, link: &str, counts: [Count; 2]| -> Vec<String> {
        let numbers = counts.into_iter().flat_map(|c| [c.mul, c.add, c.trig]);
        let words = [part.to_owned(), csv_cell(link)].into_iter();
        words.chain(numbers.map(|n| n.to_string())).collect()
    };
    let by_link = standard.count_by_link().into_iter();
    let links = base.links.iter().zip(by_link.zip(base.count_by_link()));
    let mut records: Vec<Vec<String>> = vec![header];
    records.extend(links.map(|(link, (a, b))| row("link", link, [a, b])));
    records.push(row("state", "", [standard.count(), base.count()]));
    records.push(row("once", "", [standard.count_once(), base.count_once()]));
    csv_text(records)
}

/// The same for programs.
pub(crate) fn json(standard: &Code, base: &Code) -> String {
    let count = |c: Count| json!({"mul": c.mul, "add": c.add, "trig": c.trig});
    let model = |code: &Code| {
        let by_link = code.count_by_link().into_iter().map(count);
        let links: Vec<Value> = code
            .links
            .iter()
            .zip(by_link)
            .map(|(name, count)| json!({"link": name, "count": count}))
            .collect();
        json!({
            "parameters": code.parameters,
            "state": count(code.count()),
            "once": count(code.count_once()),
            "links": links,
        })
    };
    pretty(&json!({
        "schema": crate::SCHEMA,
        "robot": base.robot,
        "what": base.what.name(),
        "standard": model(standard),
        "reduced": model(base),
    }))
}
