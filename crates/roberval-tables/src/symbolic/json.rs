//! Relations in symbols for programs.

use roberval_symbolic::{Coefficient, Notation, Route, SymbolKind, SymbolicRelations};
use serde_json::{Map, Value, json};

use super::{formulas, origins, sympy_names};
use crate::couples::equation;
use crate::json::pretty;
use crate::robot;

/// The answer for programs.
pub(crate) fn json(answer: &SymbolicRelations) -> String {
    let labels = answer.parameters.labels();
    let list = |columns: &[usize]| list(labels, columns);
    let origins = answer.origins.iter();
    let origins =
        origins.map(|(column, origin)| (labels[*column].clone(), json!(origin.to_string())));
    let names = labels.iter().cloned().zip(sympy_names(answer));
    let names = names.map(|(label, name)| (label, json!(name)));
    let loops = answer.loops.iter();
    let loops = loops.map(|couple| equation(&answer.mechanism, couple));
    let primes = answer.verification.primes.iter().map(u64::to_string);
    pretty(&json!({
        "schema": crate::SCHEMA,
        "robot": robot::json(&answer.mechanism),
        "model": answer.model.name(),
        "symbols": symbols(answer),
        "notes": answer.named.notes,
        "no_effect": list(&answer.no_effect),
        "base": list(&answer.base),
        "regrouped": list(&answer.regrouped),
        "rank": answer.base.len(),
        "relations": relations(answer),
        "open": open(answer),
        "sympy_names": Value::Object(names.collect()),
        "origins": Value::Object(origins.collect()),
        "rules_alone": answer.route == Route::RulesAlone,
        "loops": loops.collect::<Vec<_>>(),
        "left_over": list(&answer.left_over),
        "special": special(answer),
        "verification": {
            "primes": primes.collect::<Vec<_>>(),
            "failure_probability": answer.verification.failure_probability,
        },
    }))
}

fn list<'l>(labels: &'l [String], columns: &[usize]) -> Vec<&'l str> {
    columns.iter().map(|&c| labels[c].as_str()).collect()
}

fn symbols(answer: &SymbolicRelations) -> Vec<Value> {
    let symbols = answer.named.symbols.iter().map(|s| {
        let kind = match s.kind {
            SymbolKind::Length => "length",
            SymbolKind::Angle => "angle",
        };
        json!({
            "name": s.name,
            "shown": s.shown,
            "kind": kind,
            "given": s.given.text,
            "value": s.given.value,
            "sympy": Notation::SymPy.name(&s.shown),
        })
    });
    symbols.collect()
}

fn relations(answer: &SymbolicRelations) -> Map<String, Value> {
    let (labels, names) = (answer.parameters.labels(), sympy_names(answer));
    let by_origin = origins(answer);
    let relation = |formula: super::Formula| {
        let right = formula.pieces()[2..].join(" ");
        let made_by = formula.made_by(&by_origin).into_iter();
        let made_by: Vec<_> = made_by.map(|at| by_origin[at].0.to_string()).collect();
        let value = json!({
            "text": right,
            "latex": formula.latex(),
            "sympy": formula.sympy(&names),
            "made_by": made_by,
        });
        (labels[formula.base].clone(), value)
    };
    formulas(answer).into_iter().map(relation).collect()
}

/// The coefficients without a formula, and why.
fn open(answer: &SymbolicRelations) -> Vec<Value> {
    let labels = answer.parameters.labels();
    let rows = answer.base.iter().zip(&answer.beta);
    let entries = rows.flat_map(|(&base, row)| {
        let entries = answer.regrouped.iter().zip(row);
        entries.map(move |(&column, coefficient)| (base, column, coefficient))
    });
    let open = entries.filter_map(|(base, column, coefficient)| match coefficient {
        Some(Coefficient::Open { symbols, why }) => Some(json!({
            "base": labels[base],
            "parameter": labels[column],
            "symbols": symbols,
            "why": why.to_string(),
        })),
        _ => None,
    });
    open.collect()
}

fn special(answer: &SymbolicRelations) -> Vec<Value> {
    let labels = answer.parameters.labels();
    let special = answer.special.iter().map(|s| {
        json!({
            "values": s.values,
            "fewer": s.fewer,
            "without_effect": s.without_effect,
            "gone": list(labels, &s.gone),
            "come": list(labels, &s.come),
            "beyond_parts": s.beyond,
        })
    });
    special.collect()
}
