use roberval_base::{BaseParameters, Choice, Tally};
use serde_json::{Map, Value, json};

use super::values;
use crate::json::pretty;
use crate::robot;

/// The answer for programs: `"schema": 1`, keys in this order.
pub(crate) fn json(answer: &BaseParameters) -> String {
    let value = json!({
        "schema": 1,
        "robot": robot::json(&answer.mechanism),
        "model": answer.model.name(),
        "engine": answer.engine.name(),
        "choice": choice(&answer.choice),
        "seed": answer.seed,
        "rows": answer.rows,
        "parameters": robot::parameters(&answer.mechanism, &answer.parameters),
        "counts": counts(answer.tally()),
        "no_effect": answer.labels(&answer.no_effect),
        "base": answer.labels(&answer.base),
        "regrouped": answer.labels(&answer.regrouped),
        "unchanged": answer.labels(&answer.unchanged),
        "regrouped_into": answer.labels(&answer.regrouped_into),
        "rank": answer.rank(),
        "beta": beta(answer),
        "relations": crate::relations(answer),
        "values": values_json(answer),
        "diagnosis": diagnosis(answer),
        "warnings": answer.mechanism.description.warnings,
    });
    pretty(&value)
}

fn choice(choice: &Choice) -> Value {
    match choice {
        Choice::Prefer { keep, drop } => json!({"rule": "prefer", "keep": keep, "drop": drop}),
        _ => json!({"rule": choice.name()}),
    }
}

fn counts(tally: Tally) -> Value {
    json!({
        "standard": tally.standard,
        "no_effect": tally.no_effect,
        "with_effect": tally.base + tally.regrouped,
        "base": tally.base,
        "unchanged": tally.unchanged,
        "regrouped_into": tally.regrouped_into,
        "regrouped": tally.regrouped,
    })
}

/// Nonzero entries: {base: {regrouped: coefficient}}.
fn beta(answer: &BaseParameters) -> Value {
    let labels = answer.parameters.labels();
    let rows = answer
        .relations()
        .into_iter()
        .filter(|relation| !relation.terms.is_empty())
        .map(|relation| {
            let terms = relation.terms.iter();
            let row = terms.map(|&(column, x)| (labels[column].clone(), Value::from(x)));
            (labels[relation.base].clone(), Value::Object(row.collect()))
        });
    Value::Object(rows.collect())
}

fn values_json(answer: &BaseParameters) -> Value {
    let Some((x, xb)) = values(answer) else {
        return json!({"X": null, "XB": null});
    };
    let labels = answer.parameters.labels();
    let x: Map<String, Value> = labels
        .iter()
        .cloned()
        .zip(x.iter().map(|x| json!(x)))
        .collect();
    let base = answer.base.iter().map(|&c| labels[c].clone());
    let xb: Map<String, Value> = base.zip(xb.iter().map(|x| json!(x))).collect();
    json!({"X": x, "XB": xb})
}

pub(crate) fn diagnosis(answer: &BaseParameters) -> Value {
    let diagnosis = &answer.diagnosis;
    json!({
        "clear": diagnosis.clear,
        "spectrum": diagnosis.spectrum,
        "spectrum_labels": answer.labels(&diagnosis.spectrum_columns),
        "tolerance": diagnosis.tolerance,
        "gap": diagnosis.gap,
        "residual": diagnosis.residual,
        "messages": diagnosis.messages,
    })
}
