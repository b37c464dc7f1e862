//! The paper's PUMA 560: Tables II to V, corrected, by every model and engine.

use std::collections::BTreeMap;
use std::path::Path;

use roberval_base::{
    BaseParameters, Engine, Model, Options, PAPER_EPS_VAX, Tolerance, base_parameters,
};
use roberval_mechanism::{Geometry, Mechanism};
use roberval_scalar::Quantity;
use serde_json::Value;

/// Coefficients against the exact fractions.
const BETA_ROUNDING: f64 = 1e-12;
/// Table III prints four decimals.
const PRINTED: f64 = 5.1e-5;

fn puma() -> Mechanism {
    let description = roberval_formats::load("puma560").expect("in the catalogue");
    Mechanism::new(&description).expect("valid")
}

fn expected() -> Option<Value> {
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/spec/puma560_expected.json");
    let Ok(text) = std::fs::read_to_string(&path) else {
        eprintln!("skipped: no {} beside the checkout", path.display());
        return None;
    };
    Some(serde_json::from_str(&text).expect("JSON"))
}

fn strings(value: &Value) -> Vec<&str> {
    value
        .as_array()
        .expect("a list")
        .iter()
        .map(|v| v.as_str().expect("a label"))
        .collect()
}

fn answer(model: Model, engine: Engine) -> BaseParameters {
    let options = Options {
        model,
        engine,
        ..Options::default()
    };
    base_parameters(&puma(), &options).expect("the PUMA is analysed")
}

fn routes() -> impl Iterator<Item = (Model, Engine)> {
    Model::ALL
        .into_iter()
        .flat_map(|m| Engine::ALL.map(|e| (m, e)))
}

#[test]
fn fifty_five_parameters_have_an_effect_and_forty_are_base_by_every_route() {
    for (model, engine) in routes() {
        let answer = answer(model, engine);
        let tally = answer.tally();
        let found = (tally.standard, tally.no_effect, tally.base, tally.regrouped);
        assert_eq!(found, (66, 11, 40, 15), "{model:?} {engine:?}");
        assert_eq!((tally.unchanged, tally.regrouped_into), (23, 17));
        assert!(answer.diagnosis.clear, "{:?}", answer.diagnosis.messages);
        assert!(answer.diagnosis.gap.expect("a gap") > 1e9);
    }
}

#[test]
fn the_sets_are_the_papers_by_every_route() {
    let Some(expected) = expected() else { return };
    for (model, engine) in routes() {
        let answer = answer(model, engine);
        assert_eq!(
            answer.parameters.labels(),
            strings(&expected["parameter_order"])
        );
        assert_eq!(
            answer.labels(&answer.no_effect),
            strings(&expected["eliminated"])
        );
        assert_eq!(answer.labels(&answer.base), strings(&expected["base"]));
        assert_eq!(
            answer.labels(&answer.regrouped),
            strings(&expected["deleted"])
        );
        assert_eq!(
            answer.labels(&answer.unchanged),
            strings(&expected["unchanged"])
        );
        assert_eq!(
            answer.labels(&answer.regrouped_into),
            strings(&expected["regrouped_into"])
        );
    }
}

#[test]
fn beta_is_the_exact_fractions_by_every_route() {
    let Some(expected) = expected() else { return };
    for (model, engine) in routes() {
        let answer = answer(model, engine);
        let labels = answer.parameters.labels();
        let found: BTreeMap<(&str, &str), f64> = answer
            .relations()
            .iter()
            .flat_map(|r| {
                r.terms
                    .iter()
                    .map(|&(c, x)| ((labels[r.base].as_str(), labels[c].as_str()), x))
                    .collect::<Vec<_>>()
            })
            .collect();
        assert_eq!(
            found.len(),
            58,
            "{model:?} {engine:?}: dust is an exact zero"
        );
        for (base, row) in expected["beta_float"].as_object().expect("rows") {
            for (regrouped, exact) in row.as_object().expect("a row") {
                let exact = exact.as_f64().expect("a number");
                let ours = found[&(base.as_str(), regrouped.as_str())];
                assert!(
                    (ours - exact).abs() <= BETA_ROUNDING,
                    "{base} {regrouped}: {ours}"
                );
            }
        }
    }
}

#[test]
fn the_values_are_those_of_table_iii() {
    let Some(expected) = expected() else { return };
    for (model, engine) in routes() {
        let answer = answer(model, engine);
        let x = answer
            .mechanism
            .standard_parameters()
            .expect("the catalogue gives X");
        let xb = answer.values(&x).expect("right length");
        for (label, xb) in answer.labels(&answer.base).iter().zip(xb) {
            let exact = expected["XB_float"][label].as_f64().expect("a number");
            assert!((xb - exact).abs() <= BETA_ROUNDING, "{label}: {xb}");
            let printed: f64 = expected["XB_printed"][label]
                .as_str()
                .expect("text")
                .parse()
                .expect("a number");
            assert!(
                (xb - printed).abs() <= PRINTED,
                "{label}: {xb} printed {printed}"
            );
        }
    }
}

#[test]
fn the_papers_own_tolerance_gives_forty_too() {
    for (model, engine) in routes() {
        let options = Options {
            model,
            engine,
            tolerance: Tolerance::Paper { eps: f64::EPSILON },
            ..Options::default()
        };
        let answer = base_parameters(&puma(), &options).expect("analysed");
        assert_eq!(answer.rank(), 40, "{model:?} {engine:?}");
    }
    assert!((55.0 * 68.553 * PAPER_EPS_VAX - 5.23e-14).abs() < 5e-17);
}

#[test]
fn a_raised_base_does_not_add_a_constant_to_the_energy_model() {
    let mut description = roberval_formats::load("puma560").expect("in the catalogue");
    let Geometry::Mdh(first) = &mut description.links[0].geometry else {
        panic!("the PUMA is given in modified DH")
    };
    first.r = Quantity::parse_length("0.67", &[]).expect("a length");
    let puma = Mechanism::new(&description).expect("valid");
    for (model, engine) in routes() {
        let options = Options {
            model,
            engine,
            ..Options::default()
        };
        assert_eq!(
            base_parameters(&puma, &options).expect("analysed").rank(),
            40,
            "{model:?}"
        );
    }
}
