//! The known inertial parameters of the links in somebody's order, a row a link.

use roberval_mechanism::{Convention, Mechanism};
use serde_json::{Map, Value, json};

use crate::csv_text;
use crate::document::{Block, Column, Document, Item, Table};
use crate::escape::csv_cell;
use crate::json::pretty;
use crate::number::{exact, size};

/// The columns: the convention's, then the rotor inertia, which is the same everywhere.
fn titles(convention: Convention) -> Vec<&'static str> {
    let rotor = match convention {
        Convention::Paper | Convention::Urdf => "Ia",
        Convention::Pinocchio | Convention::Mujoco => "armature",
    };
    let columns = convention.columns().iter().copied();
    columns.chain([rotor]).collect()
}

/// A row a link, numbers where they are known. The order alone needs not all ten.
fn rows(mechanism: &Mechanism, convention: Convention) -> Vec<(&str, Vec<Option<f64>>)> {
    let count = convention.columns().len();
    let links = mechanism.links.iter();
    links
        .map(|link| {
            let known: [Option<f64>; 10] = std::array::from_fn(|k| link.inertia[k]);
            let ten = link.ten_parameters();
            let mut row = match ten.and_then(|ten| convention.of_paper(&ten)) {
                Some(numbers) => numbers.into_iter().map(Some).collect(),
                None if convention == Convention::Paper => known.to_vec(),
                None => vec![None; count],
            };
            row.push(link.inertia[10]);
            (link.name.as_str(), row)
        })
        .collect()
}

pub(crate) fn document(mechanism: &Mechanism, convention: Convention) -> Document {
    let mut columns = vec![Column::left("link")];
    columns.extend(titles(convention).into_iter().map(Column::right));
    let rows = rows(mechanism, convention)
        .into_iter()
        .map(|(link, numbers)| {
            let mut row = vec![Item::text(link)];
            row.extend(
                numbers
                    .iter()
                    .map(|x| Item::Number(x.map_or(String::new(), size))),
            );
            row
        });
    vec![
        Block::Title(mechanism.name.clone()),
        Block::Lines(vec![
            format!("Order {}: {}.", convention.name(), convention.place()),
            "SI units; links without all ten values are empty; every digit with --format csv or json"
                .to_owned(),
        ]),
        Block::Table(Table {
            columns,
            rows: rows.collect(),
            folded: false,
        }),
    ]
}

pub(crate) fn json(mechanism: &Mechanism, convention: Convention) -> String {
    let links = rows(mechanism, convention).into_iter();
    let links: Map<String, Value> = links
        .map(|(link, row)| (link.to_owned(), json!(row)))
        .collect();
    pretty(&json!({
        "schema": crate::SCHEMA,
        "order": convention.name(),
        "place": convention.place(),
        "columns": titles(convention),
        "links": links,
    }))
}

pub(crate) fn csv(mechanism: &Mechanism, convention: Convention) -> String {
    let mut header = vec!["link".to_owned()];
    header.extend(titles(convention).into_iter().map(str::to_owned));
    let rows = rows(mechanism, convention)
        .into_iter()
        .map(|(link, numbers)| {
            let mut row = vec![csv_cell(link)];
            row.extend(numbers.iter().map(|x| x.map_or(String::new(), exact)));
            row
        });
    csv_text(std::iter::once(header).chain(rows))
}
