//! The built-in robots.

use serde_json::{Value, json};

use crate::document::{Block, Column, Document, Item, Table};
use crate::json::pretty;
use crate::{RobotEntry, csv_text};

pub(crate) fn document(robots: &[RobotEntry<'_>]) -> Document {
    let rows = robots
        .iter()
        .map(|robot| vec![Item::text(robot.name), Item::text(robot.title)]);
    let sources = robots.iter().map(|r| format!("{}: {}", r.name, r.source));
    vec![
        Block::Title("Built-in robots".to_owned()),
        Block::Table(Table {
            columns: vec![Column::left("name"), Column::left("robot")],
            rows: rows.collect(),
            folded: false,
        }),
        Block::Heading("Sources".to_owned()),
        Block::Lines(sources.collect()),
    ]
}

pub(crate) fn json(robots: &[RobotEntry<'_>]) -> String {
    let rows: Vec<Value> = robots
        .iter()
        .map(|r| json!({"name": r.name, "title": r.title, "source": r.source}))
        .collect();
    pretty(&json!({"schema": 1, "robots": rows}))
}

pub(crate) fn csv(robots: &[RobotEntry<'_>]) -> String {
    let header = ["name", "title", "source"].map(str::to_owned).to_vec();
    let row = |r: &RobotEntry<'_>| [r.name, r.title, r.source].map(str::to_owned).to_vec();
    csv_text(std::iter::once(header).chain(robots.iter().map(row)))
}
