//! Relations in symbols: `XXR_2 = XX_2 - YY_2 - D3^2 (M_3 + M_4)`.

mod document;
mod json;

use roberval_symbolic::{Coefficient, Factored, Notation, Open, Origin, SymbolicRelations};

pub(crate) use document::document;
pub(crate) use json::json;

use crate::number::size;
use crate::relation::{Label, Term, pieces};
use crate::report::html::text as html;
use crate::{csv_text, escape, latex};

/// `left = first + terms`.
#[derive(Debug, Clone)]
pub(crate) struct Formula {
    left: Label,
    first: Label,
    /// The column of `first`.
    base: usize,
    groups: Vec<Group>,
    /// Letters of the rules that made it; empty where they are told otherwise.
    made_by: String,
}

/// Parameters of one kind with one coefficient.
#[derive(Debug, Clone)]
struct Group {
    /// Or the symbols it depends on, and why it is no more than that.
    coefficient: Result<Factored, (Vec<String>, Open)>,
    members: Vec<Label>,
    columns: Vec<usize>,
}

impl Formula {
    /// The formula as the pieces between which a line may break.
    pub fn pieces(&self) -> Vec<String> {
        let groups = self.groups.iter().map(|group| Term {
            negative: group.negative(),
            factor: group.factor(Notation::Text),
            members: &group.members,
        });
        let mut pieces = pieces(&self.left, &self.first, groups);
        if !self.made_by.is_empty() {
            pieces.push(format!("[{}]", self.made_by));
        }
        pieces
    }

    /// The formula in LaTeX.
    pub fn latex(&self) -> String {
        let mut text = format!(
            "{} = {}",
            latex::label(&self.left),
            latex::label(&self.first)
        );
        for group in &self.groups {
            let sign = if group.negative() { '-' } else { '+' };
            let factor = match group.factor(Notation::Latex) {
                factor if factor.is_empty() => factor,
                factor => factor + "\\,",
            };
            text += &format!(" {sign} {factor}{}", latex::members(&group.members));
        }
        if !self.made_by.is_empty() {
            text += &format!("\\quad[\\text{{{}}}]", self.made_by);
        }
        text
    }

    /// The formula in HTML; a line may break before its signs.
    pub fn html(&self) -> String {
        let label = |label: &Label| {
            let r = if label.regrouped { "R" } else { "" };
            let link = html(&escape::plain(&label.link));
            format!("{}{r}<sub>{link}</sub>", label.kind)
        };
        let mut text = format!("{}\u{a0}=\u{a0}{}", label(&self.left), label(&self.first));
        for group in &self.groups {
            let sign = if group.negative() { "\u{2212}" } else { "+" };
            let factor = match group.factor(Notation::Html) {
                factor if factor.is_empty() => factor,
                factor => factor + "\u{a0}",
            };
            let members: Vec<String> = group.members.iter().map(label).collect();
            let members = match &members[..] {
                [one] => one.clone(),
                _ => format!("({})", members.join(" +\u{a0}")),
            };
            text += &format!(" {sign}\u{a0}{factor}{members}");
        }
        text
    }

    /// The right side for SymPy, with these names of the columns.
    fn sympy(&self, names: &[String]) -> String {
        let mut text = names[self.base].clone();
        for group in &self.groups {
            let sign = if group.negative() { '-' } else { '+' };
            let members: Vec<&str> = group.columns.iter().map(|&c| names[c].as_str()).collect();
            let sum = match &members[..] {
                [one] => (*one).to_owned(),
                _ => format!("({})", members.join(" + ")),
            };
            text += &match group.factor(Notation::SymPy) {
                factor if factor.is_empty() => format!(" {sign} {sum}"),
                factor => format!(" {sign} {factor}*{sum}"),
            };
        }
        text
    }
}

impl Formula {
    /// The places of the rules that bring its terms.
    fn made_by(&self, origins: &[(Origin, Vec<usize>)]) -> Vec<usize> {
        let mut columns = self.groups.iter().flat_map(|g| &g.columns);
        let all: Vec<&usize> = columns.by_ref().collect();
        let brings =
            |(_, (_, gone)): &(usize, &(Origin, Vec<usize>))| gone.iter().any(|c| all.contains(&c));
        let made = origins.iter().enumerate().filter(brings);
        made.map(|(at, _)| at).collect()
    }
}

impl Group {
    fn negative(&self) -> bool {
        self.coefficient.as_ref().is_ok_and(|c| c.negative)
    }

    fn factor(&self, notation: Notation) -> String {
        match &self.coefficient {
            Ok(factored) => factored.text(notation),
            Err((symbols, _)) => {
                let of = symbols.join(", ");
                match notation {
                    Notation::Latex => format!("f(\\text{{{}}})", escape::latex(&of)),
                    Notation::Html => format!("<i>f</i>({})", html(&of)),
                    _ => format!("f({of})"),
                }
            }
        }
    }
}

/// The relations that are not trivial.
pub(crate) fn formulas(answer: &SymbolicRelations) -> Vec<Formula> {
    let rows = answer.base.iter().zip(&answer.beta);
    let rows = rows.filter(|(_, row)| row.iter().any(Option::is_some));
    rows.map(|(&base, row)| Formula {
        left: label(answer, base, true),
        first: label(answer, base, false),
        base,
        groups: groups(answer, row),
        made_by: String::new(),
    })
    .collect()
}

