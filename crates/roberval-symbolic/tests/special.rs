//! What is special about given values, against the exact engine at random values.

mod common;

use std::collections::HashMap;

use common::relations;
use num_rational::BigRational;
use num_traits::Zero;
use roberval_base::{Model, decide_exactly};
use roberval_formats::parse_toml;
use roberval_mechanism::{Mechanism, RobotDescription};
use roberval_scalar::{Quantity, SplitMix64};
use roberval_symbolic::{Special, SymbolKind, SymbolicOptions, SymbolicRelations};

fn robot(constants: &str, links: &[&str]) -> RobotDescription {
    let mut text = format!("name = \"special\"\n[constants]\n{constants}\n");
    for (k, link) in (1..).zip(links) {
        text += &format!("[[link]]\nname = \"{k}\"\n{link}\n");
    }
    parse_toml(&text, "special.toml").expect("a robot")
}

fn labels(answer: &SymbolicRelations, columns: &[usize]) -> Vec<String> {
    let labels = answer.parameters.labels();
    columns.iter().map(|&c| labels[c].clone()).collect()
}

/// Two fingers on a hand, of which one slides as the other does: on parallel lines they share
/// what their slides cannot tell apart.
fn fingers(first: &str, second: &str) -> SymbolicRelations {
    let finger = |angle: &str| {
        format!("joint = \"prismatic\"\nantecedent = \"3\"\nalpha = \"{angle}\"\nd = 0\ntheta = 0")
    };
    let robot = robot(
        &format!("A = \"{first}\"\nB = \"{second}\""),
        &[
            "alpha = 0\nd = 0\nr = 0",
            "alpha = \"90 deg\"\nd = 0\nr = 0.3",
            "alpha = \"-90 deg\"\nd = 0\nr = 0.2",
            &finger("A"),
            &(finger("B") + "\n[[couple]]\njoint = \"5\"\nequals = { 4 = -1 }"),
        ],
    );
    relations(&robot, &SymbolicOptions::default())
}

#[test]
fn equal_and_opposite_angles_are_told_as_such() {
    for (first, second, expected) in [
        ("30 deg", "30 deg", Some("A = B")),
        ("30 deg", "-150 deg", Some("A = 180 deg + B")),
        ("30 deg", "-30 deg", None),
        ("0.3", "0.3", Some("A = B")),
    ] {
        let answer = fingers(first, second);
        let causes: Vec<&[String]> = answer.special.iter().map(|s| &s.values[..]).collect();
        match expected {
            None => assert!(causes.is_empty(), "{causes:?}"),
            Some(text) => {
                assert_eq!(causes, [&[text.to_owned()][..]]);
                let gone = labels(&answer, &answer.special[0].gone);
                assert!(gone.iter().all(|label| label.ends_with("_5")), "{gone:?}");
            }
        }
    }
}

#[test]
fn named_angles_of_0_and_90_degrees_are_asked() {
    let two = |angle: &str| {
        let link = "alpha = \"A\"\nd = \"L\"\nr = 0.1";
        let robot = robot(
            &format!("A = \"{angle}\"\nL = 0.4"),
            &["alpha = \"90 deg\"\nd = 0\nr = 0", link],
        );
        relations(&robot, &SymbolicOptions::default()).special
    };
    assert!(two("40 deg").is_empty());
    for angle in ["0", "90 deg", "180 deg"] {
        let causes = two(angle);
        assert_eq!(causes[0].values, [format!("A = {angle}")], "{causes:?}");
        assert!(causes[0].fewer > 0);
    }
}

/// Half of all prime fields have no root of 7.
#[test]
fn given_values_may_be_roots() {
    for seed in 0..8 {
        let link = "alpha = \"90 deg\"\nd = \"L\"\nr = 0.1";
        let robot = robot("L = \"sqrt(7)\"", &["alpha = 0\nd = 0\nr = 0", link]);
        let options = SymbolicOptions {
            seed,
            ..SymbolicOptions::default()
        };
        assert!(relations(&robot, &options).special.is_empty());
    }
}

