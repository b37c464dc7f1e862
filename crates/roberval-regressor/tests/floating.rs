//! A floating base against six joints in its place, against the energy's own derivative,
//! and in a moved world.

use nalgebra::{Quaternion, Rotation3, UnitQuaternion, Vector3};
use roberval_mechanism::{
    Geometry, JointKind, LinkDescription, Mechanism, RobotDescription, SourceFormat,
};
use roberval_regressor::{Model, Regressor, RegressorError, States};
use roberval_scalar::SplitMix64;
use roberval_testkit::{Family, decimal};

const ROBOTS: u64 = 120;

/// Two recursions of a dozen bodies, relative to the entries' magnitudes: some hundred eps.
const ROUNDING: f64 = 1e-12;

/// Central differences at this step are good to about its square.
const STEP: f64 = 1e-4;
const DIFFERENCES: f64 = 3e-4;

fn description(seed: u64) -> RobotDescription {
    let format = [SourceFormat::Mdh, SourceFormat::Urdf][seed as usize % 2];
    let family = Family {
        format,
        links: (1, 8),
        ..Family::default()
    };
    let mut robot = family.robot(seed).with_floating_base();
    let some = robot.links[1].inertia.clone();
    robot.links[0].inertia[..10].clone_from_slice(&some[..10]);
    robot
}

fn mechanism(description: &RobotDescription) -> Mechanism {
    Mechanism::new(description).expect("valid")
}

#[derive(Clone)]
struct State {
    q: Vec<f64>,
    qd: Vec<f64>,
    qdd: Vec<f64>,
}

impl State {
    /// A state with the pose of the base written by `place`.
    fn random(n: usize, seed: u64) -> Self {
        let mut random = SplitMix64::new(seed ^ 0xf10a7);
        let mut draw = |size: f64, n| (0..n).map(|_| random.uniform(-size, size)).collect();
        Self {
            q: draw(3.0, n + 1),
            qd: draw(2.0, n),
            qdd: draw(4.0, n),
        }
    }

    fn place(&mut self, position: Vector3<f64>, attitude: &UnitQuaternion<f64>) {
        self.q[..3].copy_from_slice(position.as_slice());
        self.q[3..7].copy_from_slice(attitude.coords.as_slice());
    }

    fn pose(&self) -> (Vector3<f64>, UnitQuaternion<f64>) {
        let [x, y, z, w] = [3, 4, 5, 6].map(|k| self.q[k]);
        let attitude = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
        (vector(&self.q, 0), attitude)
    }

    fn rows(&self, robot: &Mechanism, model: Model) -> Vec<f64> {
        let regressor = Regressor::new(robot);
        let states = States {
            q: &self.q,
            qd: &self.qd,
            qdd: &self.qdd,
        };
        let width = regressor.parameters().len();
        let mut out = vec![f64::NAN; model.rows(robot.dof()) * width];
        regressor.fill(model, states, &mut out).expect("a state");
        out
    }

    /// The state a time later: the velocities grow evenly, in the base's frame.
    fn after(&self, t: f64) -> Self {
        let mut later = self.clone();
        let (p, r) = self.pose();
        let (v, w) = (vector(&self.qd, 0), vector(&self.qd, 3));
        let (dv, dw) = (vector(&self.qdd, 0), vector(&self.qdd, 3));
        let turn = UnitQuaternion::from_scaled_axis(w * t + dw * (t * t / 2.0));
        let shift = v * t + (dv + w.cross(&v)) * (t * t / 2.0);
        for k in 6..self.qd.len() {
            later.q[k + 1] += self.qd[k] * t + self.qdd[k] * t * t / 2.0;
        }
        for (qd, qdd) in later.qd.iter_mut().zip(&self.qdd) {
            *qd += qdd * t;
        }
        later.place(p + r * shift, &(r * turn));
        later
    }
}

fn vector(x: &[f64], at: usize) -> Vector3<f64> {
    Vector3::new(x[at], x[at + 1], x[at + 2])
}

/// A state of the floating robot, its quaternion of length 1.
fn state(robot: &Mechanism, seed: u64) -> State {
    let mut state = State::random(robot.dof(), seed);
    let (p, r) = state.pose();
    state.place(p, &r);
    state
}

