//! beta as a map: rows take up columns.

use std::fmt::Write;

use roberval_base::{BaseParameters, Relation};

use super::html::{figure, short, text};
use crate::number::shortest;
use crate::relation::Label;

/// Side of a cell and about the width of a label's letter, in pixels.
const CELL: usize = 15;
const LETTER: usize = 6;

/// Longer labels are cut.
const LONGEST: usize = 15;

pub(super) fn section(answer: &BaseParameters) -> String {
    if answer.regrouped_into.is_empty() {
        return String::new();
    }
    let levels = [
        ("q4", "\u{2264} \u{2212}1"),
        ("q3", "\u{2212}0.3"),
        ("q2", "\u{2212}0.05"),
        ("q1", "\u{2212}0"),
        ("p1", "+0"),
        ("p2", "0.05"),
        ("p3", "0.3"),
        ("p4", "\u{2265} 1"),
    ];
    let scale: Vec<String> = levels
        .iter()
        .map(|(class, name)| {
            format!("<span><svg width=\"13\" height=\"13\"><rect class=\"h {class}\"/></svg>{name}</span>")
        })
        .collect();
    let caption = format!(
        "A row is a sum, a column a parameter that acts only inside sums; a cell is its coefficient: \
         a number for inertias that move along, a length for moments, a length squared for masses. \
         The other {} rows of &#946; are zero. <span class=\"scale\">{}</span>",
        answer.unchanged.len(),
        scale.concat()
    );
    format!(
        "<section><h2>The coefficients &#946;</h2>{}</section>",
        figure("Heat map of the coefficients beta", &map(answer), &caption)
    )
}

fn map(answer: &BaseParameters) -> String {
    let relations: Vec<_> = answer
        .relations()
        .into_iter()
        .filter(|r| !r.terms.is_empty())
        .collect();
    let sums: Vec<String> = relations
        .iter()
        .map(|r| Label::of_base(answer, r.base).text())
        .collect();
    let others: Vec<String> = answer
        .regrouped
        .iter()
        .map(|&c| Label::of(answer, c).text())
        .collect();
    let room = |labels: &[String]| {
        let lengths = labels.iter().map(|l| l.chars().count().min(LONGEST));
        lengths.max().unwrap_or(0) * LETTER + 14
    };
    let [left, top] = [room(&sums), room(&others)];
    let (width, height) = (
        left + others.len() * CELL + 10,
        top + sums.len() * CELL + 10,
    );
    let mut svg = format!(
        "<svg class=\"wide\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
         data-cell=\"{CELL}\" data-of=\"{}\">\
         <rect class=\"back\" x=\"{left}\" y=\"{top}\" width=\"{}\" height=\"{}\"/>",
        // A line each for the script: no label has a line break.
        others
            .iter()
            .map(|o| text(o))
            .collect::<Vec<_>>()
            .join("\n"),
        others.len() * CELL,
        sums.len() * CELL
    );
    let bases: Vec<usize> = relations.iter().map(|r| r.base).collect();
    separators(answer, &bases, [left, top], &mut svg);
    for (j, label) in others.iter().enumerate() {
        // Writing to a string does not fail.
        let _ = write!(
            svg,
            "<text class=\"tiny\" transform=\"translate({} {}) rotate(-90)\">{}</text>",
            left + j * CELL + 11,
            top - 5,
            text(&short(label, LONGEST))
        );
    }
    for (i, (relation, sum)) in relations.iter().zip(&sums).enumerate() {
        row(answer, relation, sum, [left, top + i * CELL], &mut svg);
    }
    svg + "</svg>"
}

/// A sum's name and its coefficients, from this corner.
fn row(
    answer: &BaseParameters,
    relation: &Relation,
    sum: &str,
    [left, top]: [usize; 2],
    svg: &mut String,
) {
    let _ = write!(
        svg,
        "<text class=\"tiny\" text-anchor=\"end\" x=\"{}\" y=\"{}\">{}</text>\
         <g transform=\"translate({} {})\" data-of=\"{}\">",
        left - 6,
        top + 11,
        text(&short(sum, LONGEST)),
        left + 1,
        top + 1,
        text(sum)
    );
    for (column, coefficient) in &relation.terms {
        let j = answer.regrouped.partition_point(|r| r < column);
        let _ = write!(
            svg,
            "<rect class=\"m {}\" x=\"{}\" data-v=\"{}\"/>",
            level(*coefficient),
            j * CELL,
            shortest(*coefficient),
        );
    }
    svg.push_str("</g>");
}

/// Lines between the links' blocks.
fn separators(answer: &BaseParameters, bases: &[usize], [left, top]: [usize; 2], svg: &mut String) {
    let ids = answer.parameters.ids();
    let cuts = |columns: &[usize]| -> Vec<usize> {
        let pairs = columns.windows(2).enumerate();
        pairs
            .filter(|(_, pair)| ids[pair[0]].link != ids[pair[1]].link)
            .map(|(i, _)| (i + 1) * CELL)
            .collect()
    };
    let (width, height) = (answer.regrouped.len() * CELL, bases.len() * CELL);
    for x in cuts(&answer.regrouped) {
        let _ = write!(
            svg,
            "<path class=\"sep\" d=\"M{},{top}v{height}\"/>",
            left + x
        );
    }
    for y in cuts(bases) {
        let _ = write!(
            svg,
            "<path class=\"sep\" d=\"M{left},{}h{width}\"/>",
            top + y
        );
    }
}

/// How deep the colour is.
fn level(x: f64) -> &'static str {
    let step = [0.05, 0.3, 1.0 - 1e-9]
        .iter()
        .filter(|s| x.abs() >= **s)
        .count();
    if x < 0.0 {
        ["q1", "q2", "q3", "q4"][step]
    } else {
        ["p1", "p2", "p3", "p4"][step]
    }
}
