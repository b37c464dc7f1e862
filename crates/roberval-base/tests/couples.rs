//! Robots whose joints follow from others: published counts and the laws of the method.

use std::collections::BTreeSet;

use roberval_base::{Choice, Engine, Model, Options, Tolerance, base_parameters, compare};
use roberval_mechanism::{Mechanism, RobotDescription, SourceFormat};
use roberval_testkit::{Family, coupled};

const ROBOTS: u64 = 150;

/// Of them, those that floats find hard: many joints that follow one coordinate by ratios
/// such as 3/2, -1/3 and 5/4 leave few independent functions, and small values.
const MOST_DOUBTFUL: usize = 6;

fn generated(seed: u64) -> RobotDescription {
    let format = [SourceFormat::Mdh, SourceFormat::Urdf][seed as usize % 2];
    let family = Family {
        links: (2, 7),
        format,
        ..Family::default()
    };
    coupled(family.robot(seed), seed)
}

fn catalogue(name: &str) -> RobotDescription {
    roberval_formats::load(name).expect("built in")
}

fn mechanism(robot: &RobotDescription) -> Mechanism {
    Mechanism::new(robot).expect("valid")
}

/// c, b and the base columns, the same for d, d0 and h.
fn counts(robot: &RobotDescription) -> (usize, usize, Vec<String>) {
    let robot = mechanism(robot);
    let labels = robot.parameters().labels().to_vec();
    let of = |model| {
        let options = Options {
            model,
            ..Options::default()
        };
        let answer = base_parameters(&robot, &options).expect("decided");
        assert!(answer.diagnosis.clear, "{:?}", answer.diagnosis.messages);
        let base = answer.base.iter().map(|&c| labels[c].clone()).collect();
        (labels.len() - answer.no_effect.len(), answer.rank(), base)
    };
    let [d, d0, h] = [Model::D, Model::D0, Model::H].map(of);
    assert_eq!(d, d0);
    assert_eq!(d, h);
    d
}

#[test]
fn the_papers_parallelogram_has_35_base_parameters() {
    let robot = catalogue("hitachi_hpr");
    let (c, b, base) = counts(&robot);
    assert_eq!((c, b), (62, 35));
    let expected = "ZZ_1 XX_2 XY_2 XZ_2 YZ_2 ZZ_2 MX_2 MY_2 XX_3 XY_3 XZ_3 YZ_3 ZZ_3 MX_3 MY_3 \
                    MX_4 MY_4 Ia_4 MY_5 XX_6 XY_6 XZ_6 YZ_6 ZZ_6 MX_6 MY_6 Ia_6 \
                    XX_7 XY_7 XZ_7 YZ_7 ZZ_7 MX_7 MY_7 Ia_7";
    assert_eq!(base.join(" "), expected);
    let answer = base_parameters(&mechanism(&robot), &Options::default()).expect("decided");
    let opened = answer.diagnosis.structure.and_then(|s| s.opened);
    assert_eq!(opened.map(|o| o.rank), Some(46));
    let mut tree = robot;
    tree.couples.clear();
    assert_eq!(counts(&tree).1, 46);
}

/// Which motors there are changes the parameters, hardly their number.
#[test]
fn the_papers_parallelogram_with_other_motors() {
    let with = |rotors: &[&str]| {
        let mut robot = catalogue("hitachi_hpr");
        for link in &mut robot.links {
            link.rotor = rotors.contains(&link.name.as_str());
        }
        let (c, b, _) = counts(&robot);
        (c, b)
    };
    assert_eq!(with(&["1", "2", "3", "4", "5", "6", "7"]), (64, 35));
    assert_eq!(with(&["1", "2", "3", "6", "7"]).1, 34);
}

/// The forearm numbered before the rod, and the constraint of the other closing angle:
/// t2 = t3 + t4 + pi, where t4 is now the forearm's.
#[test]
fn the_papers_parallelogram_in_the_other_numbering() {
    let text = include_str!("../../roberval-formats/catalogue/hitachi_hpr.toml");
    let swapped = text
        .replace(
            "name = \"4\"\nantecedent = \"2\"",
            "name = \"5\"\nantecedent = \"2\"",
        )
        .replace(
            "name = \"5\"\nantecedent = \"3\"",
            "name = \"4\"\nantecedent = \"3\"",
        )
        .replace("antecedent = \"5\"", "antecedent = \"4\"")
        .replace(
            "alpha = 0\nd = \"L1\"",
            "alpha = 0\nactive = false\nd = \"L1\"",
        );
    let head = swapped.split("[[couple]]").next().expect("links");
    let couples = "[[couple]]\njoint = \"2\"\nequals = { \"3\" = 1, \"4\" = 1 }\noffset = \"pi\"\n\
                   [[couple]]\njoint = \"5\"\nequals = { \"4\" = -1 }\noffset = \"-pi\"\n";
    let robot = roberval_formats::parse_toml(&format!("{head}{couples}"), "swapped");
    let (c, b, _) = counts(&robot.expect("readable"));
    assert_eq!((c, b), (62, 35));
}

#[test]
fn the_sr400_has_42_base_parameters_of_a_trees_53() {
    let robot = catalogue("sr400");
    let (c, b, _) = counts(&robot);
    assert_eq!((c, b), (75, 42));
    let mut tree = robot;
    tree.couples.clear();
    assert_eq!(counts(&tree).1, 53);
}

#[test]
fn all_models_and_engines_give_one_answer_on_coupled_robots() {
    let mut doubtful = Vec::new();
    for seed in 0..ROBOTS {
        let robot = mechanism(&generated(seed));
        let all = compare(&robot, &Choice::Paper, Tolerance::default(), seed).expect("valid");
        for route in &all.routes {
            let answer = &route.answer;
            let sure = answer.engine == Engine::Exact || answer.diagnosis.clear;
            assert!(
                route.same_columns || !sure,
                "seed {seed}, {} by {}: {} base parameters",
                answer.model.name(),
                answer.engine.name(),
                answer.rank()
            );
        }
        if !all.agree {
            doubtful.push(seed);
        }
    }
    assert!(doubtful.len() <= MOST_DOUBTFUL, "{doubtful:?}");
}

#[test]
fn neither_the_order_of_links_nor_that_of_couples_changes_the_rank() {
    for seed in 0..ROBOTS {
        let robot = generated(seed);
        let mut reversed = robot.clone();
        reversed.links.reverse();
        reversed.couples.reverse();
        let rank = |r: &RobotDescription| {
            let answer = base_parameters(&mechanism(r), &Options::default()).expect("decided");
            assert!(
                answer.diagnosis.clear,
                "{seed}: {:?}",
                answer.diagnosis.messages
            );
            let effects: BTreeSet<usize> = answer.no_effect.iter().copied().collect();
            (answer.rank(), effects.len())
        };
        assert_eq!(rank(&robot), rank(&reversed), "seed {seed}");
    }
}

#[test]
fn couples_never_add_base_parameters() {
    for seed in 0..ROBOTS {
        let answer = base_parameters(&mechanism(&generated(seed)), &Options::default());
        let answer = answer.expect("decided");
        let rank = answer.rank();
        if let Some(opened) = answer.diagnosis.structure.and_then(|s| s.opened) {
            assert!(
                rank <= opened.rank,
                "seed {seed}: {rank} of {}",
                opened.rank
            );
            assert!(opened.removed.len() >= opened.rank - rank, "seed {seed}");
        }
    }
}
