use roberval_base::{BaseParameters, Blame, Choice, Tally, Witness};
use roberval_mechanism::Change;
use serde_json::{Map, Value, json};

use super::values;
use crate::json::pretty;
use crate::robot;
use crate::{couples, loops};

/// The answer for programs: `"schema": 1`, keys in this order.
pub(crate) fn json(answer: &BaseParameters) -> String {
    let value = json!({
        "schema": crate::SCHEMA,
        "robot": robot::json(&answer.mechanism),
        "constraints": couples::json(&answer.mechanism),
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
        "beta_exact": beta_exact(answer),
        "relations": crate::relations(answer),
        "values": values_json(answer),
        "diagnosis": diagnosis(answer),
        "cleaning": cleaning(answer),
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

/// Nonzero entries as exact texts (`363/1250`); `null` unless the exact engine found them.
fn beta_exact(answer: &BaseParameters) -> Value {
    let Some(beta) = &answer.beta_exact else {
        return Value::Null;
    };
    let labels = answer.parameters.labels();
    let mut rows = Map::new();
    for (&base, row) in answer.base.iter().zip(beta) {
        let terms = answer
            .regrouped
            .iter()
            .zip(row)
            .filter(|(_, x)| !x.is_zero());
        let row: Map<String, Value> = terms
            .map(|(&column, x)| (labels[column].clone(), Value::from(x.to_string())))
            .collect();
        if !row.is_empty() {
            rows.insert(labels[base].clone(), Value::Object(row));
        }
    }
    Value::Object(rows)
}

/// What was set right in the robot file before, and what the file as written gives.
fn cleaning(answer: &BaseParameters) -> Value {
    let Some(cleaning) = &answer.mechanism.cleaning else {
        return Value::Null;
    };
    let changes = |changes: &mut dyn Iterator<Item = &Change>| -> Vec<Value> {
        let change = |c: &Change| {
            json!({
                "link": c.link,
                "joint": c.joint,
                "field": c.field.to_string(),
                "written": c.written.text,
                "became": c.became.text,
                "size": c.size,
                "text": c.to_string(),
            })
        };
        changes.map(change).collect()
    };
    let cleaned = &cleaning.cleaned;
    json!({
        "changes": changes(&mut cleaned.changes.iter()),
        "near_misses": changes(&mut cleaned.near_misses.iter().map(|n| &n.change)),
    })
}

fn structure(answer: &BaseParameters) -> Value {
    let structure = answer.diagnosis.structure.as_ref();
    let space = answer.mechanism.parameters();
    let labels = |columns: &[usize]| -> Vec<String> {
        columns.iter().map(|&c| space.labels()[c].clone()).collect()
    };
    json!(structure.map(|s| json!({
        "rank": s.rank,
        "nullspace_rank": s.nullspace_rank,
        "opened": s.opened.as_ref().map(|o| json!({
            "rank": o.rank,
            "removed": labels(&o.removed),
        })),
        "primes": s.primes.iter().map(u64::to_string).collect::<Vec<_>>(),
        "seeds": s.seeds.iter().map(u64::to_string).collect::<Vec<_>>(),
        "failure_probability": s.failure_probability,
        "generic_angles": s.generic,
    })))
}

fn literal(answer: &BaseParameters) -> Value {
    let blame = |list: &[Blame]| -> Vec<Value> {
        let one = |b: &Blame| json!({"what": b.what, "rank": b.rank});
        list.iter().map(one).collect()
    };
    let literal = answer.diagnosis.literal.as_ref();
    json!(literal.map(|l| json!({
        "rank": l.rank,
        "blame": blame(&l.blame),
        "near_misses": blame(&l.near_misses),
    })))
}

fn witnesses(answer: &BaseParameters) -> Vec<Value> {
    let witness = |w: &Witness| {
        json!({
            "engine": w.engine.name(),
            "rank": w.rank,
            "gap": w.gap,
            "gap_at_structural": w.gap_at_structural,
        })
    };
    answer.diagnosis.witnesses.iter().map(witness).collect()
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
        "structural": structure(answer),
        "precision": loops::precision(answer),
        "float": witnesses(answer),
        "literal": literal(answer),
    })
}