/// Chains whose lengths and angles are named and have few different values.
fn of_few_values(seed: u64) -> RobotDescription {
    let mut random = SplitMix64::new(seed);
    let count = 2 + random.below(3);
    let (mut constants, mut links) = (String::new(), Vec::new());
    for k in 1..=count {
        let lengths = ["0", "0.3", "-0.3", "0.3", "0.5"];
        for letter in ["D", "R"] {
            constants += &format!("{letter}{k} = {}\n", lengths[random.below(lengths.len())]);
        }
        let alpha = match random.below(3) {
            0 => "0",
            1 => "90 deg",
            _ => "-90 deg",
        };
        let joint = match random.below(4) {
            0 => "joint = \"prismatic\"\ntheta = 0\n".to_owned(),
            _ => format!("r = \"R{k}\"\n"),
        };
        let antecedent = match k {
            1 => "base".to_owned(),
            _ => (k - 1 - random.below(2).min(k - 2)).to_string(),
        };
        links.push(format!(
            "antecedent = \"{antecedent}\"\nalpha = \"{alpha}\"\nd = \"D{k}\"\n{joint}"
        ));
    }
    if count > 2 {
        // Two that move alike.
        let sign = ["", "-"][random.below(2)];
        let tail = "[[couple]]\njoint = \"3\"\nequals = { 2 = ";
        let same = links[1].contains("prismatic") == links[2].contains("prismatic");
        if same {
            links[count - 1] += &format!("{tail}{sign}1 }}\n");
        }
    }
    let links: Vec<&str> = links.iter().map(String::as_str).collect();
    robot(&constants, &links)
}

/// Fewer base parameters than generic ones, by the exact engine with these conditions on
/// lengths that are random otherwise.
fn fewer(answer: &SymbolicRelations, conditions: &[&str], random: &mut SplitMix64) -> usize {
    let mut values: HashMap<String, BigRational> = HashMap::new();
    for symbol in &answer.named.symbols {
        assert_eq!(symbol.kind, SymbolKind::Length);
        let thousandths = 1 + random.below(9_999_999) as i64;
        values.insert(
            symbol.name.clone(),
            BigRational::new(thousandths.into(), 1000.into()),
        );
    }
    // Ties are `earlier = later`: the last ones are made to hold first.
    let mut conditions: Vec<&str> = conditions.to_vec();
    conditions.sort_by_key(|c| {
        let first = c.split(' ').next();
        let place = answer
            .named
            .symbols
            .iter()
            .position(|s| Some(s.name.as_str()) == first);
        std::cmp::Reverse(place)
    });
    for condition in conditions {
        let (name, right) = condition.split_once(" = ").expect("an equation");
        let mut sum = BigRational::zero();
        let mut minus = false;
        for word in right.split(' ') {
            let bare = word.trim_start_matches('-');
            minus ^= word.starts_with('-');
            let value = match bare {
                "+" | "" => continue,
                _ => values.get(bare).cloned().unwrap_or_else(|| {
                    let given = answer.named.symbols.iter().find(|s| s.name == name);
                    let value = given.expect("a symbol").given.value.abs() * 10.0;
                    BigRational::new((value.round() as i64).into(), 10.into())
                }),
            };
            sum += if minus { -value } else { value };
            minus = false;
        }
        values.insert(name.to_owned(), sum);
    }
    let mut robot = answer.named.description.clone();
    for (name, value) in &mut robot.constants {
        if let Some(x) = values.get(name) {
            *value = Quantity::from_rational(x);
        }
    }
    let mechanism = Mechanism::new(&robot).expect("a mechanism");
    let order: Vec<usize> = (0..answer.parameters.len()).collect();
    let decision = decide_exactly(&mechanism, Model::D, &order, 0).expect("a decision");
    answer.base.len().saturating_sub(decision.kept.len())
}

#[test]
fn causes_lower_the_rank_are_minimal_and_none_is_missing() {
    let (mut ties, mut single) = (0, 0);
    let mut random = SplitMix64::new(6);
    for seed in 0..100 {
        let robot = of_few_values(seed);
        let answer = relations(&robot, &SymbolicOptions::default());
        let given: Vec<String> = answer
            .named
            .symbols
            .iter()
            .map(|s| format!("{} = {}", s.name, s.given))
            .collect();
        let all: Vec<&str> = given.iter().map(String::as_str).collect();
        let together = fewer(&answer, &all, &mut random);
        assert_eq!(
            answer.special.is_empty(),
            together == 0,
            "{seed}: {:?}",
            answer.special
        );
        for cause in &answer.special {
            let conditions: Vec<&str> = cause.values.iter().map(String::as_str).collect();
            let whole = fewer(&answer, &conditions, &mut random);
            assert!(
                whole >= cause.fewer && cause.fewer > 0,
                "{seed}: {cause:?} {whole}"
            );
            if cause.beyond {
                continue;
            }
            assert_eq!(whole, cause.fewer, "{seed}: {cause:?}");
            for left_out in 0..conditions.len() {
                let mut part = conditions.clone();
                part.remove(left_out);
                assert_eq!(fewer(&answer, &part, &mut random), 0, "{seed}: {part:?}");
            }
        }
        let is_tie = |s: &Special| s.values.iter().any(|v| !given.contains(v));
        ties += answer.special.iter().filter(|s| is_tie(s)).count();
        single += answer.special.iter().filter(|s| !is_tie(s)).count();
    }
    assert!(ties > 2 && single > 2, "{ties} {single}");
}
