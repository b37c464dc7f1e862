//! Cleaned geometry: what is set right, what is left alone, and that it can be undone.

use std::f64::consts::PI;

use roberval_mechanism::{
    Change, CleanPolicy, Field, Geometry, JointKind, LinkDescription, Mechanism, Origin,
    RobotDescription, SourceFormat, Unit, apply, clean, revert,
};
use roberval_scalar::{Constants, LinearInPi, Quantity};
use roberval_testkit::{Angles, Family, angles_mut, dusty, lengths_mut, literal_style, tilted};

/// The decimals of the literal-style study. With three the rounding error may be 5e-4.
const STYLES: [usize; 6] = [16, 11, 9, 6, 5, 4];

/// Robots of the study, each written in all six styles.
const ROBOTS: u64 = 300;

/// An angle of the robot's own, rad: twice as far from every k pi/12 as a rounding.
const GENUINE: f64 = 2e-4;

fn default_clean(robot: &RobotDescription) -> roberval_mechanism::Cleaned {
    clean(robot, &CleanPolicy::default())
}

fn family(seed: u64, angles: Angles) -> Family {
    Family {
        angles,
        format: [SourceFormat::Mdh, SourceFormat::Urdf][(seed % 2) as usize],
        ..Family::default()
    }
}

/// Angles as fractions of pi and lengths as fractions, exactly.
fn exact(robot: &RobotDescription) -> Vec<LinearInPi> {
    let mut robot = robot.clone();
    let constants = robot.constants.clone();
    let value = |x: &mut Quantity| LinearInPi::of(&x.expr, &constants).expect("linear in pi");
    let mut all: Vec<LinearInPi> = angles_mut(&mut robot).into_iter().map(value).collect();
    all.extend(lengths_mut(&mut robot).into_iter().map(value));
    all
}

#[test]
fn every_literal_style_is_cleaned_to_the_exact_angles() {
    let mut snapped = 0;
    for seed in 0..ROBOTS {
        let robot = family(seed, Angles::Fifteens).robot(seed);
        for decimals in STYLES {
            let styled = literal_style(&robot, decimals);
            let cleaned = default_clean(&styled);
            assert_eq!(
                exact(&cleaned.description),
                exact(&robot),
                "seed {seed}, {decimals} decimals"
            );
            assert!(cleaned.near_misses.is_empty());
            let bound = 0.5 * 10.0_f64.powi(-(decimals as i32)) + 1e-15;
            assert!(cleaned.changes.iter().all(|c| c.size <= bound));
            snapped += cleaned.changes.len();
        }
    }
    // The study is about something: several angles a robot.
    assert!(snapped > 5 * 6 * ROBOTS as usize, "{snapped}");
}

#[test]
fn dust_is_cleaned_to_the_exact_lengths_and_axes() {
    for seed in 0..ROBOTS {
        let robot = family(seed, Angles::Fifteens).robot(seed);
        let dust = dusty(&literal_style(&robot, 6), seed);
        let cleaned = default_clean(&dust);
        assert_eq!(exact(&cleaned.description), exact(&robot), "seed {seed}");
    }
}

#[test]
fn genuine_off_angles_are_never_touched() {
    for seed in 0..ROBOTS {
        let robot = tilted(&family(seed, Angles::Mixed).robot(seed), seed, GENUINE);
        let cleaned = default_clean(&robot);
        assert!(cleaned.description == robot, "seed {seed}");
        assert_eq!(cleaned.changes, [], "seed {seed}");
    }
}

#[test]
fn cleaning_a_cleaned_robot_changes_nothing() {
    for seed in 0..ROBOTS {
        let robot = family(seed, Angles::Mixed).robot(seed);
        for decimals in STYLES {
            let styled = dusty(&literal_style(&robot, decimals), seed);
            for policy in [CleanPolicy::default(), CleanPolicy::aggressive()] {
                let once = clean(&styled, &policy);
                let twice = clean(&once.description, &policy);
                assert!(twice.description == once.description, "seed {seed}");
                assert_eq!(twice.changes, []);
                assert_eq!(twice.near_misses, once.near_misses);
            }
        }
    }
}

