//! A robot as it is understood, with its geometry as written.

use roberval_mechanism::{Geometry, JointKind, Link, LinkDescription, Mechanism, ParameterKind};

use crate::document::{Block, Column, Document, Item, Table};
use crate::escape::csv_cell;
use crate::number::{exact, shortest};
use crate::relation::Label;
use crate::{couples, csv_text, robot};

mod json;

pub(crate) use json::json;

/// The robot for people.
pub(crate) fn document(mechanism: &Mechanism) -> Document {
    let mut lines = vec![
        robot::joints_and_gravity(mechanism),
        format!(
            "{}, {} standard parameters",
            variables(mechanism),
            mechanism.parameters().len()
        ),
    ];
    lines.extend(couples::lines(mechanism));
    let mut blocks = vec![
        Block::Title(mechanism.name.clone()),
        Block::Lines(lines),
        Block::Heading("Links".to_owned()),
        Block::Table(links(mechanism)),
    ];
    blocks.extend(constants(mechanism));
    blocks.push(Block::Heading(
        "Geometry as written (lengths in m, angles in rad unless marked)".to_owned(),
    ));
    blocks.extend(geometry(mechanism));
    blocks.extend(inertia(mechanism));
    let warnings = &mechanism.description.warnings;
    if !warnings.is_empty() {
        blocks.push(Block::Heading("Warnings".to_owned()));
        blocks.push(Block::Lines(warnings.clone()));
    }
    blocks
}

/// `6 joint variables`, with the rows of a base where there is one.
fn variables(mechanism: &Mechanism) -> String {
    let n = mechanism.dof();
    if !mechanism.is_floating() {
        return format!("{n} joint variables");
    }
    let rows = mechanism.row_names();
    format!(
        "{} joint variables and a base with 6; rows {} .. {} are the force and moment on it, in its frame",
        n - 6,
        rows[0],
        rows[5]
    )
}

/// The links in parameter order, each with its description.
fn described(mechanism: &Mechanism) -> impl Iterator<Item = (&Link, &LinkDescription)> {
    let links = mechanism.links.iter();
    links.map(|link| (link, &mechanism.description.links[link.in_file]))
}

fn antecedent(mechanism: &Mechanism, link: &Link) -> String {
    let name = |a: usize| mechanism.links[a].name.clone();
    link.antecedent.map_or("(base)".to_owned(), name)
}

fn links(mechanism: &Mechanism) -> Table {
    let space = mechanism.parameters();
    let mut variables = 0;
    let rows = mechanism.links.iter().enumerate().map(|(j, link)| {
        let first = space.first_column(j);
        let count = link.columns();
        let numbers = match link.joint {
            JointKind::Floating => 7,
            kind => kind.dof(),
        };
        variables += numbers;
        let yes = |yes: bool| Item::text(if yes { "yes" } else { "" });
        vec![
            Item::text(&link.name),
            Item::text(antecedent(mechanism, link)),
            Item::text(link.joint_name.as_deref().unwrap_or("")),
            Item::text(link.joint.name()),
            Item::text(match numbers {
                0 => String::new(),
                1 => format!("q_{variables}"),
                n => format!("q_{}..q_{variables}", variables + 1 - n),
            }),
            yes(link.active),
            yes(link.rotor),
            Item::text(match count {
                0 => String::new(),
                _ => format!("{}..{}", first + 1, first + count),
            }),
        ]
    });
    Table {
        columns: [
            "link", "on", "joint", "type", "variable", "active", "rotor", "columns",
        ]
        .map(Column::left)
        .to_vec(),
        rows: rows.collect(),
        folded: false,
    }
}

fn constants(mechanism: &Mechanism) -> Document {
    let constants = &mechanism.description.constants;
    if constants.is_empty() {
        return Vec::new();
    }
    let rows = constants.iter().map(|(name, value)| {
        vec![
            Item::text(name),
            Item::text(&value.text),
            Item::Number(shortest(value.value)),
        ]
    });
    vec![
        Block::Heading("Constants".to_owned()),
        Block::Table(Table {
            columns: vec![
                Column::left("name"),
                Column::left("as written"),
                Column::right("value"),
            ],
            rows: rows.collect(),
            folded: false,
        }),
    ]
}

