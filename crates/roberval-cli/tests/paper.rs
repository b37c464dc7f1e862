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

#[test]
fn json_has_the_keys_that_others_rely_on() {
    let run = roberval(&["base", "puma560", "--format", "json"]);
    let found: Value = serde_json::from_str(&run.out).expect("JSON");
    let keys = |v: &Value| -> String {
        let keys = v.as_object().into_iter().flat_map(|o| o.keys());
        keys.map(String::as_str).collect::<Vec<_>>().join(" ")
    };
    assert_eq!(
        keys(&found),
        "schema robot constraints model engine choice seed rows parameters counts \
         no_effect base regrouped unchanged regrouped_into rank beta beta_exact relations values \
         diagnosis cleaning warnings"
    );
    assert_eq!(keys(&found["robot"]), "name gravity links");
    let link = &found["robot"]["links"][1];
    assert_eq!(keys(link), "index name joint type antecedent");
    assert_eq!(link["index"], 2);
    assert_eq!(link["antecedent"], "1");
    assert_eq!(found["robot"]["links"][0]["antecedent"], Value::Null);
    assert_eq!(keys(&found["parameters"][0]), "label kind link");
    assert_eq!(found["parameters"][10]["label"], "Ia_1");
    assert_eq!(
        keys(&found["diagnosis"]),
        "clear spectrum spectrum_labels tolerance gap residual messages \
         warnings structural precision float literal"
    );
    assert_eq!(found["diagnosis"]["clear"], true);
    assert_eq!(
        found["diagnosis"]["spectrum"].as_array().map(Vec::len),
        Some(55)
    );
    assert_eq!(keys(&found["values"]), "X XB");
    assert_eq!(found["beta"]["MX_2"]["M_3"], 0.5);
    assert_eq!(found["relations"][16], "XXR_6 = XX_6 - YY_6");
}

#[test]
fn values_are_null_where_the_robot_file_has_none() {
    let run = roberval(&["base", "two_link", "--format", "json"]);
    let found: Value = serde_json::from_str(&run.out).expect("JSON");
    if found["values"]["X"].is_null() {
        assert_eq!(found["values"]["XB"], Value::Null);
    }
    let show = roberval(&["show", "ur5", "--format", "json"]);
    let show: Value = serde_json::from_str(&show.out).expect("JSON");
    let base = roberval(&["base", "ur5", "--format", "json"]);
    let base: Value = serde_json::from_str(&base.out).expect("JSON");
    let known = show["inertia"].as_object().is_some_and(|x| !x.is_empty());
    assert_eq!(base["values"]["X"].is_object(), known);
}

#[test]
fn csv_columns_times_x_are_xb() {
    let run = roberval(&["base", "puma560", "--format", "csv"]);
    let mut reader = csv::Reader::from_reader(run.out.as_bytes());
    let header = reader.headers().expect("a header").clone();
    assert_eq!(header.len(), 7 + 17);
    let rows: Vec<csv::StringRecord> = reader.records().map(|r| r.expect("a row")).collect();
    assert_eq!(rows.len(), 66);
    let number = |text: &str| text.parse::<f64>().unwrap_or(0.0);
    for c in 7..header.len() {
        let sum: f64 = rows.iter().map(|r| number(&r[c]) * number(&r[4])).sum();
        let row = rows
            .iter()
            .find(|r| r[0] == header[c])
            .expect("a base parameter");
        assert_eq!(&row[3], "regrouped_into");
        assert!(
            (sum - number(&row[5])).abs() <= FLOAT_ERROR,
            "{}",
            &header[c]
        );
    }
    assert_eq!(rows.iter().filter(|r| &r[3] == "no_effect").count(), 11);
    assert_eq!(rows.iter().filter(|r| &r[3] == "unchanged").count(), 23);
}

#[test]
fn markdown_and_latex_have_the_fields_notation() {
    let markdown = roberval(&["base", "puma560", "--format", "markdown"]).out;
    assert!(markdown.contains("- `XXR_2 = XX_2 - YY_2 - 0.25 (M_3 + M_4 + M_5 + M_6)`\n"));
    let latex = roberval(&["base", "puma560", "--format", "latex"]).out;
    assert!(latex.contains(
        "$ZZ_{R1} = ZZ_{1} + YY_{2} + YY_{3} + 0.4\\,MZ_{3} + \
         0.2904\\,(M_{4} + M_{5} + M_{6}) + 0.29\\,M_{3} + Ia_{1}$"
    ));
}

#[test]
fn the_comparison_of_the_paper_has_nine_agreeing_routes() {
    let run = roberval(&["compare", "puma560", "--format", "json"]);
    assert_eq!((run.code, run.err.as_str()), (0, ""));
    let found: Value = serde_json::from_str(&run.out).expect("JSON");
    let routes = found["routes"].as_array().expect("a list");
    assert!(routes.len() >= 9);
    for route in routes {
        assert_eq!(route["with_effect"], 55, "{route}");
        assert_eq!(route["rank"], 40, "{route}");
        assert_eq!(route["same_columns"], true, "{route}");
        assert_eq!(route["diagnosis"]["clear"], true, "{route}");
    }
    assert_eq!(found["agree"], true);
}
