//! Relations in the field's notation:
//! `ZZR_1 = ZZ_1 + YY_2 + YY_3 + 0.4 MZ_3 + 0.2904 (M_4 + M_5 + M_6) + 0.29 M_3 + Ia_1`.

use std::cmp::Reverse;

use roberval_base::{BaseParameters, ExactNumber, Relation};
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
    /// Its size exactly, where that says more than the decimal.
    pub exact: Option<Surd>,
    pub members: Vec<Label>,
}

/// A fraction times a root: `2/9`, `1/3 sqrt(2)`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Surd {
    pub above: String,
    pub below: Option<String>,
    pub root: Option<String>,
}

impl Surd {
    /// The size of a number whose decimal is long and whose exact form is not.
    pub fn of(number: &str, decimal: &str) -> Option<Self> {
        /// Decimals of more characters are fractions or roots, most likely.
        const SHORT: usize = 9;
        /// Longer fractions say less than their decimals.
        const LONGEST: usize = 12;
        let number = number.trim_start_matches('-');
        let (fraction, root) = match number.split_once(" sqrt(") {
            Some((fraction, root)) => (fraction, Some(root.trim_end_matches(')').to_owned())),
            None => (number, None),
        };
        let sum = number.contains(" + ") || number.contains(" - ");
        if decimal.len() <= SHORT || sum || fraction.len() > LONGEST {
            return None;
        }
        let (above, below) = match fraction.split_once('/') {
            Some((above, below)) => (above, Some(below.to_owned())),
            None => (fraction, None),
        };
        Some(Self {
            above: above.to_owned(),
            below,
            root,
        })
    }

    /// `2/9`, `sqrt(2)/3`, `3 sqrt(2)`
    pub fn text(&self) -> String {
        let below = self
            .below
            .as_ref()
            .map_or(String::new(), |b| format!("/{b}"));
        match (&self.root, self.above.as_str()) {
            (None, above) => format!("{above}{below}"),
            (Some(n), "1") => format!("sqrt({n}){below}"),
            (Some(n), above) => format!("{above} sqrt({n}){below}"),
        }
    }
}

impl Group {
    /// The size of the coefficient in text; nothing for 1.
    pub fn factor(&self) -> String {
        match (&self.exact, self.coefficient.abs()) {
            (Some(exact), _) => exact.text(),
            (None, 1.0) => String::new(),
            (None, x) => shortest(x),
        }
    }
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
            groups: groups(answer, relation),
        }
    }

    /// The relation as the pieces between which a line may break.
    pub fn pieces(&self) -> Vec<String> {
        let terms = self.groups.iter().map(|group| Term {
            negative: group.coefficient < 0.0,
            factor: group.factor(),
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
fn groups(answer: &BaseParameters, relation: &Relation) -> Vec<Group> {
    let row = answer.base.iter().position(|&base| base == relation.base);
    let exact = |column: usize| -> Option<&ExactNumber> {
        let place = answer.regrouped.iter().position(|&x| x == column)?;
        let number = answer.beta_exact.as_ref()?.get(row?)?.get(place)?;
        number.is_exact().then_some(number)
    };
    let mut groups: Vec<Group> = Vec::new();
    for &(column, coefficient) in &relation.terms {
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
                exact: exact(column)
                    .and_then(|number| Surd::of(&number.to_string(), &shortest(coefficient.abs()))),
                members: vec![member],
            }),
        }
    }
    groups.sort_by_key(|group| (group.members[0].kind, Reverse(group.members.len())));
    groups
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_decimals_are_short_fractions_and_roots_where_these_are_known() {
        let text = |number, decimal| Surd::of(number, decimal).map(|exact| exact.text());
        assert_eq!(text("-2/9", "0.222222222222").as_deref(), Some("2/9"));
        assert_eq!(
            text("1/3 sqrt(2)", "0.471404520791").as_deref(),
            Some("sqrt(2)/3")
        );
        assert_eq!(
            text("3/2 sqrt(3)", "2.59807621135").as_deref(),
            Some("3 sqrt(3)/2")
        );
        assert_eq!(text("363/1250", "0.2904"), None);
        assert_eq!(text("1/2 + 3/4 sqrt(2)", "1.56066017178"), None);
        assert_eq!(text("123456789/1234567890123", "0.0001"), None);
        assert_eq!(text("123456789/1234567890123", "0.000100000000"), None);
    }
}
