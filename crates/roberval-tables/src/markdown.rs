//! Documents as GitHub's Markdown.

use std::fmt::Write;

use crate::document::{Block, Document, Item, Table};
use crate::escape::{markdown, markdown_code};

/// The document as Markdown.
pub(crate) fn render(document: &Document) -> String {
    let parts: Vec<String> = document.iter().map(block).collect();
    parts.join("\n")
}

fn block(block: &Block) -> String {
    match block {
        Block::Title(text) => format!("# {}\n", markdown(text)),
        Block::Heading(text) => format!("## {}\n", markdown(text)),
        Block::Lines(lines) => list(lines.iter().map(|line| markdown(line))),
        Block::Table(rows) => table(rows),
        Block::Rule(text) => format!("**{}**\n", markdown(text)),
        Block::List(lead, labels) => {
            let labels: Vec<String> = labels.iter().map(|l| markdown_code(&l.text())).collect();
            format!("{} {}\n", markdown(lead), labels.join(", "))
        }
        Block::Relations(relations) => list(
            relations
                .iter()
                .map(|r| markdown_code(&r.pieces().join(" "))),
        ),
        Block::Formulas(formulas) => list(
            formulas
                .iter()
                .map(|f| markdown_code(&f.pieces().join(" "))),
        ),
    }
}

fn list(items: impl Iterator<Item = String>) -> String {
    items.fold(String::new(), |mut text, item| {
        let _ = writeln!(text, "- {item}");
        text
    })
}

fn table(table: &Table) -> String {
    let row = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    let mut text = row(table.columns.iter().map(|c| markdown(c.title)).collect());
    let rule = |right: bool| if right { "---:" } else { ":---" };
    text += &row(table
        .columns
        .iter()
        .map(|c| rule(c.right).to_owned())
        .collect());
    for cells in &table.rows {
        text += &row(cells.iter().map(cell).collect());
    }
    text
}

fn cell(item: &Item) -> String {
    match item {
        Item::Text(text) | Item::Number(text) => markdown(text),
        Item::Mark(mark, _) => markdown(mark),
        Item::Label(label) => markdown_code(&label.text()),
    }
}
