//! The structural answer by three routes that share no recursion: rows in prime fields,
//! the parameter nullspace link by link, and the float staircase.
//!
//! `ROBERVAL_LONG_TESTS=1` runs 10,000 generated robots instead of 600.

use roberval_base::{Engine, Model, Options, base_parameters, decide_exactly, nullspace_rank};
use roberval_mechanism::{Geometry, JointKind, Mechanism, RobotDescription, SourceFormat};
use roberval_scalar::{Quantity, SplitMix64};
use roberval_testkit::{Angles, Family, decimal, make_planar};

fn robots() -> u64 {
    match std::env::var("ROBERVAL_LONG_TESTS") {
        Ok(value) if value != "0" => 10_000,
        _ => 600,
    }
}

/// Every combination of format, angles, rotors and gravity in turn; the generator itself
/// draws along an axis, tilted, or no gravity, and rotors on four joints of five.
fn generated(seed: u64) -> RobotDescription {
    let pick = |n: u64, radix: u64| seed / n % radix;
    let mut robot = Family {
        format: [SourceFormat::Mdh, SourceFormat::Urdf][pick(1, 2) as usize],
        angles: [
            Angles::Right,
            Angles::Mixed,
            Angles::Fifteens,
            Angles::Oblique,
        ][pick(2, 4) as usize],
        ..Family::default()
    }
    .robot(seed);
    if pick(8, 4) == 0 {
        robot.links.iter_mut().for_each(|l| l.rotor = false);
    }
    if pick(32, 4) == 0 {
        robot.gravity = [0, 0, 0].map(|g| decimal(g, 0));
    }
    robot
}

/// The same with planar joints (of URDF placements), and every other one on a base that
/// floats.
fn planar_or_floating(seed: u64) -> RobotDescription {
    let mut robot = generated(seed);
    if robot.format == SourceFormat::Urdf {
        let joints = 1 + seed as usize / 4 % 2;
        for link in (0..robot.links.len()).rev().step_by(3).take(joints) {
            make_planar(&mut robot, link);
        }
    }
    match seed / 2 % 2 {
        0 => robot,
        _ => robot.with_floating_base(),
    }
}

fn mechanism(description: &RobotDescription) -> Mechanism {
    Mechanism::new(description).expect("a valid robot")
}

/// The numbers of kept columns of each link.
fn kept_per_link(robot: &Mechanism, kept: &[usize]) -> Vec<usize> {
    let mut counts = vec![0; robot.links.len()];
    for &column in kept {
        counts[robot.parameters().ids()[column].link] += 1;
    }
    counts
}

/// What disagrees about this robot, if anything does.
fn disagreement(robot: &Mechanism, seed: u64) -> Option<String> {
    let all: Vec<usize> = (0..robot.parameters().len()).collect();
    let exact = decide_exactly(robot, Model::D, &all, seed).expect("in a field");
    let nullspace = nullspace_rank(robot, !seed).expect("in a field");
    let options = Options {
        engine: Engine::Qr,
        seed,
        ..Options::default()
    };
    let float = base_parameters(robot, &options).expect("valid");
    let same = nullspace.kept == exact.kept
        && nullspace.rank == exact.kept.len()
        && nullspace.per_link == kept_per_link(robot, &exact.kept)
        && float.base == exact.kept
        && float.no_effect == exact.no_effect;
    (!same).then(|| {
        format!(
            "{}: exact {}, nullspace {} ({:?}), float {}; {:?}",
            robot.name,
            exact.kept.len(),
            nullspace.rank,
            nullspace.per_link,
            float.rank(),
            float.diagnosis.messages
        )
    })
}

#[test]
fn the_puma_has_1_7_8_8_8_8_base_parameters() {
    let robot = mechanism(&roberval_formats::load("puma560").expect("in the catalogue"));
    let answer = nullspace_rank(&robot, 0).expect("in a field");
    assert_eq!(answer.per_link, [1, 7, 8, 8, 8, 8]);
    assert_eq!(answer.rank, 40);
}

#[test]
fn three_routes_agree_on_the_catalogue() {
    for entry in roberval_formats::catalogue() {
        let robot = mechanism(&roberval_formats::load(entry.name).expect("in the catalogue"));
        if robot.closure.is_some() || robot.assembly.is_some() {
            continue; // the nullspace algorithm knows trees only
        }
        assert_eq!(disagreement(&robot, 1), None, "{}", entry.name);
    }
}

#[test]
fn three_routes_agree_on_generated_robots() {
    let count = robots();
    let wrong: Vec<String> = (0..count)
        .filter_map(|seed| disagreement(&mechanism(&generated(seed)), seed))
        .collect();
    eprintln!("{count} generated robots, {} disagreements", wrong.len());
    assert!(wrong.is_empty(), "{:#?}", &wrong[..wrong.len().min(10)]);
}

