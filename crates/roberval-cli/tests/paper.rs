//! The paper's PUMA 560 on the command line.

mod common;

use common::{roberval, spec};
use serde_json::Value;

/// The files' fractions are exact; ours are computed in doubles from numbers below 10.
const FLOAT_ERROR: f64 = 1e-12;

#[test]
fn the_first_relation_reads_as_in_the_field() {
    let run = roberval(&["base", "puma560"]);
    assert_eq!(run.code, 0, "{}", run.err);
    assert_eq!(run.err, "");
    let relation = "ZZR_1 = ZZ_1 + YY_2 + YY_3 + 0.4 MZ_3 + 0.2904 (M_4 + M_5 + M_6) \
                    + 0.29 M_3 + Ia_1";
    assert!(run.out.lines().any(|line| line == relation), "{}", run.out);
    assert!(
        run.out
            .contains("66 standard parameters = 11 without effect + 55 with an effect")
    );
    assert!(
        run.out
            .contains("40 base parameters = 23 unchanged + 17 regrouped into; 15 regrouped away")
    );
}

#[test]
fn json_has_the_sets_beta_and_values_of_the_specification() {
    let run = roberval(&["base", "puma560", "--format", "json"]);
    assert_eq!(run.code, 0, "{}", run.err);
    let found: Value = serde_json::from_str(&run.out).expect("JSON");
    assert_eq!(found["schema"], 1);
    assert_eq!(found["rank"], 40);
    let Some(expected) = spec("puma560_expected.json") else {
        return;
    };
    let expected: Value = serde_json::from_str(&expected).expect("JSON");
    let sets = [
        ("eliminated", "no_effect"),
        ("base", "base"),
        ("deleted", "regrouped"),
        ("unchanged", "unchanged"),
        ("regrouped_into", "regrouped_into"),
    ];
    for (theirs, ours) in sets {
        assert_eq!(expected[theirs], found[ours], "{theirs}");
    }
    same_numbers(&expected["beta_float"], &found["beta"], "beta");
    same_numbers(&expected["XB_float"], &found["values"]["XB"], "XB");
}

/// Objects with the same keys, and the same numbers in the end.
fn same_numbers(expected: &Value, found: &Value, at: &str) {
    if let (Value::Object(a), Value::Object(b)) = (expected, found) {
        let (mut left, mut right): (Vec<_>, Vec<_>) = (a.keys().collect(), b.keys().collect());
        left.sort();
        right.sort();
        assert_eq!(left, right, "keys of {at}");
        a.iter()
            .for_each(|(k, v)| same_numbers(v, &b[k], &format!("{at}.{k}")));
        return;
    }
    let number = |v: &Value| v.as_f64().unwrap_or_else(|| panic!("{at}: {v}"));
    let error = (number(expected) - number(found)).abs();
    assert!(error <= FLOAT_ERROR, "{at}: {expected} and {found}");
}
