//! The regressor against independent routes: a world-frame Newton-Euler written with
//! matrices, the energy's own derivative (power balance), and physical invariances.

use nalgebra::{Matrix3, Matrix4, Rotation3, Unit, Vector3};
use roberval_mechanism::{JointKind, Mechanism, SourceFormat};
use roberval_regressor::{Model, Regressor, States};
use roberval_scalar::SplitMix64;
use roberval_testkit::Family;

const ROBOTS: u64 = 300;

/// Torque against regressor, relative to the sum of magnitudes: a few hundred eps.
const TORQUE_ROUNDING: f64 = 500.0 * f64::EPSILON;

/// Central differences at step 1e-4 are good to about step^2.
const POWER_STEP: f64 = 1e-4;
const POWER_DIFFERENCES: f64 = 3e-6;

fn robots() -> impl Iterator<Item = Mechanism> {
    (0..ROBOTS).map(|seed| {
        let format = if seed.is_multiple_of(2) {
            SourceFormat::Mdh
        } else {
            SourceFormat::Urdf
        };
        let family = Family {
            format,
            ..Family::default()
        };
        Mechanism::new(&family.robot(seed)).expect("a generated robot is valid")
    })
}

struct State {
    q: Vec<f64>,
    qd: Vec<f64>,
    qdd: Vec<f64>,
}

impl State {
    fn random(n: usize, seed: u64) -> Self {
        let mut random = SplitMix64::new(seed ^ 0xabcd);
        let mut draw = |size: f64| (0..n).map(|_| random.uniform(-size, size)).collect();
        Self {
            q: draw(3.0),
            qd: draw(2.0),
            qdd: draw(4.0),
        }
    }

    fn as_states(&self) -> States<'_> {
        States {
            q: &self.q,
            qd: &self.qd,
            qdd: &self.qdd,
        }
    }

    /// The state on the trajectory q + qd t + qdd t^2 / 2.
    fn after(&self, t: f64) -> Self {
        let q = |i: usize| self.q[i] + self.qd[i] * t + self.qdd[i] * t * t / 2.0;
        Self {
            q: (0..self.q.len()).map(q).collect(),
            qd: (0..self.q.len())
                .map(|i| self.qd[i] + self.qdd[i] * t)
                .collect(),
            qdd: self.qdd.clone(),
        }
    }
}

fn rows(regressor: &Regressor, model: Model, state: &State) -> Vec<f64> {
    let mut out = vec![f64::NAN; model.rows(regressor.dof()) * regressor.parameters().len()];
    regressor
        .fill(model, state.as_states(), &mut out)
        .expect("valid state");
    out
}

fn times(rows: &[f64], x: &[f64]) -> Vec<f64> {
    rows.chunks(x.len())
        .map(|row| row.iter().zip(x).map(|(a, b)| a * b).sum())
        .collect()
}

/// World-frame quantities of a link from homogeneous transforms, nothing shared with
/// the recursion under test.
struct World {
    pose: Vec<Matrix4<f64>>,
    w: Vec<Vector3<f64>>,
    dw: Vec<Vector3<f64>>,
    a: Vec<Vector3<f64>>,
}

fn world(robot: &Mechanism, state: &State) -> World {
    let mut out = World {
        pose: vec![],
        w: vec![],
        dw: vec![],
        a: vec![],
    };
    let mut k = 0;
    for link in &robot.links {
        let (pose, w, dw, a) = match link.antecedent {
            None => (
                Matrix4::identity(),
                Vector3::zeros(),
                Vector3::zeros(),
                -robot.gravity,
            ),
            Some(p) => (out.pose[p], out.w[p], out.dw[p], out.a[p]),
        };
        let mut local = link.rotation.to_homogeneous();
        local.fixed_view_mut::<3, 1>(0, 3).copy_from(&link.origin);
        let (q, qd, qdd) = match link.joint {
            JointKind::Fixed | JointKind::Floating => (0.0, 0.0, 0.0),
            _ => {
                k += 1;
                (state.q[k - 1], state.qd[k - 1], state.qdd[k - 1])
            }
        };
        let joint = match link.joint {
            JointKind::Revolute => {
                Rotation3::from_axis_angle(&Unit::new_normalize(link.axis), q).to_homogeneous()
            }
            _ => Matrix4::new_translation(&(link.axis * q)),
        };
        let next: Matrix4<f64> = pose * local * joint;
        let turn: Matrix3<f64> = next.fixed_view::<3, 3>(0, 0).into();
        let axis = turn * link.axis;
        let arm = next.fixed_view::<3, 1>(0, 3) - pose.fixed_view::<3, 1>(0, 3);
        let mut point = a + dw.cross(&arm) + w.cross(&w.cross(&arm));
        let (mut w, mut dw) = (w, dw);
        match link.joint {
            JointKind::Revolute => {
                dw += w.cross(&(axis * qd)) + axis * qdd;
                w += axis * qd;
            }
            _ => point += 2.0 * w.cross(&(axis * qd)) + axis * qdd,
        }
        out.pose.push(next);
        out.w.push(w);
        out.dw.push(dw);
        out.a.push(point);
    }
    out
}

