//! Relations in symbols and generated code from the command line.

mod common;

use common::{Folder, roberval};

#[test]
fn table_v_is_printed_in_symbols() {
    let run = roberval(&["base", "puma560", "--symbolic"]);
    assert_eq!(run.code, 0, "{}", run.err);
    for line in [
        "ZZR_1 = ZZ_1 + YY_2 + YY_3 + 2 R3 MZ_3 + (D3^2 + R3^2) M_3 + (D3^2 + D4^2 + R3^2) (M_4 + M_5 + M_6)",
        "XYR_3 = XY_3 - D4 MZ_4 - D4 R4 (M_4 + M_5 + M_6)",
        "XXR_6 = XX_6 - YY_6",
    ] {
        assert!(run.out.contains(line), "{}", run.out);
    }
    assert!(
        run.out
            .contains("rule: mass along a revolute joint's axis: ")
    );
    assert!(!run.out.contains("elimination"));
}

#[test]
fn relations_in_symbols_have_all_forms() {
    let folder = Folder::new("symbols");
    let sympy = folder.path("relations.py");
    let json = &[
        "base",
        "sr400",
        "--symbolic",
        "--sympy",
        &sympy,
        "--format",
        "json",
    ];
    let run = roberval(json);
    assert_eq!(run.code, 0, "{}", run.err);
    let value: serde_json::Value = serde_json::from_str(&run.out).expect("JSON");
    let relation = &value["relations"]["MX_7"];
    assert_eq!(relation["text"], "MX_7 - D8/D3 MX_8 + D8 M_8");
    assert_eq!(relation["sympy"], "MX_7 - D8/D3*MX_8 + D8*M_8");
    assert_eq!(
        relation["latex"],
        "MX_{R7} = MX_{7} - \\frac{D_{8}}{D_{3}}\\,MX_{8} + D_{8}\\,M_{8}"
    );
    let module = std::fs::read_to_string(&sympy).expect("written");
    assert!(
        module.contains("    \"MX_7\": MX_7 - D8/D3*MX_8 + D8*M_8,\n"),
        "{module}"
    );
    let latex = roberval(&["base", "stanford", "--symbolic", "--format", "latex"]);
    assert!(
        latex.out.contains("2 R_{2}\\,MZ_{2} + R_{2}^{2}\\,M_{2}"),
        "{}",
        latex.out
    );
}

/// A robot TOML: a chain with these constants, and with these alpha and d.
fn chain(constants: &str, rows: &[[&str; 2]]) -> String {
    let link = |(j, [alpha, d]): (usize, &[&str; 2])| {
        format!("[[link]]\nname = \"{j}\"\nalpha = \"{alpha}\"\nd = \"{d}\"\nr = 0\n")
    };
    let links: String = (1..).zip(rows).map(link).collect();
    format!("name = \"chain\"\n[constants]\n{constants}\n{links}")
}

/// The third axis stands at this distance from the second.
fn distant(d: &str) -> String {
    chain("L = 0.5\nM = 0.2", &[["0", "0"], ["90 deg", "0"], ["0", d]])
}

/// Powers beyond those that are looked for stay open; the module defines what stands for them.
#[test]
fn the_sympy_module_of_an_open_coefficient_defines_f() {
    let folder = Folder::new("open");
    let (file, module) = (folder.path("open.toml"), folder.path("open.py"));
    let high = ["L"; 13].join("*");
    std::fs::write(&file, distant(&high)).expect("written");
    let run = roberval(&["base", &file, "--symbolic", "--sympy", &module]);
    assert_eq!(run.code, 0, "{}", run.err);
    let text = std::fs::read_to_string(&module).expect("written");
    assert!(text.contains("*M_3") && text.contains("f(L)"), "{text}");
    assert!(text.starts_with("# Verified at random values "), "{text}");
    assert!(text.contains("\nfrom sympy import Function, "), "{text}");
    assert!(text.contains("\nf = Function(\"f\")"), "{text}");
}

#[test]
fn minus_a_square_has_one_sign() {
    let folder = Folder::new("square");
    let file = folder.path("square.toml");
    std::fs::write(&file, distant("L - M")).expect("written");
    for format in ["table", "latex"] {
        let run = roberval(&["base", &file, "--symbolic", "--format", format]);
        assert_eq!(run.code, 0, "{}", run.err);
        assert!(!run.out.contains("+ -"), "{}", run.out);
    }
    let run = roberval(&["base", &file, "--symbolic"]);
    assert!(run.out.contains("- (L - M)^2 M_3"), "{}", run.out);
}