/// The same robot carried by joints along x, y, z and about z, y, x.
fn carried(robot: &RobotDescription) -> RobotDescription {
    let mut carried = robot.clone();
    let unit = |k: usize| std::array::from_fn(|i| decimal(i64::from(i == k), 0));
    let kinds = [JointKind::Prismatic, JointKind::Revolute];
    let steps = [(0, 0), (0, 1), (0, 2), (1, 2), (1, 1), (1, 0)];
    let mut antecedent = None;
    let mut links = Vec::new();
    for (i, (kind, axis)) in steps.into_iter().enumerate() {
        let last = i == 5;
        let name = if last {
            "0".to_owned()
        } else {
            format!("step {i}")
        };
        links.push(LinkDescription {
            name: name.clone(),
            antecedent: antecedent.replace(name),
            joint: kinds[kind],
            massless: !last,
            geometry: Geometry::Placed {
                origins: Vec::new(),
                axis: unit(axis),
            },
            ..robot.links[0].clone()
        });
    }
    carried.links.splice(0..1, links);
    carried
}

/// The base's twist and its rate from the angles a, b, c about z, y, x and the position:
/// returns the attitude, (v, w), (dv, dw) and the columns of the Jacobian of (v, w).
type Twist = (Vector3<f64>, Vector3<f64>);

fn kinematics(s: &State) -> (Rotation3<f64>, Twist, Twist, Vec<Twist>) {
    let zero = Vector3::zeros();
    let (mut r, mut w, mut dw) = (Rotation3::identity(), zero, zero);
    let mut turns: Vec<Vector3<f64>> = Vec::new();
    for (k, axis) in [(3, Vector3::z()), (4, Vector3::y()), (5, Vector3::x())] {
        let turn = Rotation3::new(axis * s.q[k]);
        let carried = turn.inverse() * w;
        dw = turn.inverse() * dw + axis * s.qdd[k] + carried.cross(&(axis * s.qd[k]));
        w = carried + axis * s.qd[k];
        turns.iter_mut().for_each(|e| *e = turn.inverse() * *e);
        turns.push(axis);
        r *= turn;
    }
    let v = r.inverse() * vector(&s.qd, 0);
    let dv = r.inverse() * vector(&s.qdd, 0) - w.cross(&v);
    let slides = [Vector3::x(), Vector3::y(), Vector3::z()].map(|e| (r.inverse() * e, zero));
    let columns = slides
        .into_iter()
        .chain(turns.into_iter().map(|e| (zero, e)));
    (r, (v, w), (dv, dw), columns.collect())
}

#[test]
fn a_floating_base_has_the_rows_of_six_joints_that_carry_it() {
    for seed in 0..ROBOTS {
        let floating = description(seed);
        let (robot, chain) = (mechanism(&floating), mechanism(&carried(&floating)));
        assert_eq!(robot.parameters().labels(), chain.parameters().labels());
        let n = robot.dof();
        let mut by_joints = State::random(n, seed);
        by_joints.q.pop();
        let (r, (v, w), (dv, dw), jacobian) = kinematics(&by_joints);
        let mut free = by_joints.clone();
        free.q.insert(6, 0.0);
        free.place(
            vector(&by_joints.q, 0),
            &UnitQuaternion::from_rotation_matrix(&r),
        );
        free.qd[..6].copy_from_slice(&[v.x, v.y, v.z, w.x, w.y, w.z]);
        free.qdd[..6].copy_from_slice(&[dv.x, dv.y, dv.z, dw.x, dw.y, dw.z]);
        let c = robot.parameters().len();
        // Not d0: at rest, the rates of these coordinates and of those are not the same.
        for model in [Model::D, Model::H] {
            let (ours, theirs) = (free.rows(&robot, model), by_joints.rows(&chain, model));
            for column in 0..c {
                for row in 0..model.rows(n) {
                    let entry = |i: usize| ours[i * c + column];
                    let expected = if model == Model::H || row >= 6 {
                        entry(row)
                    } else {
                        let (v, w) = jacobian[row];
                        let wrench = [0, 1, 2, 3, 4, 5].map(entry);
                        v.dot(&vector(&wrench, 0)) + w.dot(&vector(&wrench, 3))
                    };
                    let found = theirs[row * c + column];
                    let size = 1e2 + expected.abs();
                    assert!((found - expected).abs() <= ROUNDING * size, "robot {seed}");
                }
            }
        }
    }
}

