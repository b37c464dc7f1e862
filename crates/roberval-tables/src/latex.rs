//! Documents as LaTeX to `\input`, with the packages booktabs, longtable and amsmath.

use std::fmt::Write;

use crate::document::{Block, Document, Item, Table};
use crate::escape;
use crate::number::shortest;
use crate::relation::{Group, Label, Sum, Surd};

/// The document as LaTeX.
pub(crate) fn render(document: &Document) -> String {
    let packages = "% Needs \\usepackage{booktabs,longtable,amsmath,textcomp} and, for the quotes\n\
                    % in names, \\usepackage[T1]{fontenc}.\n";
    document.iter().fold(packages.to_owned(), |mut text, part| {
        text += "\n";
        text += &block(part);
        text
    })
}

fn block(block: &Block) -> String {
    match block {
        Block::Title(text) => format!("\\subsection*{{{}}}\n", escape::latex(text)),
        Block::Heading(text) => format!("\\subsubsection*{{{}}}\n", escape::latex(text)),
        Block::Lines(lines) => paragraphs(lines.iter().map(|line| escape::latex(line))),
        Block::Table(rows) => table(rows),
        Block::Rule(text) => format!("\\noindent\\textbf{{{}}}\\par\n", escape::latex(text)),
        Block::List(lead, labels) => {
            let labels: Vec<String> = labels.iter().map(|l| format!("${}$", label(l))).collect();
            let text = format!("{} {}", escape::latex(lead), labels.join(",\n"));
            paragraphs(std::iter::once(text))
        }
        Block::Relations(relations) => {
            paragraphs(relations.iter().map(|r| format!("${}$", relation(r))))
        }
        Block::Formulas(formulas) => {
            paragraphs(formulas.iter().map(|f| format!("${}$", f.latex())))
        }
    }
}

/// Ragged paragraphs whose later lines hang; formulas break before + and -.
fn paragraphs(texts: impl Iterator<Item = String>) -> String {
    let mut out = "{\\raggedright\\setlength{\\parindent}{0pt}\n".to_owned();
    for text in texts {
        let _ = writeln!(out, "\\hangindent=2em {text}\\par");
    }
    out + "}\n"
}

fn table(table: &Table) -> String {
    let row = |cells: Vec<String>| format!("{} \\\\\n", cells.join(" & "));
    let align: String = table
        .columns
        .iter()
        .map(|c| if c.right { 'r' } else { 'l' })
        .collect();
    let mut text = "{\\small\\setlength{\\tabcolsep}{3pt}\n".to_owned();
    text += &format!("\\begin{{longtable}}{{{align}}}\n\\toprule\n");
    text += &row(table
        .columns
        .iter()
        .map(|c| escape::latex(c.title))
        .collect());
    text += "\\midrule\n\\endhead\n\\bottomrule\n\\endfoot\n";
    for cells in &table.rows {
        text += &row(cells.iter().map(cell).collect());
    }
    text + "\\end{longtable}\n}\n"
}

fn cell(item: &Item) -> String {
    match item {
        // A bracket at the start of a row would be an argument of the \\ before it.
        Item::Text(text) => format!("{{}}{}", escape::latex(text)),
        Item::Mark(mark, _) => format!("{{}}{}", escape::latex(mark)),
        Item::Number(number) => format!("${}$", power_of_ten(number)),
        Item::Label(item) => format!("${}$", label(item)),
    }
}

/// `1.2 \times 10^{-5}` for 1.2e-05.
fn power_of_ten(number: &str) -> String {
    match number.split_once('e') {
        Some((mantissa, exponent)) => match exponent.parse::<i32>() {
            Ok(exponent) => format!("{mantissa} \\times 10^{{{exponent}}}"),
            Err(_) => format!("\\text{{{}}}", escape::latex(number)),
        },
        None if number.parse::<f64>().is_ok_and(f64::is_finite) => number.to_owned(),
        None => format!("\\text{{{}}}", escape::latex(number)),
    }
}

/// `ZZ_{1}`, `ZZ_{R1}`, `ZZ_{R\,\text{left arm}}`.
pub(crate) fn label(label: &Label) -> String {
    let link = &label.link;
    let short = link.len() <= 2 && link.chars().all(|c| c.is_ascii_digit());
    let subscript = match (label.regrouped, short) {
        (false, true) => link.clone(),
        (true, true) => format!("R{link}"),
        (false, false) => format!("\\text{{{}}}", escape::latex(link)),
        (true, false) => format!("R\\,\\text{{{}}}", escape::latex(link)),
    };
    format!("{}_{{{subscript}}}", label.kind)
}

fn relation(sum: &Sum) -> String {
    let mut text = format!("{} = {}", label(&sum.left), label(&sum.first));
    for group in &sum.groups {
        text += &term(group);
    }
    text
}

/// Parameters as a sum, in brackets if there are several.
pub(crate) fn members(members: &[Label]) -> String {
    let labels: Vec<String> = members.iter().map(label).collect();
    match &labels[..] {
        [one] => one.clone(),
        _ => format!("({})", labels.join(" + ")),
    }
}

fn term(group: &Group) -> String {
    let sign = if group.coefficient < 0.0 { '-' } else { '+' };
    let members = members(&group.members);
    match (&group.exact, group.coefficient.abs()) {
        (Some(exact), _) => format!(" {sign} {}\\,{members}", surd(exact)),
        (None, 1.0) => format!(" {sign} {members}"),
        (None, x) => format!(" {sign} {}\\,{members}", power_of_ten(&shortest(x))),
    }
}

/// `\tfrac{2}{9}`, `\tfrac{\sqrt{2}}{3}`
fn surd(exact: &Surd) -> String {
    let above = match (&exact.root, exact.above.as_str()) {
        (None, above) => above.to_owned(),
        (Some(n), "1") => format!("\\sqrt{{{n}}}"),
        (Some(n), above) => format!("{above}\\sqrt{{{n}}}"),
    };
    match &exact.below {
        Some(below) => format!("\\tfrac{{{above}}}{{{below}}}"),
        None => above,
    }
}
