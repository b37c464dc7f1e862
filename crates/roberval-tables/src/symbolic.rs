//! Relations in symbols: `XXR_2 = XX_2 - YY_2 - D3^2 (M_3 + M_4)`.

use roberval_symbolic::{
    Coefficient, Factored, Notation, Origin, Route, Special, SymbolKind, SymbolicRelations,
};
use serde_json::{Map, Value, json};

use crate::document::{Block, Document};
use crate::json::pretty;
use crate::number::size;
use crate::relation::{Label, Term, pieces};
use crate::{csv_text, escape, latex, robot};

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
    /// `None`: no polynomial; with the symbols it depends on.
    coefficient: Result<Factored, Vec<String>>,
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
            Err(symbols) => {
                let of = symbols.join(", ");
                match notation {
                    Notation::Latex => format!("f(\\text{{{}}})", escape::latex(&of)),
                    _ => format!("f({of})"),
                }
            }
        }
    }
}

/// The relations that are not trivial.
fn formulas(answer: &SymbolicRelations) -> Vec<Formula> {
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
            Coefficient::Open(symbols) => Err(symbols.clone()),
            quotient => Factored::of(quotient, &answer.variables).ok_or_else(Vec::new),
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

/// The answer for people.
pub(crate) fn document(answer: &SymbolicRelations) -> Document {
    let origins = origins(answer);
    let mut formulas = formulas(answer);
    for formula in &mut formulas {
        formula.made_by = letters(&formula.made_by(&origins));
    }
    let mut lines = vec![robot::joints_and_gravity(&answer.mechanism)];
    lines.extend(symbols(answer));
    lines.extend(tally(answer));
    lines.push(format!(
        "Verified at random values in {} prime fields, failure probability below {}",
        answer.verification.primes.len(),
        size(answer.verification.failure_probability)
    ));
    lines.extend(
        answer
            .named
            .notes
            .iter()
            .map(|note| format!("note: {note}")),
    );
    lines.extend(specials(answer));
    lines.extend(quotients(answer));
    lines.extend(open(&formulas));
    let mut blocks = vec![
        Block::Title(answer.mechanism.name.clone()),
        Block::Lines(lines),
        Block::Heading("Relations".to_owned()),
        Block::Formulas(formulas),
        Block::Heading("Where they come from".to_owned()),
    ];
    let lists = origins
        .into_iter()
        .enumerate()
        .map(|(at, (origin, columns))| {
            let labels = columns.iter().map(|&c| label(answer, c, false)).collect();
            Block::List(format!("[{}] {origin}:", letters(&[at])), labels)
        });
    blocks.extend(lists);
    blocks
}

/// How many parameters there are of each kind.
fn tally(answer: &SymbolicRelations) -> Vec<String> {
    let (gone, idle) = (answer.regrouped.len(), answer.no_effect.len());
    let others = format!("{gone} regrouped away, {idle} without effect");
    let left = answer.base.len();
    if answer.route == Route::Whole {
        let base = "base parameters for generic values of the symbols";
        return vec![format!("{left} {base}; {others}")];
    }
    let all = answer.parameters.len();
    let then = match &answer.left_over[..] {
        [] => format!("The numerical method on these {left} removes none: they are the base"),
        more => {
            let labels = more.iter().map(|&c| label(answer, c, false).text());
            let labels = labels.collect::<Vec<_>>().join(", ");
            let base = left - more.len();
            let count = more.len();
            format!(
                "The numerical method on these {left} removes {count} ({labels}): {base} are base"
            )
        }
    };
    let rules = "The closed-form rules alone, for generic values of the symbols, leave";
    vec![
        format!("{rules} {left} of {all} parameters; {others}"),
        then,
    ]
}

/// `a, c` for the first and the third.
fn letters(places: &[usize]) -> String {
    let letter = |&at: &usize| char::from(b'a' + at as u8).to_string();
    places.iter().map(letter).collect::<Vec<_>>().join(", ")
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

fn symbols(answer: &SymbolicRelations) -> Vec<String> {
    let of = |kind: SymbolKind, word: &str| {
        let symbols = answer.named.symbols.iter().filter(|s| s.kind == kind);
        let listed: Vec<String> = symbols
            .map(|s| format!("{} = {}", s.name, s.given))
            .collect();
        (!listed.is_empty()).then(|| format!("{word}: {}", listed.join(", ")))
    };
    let lengths = of(SymbolKind::Length, "Lengths in m");
    lengths
        .into_iter()
        .chain(of(SymbolKind::Angle, "Angles"))
        .collect()
}

fn specials(answer: &SymbolicRelations) -> Vec<String> {
    let count = |n: usize| match n {
        1 => "1 more parameter".to_owned(),
        n => format!("{n} more parameters"),
    };
    let special = answer.special.iter().map(|special: &Special| {
        let regrouped = special.fewer.saturating_sub(special.without_effect);
        let idle = special.without_effect.min(special.fewer);
        let what = match (regrouped, idle) {
            (n, 0) => format!("{} regroup{}", count(n), if n == 1 { "s" } else { "" }),
            (0, n) => format!("{} lose{} effect", count(n), if n == 1 { "s" } else { "" }),
            (n, k) => format!("{} regroup or lose effect ({k})", count(n + k)),
        };
        let gone = special.gone.iter().map(|&c| label(answer, c, false).text());
        let gone = gone.collect::<Vec<_>>().join(", ");
        let values = special.values.join(", ");
        format!("special values: with {values}, {what}: {gone}")
    });
    special.collect()
}

/// Where a relation is no polynomial.
fn quotients(answer: &SymbolicRelations) -> Option<String> {
    let entries = answer.beta.iter().flatten().flatten();
    let divided = |c: &&Coefficient| match c {
        Coefficient::Quotient { denominator, .. } => denominator.iter().any(|e| *e > 0),
        Coefficient::Open(_) => false,
    };
    match entries.filter(divided).count() {
        0 => None,
        1 => Some("1 coefficient is no polynomial but a quotient".to_owned()),
        n => Some(format!("{n} coefficients are no polynomials but quotients")),
    }
}

fn open(formulas: &[Formula]) -> Option<String> {
    let groups = formulas.iter().flat_map(|f| &f.groups);
    let open = groups.filter(|g| g.coefficient.is_err()).count();
    let what = match open {
        0 => return None,
        1 => "1 coefficient, written f(symbols), is".to_owned(),
        n => format!("{n} coefficients, written f(symbols), are"),
    };
    Some(format!(
        "{what} no polynomial over a monomial, or of too many terms; values: base without --symbolic"
    ))
}

/// The answer for programs.
pub(crate) fn json(answer: &SymbolicRelations) -> String {
    let labels = answer.parameters.labels();
    let names = sympy_names(answer);
    let list =
        |columns: &[usize]| -> Vec<&str> { columns.iter().map(|&c| labels[c].as_str()).collect() };
    let symbols = answer.named.symbols.iter().map(|s| {
        let kind = match s.kind {
            SymbolKind::Length => "length",
            SymbolKind::Angle => "angle",
        };
        let sympy = Notation::SymPy.name(&s.name);
        json!({
            "name": s.name, "kind": kind, "given": s.given.text, "value": s.given.value,
            "sympy": sympy,
        })
    });
    let (formulas, by_origin) = (formulas(answer), origins(answer));
    let relations = formulas.iter().map(|formula| {
        let right = formula.pieces()[2..].join(" ");
        let made_by = formula.made_by(&by_origin).into_iter();
        let made_by: Vec<_> = made_by.map(|at| by_origin[at].0.to_string()).collect();
        let value = json!({
            "text": right, "latex": formula.latex(), "sympy": formula.sympy(&names),
            "made_by": made_by,
        });
        (labels[formula.base].clone(), value)
    });
    let names: Map<String, Value> = labels
        .iter()
        .cloned()
        .zip(names.iter().map(|n| json!(n)))
        .collect();
    let special = answer
        .special
        .iter()
        .map(|s| json!({"values": s.values, "fewer": s.fewer, "without_effect": s.without_effect, "gone": list(&s.gone)}));
    let origins = answer.origins.iter();
    let origins =
        origins.map(|(column, origin)| (labels[*column].clone(), json!(origin.to_string())));
    pretty(&json!({
        "schema": crate::SCHEMA,
        "robot": robot::json(&answer.mechanism),
        "symbols": symbols.collect::<Vec<_>>(),
        "notes": answer.named.notes,
        "no_effect": list(&answer.no_effect),
        "base": list(&answer.base),
        "regrouped": list(&answer.regrouped),
        "rank": answer.base.len(),
        "relations": Value::Object(relations.collect()),
        "sympy_names": names,
        "origins": Value::Object(origins.collect()),
        "rules_alone": answer.route == Route::RulesAlone,
        "left_over": list(&answer.left_over),
        "special": special.collect::<Vec<_>>(),
        "verification": {
            "primes": answer.verification.primes.iter().map(u64::to_string).collect::<Vec<_>>(),
            "failure_probability": answer.verification.failure_probability,
        },
    }))
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
    let mut text = "from sympy import Function, Rational, cos, sin, symbols\n\n".to_owned();
    if open(&formulas).is_some() {
        text += "f = Function(\"f\")  # of what is no polynomial over a monomial, or too long\n";
    }
    for symbol in &answer.named.symbols {
        let name = Notation::SymPy.name(&symbol.name);
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
