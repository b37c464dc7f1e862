//! Joints that follow from others: the projected regressor against the opened tree's and
//! against the rate of the energy.

use roberval_mechanism::{Mechanism, SourceFormat, VariableLaw};
use roberval_regressor::{Model, Regressor, States};
use roberval_scalar::SplitMix64;
use roberval_testkit::{Family, coupled};

const ROBOTS: u64 = 200;

/// Sums of products of the same numbers in another order.
const ROUNDING: f64 = 500.0 * f64::EPSILON;

/// Central differences at step 1e-4 are good to about step^2 times velocities cubed.
const STEP: f64 = 1e-4;
const DIFFERENCES: f64 = 1e-3;

fn robots() -> impl Iterator<Item = (Mechanism, Mechanism)> {
    (0..ROBOTS).map(|seed| {
        let format = [SourceFormat::Mdh, SourceFormat::Urdf][seed as usize % 2];
        let family = Family {
            links: (2, 8),
            format,
            ..Family::default()
        };
        let robot = coupled(family.robot(seed), seed);
        let mut opened = robot.clone();
        opened.couples.clear();
        let valid = |r| Mechanism::new(&r).expect("valid");
        (valid(robot), valid(opened))
    })
}

struct State([Vec<f64>; 3]);

impl State {
    fn random(n: usize, seed: u64) -> Self {
        let mut random = SplitMix64::new(seed);
        let mut draw = |size: f64| (0..n).map(|_| random.uniform(-size, size)).collect();
        Self([draw(3.0), draw(1.0), draw(2.0)])
    }

    fn as_states(&self) -> States<'_> {
        let [q, qd, qdd] = &self.0;
        States { q, qd, qdd }
    }

    fn after(&self, t: f64) -> Self {
        let [q, qd, qdd] = &self.0;
        let position = |i: usize| q[i] + qd[i] * t + qdd[i] * t * t / 2.0;
        let velocity = |i: usize| qd[i] + qdd[i] * t;
        let all = 0..q.len();
        Self([
            all.clone().map(position).collect(),
            all.map(velocity).collect(),
            qdd.clone(),
        ])
    }
}

fn rows(robot: &Mechanism, model: Model, state: &State) -> Vec<f64> {
    let regressor = Regressor::new(robot);
    let size = model.rows(robot.independent()) * regressor.parameters().len();
    let mut out = vec![f64::NAN; size];
    let filled = regressor.fill(model, state.as_states(), &mut out);
    filled.expect("a valid state");
    out
}

/// G and the constant part of q, by the closure's own numbers.
fn law(robot: &Mechanism) -> Vec<(Vec<f64>, f64)> {
    let m = robot.independent();
    let laws = robot.closure.iter().flat_map(|c| &c.laws);
    let row = |law: &VariableLaw| {
        let mut row = vec![0.0; m];
        match law {
            VariableLaw::Independent(place) => {
                row[*place] = 1.0;
                (row, 0.0)
            }
            VariableLaw::Implicit | VariableLaw::Formula(_) => panic!("sums only"),
            VariableLaw::Affine(law) => {
                for (place, multiplier) in &law.terms {
                    row[*place] = multiplier.value;
                }
                (row, law.offset.value)
            }
        }
    };
    laws.map(row).collect()
}

#[test]
fn rows_of_a_coupled_robot_are_g_transposed_times_those_of_its_tree() {
    for (seed, (robot, opened)) in robots().enumerate() {
        if robot.closure.is_none() {
            continue;
        }
        let (m, g) = (robot.independent(), law(&robot));
        let state = State::random(m, seed as u64);
        let expand = |x: &[f64], offset: bool| -> Vec<f64> {
            let sum = |(row, start): &(Vec<f64>, f64)| {
                let sum: f64 = row.iter().zip(x).map(|(g, x)| g * x).sum();
                sum + if offset { *start } else { 0.0 }
            };
            g.iter().map(sum).collect()
        };
        let [q, qd, qdd] = &state.0;
        let all = State([expand(q, true), expand(qd, false), expand(qdd, false)]);
        for model in Model::ALL {
            let (ours, tree) = (rows(&robot, model, &state), rows(&opened, model, &all));
            let width = robot.parameters().len();
            let mut sizes = vec![0.0; ours.len()];
            let regressor = Regressor::new(&robot);
            let filled = regressor.fill_magnitudes(model, state.as_states(), &mut sizes);
            filled.expect("a valid state");
            for (at, (&x, &size)) in ours.iter().zip(&sizes).enumerate() {
                let (k, column) = (at / width, at % width);
                let expected: f64 = match model {
                    Model::H => tree[column],
                    _ => (0..g.len())
                        .map(|i| g[i].0[k] * tree[i * width + column])
                        .sum(),
                };
                let bar = ROUNDING * (1.0 + size);
                assert!(
                    (x - expected).abs() <= bar,
                    "{} {at}: {x} {expected}",
                    robot.name
                );
                assert!(x.abs() <= size * (1.0 + ROUNDING), "{} {at}", robot.name);
            }
        }
    }
}

#[test]
fn the_power_of_the_independent_torques_is_the_rate_of_the_energy() {
    for (seed, (robot, _)) in robots().enumerate() {
        let state = State::random(robot.independent(), seed as u64);
        let d = rows(&robot, Model::D, &state);
        let h = |t: f64| rows(&robot, Model::H, &state.after(t));
        let (before, after) = (h(-STEP), h(STEP));
        let width = robot.parameters().len();
        for column in 0..width {
            let torques = d.iter().skip(column).step_by(width);
            let power: f64 = torques.zip(&state.0[1]).map(|(d, qd)| d * qd).sum();
            let rate = (after[column] - before[column]) / (2.0 * STEP);
            let size = 1.0 + power.abs() + before[column].abs();
            let label = robot.parameters().labels()[column].clone();
            assert!(
                (power - rate).abs() <= DIFFERENCES * size,
                "{} {label}: {power} against {rate}",
                robot.name
            );
        }
    }
}

#[test]
fn torques_and_chosen_columns_are_those_of_the_full_rows() {
    for (seed, (robot, _)) in robots().enumerate().take(50) {
        let regressor = Regressor::new(&robot);
        let state = State::random(robot.independent(), seed as u64);
        let d = rows(&robot, Model::D, &state);
        let x = robot.standard_parameters().expect("inertias");
        let mut torques = vec![f64::NAN; robot.independent()];
        let done = regressor.torques(&x, state.as_states(), &mut torques);
        done.expect("valid");
        for (row, torque) in d.chunks(x.len()).zip(&torques) {
            let sum: f64 = row.iter().zip(&x).map(|(d, x)| d * x).sum();
            let size: f64 = row.iter().zip(&x).map(|(d, x)| (d * x).abs()).sum();
            assert!(
                (sum - torque).abs() <= ROUNDING * (1.0 + size),
                "{}",
                robot.name
            );
        }
        let columns: Vec<usize> = (0..x.len()).step_by(3).collect();
        let mut some = vec![f64::NAN; robot.independent() * columns.len()];
        let done = regressor.fill_columns(Model::D, &columns, state.as_states(), &mut some);
        done.expect("valid");
        for (row, some) in d.chunks(x.len()).zip(some.chunks(columns.len())) {
            let chosen: Vec<f64> = columns.iter().map(|&c| row[c]).collect();
            assert_eq!(some, chosen);
        }
    }
}