/// Joint torques by world-frame Newton-Euler, inward pass by virtual power of each
/// link on each ancestor joint.
fn newton_euler(robot: &Mechanism, state: &State) -> (Vec<f64>, Vec<f64>) {
    let world = world(robot, state);
    let n = robot.dof();
    let (mut torque, mut size) = (vec![0.0; n], vec![0.0; n]);
    let mut variable = vec![None; robot.links.len()];
    let mut k = 0;
    for (j, link) in robot.links.iter().enumerate() {
        if link.joint != JointKind::Fixed {
            variable[j] = Some(k);
            k += 1;
        }
    }
    for (j, link) in robot.links.iter().enumerate() {
        let x = link.inertia.map(|x| x.unwrap_or(0.0));
        let r: Matrix3<f64> = world.pose[j].fixed_view::<3, 3>(0, 0).into();
        let p: Vector3<f64> = world.pose[j].fixed_view::<3, 1>(0, 3).into();
        let inertia =
            r * Matrix3::new(x[0], x[1], x[2], x[1], x[3], x[4], x[2], x[4], x[5]) * r.transpose();
        let ms = r * Vector3::new(x[6], x[7], x[8]);
        let (w, dw, a) = (world.w[j], world.dw[j], world.a[j]);
        let force = x[9] * a + dw.cross(&ms) + w.cross(&w.cross(&ms));
        let moment = inertia * dw + w.cross(&(inertia * w)) + ms.cross(&a);
        let mut ancestor = Some(j);
        while let Some(i) = ancestor {
            let ri: Matrix3<f64> = world.pose[i].fixed_view::<3, 3>(0, 0).into();
            let pi: Vector3<f64> = world.pose[i].fixed_view::<3, 1>(0, 3).into();
            let axis = ri * robot.links[i].axis;
            if let Some(row) = variable[i] {
                let term = match robot.links[i].joint {
                    JointKind::Revolute => axis.dot(&(moment + (p - pi).cross(&force))),
                    _ => axis.dot(&force),
                };
                torque[row] += term;
                size[row] += moment.norm() + (1.0 + (p - pi).norm()) * force.norm();
            }
            ancestor = robot.links[i].antecedent;
        }
        if let (Some(row), true) = (variable[j], link.rotor) {
            torque[row] += x[10] * state.qdd[row];
            size[row] += (x[10] * state.qdd[row]).abs();
        }
    }
    (torque, size)
}

#[test]
fn regressor_times_parameters_is_the_torque_of_an_independent_newton_euler() {
    for (seed, robot) in robots().enumerate() {
        let regressor = Regressor::new(&robot);
        let state = State::random(robot.dof(), seed as u64);
        let x = robot
            .standard_parameters()
            .expect("generated robots have inertias");
        let from_columns = times(&rows(&regressor, Model::D, &state), &x);
        let mut streamed = vec![f64::NAN; robot.dof()];
        regressor
            .torques(&x, state.as_states(), &mut streamed)
            .expect("valid state");
        let (torque, size) = newton_euler(&robot, &state);
        for i in 0..robot.dof() {
            let bar = TORQUE_ROUNDING * size[i].max(1e-3);
            assert!(
                (from_columns[i] - torque[i]).abs() <= bar,
                "{} row {i}",
                robot.name
            );
            assert!(
                (streamed[i] - torque[i]).abs() <= bar,
                "{} row {i}",
                robot.name
            );
        }
    }
}

