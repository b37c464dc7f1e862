//! Mechanisms with loops given by their cut joints.

use roberval_base::{BaseParameters, Engine, Options, base_parameters};
use roberval_formats::parse_toml;
use roberval_mechanism::Mechanism;
use roberval_regressor::Model;

mod common {
    pub mod loop_robots;
}
use common::loop_robots::*;

fn mechanism(text: &str) -> Mechanism {
    let description = parse_toml(text, "loop.toml").unwrap_or_else(|e| panic!("{e}\n{text}"));
    Mechanism::new(&description).unwrap_or_else(|e| panic!("{e}"))
}

fn answer(mechanism: &Mechanism, model: Model, engine: Engine, seed: u64) -> BaseParameters {
    let options = Options {
        model,
        engine,
        seed,
        ..Options::default()
    };
    let answer = base_parameters(mechanism, &options).unwrap_or_else(|e| panic!("{e}"));
    assert!(
        answer.diagnosis.clear,
        "{} {}: {:?} {:?}",
        mechanism.name,
        model.name(),
        answer.diagnosis.messages,
        answer.diagnosis.precision
    );
    answer
}

/// c, b and the labels of the regrouped parameters, the same by all models and engines.
fn counts(text: &str) -> (usize, usize, Vec<String>) {
    let mechanism = mechanism(text);
    let count = |a: &BaseParameters| {
        let labels = a.labels(&a.regrouped);
        let labels: Vec<String> = labels.into_iter().map(str::to_owned).collect();
        (a.base.len() + a.regrouped.len(), a.rank(), labels)
    };
    let first = count(&answer(&mechanism, Model::D, Engine::Exact, 1));
    for model in Model::ALL {
        for engine in [Engine::Exact, Engine::Qr, Engine::Svd] {
            let found = answer(&mechanism, model, engine, 2);
            assert_eq!(count(&found), first, "{} {engine:?}", model.name());
        }
    }
    first
}

#[test]
fn planar_four_and_five_bars_have_the_counts_of_the_table() {
    let table = [
        (four_bar(IN_PLANE), 11, 8, "Ia_1 M_2 MX_3"),
        (four_bar(NORMAL), 7, 4, "Ia_1 M_2 ZZ_3"),
        (five_bar(IN_PLANE), 16, 11, "Ia_1 M_2 Ia_3 MX_4 M_4"),
        (five_bar(NORMAL), 12, 7, "Ia_1 M_2 Ia_3 MX_4 M_4"),
    ];
    for (text, c, b, deleted) in table {
        let (found_c, found_b, labels) = counts(&text);
        assert_eq!(
            (found_c, found_b, labels.join(" ").as_str()),
            (c, b, deleted),
            "{text}"
        );
    }
}