#[test]
fn the_literal_policy_changes_and_reports_nothing() {
    for seed in 0..20 {
        let robot = dusty(
            &literal_style(&family(seed, Angles::Right).robot(seed), 2),
            seed,
        );
        let cleaned = clean(&robot, &CleanPolicy::literal());
        assert!(cleaned.description == robot, "seed {seed}");
        assert!(cleaned.changes.is_empty() && cleaned.near_misses.is_empty());
    }
}

#[test]
fn all_changes_but_one_and_only_one_meet_in_the_middle() {
    for seed in 0..60 {
        let robot = dusty(
            &literal_style(&family(seed, Angles::Right).robot(seed), 5),
            seed,
        );
        let cleaned = default_clean(&robot);
        assert!(apply(&robot, &cleaned.changes) == cleaned.description);
        assert!(apply(&robot, &[]) == robot);
        for (index, change) in cleaned.changes.iter().enumerate() {
            let all_but_one = revert(&cleaned, index);
            assert!(all_but_one != cleaned.description);
            let one = std::slice::from_ref(change);
            assert!(apply(&all_but_one, one) == cleaned.description);
            // Its size is relative to an axis that is a little longer now.
            let left = default_clean(&all_but_one).changes;
            assert_eq!(shown(&left), shown(one), "seed {seed}");
            let others: Vec<Change> =
                [&cleaned.changes[..index], &cleaned.changes[index + 1..]].concat();
            assert!(apply(&robot, &others) == all_but_one);
        }
        assert!(revert(&cleaned, cleaned.changes.len()) == cleaned.description);
    }
}

#[test]
fn inertias_and_everything_else_stay_as_written() {
    for seed in 0..40 {
        let robot = dusty(
            &literal_style(&family(seed, Angles::Right).robot(seed), 4),
            seed,
        );
        let mut cleaned = clean(&robot, &CleanPolicy::aggressive()).description;
        for (link, before) in cleaned.links.iter_mut().zip(&robot.links) {
            link.geometry = before.geometry.clone();
        }
        assert!(cleaned == robot, "seed {seed}");
    }
}

#[test]
fn the_cleaned_robot_is_the_exact_one_in_floats() {
    for seed in 0..ROBOTS {
        let robot = family(seed, Angles::Right).robot(seed);
        let Ok(exact) = Mechanism::new(&robot) else {
            continue;
        };
        let dust = dusty(&literal_style(&robot, 4), seed);
        let cleaned = Mechanism::new(&default_clean(&dust).description).unwrap();
        for (a, b) in cleaned.links.iter().zip(&exact.links) {
            assert_eq!((a.rotation, a.axis), (b.rotation, b.axis), "seed {seed}");
        }
    }
}

/// A robot of one URDF joint (behind a fixed one).
fn placed(rpy: [&str; 3], xyz: [&str; 3], axis: [&str; 3]) -> RobotDescription {
    let read = |text: &str| Quantity::parse_decimal(text).unwrap();
    let origin = |joint: &str, xyz: [&str; 3], rpy: [&str; 3]| Origin {
        joint: joint.to_owned(),
        xyz: xyz.map(read),
        rpy: rpy.map(read),
    };
    let mut robot = Family {
        links: (1, 1),
        format: SourceFormat::Urdf,
        ..Family::default()
    }
    .robot(0);
    robot.gravity = ["0", "0", "-9.81"].map(read);
    robot.links[0] = LinkDescription {
        name: "hand".into(),
        joint_name: Some("wrist".into()),
        joint: JointKind::Revolute,
        geometry: Geometry::Placed {
            origins: vec![
                origin("mount", ["0"; 3], ["0", "3.1416", "0"]),
                origin("wrist", xyz, rpy),
            ],
            axis: axis.map(read),
        },
        ..robot.links[0].clone()
    };
    robot
}

fn shown<T: ToString>(items: &[T]) -> Vec<String> {
    items.iter().map(T::to_string).collect()
}