#[test]
fn the_power_of_the_torques_is_the_rate_of_the_energy() {
    for (seed, robot) in robots().enumerate() {
        let regressor = Regressor::new(&robot);
        let state = State::random(robot.dof(), seed as u64);
        let d = rows(&regressor, Model::D, &state);
        let h = |t: f64| rows(&regressor, Model::H, &state.after(t));
        let (before, after) = (h(-POWER_STEP), h(POWER_STEP));
        let width = regressor.parameters().len();
        for column in 0..width {
            let power: f64 = (0..robot.dof())
                .map(|i| d[i * width + column] * state.qd[i])
                .sum();
            let rate = (after[column] - before[column]) / (2.0 * POWER_STEP);
            let size = 1.0 + power.abs() + before[column].abs();
            assert!(
                (power - rate).abs() <= POWER_DIFFERENCES * size * 100.0,
                "{} {}: {power} against {rate}",
                robot.name,
                regressor.parameters().labels()[column],
            );
        }
    }
}

#[test]
fn d0_is_d_at_rest() {
    for (seed, robot) in robots().enumerate().take(50) {
        let regressor = Regressor::new(&robot);
        let mut state = State::random(robot.dof(), seed as u64);
        let d0 = rows(&regressor, Model::D0, &state);
        state.qd.fill(0.0);
        assert_eq!(d0, rows(&regressor, Model::D, &state));
    }
}

#[test]
fn a_choice_of_columns_has_the_same_entries_as_all_columns() {
    for (seed, robot) in robots().enumerate().take(60) {
        let regressor = Regressor::new(&robot);
        let state = State::random(robot.dof(), seed as u64);
        let width = regressor.parameters().len();
        let columns: Vec<usize> = (0..width).rev().step_by(3).collect();
        for model in Model::ALL {
            let all = rows(&regressor, model, &state);
            let mut some = vec![f64::NAN; model.rows(robot.dof()) * columns.len()];
            regressor
                .fill_columns(model, &columns, state.as_states(), &mut some)
                .expect("valid");
            for (row, some) in all.chunks(width).zip(some.chunks(columns.len())) {
                let expected: Vec<f64> = columns.iter().map(|&c| row[c]).collect();
                assert_eq!(some, expected);
            }
        }
    }
}

#[test]
fn every_entry_is_below_its_magnitude() {
    for (seed, robot) in robots().enumerate().take(100) {
        let regressor = Regressor::new(&robot);
        let state = State::random(robot.dof(), seed as u64);
        for model in Model::ALL {
            let values = rows(&regressor, model, &state);
            let mut sizes = vec![f64::NAN; values.len()];
            regressor
                .fill_magnitudes(model, state.as_states(), &mut sizes)
                .expect("valid");
            for (value, size) in values.iter().zip(&sizes) {
                assert!(value.abs() <= size * (1.0 + 1e-12), "{value} above {size}");
            }
        }
    }
}

#[test]
fn states_of_the_wrong_shape_or_not_finite_are_refused_by_name() {
    let robot = robots()
        .find(|r| r.dof() == 3)
        .expect("a robot with three joints");
    let regressor = Regressor::new(&robot);
    let mut out = vec![0.0; 3 * regressor.parameters().len()];
    let good = [0.1, 0.2, 0.3];
    let short = States {
        q: &good,
        qd: &good[..2],
        qdd: &good,
    };
    let error = regressor
        .fill(Model::D, short, &mut out)
        .expect_err("too short");
    assert!(
        error.to_string().contains("qd has 2 entries, expected 3"),
        "{error}"
    );
    let bad = [0.1, f64::NAN, 0.3];
    let states = States {
        q: &good,
        qd: &good,
        qdd: &bad,
    };
    let error = regressor
        .fill(Model::D, states, &mut out)
        .expect_err("not finite");
    assert!(error.to_string().contains("qdd[0, 1] is NaN"), "{error}");
    let states = States {
        q: &good,
        qd: &good,
        qdd: &good,
    };
    let error = regressor
        .fill(Model::D, states, &mut out[1..])
        .expect_err("out too short");
    assert!(error.to_string().contains("out has"), "{error}");
}
