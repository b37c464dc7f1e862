//! Relations in symbols for people.

use std::collections::BTreeMap;

use roberval_base::Model;
use roberval_symbolic::{Coefficient, Open, Route, Special, SymbolKind, SymbolicRelations};

use super::{Formula, formulas, label, origins, verified};
use crate::couples::{equation, shortened};
use crate::document::{Block, Document};
use crate::robot;

/// The answer for people.
pub(crate) fn document(answer: &SymbolicRelations) -> Document {
    let origins = origins(answer);
    let mut formulas = formulas(answer);
    for formula in &mut formulas {
        formula.made_by = letters(&formula.made_by(&origins));
    }
    let mut lines = vec![robot::joints_and_gravity(&answer.mechanism)];
    lines.extend(symbols(answer));
    if answer.model != Model::default() {
        lines.push(format!("Linear model {}", answer.model.name()));
    }
    lines.extend(tally(answer));
    lines.push(verified(answer));
    lines.extend(loops(answer));
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

fn symbols(answer: &SymbolicRelations) -> Vec<String> {
    let of = |kind: SymbolKind, word: &str| {
        let symbols = answer.named.symbols.iter().filter(|s| s.kind == kind);
        let listed: Vec<String> = symbols
            .map(|s| format!("{} = {}", s.shown, s.given))
            .collect();
        (!listed.is_empty()).then(|| format!("{word}: {}", listed.join(", ")))
    };
    let lengths = of(SymbolKind::Length, "Lengths in m");
    lengths
        .into_iter()
        .chain(of(SymbolKind::Angle, "Angles"))
        .collect()
}

/// `with D3 = 0 five more parameters regroup: ...`
fn specials(answer: &SymbolicRelations) -> Vec<String> {
    let names = |columns: &[usize]| {
        let labels = columns.iter().map(|&c| label(answer, c, false).text());
        labels.collect::<Vec<_>>().join(", ")
    };
    let special = answer.special.iter().map(|special: &Special| {
        let idle = special.without_effect.min(special.fewer);
        let s = if special.fewer == 1 { "s" } else { "" };
        let what = match (special.fewer - idle, idle) {
            (_, 0) => format!("regroup{s}"),
            (0, _) => format!("lose{s} effect"),
            (_, k) => format!("regroup or lose effect ({k})"),
        };
        let parameters = match special.fewer {
            1 => "parameter",
            _ => "parameters",
        };
        let together = match special.beyond {
            true => " together",
            false => "",
        };
        let instead = match &special.come[..] {
            [] => String::new(),
            come => format!("; {} then stays", names(come)),
        };
        format!(
            "special values: with {}{together} {} more {parameters} {what}: {}{instead}",
            special.values.join(" and "),
            word(special.fewer),
            names(&special.gone)
        )
    });
    special.collect()
}

/// A number that can stand beside `D3 = 0`.
fn word(number: usize) -> String {
    const WORDS: [&str; 13] = [
        "no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten",
        "eleven", "twelve",
    ];
    WORDS
        .get(number)
        .map_or_else(|| format!("({number})"), |word| (*word).to_owned())
}

/// The couples that stand for the robot's loops.
fn loops(answer: &SymbolicRelations) -> Option<String> {
    if answer.loops.is_empty() {
        return None;
    }
    let equations = answer.loops.iter().map(|c| equation(&answer.mechanism, c));
    let couples = shortened(&equations.collect::<Vec<_>>());
    Some(format!(
        "On this branch the loops are couples, as which they are taken: {couples}"
    ))
}

/// Where a relation is no polynomial.
fn quotients(answer: &SymbolicRelations) -> Option<String> {
    let entries = answer.beta.iter().flatten().flatten();
    let divided = |c: &&Coefficient| match c {
        Coefficient::Quotient { denominator, .. } => denominator.iter().any(|e| *e > 0),
        Coefficient::Open { .. } => false,
    };
    match entries.filter(divided).count() {
        0 => None,
        1 => Some("1 coefficient is no polynomial but a quotient".to_owned()),
        n => Some(format!("{n} coefficients are no polynomials but quotients")),
    }
}

/// The coefficients without a formula, by the reason.
fn open(formulas: &[Formula]) -> Vec<String> {
    let groups = formulas.iter().flat_map(|f| &f.groups);
    let mut reasons: BTreeMap<Open, usize> = BTreeMap::new();
    for (_, why) in groups.filter_map(|g| g.coefficient.as_ref().err()) {
        *reasons.entry(*why).or_default() += 1;
    }
    let line = |(why, count): (Open, usize)| {
        let are = match count {
            1 => "1 coefficient, written f(symbols), is".to_owned(),
            n => format!("{n} coefficients, written f(symbols), are each"),
        };
        format!("{are} {why}; base without --symbolic gives the value")
    };
    reasons.into_iter().map(line).collect()
}
