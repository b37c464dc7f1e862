//! Programs worked out here, on many robots: what no compiler need be run for.

use roberval_base::{Options, base_parameters};
use roberval_code::{Input, What};
use roberval_mechanism::{Mechanism, RobotDescription, SourceFormat};
use roberval_testkit::{Angles, Family, coupled};

use crate::cases::{Case, SAMPLES};

/// Robots of each kind.
const ROBOTS: u64 = 12;

/// Chains and trees, turning and sliding, on the ground or floating, some of them coupled.
fn robots() -> Vec<RobotDescription> {
    let mut robots = Vec::new();
    for (kind, angles) in [Angles::Right, Angles::Oblique, Angles::Mixed]
        .into_iter()
        .enumerate()
    {
        for format in [SourceFormat::Mdh, SourceFormat::Urdf] {
            for seed in 0..ROBOTS {
                let family = Family {
                    links: (1, 9),
                    branch: 0.2 * (seed % 3) as f64,
                    angles,
                    format,
                    ..Family::default()
                };
                let robot = family.robot(100 * kind as u64 + seed);
                robots.push(match seed % 4 {
                    0 => robot.with_floating_base(),
                    1 => coupled(robot, seed),
                    2 => coupled(robot, seed).with_floating_base(),
                    _ => robot,
                });
            }
        }
    }
    robots
}

impl Case {
    /// What the program gives at one sample.
    fn evaluated(&self, sample: usize) -> Vec<f64> {
        let at = |array: &[f64], k: usize| array[sample * (array.len() / SAMPLES) + k];
        let columns = self.code.independent;
        let prepared = self.code.prepare.as_ref().map(|prepare| {
            prepare.evaluate(|input| match input {
                Input::Parameter(k) => self.x[k],
                _ => f64::NAN,
            })
        });
        self.code.main.evaluate(|input| match input {
            Input::Q(k) => at(&self.q, k),
            Input::Qd(k) => at(&self.qd, k),
            Input::Qdd(k) => at(&self.qdd, k),
            Input::G(i, k) => at(&self.g, i * columns + k),
            Input::Parameter(k) => self.x[k],
            Input::Prepared(k) => prepared.as_ref().map_or(f64::NAN, |values| values[k]),
        })
    }
}

#[test]
fn programs_give_the_librarys_numbers_on_generated_robots() {
    for (index, robot) in robots().iter().enumerate() {
        let mechanism = Mechanism::new(robot).expect("a valid robot");
        let answer = base_parameters(&mechanism, &Options::default()).expect("an answer");
        let all: Vec<usize> = (0..mechanism.parameters().len()).collect();
        for (columns, what) in [&answer.base, &all]
            .into_iter()
            .flat_map(|c| What::ALL.map(|w| (c, w)))
        {
            let case = Case::new(&mechanism, what, (columns, &answer.no_effect), index as u64);
            for (sample, expected) in case.expected.iter().enumerate() {
                let found = case.evaluated(sample);
                let scale = expected.iter().fold(1.0_f64, |m, x| m.max(x.abs()));
                for (found, expected) in found.iter().zip(expected) {
                    let error = (found - expected).abs() / scale;
                    assert!(
                        error <= crate::TOLERANCE,
                        "{} {index}, {what:?}, {} parameters: {found} for {expected}",
                        robot.name,
                        columns.len()
                    );
                }
            }
        }
    }
}