#[test]
fn three_routes_agree_on_generated_robots_with_planar_joints_or_floating() {
    let count = robots() / 2;
    let wrong: Vec<String> = (0..count)
        .filter_map(|seed| disagreement(&mechanism(&planar_or_floating(seed)), seed))
        .collect();
    assert!(wrong.is_empty(), "{:#?}", &wrong[..wrong.len().min(10)]);
}

/// All ten parameters of the base are visible, 7 of a body on a revolute joint and 4 on a
/// prismatic one (and the rotor's inertia): whatever the geometry is, for the base moves
/// in all ways.
#[test]
fn a_floating_robot_has_10_and_7_a_revolute_and_4_a_prismatic_joint() {
    for seed in 0..200 {
        let robot = mechanism(&generated(seed).with_floating_base());
        let per_link: Vec<usize> = robot
            .links
            .iter()
            .map(|link| match link.joint {
                JointKind::Floating => 10,
                JointKind::Revolute => 7 + usize::from(link.rotor),
                JointKind::Prismatic => 4 + usize::from(link.rotor),
                JointKind::Fixed => 0,
            })
            .collect();
        let all: Vec<usize> = (0..robot.parameters().len()).collect();
        let exact = decide_exactly(&robot, Model::H, &all, seed).expect("in a field");
        assert_eq!(kept_per_link(&robot, &exact.kept), per_link, "robot {seed}");
    }
}

/// Inserts turns by a, b and -(a + b) about x, y or z, decimals, before some placements: nothing
/// changes. With `leave`, the first of them is left out here and there.
fn related_angles(robot: &mut RobotDescription, random: &mut SplitMix64, leave: bool) {
    for link in &mut robot.links {
        let Geometry::Placed { origins, .. } = &mut link.geometry else {
            panic!("a URDF robot")
        };
        if random.below(2) == 0 {
            continue;
        }
        let [a, b] = [(); 2].map(|()| random.below(100) as i64 + 20);
        let axis = random.below(3);
        let first = usize::from(leave && random.below(3) == 0);
        for angle in &[a, b, -(a + b)][first..] {
            let mut turn = origins[0].clone();
            turn.xyz = [(); 3].map(|()| Quantity::zero());
            turn.rpy = [(); 3].map(|()| Quantity::zero());
            turn.rpy[axis] = decimal(*angle, -2);
            origins.insert(0, turn);
        }
    }
}

#[test]
fn three_routes_agree_where_decimal_angles_are_related() {
    for seed in 0..200 {
        let family = Family {
            format: SourceFormat::Urdf,
            angles: [Angles::Right, Angles::Mixed][seed as usize % 2],
            ..Family::default()
        };
        let original = family.robot(seed);
        let mut random = SplitMix64::new(seed);
        let mut changed = original.clone();
        related_angles(&mut changed, &mut random, false);
        let [before, after] = [&original, &changed].map(|description| {
            let robot = mechanism(description);
            let all: Vec<usize> = (0..robot.parameters().len()).collect();
            decide_exactly(&robot, Model::D, &all, seed).expect("in a field")
        });
        assert_eq!(before.kept, after.kept, "robot {seed}: the turns cancel");
        assert!(after.generic.is_empty());
        related_angles(&mut changed, &mut random, true);
        assert_eq!(disagreement(&mechanism(&changed), seed), None, "{seed}");
    }
}

/// On an antecedent that moves freely, a revolute link hides XX + YY, MZ and M (z being
/// its axis) and a prismatic one its six moments of inertia; on another, more is hidden.
#[test]
fn no_link_contributes_more_than_on_an_antecedent_that_moves_freely() {
    let mut most = [0, 0];
    for seed in 0..300 {
        let robot = mechanism(&generated(seed));
        let answer = nullspace_rank(&robot, seed).expect("in a field");
        for (link, &count) in robot.links.iter().zip(&answer.per_link) {
            let (kind, hidden) = match link.joint {
                JointKind::Revolute => (0, 3),
                JointKind::Prismatic => (1, 6),
                JointKind::Fixed | JointKind::Floating => {
                    assert_eq!(count, 0);
                    continue;
                }
            };
            let columns = if link.rotor { 11 } else { 10 };
            assert!((1..=columns - hidden).contains(&count), "robot {seed}");
            most[kind] = most[kind].max(count);
        }
    }
    assert_eq!(most, [8, 5], "the bound is reached");
}

#[test]
fn the_field_does_not_matter() {
    for seed in 0..100 {
        let robot = mechanism(&generated(seed));
        let [one, other] = [1, 2].map(|s| nullspace_rank(&robot, s).expect("in a field"));
        assert_ne!(one.prime, other.prime);
        assert_eq!(one.kept, other.kept);
    }
}