#[test]
fn changes_and_near_misses_say_what_where_and_how_far() {
    let robot = placed(
        ["1.5708", "1.57", "-1.5707963267948966"],
        ["4.2e-17", "0.3", "-1e-6"],
        ["1e-9", "0", "-1.00"],
    );
    let cleaned = default_clean(&robot);
    assert_eq!(
        shown(&cleaned.changes),
        [
            "mount rpy[1] = 3.1416 is 7.3e-6 rad from pi",
            "wrist xyz[0] = 4.2e-17 is 4.2e-17 m from 0",
            "wrist xyz[2] = -1e-6 is 1.0e-6 m from 0",
            "wrist rpy[0] = 1.5708 is 3.7e-6 rad from pi/2",
            "wrist rpy[2] = -1.5707963267948966 is 6.1e-17 rad from -pi/2",
            "wrist axis[0] = 1e-9 is 1.0e-9 of the axis' length, taken as 0",
        ]
    );
    let quiet: Vec<bool> = cleaned.changes.iter().map(Change::is_last_digit).collect();
    assert_eq!(quiet, [false, true, false, false, true, false]);
    assert_eq!(
        shown(&cleaned.near_misses),
        ["wrist rpy[1] = 1.57 is 8.0e-4 rad from pi/2: left as written"]
    );
    let near = &cleaned.near_misses[0].change;
    assert_eq!(
        (near.field, near.field.unit()),
        (Field::Rpy(1), Unit::Angle)
    );
    assert_eq!(near.link.as_deref(), Some("hand"));
    assert_eq!(
        apply(&cleaned.description, std::slice::from_ref(near)),
        clean(&robot, &CleanPolicy::aggressive()).description
    );
}

#[test]
fn axes_that_say_what_they_mean_are_left_as_written() {
    for axis in [
        ["0", "0", "1"],
        ["0", "-2", "0.0"],
        ["1", "1", "1"],
        ["0.707107", "-0.707107", "0"],
    ] {
        let robot = placed(["0", "-0.0", "0.1"], ["0", "0", "0.5"], axis);
        let changes = default_clean(&robot).changes;
        assert_eq!(changes.len(), 1, "the fixed joint's: {:?}", shown(&changes));
    }
}

#[test]
fn truncations_to_four_decimals_are_roundings_too() {
    for (text, meant) in [("3.1415", "pi"), ("-1.5707", "-pi/2"), ("0.5235", "pi/6")] {
        let robot = placed([text, "0", "0"], ["0"; 3], ["0", "0", "1"]);
        assert_eq!(default_clean(&robot).changes[1].became.text, meant);
    }
}

#[test]
fn the_axis_of_a_fixed_joint_has_no_meaning_and_is_left() {
    let mut robot = placed(["0"; 3], ["0"; 3], ["1e-9", "0", "1"]);
    assert_eq!(default_clean(&robot).changes.len(), 2);
    robot.links[0].joint = JointKind::Fixed;
    assert_eq!(default_clean(&robot).changes.len(), 1);
}

#[test]
fn the_known_near_misses_are_shown_and_set_right_on_request_only() {
    for (text, meant) in [
        ("1.57", "pi/2"),
        ("1.571", "pi/2"),
        ("3.14", "pi"),
        ("-0.78", "-pi/4"),
        ("1.047", "pi/3"),
        ("0.2618", ""),
        ("1.58", ""),
        ("0.77", ""),
    ] {
        let robot = placed([text, "0", "0"], ["0"; 3], ["0", "0", "1"]);
        let near = default_clean(&robot).near_misses;
        let found: Vec<&str> = near.iter().map(|n| n.change.became.text.as_str()).collect();
        if meant.is_empty() {
            assert_eq!(found, [""; 0], "{text}");
        } else {
            assert_eq!(found, [meant], "{text}");
            let bold = clean(&robot, &CleanPolicy::aggressive());
            assert!(bold.near_misses.is_empty());
            assert_eq!(bold.changes[1].became.text, meant);
        }
    }
}

/// The generated two-link robot with this alpha at its last link.
fn with_alpha(text: &str, constants: &Constants) -> RobotDescription {
    let mut robot = Family {
        links: (1, 1),
        angles: Angles::Right,
        ..Family::default()
    }
    .robot(3);
    robot.constants = constants.to_vec();
    if let Geometry::Mdh(g) = &mut robot.links[0].geometry {
        g.alpha = Quantity::parse_angle(text, constants).unwrap();
    }
    robot
}

