//! What the benches share: robots of 6, 7, 12 and 30 joints, and short measurements.

use std::fmt::Write;
use std::time::Duration;

use criterion::Criterion;
use roberval_mechanism::Mechanism;

/// The robots measured: PUMA 560, iiwa 14, a four-legged and a two-armed tree.
///
/// # Panics
/// If a robot of the catalogue is missing.
#[must_use]
pub fn robots() -> Vec<(&'static str, Mechanism)> {
    let built_in = |name| roberval_formats::load(name).expect("in the catalogue");
    let written = |name, limbs: &[Limb]| {
        roberval_formats::parse_toml(&tree(limbs), name).expect("a valid robot")
    };
    let legs: Vec<Limb> = (1..=4).map(|leg| ("base", leg, 3)).collect();
    let body = [
        ("base", 1, 6),
        ("base", 2, 6),
        ("base", 3, 3),
        ("3_3", 4, 7),
        ("3_3", 5, 7),
        ("3_3", 6, 1),
    ];
    [
        ("6 joints", built_in("puma560")),
        ("7 joints", built_in("iiwa14")),
        ("12 joints", written("quadruped", &legs)),
        ("30 joints", written("humanoid", &body)),
    ]
    .map(|(name, robot)| (name, Mechanism::new(&robot).expect("valid")))
    .into()
}

/// Robots whose joints follow others: the SR400 with its parallelogram, and a humanoid of 60
/// joints, of which 20 are finger joints that follow the first one of their finger.
///
/// # Panics
/// If a robot is not valid.
#[must_use]
pub fn coupled_robots() -> Vec<(&'static str, Mechanism)> {
    let sr400 = roberval_formats::load("sr400").expect("in the catalogue");
    let mut limbs = vec![
        ("base", 1, 6),
        ("base", 2, 6),
        ("base", 3, 3),
        ("3_3", 4, 7),
        ("3_3", 5, 7),
        ("3_3", 6, 1),
    ];
    let fingers = 11..=20;
    limbs.extend(
        fingers
            .clone()
            .map(|f| (if f <= 15 { "4_7" } else { "5_7" }, f, 3)),
    );
    let mut text = tree(&limbs);
    for finger in fingers {
        for (joint, ratio) in [(2, "1"), (3, "2/3")] {
            write!(
                text,
                "[[couple]]\njoint = \"{finger}_{joint}\"\nequals = {{ \"{finger}_1\" = \"{ratio}\" }}\n"
            )
            .expect("a string takes all text");
        }
    }
    let hands = roberval_formats::parse_toml(&text, "humanoid with hands").expect("a robot");
    [("sr400", sr400), ("60 joints, 20 follow", hands)]
        .map(|(name, robot)| (name, Mechanism::new(&robot).expect("valid")))
        .into()
}

/// The link that a limb stands on, its number and its joints.
type Limb<'a> = (&'a str, usize, usize);

/// Limbs of revolute joints with right twists: link j of limb k is named k_j.
fn tree(limbs: &[Limb]) -> String {
    let mut toml = String::from("name = \"tree\"\n");
    for &(root, limb, joints) in limbs {
        for joint in 1..=joints {
            let antecedent = match joint {
                1 => root.to_owned(),
                _ => format!("{limb}_{}", joint - 1),
            };
            let alpha = [90, 0, -90][joint % 3];
            write!(
                toml,
                "[[link]]\nname = \"{limb}_{joint}\"\nantecedent = \"{antecedent}\"\n\
                 alpha = \"{alpha} deg\"\nb = 0.{limb}\nd = 0.{joint}5\ntheta = 0\nr = 0.{joint}2\n"
            )
            .expect("a string takes all text");
        }
    }
    toml
}

/// Short measurements: all benches together take half a minute on a quiet machine.
#[must_use]
pub fn short() -> Criterion {
    Criterion::default()
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_millis(600))
        .sample_size(10)
        .nresamples(2000)
}
