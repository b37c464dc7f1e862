use std::f64::consts::PI;

use roberval_mechanism::{JointKind, Mechanism, VariableLaw};
use roberval_regressor::States;
use roberval_scalar::SplitMix64;

/// Random joint states: N samples of the m independent joints, row-major.
///
/// Revolute joints turn anywhere; prismatic ones move by the robot's own length L, and
/// time runs in units of sqrt(L/g), so that weights and inertia forces are comparable
/// and the answer does not depend on the unit of length.
#[derive(Debug, Clone, PartialEq)]
pub struct Samples {
    /// Positions, rad or m.
    pub q: Vec<f64>,
    /// Velocities, per s.
    pub qd: Vec<f64>,
    /// Accelerations, per s^2.
    pub qdd: Vec<f64>,
    /// Number of samples N.
    pub count: usize,
}

impl Samples {
    /// `count` samples for this robot; the same seed gives the same samples.
    #[must_use]
    pub fn draw(mechanism: &Mechanism, count: usize, seed: u64) -> Self {
        let reaches = reaches(mechanism);
        let mut random = SplitMix64::new(seed);
        let mut samples = Self::with_capacity(count * reaches.len());
        for _ in 0..count {
            let unit = |_| std::array::from_fn(|_| random.uniform(-1.0, 1.0));
            let state: Vec<[f64; 3]> = reaches.iter().map(unit).collect();
            samples.push(&reaches, &state);
        }
        samples
    }

    /// No samples yet, room for `size` numbers of each kind.
    pub(crate) fn with_capacity(size: usize) -> Self {
        Self {
            q: Vec::with_capacity(size),
            qd: Vec::with_capacity(size),
            qdd: Vec::with_capacity(size),
            count: 0,
        }
    }

    /// Adds the sample whose (q, qd, qdd), joint by joint, are `state` in units of
    /// `reaches`.
    pub(crate) fn push(&mut self, reaches: &[[f64; 3]], state: &[[f64; 3]]) {
        for (reach, state) in reaches.iter().zip(state) {
            self.q.push(reach[0] * state[0]);
            self.qd.push(reach[1] * state[1]);
            self.qdd.push(reach[2] * state[2]);
        }
        self.count += 1;
    }

    /// The samples as the regressor takes them.
    #[must_use]
    pub fn states(&self) -> States<'_> {
        States {
            q: &self.q,
            qd: &self.qd,
            qdd: &self.qdd,
        }
    }
}

/// The largest (q, qd, qdd) drawn for each independent joint: none that it moves along
/// goes much farther than it would by itself.
pub(crate) fn reaches(mechanism: &Mechanism) -> Vec<[f64; 3]> {
    let length = mechanism.characteristic_length();
    let gravity = mechanism.gravity.norm();
    let rate = if gravity > 0.0 {
        (gravity / length).sqrt()
    } else {
        1.0
    };
    let reach = |joint| match joint {
        JointKind::Prismatic => [length, rate * length, rate * rate * length],
        JointKind::Revolute | JointKind::Fixed => [PI, rate, rate * rate],
    };
    let joints = mechanism.independent_joints();
    let mut reaches: Vec<_> = joints.iter().map(|link| reach(link.joint)).collect();
    let laws = mechanism.closure.iter().flat_map(|c| &c.laws);
    let mut slow = vec![1.0_f64; reaches.len()];
    for (link, law) in mechanism.moving().zip(laws) {
        if let VariableLaw::Affine(law) = law {
            for (place, multiplier) in &law.terms {
                let moved = multiplier.value.abs() * reaches[*place][0] / reach(link.joint)[0];
                slow[*place] = slow[*place].max(moved);
            }
        }
    }
    for (reach, slow) in reaches.iter_mut().zip(slow) {
        reach.iter_mut().for_each(|x| *x /= slow);
    }
    reaches
}
