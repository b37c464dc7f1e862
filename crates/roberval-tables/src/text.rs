//! Documents as plain text of at most [`WIDTH`] columns, but for tables with more numbers.

use unicode_width::{UnicodeWidthChar, UnicodeWidthStr};

use crate::WIDTH;
use crate::document::{Block, Document, Item, Table, Tint};
use crate::escape::plain;

/// Cells of folded tables are cut to this many columns (`head~tail`): one long name must
/// not unfold the table, and lists and relations have all of it.
const WIDEST_CELL: usize = 36;

/// Where a table is too wide its texts are cut, but not to less than this.
const NARROWEST_TEXT: usize = 12;

/// A number is never cut: no float has more columns, and an expression may lose its middle.
const WIDEST_NUMBER: usize = 24;

/// Lines after the first of a list or relation begin with this many blanks.
const HANG: usize = 4;

/// Between the columns of a table, and between tables side by side.
const GUTTER: &str = "  ";
const BETWEEN: &str = "    ";

/// The document as text, every line ended; with colours for a terminal if asked for.
pub(crate) fn render(document: &Document, coloured: bool) -> String {
    let paint = |tint: Tint, lines: &mut [String]| {
        for line in lines.iter_mut().filter(|_| coloured) {
            *line = tint.paint(line);
        }
    };
    let mut lines = Vec::new();
    for block in document {
        let starts_part = matches!(block, Block::Heading(_) | Block::List(..));
        if starts_part && !lines.is_empty() {
            lines.push(String::new());
        }
        match block {
            Block::Title(text) | Block::Heading(text) => {
                let start = lines.len();
                wrap(&words(text), 0, &mut lines);
                let title = matches!(block, Block::Title(_));
                let tint = if title { Tint::Title } else { Tint::Heading };
                paint(tint, &mut lines[start..]);
            }
            Block::Lines(texts) => {
                for text in texts {
                    wrap(&words(text), HANG, &mut lines);
                }
            }
            Block::Table(table) => lines.extend(set(table, coloured)),
            Block::Rule(text) => {
                lines.push(rule(text));
                if let Some(last) = lines.last_mut() {
                    paint(Tint::Keep, std::slice::from_mut(last));
                }
            }
            Block::List(lead, labels) => {
                let mut pieces = words(lead);
                let last = labels.len().saturating_sub(1);
                pieces.extend(labels.iter().enumerate().map(|(i, label)| {
                    format!("{}{}", label.text(), if i == last { "" } else { "," })
                }));
                wrap(&pieces, HANG, &mut lines);
            }
            Block::Relations(relations) => {
                for relation in relations {
                    wrap(&relation.pieces(), HANG, &mut lines);
                }
            }
            Block::Formulas(formulas) => {
                for formula in formulas {
                    wrap(&formula.pieces(), HANG, &mut lines);
                }
            }
        }
    }
    lines.iter().fold(String::new(), |mut text, line| {
        text.push_str(line.trim_end());
        text.push('\n');
        text
    })
}

fn words(text: &str) -> Vec<String> {
    plain(text).split(' ').map(str::to_owned).collect()
}

/// Pieces with blanks between them, broken into lines; a piece that fits no line is broken
/// before its signs, where that is not enough at its blanks, at last anywhere.
fn wrap(pieces: &[String], hang: usize, lines: &mut Vec<String>) {
    let mut line = String::new();
    let mut begun = false;
    let too_long = |piece: &&str| piece.width() > WIDTH - hang;
    let terms = pieces
        .iter()
        .flat_map(|piece| match too_long(&piece.as_str()) {
            true => before_signs(piece),
            false => vec![piece.as_str()],
        });
    let words = terms.flat_map(|term| match too_long(&term) {
        true => term.split(' ').collect(),
        false => vec![term],
    });
    for piece in words {
        if begun && line.width() + 1 + piece.width() <= WIDTH {
            line.push(' ');
            line.push_str(piece);
            continue;
        }
        if begun {
            lines.push(std::mem::replace(&mut line, " ".repeat(hang)));
        }
        begun = true;
        for c in piece.chars() {
            if line.width() + c.width().unwrap_or(0) > WIDTH {
                lines.push(std::mem::replace(&mut line, " ".repeat(hang)));
            }
            line.push(c);
        }
    }
    lines.push(line);
}