/// One table for links with modified Denavit-Hartenberg parameters, one for placed ones.
fn geometry(mechanism: &Mechanism) -> Document {
    let mut mdh: Vec<Vec<Item>> = Vec::new();
    let mut placed: Vec<Vec<Item>> = Vec::new();
    for (link, written) in described(mechanism) {
        match &written.geometry {
            Geometry::Mdh(g) => {
                let numbers = [&g.gamma, &g.b, &g.alpha, &g.d, &g.theta, &g.r];
                let mut row = vec![Item::text(&link.name)];
                row.extend(numbers.map(|x| Item::text(&x.text)));
                mdh.push(row);
            }
            Geometry::Placed { origins, axis } => {
                let text = |xyz: &[roberval_scalar::Quantity; 3]| {
                    Item::text(xyz.each_ref().map(|x| x.text.as_str()).join(" "))
                };
                for (i, origin) in origins.iter().enumerate() {
                    let last = i + 1 == origins.len();
                    placed.push(vec![
                        Item::text(if i == 0 { link.name.as_str() } else { "" }),
                        Item::text(&origin.joint),
                        text(&origin.xyz),
                        text(&origin.rpy),
                        if last { text(axis) } else { Item::text("") },
                    ]);
                }
            }
        }
    }
    let tables = [
        (&["link", "gamma", "b", "alpha", "d", "theta", "r"][..], mdh),
        (&["link", "placed by", "xyz", "rpy", "axis"][..], placed),
    ];
    let tables = tables.into_iter().filter(|(_, rows)| !rows.is_empty());
    tables
        .map(|(titles, rows)| {
            let columns = titles.iter().map(|t| Column::left(t)).collect();
            Block::Table(Table {
                columns,
                rows,
                folded: false,
            })
        })
        .collect()
}

fn inertia(mechanism: &Mechanism) -> Document {
    let mut rows = Vec::new();
    for link in &mechanism.links {
        for (kind, value) in ParameterKind::ALL.into_iter().zip(link.inertia) {
            let label = Label {
                kind,
                regrouped: false,
                link: link.name.clone(),
            };
            rows.extend(value.map(|x| vec![Item::Label(label), Item::Number(shortest(x))]));
        }
    }
    if rows.is_empty() {
        let none = "The robot file gives no inertial parameters: the analysis needs none.";
        return vec![Block::Heading(none.to_owned())];
    }
    let mut blocks = vec![
        Block::Heading(
            "Known inertial parameters, about the origin of the link's frame (SI units)".to_owned(),
        ),
        Block::Table(Table {
            columns: vec![Column::left("parameter"), Column::right("value")],
            rows,
            folded: true,
        }),
    ];
    let unknown = |link: &&Link| link.inertia.iter().all(Option::is_none);
    let links = mechanism.links.iter().filter(unknown);
    let names: Vec<&str> = links.map(|link| link.name.as_str()).collect();
    if !names.is_empty() {
        let note = "Links without inertial values (the analysis needs none)";
        blocks.push(Block::Lines(vec![format!("{note}: {}", names.join(", "))]));
    }
    blocks
}

/// One row a link: its place in the tree, its frame's origin and its known parameters.
pub(crate) fn csv(mechanism: &Mechanism) -> String {
    let fixed = [
        "index",
        "link",
        "antecedent",
        "joint",
        "type",
        "active",
        "rotor",
        "x",
        "y",
        "z",
    ];
    let mut header: Vec<String> = fixed.map(str::to_owned).to_vec();
    header.extend(ParameterKind::ALL.map(|kind| kind.name().to_owned()));
    let rows = mechanism.links.iter().enumerate().map(|(j, link)| {
        let antecedent = link.antecedent.map_or("", |a| &mechanism.links[a].name);
        let mut row = vec![
            (j + 1).to_string(),
            csv_cell(&link.name),
            csv_cell(antecedent),
            csv_cell(link.joint_name.as_deref().unwrap_or("")),
            link.joint.name().to_owned(),
            link.active.to_string(),
            link.rotor.to_string(),
        ];
        row.extend(link.origin.iter().map(|&x| exact(x)));
        row.extend(link.inertia.map(|x| x.map_or(String::new(), exact)));
        row
    });
    csv_text(std::iter::once(header).chain(rows))
}