#[test]
fn the_power_of_the_wrench_and_the_torques_is_the_rate_of_the_energy() {
    for seed in 0..ROBOTS {
        let robot = mechanism(&description(seed));
        let state = state(&robot, seed);
        let d = state.rows(&robot, Model::D);
        let h = |t: f64| state.after(t).rows(&robot, Model::H);
        let (before, after) = (h(-STEP), h(STEP));
        let c = robot.parameters().len();
        for column in 0..c {
            let power: f64 = (0..robot.dof())
                .map(|i| d[i * c + column] * state.qd[i])
                .sum();
            let rate = (after[column] - before[column]) / (2.0 * STEP);
            let size = 1.0 + power.abs() + before[column].abs();
            assert!(
                (power - rate).abs() <= DIFFERENCES * size,
                "robot {seed}: {power}, {rate}"
            );
        }
    }
}

#[test]
fn a_turned_and_shifted_world_changes_no_row() {
    for seed in 0..ROBOTS {
        let mut here = description(seed);
        here.gravity = [0, 0, -981].map(|g| decimal(g, -2));
        let mut there = here.clone();
        // The world's z is the new world's x.
        there.gravity.rotate_right(1);
        let (here, there) = (mechanism(&here), mechanism(&there));
        let old = state(&here, seed);
        let world = Rotation3::from_basis_unchecked(&[Vector3::y(), Vector3::z(), Vector3::x()]);
        let world = UnitQuaternion::from_rotation_matrix(&world);
        let (p, r) = old.pose();
        let mut new = old.clone();
        new.place(world * p + Vector3::new(3.0, -1.0, 2.0), &(world * r));
        for (x, y) in old
            .rows(&here, Model::D)
            .iter()
            .zip(new.rows(&there, Model::D))
        {
            assert!((x - y).abs() <= ROUNDING * (1e2 + x.abs()), "robot {seed}");
        }
    }
}

#[test]
fn a_quaternion_and_its_negative_and_a_rounded_one_are_one_attitude() {
    for seed in 0..20 {
        let robot = mechanism(&description(seed));
        let state = state(&robot, seed);
        let rows = state.rows(&robot, Model::D);
        for factor in [-1.0, 1.004] {
            let mut other = state.clone();
            other.q[3..7].iter_mut().for_each(|x| *x *= factor);
            for (x, y) in rows.iter().zip(other.rows(&robot, Model::D)) {
                assert!((x - y).abs() <= ROUNDING * (1e2 + x.abs()));
            }
        }
    }
}

#[test]
fn without_couples_the_states_of_all_joints_are_those_given() {
    for seed in 0..20 {
        let robot = mechanism(&description(seed));
        let state = state(&robot, seed);
        let states = States {
            q: &state.q,
            qd: &state.qd,
            qdd: &state.qdd,
        };
        let all = Regressor::new(&robot).expand(states).expect("valid");
        assert_eq!(all, [state.q.clone(), state.qd.clone(), state.qdd.clone()]);
    }
}

#[test]
fn what_is_no_quaternion_is_refused() {
    let robot = mechanism(&description(1));
    let mut state = state(&robot, 1);
    state.q[3..7].copy_from_slice(&[0.0, 0.0, 0.0, 2.0]);
    let regressor = Regressor::new(&robot);
    let mut out = vec![0.0; robot.dof() * regressor.parameters().len()];
    let states = States {
        q: &state.q,
        qd: &state.qd,
        qdd: &state.qdd,
    };
    let error = regressor
        .fill(Model::D, states, &mut out)
        .expect_err("too long");
    let expected = RegressorError::Quaternion {
        sample: 0,
        length: 2.0,
    };
    assert_eq!(error, expected);
}
