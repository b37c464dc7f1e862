//! Joints of a generated robot that follow from others.

use roberval_mechanism::{Closure, Couple, JointKind, RobotDescription, Term};
use roberval_scalar::{Quantity, SplitMix64};

use crate::{decimal, degrees};

/// Probability that a joint follows others.
const DEPENDENT: f64 = 0.4;

/// Gear ratios and the multipliers of parallelograms.
const MULTIPLIERS: [&str; 9] = ["1", "-1", "1", "-1", "1/2", "-3/2", "2", "1.25", "-1/3"];

/// The robot with random affine couples, chains of them included; at least one joint
/// moves by itself, and a robot of one joint is left as it is.
#[must_use]
pub fn coupled(mut robot: RobotDescription, seed: u64) -> RobotDescription {
    let mut random = SplitMix64::new(seed ^ 0xc0_7713);
    let moving = |l: &usize| robot.links[*l].joint != JointKind::Fixed;
    let mut order: Vec<usize> = (0..robot.links.len()).filter(moving).collect();
    for k in (1..order.len()).rev() {
        order.swap(k, random.below(k + 1));
    }
    for k in 1..order.len() {
        let sure = k == 1;
        if !sure && random.uniform(0.0, 1.0) >= DEPENDENT {
            continue;
        }
        let link = order[k];
        let kind = robot.links[link].joint;
        let mut terms: Vec<Term> = Vec::new();
        for _ in 0..1 + random.below(2) {
            let source = &robot.links[order[random.below(k)]];
            if terms.iter().any(|t| t.joint == source.name) {
                continue;
            }
            terms.push(Term {
                joint: source.name.clone(),
                multiplier: multiplier(kind, source.joint, &mut random),
            });
        }
        robot.couples.push(Couple {
            joint: robot.links[link].name.clone(),
            terms,
            offset: offset(kind, &mut random),
            expression: None,
        });
        let all: Vec<usize> = (0..robot.links.len()).collect();
        if Closure::of(&robot, &all).is_err() {
            robot.couples.pop(); // its multipliers cancel
            continue;
        }
        let driven = random.below(4) == 0;
        robot.links[link].active = driven;
        robot.links[link].rotor &= driven;
        if !robot.links[link].rotor {
            robot.links[link].inertia[10] = None;
        }
    }
    robot
}

fn multiplier(kind: JointKind, source: JointKind, random: &mut SplitMix64) -> Quantity {
    if kind == source {
        let text = MULTIPLIERS[random.below(MULTIPLIERS.len())];
        return Quantity::parse_number(text, &[]).expect("a number");
    }
    // rad per m, or m per rad.
    let size = 1 + random.below(5) as i64;
    let sign = if random.below(2) == 0 { 1 } else { -1 };
    decimal(
        sign * size,
        if kind == JointKind::Revolute { 0 } else { -1 },
    )
}

fn offset(kind: JointKind, random: &mut SplitMix64) -> Quantity {
    match (random.below(3), kind) {
        (0, JointKind::Revolute) => degrees(90 * (random.below(4) as i64 - 1)),
        (1, JointKind::Revolute) => decimal(random.below(300) as i64, -2),
        (0 | 1, _) => decimal(random.below(300) as i64, -3),
        _ => decimal(0, 0),
    }
}
