//! Relations in the field's notation:
//! `ZZR_1 = ZZ_1 + YY_2 + YY_3 + 0.4 MZ_3 + 0.2904 (M_4 + M_5 + M_6) + 0.29 M_3 + Ia_1`.

use std::cmp::Reverse;

use roberval_base::{BaseParameters, Relation};
use roberval_mechanism::ParameterKind;

use crate::escape;
use crate::number::{rounded, shortest};

/// A parameter: `ZZ_1`, or `ZZR_1` once others are regrouped into it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Label {
    pub kind: ParameterKind,
    pub regrouped: bool,
    pub link: String,
}

impl Label {
    /// The parameter of a column.
    pub fn of(answer: &BaseParameters, column: usize) -> Self {
        let id = answer.parameters.ids()[column];
        Self {
            kind: id.kind,
            regrouped: false,
            link: answer.mechanism.links[id.link].name.clone(),
        }
    }

    /// The base parameter of a column, with an R if others are regrouped into it.
    pub fn of_base(answer: &BaseParameters, column: usize) -> Self {
        Self {
            regrouped: answer.regrouped_into.contains(&column),
            ..Self::of(answer, column)
        }
    }

    /// `KIND_name` or `KINDR_name`.
    pub fn text(&self) -> String {
        let r = if self.regrouped { "R" } else { "" };
        format!("{}{r}_{}", self.kind, escape::in_relation(&self.link))
    }
}

/// Parameters of one kind with one coefficient.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Group {
    /// Rounded for display.
    pub coefficient: f64,
    pub members: Vec<Label>,
}

/// `left = first + groups`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Sum {
    pub left: Label,
    pub first: Label,
    pub groups: Vec<Group>,
}

/// The relations that are not trivial.
pub(crate) fn of(answer: &BaseParameters) -> Vec<Sum> {
    answer
        .relations()
        .iter()
        .filter(|relation| !relation.terms.is_empty())
        .map(|relation| Sum::new(answer, relation))
        .collect()
}

impl Sum {
    pub fn new(answer: &BaseParameters, relation: &Relation) -> Self {
        Self {
            left: Label::of_base(answer, relation.base),
            first: Label::of(answer, relation.base),
            groups: groups(answer, &relation.terms),
        }
    }

    /// The relation as the pieces between which a line may break.
    pub fn pieces(&self) -> Vec<String> {
        let terms = self.groups.iter().map(|group| Term {
            negative: group.coefficient < 0.0,
            factor: match group.coefficient.abs() {
                1.0 => String::new(),
                x => shortest(x),
            },
            members: &group.members,
        });
        pieces(&self.left, &self.first, terms)
    }
}

/// `+ factor (members)`
pub(crate) struct Term<'a> {
    pub negative: bool,
    /// Empty for 1.
    pub factor: String,
    pub members: &'a [Label],
}

/// `left = first + terms` as the pieces between which a line may break.
pub(crate) fn pieces<'a>(
    left: &Label,
    first: &Label,
    terms: impl Iterator<Item = Term<'a>>,
) -> Vec<String> {
    let mut pieces = vec![left.text(), "=".to_owned(), first.text()];
    for term in terms {
        let sign = if term.negative { "-" } else { "+" };
        let factor = match term.factor.is_empty() {
            true => String::new(),
            false => format!("{} ", term.factor),
        };
        let (open, close) = match term.members.len() {
            1 => ("", ""),
            _ => ("(", ")"),
        };
        let first = pieces.len();
        pieces.extend(term.members.iter().map(|m| format!("+ {}", m.text())));
        let text = term.members[0].text();
        pieces[first] = format!("{sign} {factor}{open}{text}");
        if let Some(last) = pieces.last_mut() {
            last.push_str(close);
        }
    }
    pieces
}

/// Terms by kind in the paper's order; in a kind those of equal coefficient together, the
/// largest group first, else by link. Terms with coefficient 1 or -1 need no bracket and
/// stand alone.
fn groups(answer: &BaseParameters, terms: &[(usize, f64)]) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for &(column, coefficient) in terms {
        let (member, coefficient) = (Label::of(answer, column), rounded(coefficient));
        let same = groups.iter_mut().find(|group| {
            group.coefficient == coefficient
                && coefficient.abs() != 1.0
                && group.members[0].kind == member.kind
        });
        match same {
            Some(group) => group.members.push(member),
            None => groups.push(Group {
                coefficient,
                members: vec![member],
            }),
        }
    }
    groups.sort_by_key(|group| (group.members[0].kind, Reverse(group.members.len())));
    groups
}