fn label(answer: &SymbolicRelations, column: usize, regrouped: bool) -> Label {
    let id = answer.parameters.ids()[column];
    Label {
        kind: id.kind,
        regrouped,
        link: answer.mechanism.links[id.link].name.clone(),
    }
}

/// Terms by kind in the paper's order; in a kind those of equal coefficient together, by
/// link. Terms with coefficient 1 or -1 need no bracket and stand alone.
fn groups(answer: &SymbolicRelations, row: &[Option<Coefficient>]) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for (&column, coefficient) in answer.regrouped.iter().zip(row) {
        let Some(coefficient) = coefficient else {
            continue;
        };
        let member = label(answer, column, false);
        let coefficient = match coefficient {
            Coefficient::Open { symbols, why } => Err((symbols.clone(), *why)),
            quotient => Factored::of(quotient, &answer.variables)
                .ok_or_else(|| (Vec::new(), Open::NotPolynomial)),
        };
        let bracket = coefficient.as_ref().is_ok_and(|c| !c.is_unit());
        let same = groups.iter_mut().find(|group| {
            bracket && group.coefficient == coefficient && group.members[0].kind == member.kind
        });
        match same {
            Some(group) => {
                group.members.push(member);
                group.columns.push(column);
            }
            None => groups.push(Group {
                coefficient,
                members: vec![member],
                columns: vec![column],
            }),
        }
    }
    groups.sort_by_key(|group| group.members[0].kind);
    groups
}

/// The parameters that go, by the rule or elimination that removes them.
fn origins(answer: &SymbolicRelations) -> Vec<(Origin, Vec<usize>)> {
    let mut all: Vec<(Origin, Vec<usize>)> = Vec::new();
    for &(column, origin) in &answer.origins {
        match all.iter_mut().find(|(o, _)| *o == origin) {
            Some((_, columns)) => columns.push(column),
            None => all.push((origin, vec![column])),
        }
    }
    all.sort_by_key(|(origin, _)| *origin);
    all
}

/// How sure it is.
pub(crate) fn verified(answer: &SymbolicRelations) -> String {
    format!(
        "Verified at random values in {} prime fields, failure probability below {}",
        answer.verification.primes.len(),
        size(answer.verification.failure_probability)
    )
}

/// The sums, one row a term: `base = sum(sign * coefficient * parameter)`.
pub(crate) fn csv(answer: &SymbolicRelations) -> String {
    let labels = answer.parameters.labels();
    let header = ["base", "parameter", "sign", "coefficient"];
    let mut records = vec![header.map(str::to_owned).to_vec()];
    let mut term = |base: usize, column: usize, sign: &str, factor: String| {
        let [base, column] = [base, column].map(|c| escape::csv_cell(&labels[c]));
        let factor = match factor.is_empty() {
            true => "1".to_owned(),
            false => escape::csv_cell(&factor),
        };
        records.push(vec![base, column, sign.to_owned(), factor]);
    };
    for (&base, row) in answer.base.iter().zip(&answer.beta) {
        term(base, base, "1", String::new());
        for group in groups(answer, row) {
            let sign = if group.negative() { "-1" } else { "1" };
            for &column in &group.columns {
                term(base, column, sign, group.factor(Notation::SymPy));
            }
        }
    }
    csv_text(records)
}

/// Names of the parameters for SymPy: `ZZ_1`, or `ZZ_link1` where the link's name is no
/// identifier or a constant has that name.
fn sympy_names(answer: &SymbolicRelations) -> Vec<String> {
    let ids = answer
        .parameters
        .ids()
        .iter()
        .zip(answer.parameters.labels());
    ids.map(|(id, label)| {
        let plain = label.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        let taken = answer.named.symbols.iter().any(|s| s.name == *label);
        match plain && !taken {
            true => label.clone(),
            false => format!("{}_link{}", id.kind, id.link + 1),
        }
    })
    .collect()
}

/// The relations as a Python module for SymPy.
pub(crate) fn sympy(answer: &SymbolicRelations) -> String {
    let (formulas, names) = (formulas(answer), sympy_names(answer));
    let mut text = format!(
        "# {}.\nfrom sympy import Function, Rational, cos, sin, symbols\n\n",
        verified(answer)
    );
    let mut groups = formulas.iter().flat_map(|f| &f.groups);
    if groups.any(|g| g.coefficient.is_err()) {
        text += "f = Function(\"f\")  # of what has no formula in symbols\n";
    }
    for symbol in &answer.named.symbols {
        let name = Notation::SymPy.name(&symbol.shown);
        text += &format!("{name} = symbols(\"{}\", real=True)\n", symbol.name);
    }
    let used = |c: &usize| {
        let in_groups =
            |f: &Formula| f.base == *c || f.groups.iter().any(|g| g.columns.contains(c));
        formulas.iter().any(in_groups)
    };
    let used: Vec<&str> = (0..names.len())
        .filter(used)
        .map(|c| names[c].as_str())
        .collect();
    text.extend(
        used.iter()
            .map(|name| format!("{name} = symbols(\"{name}\")\n")),
    );
    text += "\nrelations = {\n";
    for formula in &formulas {
        text += &format!(
            "    \"{}\": {},\n",
            names[formula.base],
            formula.sympy(&names)
        );
    }
    text + "}\n"
}