#[test]
fn csv_is_csv() {
    let run = roberval(&["base", "puma560", "--symbolic", "--format", "csv"]);
    let mut lines = run.out.lines();
    assert_eq!(lines.next(), Some("base,parameter,sign,coefficient"));
    assert!(
        lines.all(|line| line.split(',').count() == 4),
        "{}",
        run.out
    );
    assert!(run.out.contains("\nXZ_2,M_3,-1,D3*R3\n"), "{}", run.out);
    let run = roberval(&["code", "puma560", "--counts", "--format", "csv"]);
    assert!(
        run.out.starts_with("part,link,standard_mul,"),
        "{}",
        run.out
    );
    assert!(
        run.out.lines().all(|line| line.split(',').count() == 8),
        "{}",
        run.out
    );
}

#[test]
fn code_goes_to_its_file_and_its_cost_is_told() {
    let folder = Folder::new("code");
    let file = folder.path("puma.c");
    let run = roberval(&[
        "code", "puma560", "--lang", "c", "--what", "tau", "-o", &file,
    ]);
    assert_eq!((run.code, run.out.as_str()), (0, ""), "{}", run.err);
    assert!(
        run.err
            .contains("251 multiplications, 228 additions, 10 sines and cosines a state")
    );
    let text = std::fs::read_to_string(&file).expect("written");
    assert!(text.contains("void puma_560_tau(const double q[6], const double qd[6]"));
    assert!(text.contains(" *   40 Ia_6 [kg m^2 or kg]\n"));
    let again = roberval(&["code", "puma560"]);
    assert_eq!(again.out, text);
}

#[test]
fn the_cost_of_standard_and_reduced_model_stands_side_by_side() {
    let run = roberval(&["code", "stanford", "--counts", "--format", "json"]);
    let value: serde_json::Value = serde_json::from_str(&run.out).expect("JSON");
    let sum = |model: &str| {
        let state = &value[model]["state"];
        state["mul"].as_u64().expect("a count") + state["add"].as_u64().expect("a count")
    };
    assert_eq!(sum("reduced"), 220 + 203);
    assert!(sum("standard") > sum("reduced"));
    assert_eq!(
        value["reduced"]["links"].as_array().expect("links").len(),
        6
    );
    let table = roberval(&["code", "stanford", "--counts"]);
    assert!(table.out.contains("a state"), "{}", table.out);
}

#[test]
fn the_rules_alone_tell_what_they_leave_and_which_rule_made_each_relation() {
    let puma = roberval(&["base", "puma560", "--rules"]);
    assert!(
        puma.out.contains("leave 40 of 66 parameters"),
        "{}",
        puma.out
    );
    assert!(puma.out.contains("XXR_6 = XX_6 - YY_6 [d]"), "{}", puma.out);
    assert!(puma.out.contains("[d] rule: mass along"), "{}", puma.out);
    let sr400 = roberval(&["base", "sr400", "--rules"]);
    assert!(sr400.out.contains("removes 11 ("), "{}", sr400.out);
    assert!(sr400.out.contains("42 are base"), "{}", sr400.out);
}

/// The numbers' base parameters by the same options.
#[test]
fn model_and_choice_are_honoured_by_symbols_and_by_rules() {
    let list = |args: &[&str], key: &str| {
        let run = roberval(&[&["base", "sr400", "--format", "json"], args].concat());
        assert_eq!(run.code, 0, "{args:?}: {}", run.err);
        let value: serde_json::Value = serde_json::from_str(&run.out).expect("JSON");
        let labels = value[key].as_array().expect("a list").iter();
        let label = |l: &serde_json::Value| l.as_str().expect("a label").to_owned();
        labels.map(label).collect::<Vec<String>>()
    };
    for options in [
        &["--model", "d0"][..],
        &["--model", "h"],
        &["--choice", "pivoted"],
        &["--keep", "M_6,MX_8", "--drop", "ZZ_1"],
    ] {
        let with = |flag| [&[flag], options].concat();
        let mut numbers = list(options, "base");
        numbers.sort();
        let mut symbols = list(&with("--symbolic"), "base");
        symbols.sort();
        assert_eq!(symbols, numbers, "{options:?}");
        let left_over = list(&with("--rules"), "left_over");
        let mut rules = list(&with("--rules"), "base");
        rules.retain(|label| !left_over.contains(label));
        rules.sort();
        assert_eq!(rules, numbers, "{options:?}");
    }
}

