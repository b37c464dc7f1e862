//! What was found in robot files.

use serde_json::{Value, json};

use crate::document::{Block, Column, Document, Item, Table, Tint};
use crate::escape::csv_cell;
use crate::json::pretty;
use crate::{FindingRow, csv_text};

/// A line each, as compilers write them.
pub(crate) fn text(findings: &[FindingRow], coloured: bool) -> String {
    findings.iter().fold(String::new(), |mut lines, finding| {
        let line = &finding.line_of_text;
        let word = format!(": {}: ", finding.severity);
        let colour = match finding.severity {
            "error" => Tint::Bad,
            _ => Tint::Away,
        };
        if coloured {
            let tinted = format!(": {}: ", colour.paint(finding.severity));
            lines.push_str(&line.replacen(&word, &tinted, 1));
        } else {
            lines.push_str(line);
        }
        lines.push('\n');
        lines
    })
}

pub(crate) fn document(findings: &[FindingRow]) -> Document {
    let rows = findings.iter().map(|f| {
        let place = match f.line {
            Some(line) => format!("{}:{line}", f.file),
            None => f.file.clone(),
        };
        vec![
            Item::text(place),
            Item::text(f.severity),
            Item::text(&f.rule),
            Item::text(&f.what),
            Item::text(&f.remedy),
        ]
    });
    vec![
        Block::Title("Findings in robot files".to_owned()),
        Block::Table(Table {
            columns: ["place", "severity", "rule", "what", "remedy"]
                .map(Column::left)
                .to_vec(),
            rows: rows.collect(),
            folded: false,
        }),
    ]
}

pub(crate) fn json(findings: &[FindingRow]) -> String {
    let rows: Vec<Value> = findings
        .iter()
        .map(|f| {
            json!({
                "file": f.file,
                "line": f.line,
                "column": f.column,
                "severity": f.severity,
                "rule": f.rule,
                "what": f.what,
                "remedy": f.remedy,
            })
        })
        .collect();
    pretty(&json!({"schema": crate::SCHEMA, "findings": rows}))
}

pub(crate) fn csv(findings: &[FindingRow]) -> String {
    let header = [
        "file", "line", "column", "severity", "rule", "what", "remedy",
    ];
    let number = |x: Option<u32>| x.map_or(String::new(), |x| x.to_string());
    let rows = findings.iter().map(|f| {
        vec![
            csv_cell(&f.file),
            number(f.line),
            number(f.column),
            f.severity.to_owned(),
            f.rule.clone(),
            csv_cell(&f.what),
            csv_cell(&f.remedy),
        ]
    });
    csv_text(std::iter::once(header.map(str::to_owned).to_vec()).chain(rows))
}