/// The terms of a sum, each with the sign before it.
fn before_signs(sum: &str) -> Vec<&str> {
    let sign = |at: &usize| [" + ", " - "].iter().any(|s| sum[*at..].starts_with(s));
    let blanks = sum
        .char_indices()
        .filter(|(_, c)| *c == ' ')
        .map(|(at, _)| at);
    let mut start = 0;
    let mut terms = Vec::new();
    for at in blanks.filter(sign) {
        terms.push(&sum[start..at]);
        start = at + 1;
    }
    terms.push(&sum[start..]);
    terms
}

/// `---- gap 3e13 ----`
fn rule(text: &str) -> String {
    let text = cut(&plain(text), WIDTH - 10);
    let dashes = (WIDTH - text.width()).saturating_sub(8).min(24);
    format!("---- {text} {}", "-".repeat(dashes))
}

/// The lines of a table; a folded one runs down its columns as in a newspaper.
fn set(table: &Table, coloured: bool) -> Vec<String> {
    let cells: Vec<Vec<String>> = table
        .rows
        .iter()
        .map(|row| row.iter().map(|item| cell(item, table.folded)).collect())
        .collect();
    let widths = widths(table, &cells);
    let total = widths.iter().sum::<usize>() + GUTTER.len() * (widths.len() - 1);
    let fitting = (WIDTH + BETWEEN.len()) / (total + BETWEEN.len());
    let across = if table.folded { fitting.max(1) } else { 1 };
    let down = cells.len().div_ceil(across);
    let across = cells.len().div_ceil(down.max(1)).max(1);
    let titles: Vec<String> = table.columns.iter().map(|c| c.title.to_owned()).collect();
    let one = |row: &[String], tints: &[Option<Tint>]| line(table, &widths, row, tints);
    let tints: Vec<Vec<Option<Tint>>> = table
        .rows
        .iter()
        .map(|row| {
            row.iter()
                .map(|item| tint(item).filter(|_| coloured))
                .collect()
        })
        .collect();
    let mut lines = Vec::new();
    if titles.iter().any(|title| !title.is_empty()) {
        lines.push(vec![one(&titles, &[]); across].join(BETWEEN));
    }
    for i in 0..down {
        let parts: Vec<String> = (0..across)
            .filter_map(|k| {
                let at = k * down + i;
                cells.get(at).map(|row| one(row, &tints[at]))
            })
            .collect();
        lines.push(parts.join(BETWEEN));
    }
    lines
}

fn tint(item: &Item) -> Option<Tint> {
    match item {
        Item::Mark(_, tint) => Some(*tint),
        _ => None,
    }
}

fn cell(item: &Item, folded: bool) -> String {
    let text = match item {
        Item::Text(text) | Item::Number(text) => plain(text),
        Item::Label(label) => label.text(),
        Item::Mark(mark, _) => (*mark).to_owned(),
    };
    if folded {
        cut(&text, WIDEST_CELL)
    } else {
        text
    }
}

/// The columns' widths; where they are too wide together, the widest give way as far as they
/// may: a number without its digits is none, so that a table of many is wider than the page.
fn widths(table: &Table, cells: &[Vec<String>]) -> Vec<usize> {
    let mut widths: Vec<usize> = table.columns.iter().map(|c| c.title.width()).collect();
    let mut least = widths.clone();
    for (row, items) in cells.iter().zip(&table.rows) {
        for (k, (cell, item)) in row.iter().zip(items).enumerate() {
            let most = match item {
                Item::Number(_) => WIDEST_NUMBER,
                _ => NARROWEST_TEXT,
            };
            widths[k] = widths[k].max(cell.width());
            least[k] = least[k].max(cell.width().min(most));
        }
    }
    let gutters = GUTTER.len() * widths.len().saturating_sub(1);
    while widths.iter().sum::<usize>() + gutters > WIDTH {
        let loose = (0..widths.len()).filter(|&k| widths[k] > least[k]);
        match loose.max_by_key(|&k| widths[k]) {
            Some(widest) => widths[widest] -= 1,
            None => break,
        }
    }
    widths
}