#[test]
fn fractions_of_a_turn_are_kept_whatever_the_policy() {
    for text in [
        "pi/2",
        "-90 deg",
        "89.999 deg",
        "pi/7",
        "(270 - 180) deg",
        "1.001*pi",
    ] {
        let robot = with_alpha(text, &[]);
        let cleaned = clean(&robot, &CleanPolicy::aggressive());
        assert!(cleaned.description == robot, "{text}");
    }
    let robot = with_alpha("89.999 deg", &[]);
    assert_eq!(
        shown(&default_clean(&robot).near_misses),
        ["link 1 alpha = 89.999 deg is 1.7e-5 rad from pi/2: left as written"]
    );
}

#[test]
fn conversions_from_degrees_are_changes_of_the_last_digit() {
    for text in [
        "89.99999999999999 deg",
        "90*3.141592653589793/180",
        "1.5707963267948963",
    ] {
        let cleaned = default_clean(&with_alpha(text, &[]));
        let [change] = &cleaned.changes[..] else {
            panic!("{text}: {:?}", shown(&cleaned.changes));
        };
        assert!(
            change.is_last_digit() && change.became.text == "pi/2",
            "{text}"
        );
    }
}

#[test]
fn a_constant_is_cleaned_where_it_is_used() {
    let constants = [(
        "A".to_owned(),
        Quantity::parse_number("3.1416", &[]).unwrap(),
    )];
    let cleaned = default_clean(&with_alpha("A/2", &constants));
    assert_eq!(
        shown(&cleaned.changes),
        ["link 1 alpha = A/2 is 3.7e-6 rad from pi/2"]
    );
    assert_eq!(cleaned.description.constants, constants);
}

#[test]
fn dust_of_gravity_is_removed_and_no_gravity_is_none() {
    let read = |text: &str| Quantity::parse_decimal(text).unwrap();
    let mut robot = placed(["0"; 3], ["0"; 3], ["0", "0", "1"]);
    robot.gravity = ["6e-16", "9.7e-6", "-9.81"].map(read);
    let shown = shown(&default_clean(&robot).changes);
    assert_eq!(
        shown[..2],
        [
            "gravity[0] = 6e-16 is 6.1e-17 of gravity, taken as 0",
            "gravity[1] = 9.7e-6 is 9.9e-7 of gravity, taken as 0",
        ]
    );
    robot.gravity = ["0"; 3].map(read);
    assert_eq!(default_clean(&robot).changes.len(), 1);
    robot.gravity = ["1e-300", "0", "0"].map(read);
    assert_eq!(default_clean(&robot).changes.len(), 1);
}

#[test]
fn huge_numbers_are_no_roundings() {
    let huge = "1.7e308";
    let robot = placed([huge, "1e5", "-101"], [huge; 3], [huge; 3]);
    let cleaned = default_clean(&robot);
    assert_eq!(cleaned.changes.len(), 1, "{:?}", shown(&cleaned.changes));
    assert!(cleaned.near_misses.is_empty());
    let tiny = placed(["1e-320"; 3], ["1e-400"; 3], ["1e-320"; 3]);
    let changes = default_clean(&tiny).changes;
    assert_eq!(changes.len(), 7, "axis (1, 1, 1): {:?}", shown(&changes));
}

#[test]
fn a_lumped_joint_is_one_change_for_all_links_behind_it() {
    let mut robot = placed(["1.5708", "0", "0"], ["0"; 3], ["0", "0", "1"]);
    let mut twin = robot.links[0].clone();
    twin.name = "thumb".into();
    robot.links.push(twin);
    let cleaned = default_clean(&robot);
    assert_eq!(cleaned.changes.len(), 2);
    let back = revert(&cleaned, 0);
    for link in &back.links {
        let Geometry::Placed { origins, .. } = &link.geometry else {
            panic!("a URDF link");
        };
        assert_eq!(origins[0].rpy[1].value, 3.1416);
        assert!((origins[1].rpy[0].value - PI / 2.0).abs() < 1e-16);
    }
}
