use roberval_base::BaseParameters;

use super::{Class, values};
use crate::escape::csv_cell;
use crate::number::exact;
use crate::relation;

/// One row for each standard parameter; see [`crate::base`].
pub(crate) fn csv(answer: &BaseParameters) -> String {
    let labels = answer.parameters.labels();
    let mut header: Vec<String> = ["label", "kind", "link", "class", "X", "XB", "relation"]
        .map(str::to_owned)
        .to_vec();
    let into = answer.regrouped_into.iter();
    header.extend(into.map(|&c| csv_cell(&labels[c])));
    let rows = rows(answer);
    crate::csv_text(std::iter::once(header).chain(rows))
}

fn rows(answer: &BaseParameters) -> impl Iterator<Item = Vec<String>> {
    let (labels, ids) = (answer.parameters.labels(), answer.parameters.ids());
    let classes = Class::all(answer);
    let (x, xb) = texts(answer);
    let relations = relation_texts(answer);
    let columns = coefficients(answer);
    (0..labels.len()).map(move |c| {
        let mut row = vec![
            csv_cell(&labels[c]),
            ids[c].kind.name().to_owned(),
            csv_cell(&answer.mechanism.links[ids[c].link].name),
            classes[c].name().to_owned(),
            x[c].clone(),
            xb[c].clone(),
            relations[c].clone(),
        ];
        row.extend(columns.iter().map(|column| exact(column[c])));
        row
    })
}

/// X and XB at their parameters, empty where unknown.
fn texts(answer: &BaseParameters) -> (Vec<String>, Vec<String>) {
    let empty = vec![String::new(); answer.parameters.len()];
    let (mut x_texts, mut xb_texts) = (empty.clone(), empty);
    if let Some((x, xb)) = values(answer) {
        x_texts = x.iter().map(|x| exact(*x)).collect();
        for (&column, value) in answer.base.iter().zip(&xb) {
            xb_texts[column] = exact(*value);
        }
    }
    (x_texts, xb_texts)
}

fn relation_texts(answer: &BaseParameters) -> Vec<String> {
    let mut texts = vec![String::new(); answer.parameters.len()];
    let sums = relation::of(answer);
    for (&column, sum) in answer.regrouped_into.iter().zip(&sums) {
        texts[column] = csv_cell(&sum.pieces().join(" "));
    }
    texts
}

/// For each base parameter that others regroup into, the coefficients of its sum.
fn coefficients(answer: &BaseParameters) -> Vec<Vec<f64>> {
    let relations = answer.relations().into_iter();
    relations
        .filter(|relation| !relation.terms.is_empty())
        .map(|relation| {
            let mut column = vec![0.0; answer.parameters.len()];
            column[relation.base] = 1.0;
            for (c, coefficient) in relation.terms {
                column[c] = coefficient;
            }
            column
        })
        .collect()
}