fn line(table: &Table, widths: &[usize], row: &[String], tints: &[Option<Tint>]) -> String {
    let mut cells = Vec::with_capacity(row.len());
    for (k, ((cell, &width), column)) in row.iter().zip(widths).zip(&table.columns).enumerate() {
        let cell = cut(cell, width);
        let blanks = " ".repeat(width - cell.width());
        let cell = match tints.get(k).copied().flatten() {
            Some(tint) => tint.paint(&cell),
            None => cell,
        };
        cells.push(match column.right {
            true => blanks + &cell,
            false => cell + &blanks,
        });
    }
    cells.join(GUTTER)
}

/// A text of at most `width` columns: its head, `~` and its tail.
fn cut(text: &str, width: usize) -> String {
    if text.width() <= width {
        return text.to_owned();
    }
    let tail_width = width.saturating_sub(1) / 2;
    let head_width = width.saturating_sub(1) - tail_width;
    let head = take(text.chars(), head_width);
    let tail: String = take(text.chars().rev(), tail_width).chars().rev().collect();
    format!("{head}~{tail}")
}

/// The first characters that fit into `width` columns.
fn take(characters: impl Iterator<Item = char>, width: usize) -> String {
    let mut left = width;
    characters
        .take_while(|c| match left.checked_sub(c.width().unwrap_or(0)) {
            Some(rest) => {
                left = rest;
                true
            }
            None => false,
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::Column;

    #[test]
    fn a_cut_text_keeps_head_and_tail_and_its_width() {
        assert_eq!(cut("abcdefghij", 10), "abcdefghij");
        assert_eq!(cut("abcdefghijk", 7), "abc~ijk");
        assert_eq!(
            cut("\u{8155}\u{8155}\u{8155}\u{8155}", 6),
            "\u{8155}~\u{8155}"
        );
        assert!((1..12).all(|w| cut("\u{8155}bc\u{8155}ef\u{8155}hi", w).width() <= w));
    }

    #[test]
    fn a_table_too_wide_cuts_its_names_and_no_number() {
        let mut row = vec![Item::text("a_wheel_of_the_left_side_with_a_long_name_link")];
        row.extend((0..11).map(|k| Item::Number(format!("-3.2{k}e-05"))));
        let mut columns = vec![Column::left("link")];
        columns.extend((0..11).map(|_| Column::right("XX")));
        let table = Table {
            columns,
            rows: vec![row],
            folded: false,
        };
        let text = render(&vec![Block::Table(table)], false);
        let line = text.lines().nth(1).expect("a row");
        assert!(line.starts_with("a_whee~"), "{line}");
        assert_eq!(line.matches('~').count(), 1, "{line}");
        assert!(
            (0..11).all(|k| line.contains(&format!("-3.2{k}e-05"))),
            "{line}"
        );
    }

    #[test]
    fn long_terms_are_broken_before_their_signs_then_at_blanks() {
        let factor = ["cos(A)^2 cos(B)^2 d1"; 7].join(" + ");
        let mut lines = Vec::new();
        wrap(&[format!("+ ({factor}) M_3")], 4, &mut lines);
        assert!(lines.len() > 1);
        let later = |line: &String| line.starts_with("    + cos(A)^2 cos(B)^2 d1");
        assert!(lines[1..].iter().all(later), "{lines:?}");
        let product = ["cos(A)^2"; 20].join(" ");
        let mut lines = Vec::new();
        wrap(&[product], 4, &mut lines);
        let whole = |line: &String| line.trim().split(' ').all(|word| word == "cos(A)^2");
        assert!(lines.len() > 1 && lines.iter().all(whole), "{lines:?}");
    }

    #[test]
    fn long_words_are_broken_and_later_lines_hang() {
        let mut lines = Vec::new();
        wrap(&["a".repeat(90), "b".repeat(150)], 4, &mut lines);
        assert_eq!(lines.len(), 3);
        assert!(lines.iter().all(|l| l.width() <= WIDTH));
        assert!(lines[1].starts_with("    b") && lines[2].starts_with("    b"));
    }
}