/// An angle and a length with the names of others.
fn names() -> String {
    chain("M_2 = 0.5\nf = \"30 deg\"", &[["0", "0"], ["f", "M_2"]])
}

#[test]
fn constants_with_names_of_parameters_or_functions_are_told_apart() {
    let folder = Folder::new("names");
    let file = folder.path("names.toml");
    std::fs::write(&file, names()).expect("written");
    let run = roberval(&["base", &file, "--symbolic"]);
    assert_eq!(run.code, 0, "{}", run.err);
    assert!(
        run.out.contains("Lengths in m: const_M_2 = 0.5"),
        "{}",
        run.out
    );
    assert!(run.out.contains("+ const_M_2^2 M_2"), "{}", run.out);
    assert!(run.out.contains("sin(const_f)^2"), "{}", run.out);
}

#[test]
fn joints_by_expressions_are_refused_with_the_reason_and_what_to_do() {
    let folder = Folder::new("expression");
    let file = folder.path("expression.toml");
    let couple = "[[couple]]\njoint = \"2\"\nexpression = \"2*sin(q.1)\"\n";
    std::fs::write(&file, names() + couple).expect("written");
    for flag in ["--symbolic", "--rules"] {
        let run = roberval(&["base", &file, flag]);
        assert_eq!(run.code, 2, "{}", run.err);
        for words in ["\"2\" follows by an expression", "base without --symbolic"] {
            assert!(run.err.contains(words), "{}", run.err);
        }
        assert!(!run.err.contains("loop"), "{}", run.err);
    }
}

#[test]
fn the_page_of_a_robot_with_named_constants_has_the_relations_in_them() {
    let folder = Folder::new("page");
    let page = folder.path("page.html");
    let run = roberval(&["base", "puma560", "--report", &page]);
    assert_eq!(run.code, 0, "{}", run.err);
    let text = std::fs::read_to_string(&page).expect("written");
    assert!(text.contains("<i>D</i><sub>3</sub><sup>2</sup>"));
    assert!(text.contains("Verified at random values"));
    let run = roberval(&["base", "iiwa14", "--report", &page]);
    assert_eq!(run.code, 0, "{}", run.err);
    let text = std::fs::read_to_string(&page).expect("written");
    assert!(text.contains("--symbolic"));
}

#[test]
fn special_values_are_told_in_a_sentence() {
    let folder = Folder::new("special");
    let file = folder.path("scara.toml");
    let text = chain("D2 = 0", &[["0", "0"], ["0", "D2"]]);
    std::fs::write(&file, text).expect("written");
    let run = roberval(&["base", &file, "--symbolic"]);
    assert_eq!(run.code, 0, "{}", run.err);
    let sentence = "with D2 = 0 two more parameters lose effect: MX_2, MY_2";
    assert!(run.out.contains(sentence), "{}", run.out);
}

#[test]
fn bad_requests_are_told() {
    for (args, message) in [
        (&["code", "puma560", "--lang", "cobol"][..], "cobol"),
        (
            &["code", "puma560", "--what", "mass", "--friction"],
            "friction is a part of tau only",
        ),
        (&["base", "puma560", "--sympy", "x.py"], "--symbolic"),
        (
            &["base", "puma560", "--symbolic", "--format", "sympy"],
            "--sympy FILE",
        ),
        (
            &["base", "puma560", "--symbolic", "--report", "x.html"],
            "--report",
        ),
        (
            &["base", "puma560", "--rules", "--engine", "svd"],
            "leave out --engine",
        ),
        (
            &["base", "puma560", "--symbolic", "--rows", "200"],
            "leave out --engine, --rows",
        ),
        (&["base", "puma560", "--symbolic", "--rules"], "one of them"),
        (&["code", "puma560", "--format", "json"], "--counts"),
        (
            &["code", "puma560", "--counts", "--lang", "rust"],
            "leave out --lang",
        ),
        (
            &["code", "puma560", "--counts", "--parameters", "base"],
            "leave out --lang and --parameters",
        ),
        (
            &["code", "puma560", "--parameters=standard", "--keep=MX_2"],
            "--keep and --drop are for base parameters",
        ),
        (
            &[
                "code",
                "puma560",
                "--parameters=standard",
                "--choice=pivoted",
            ],
            "--parameters standard takes all",
        ),
        (
            &["code", "puma560", "--paper-tolerance"],
            "leave out --paper-tolerance",
        ),
    ] {
        let run = roberval(args);
        assert_eq!(run.code, 2, "{args:?}");
        assert!(run.err.contains(message), "{args:?}: {}", run.err);
    }
}
