use std::f64::consts::PI;

use roberval_mechanism::{JointKind, Mechanism};
use roberval_regressor::States;
use roberval_scalar::SplitMix64;

/// Random joint states: N samples of n joints, row-major.
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
        let length = mechanism.characteristic_length();
        let gravity = mechanism.gravity.norm();
        let rate = if gravity > 0.0 {
            (gravity / length).sqrt()
        } else {
            1.0
        };
        let mut random = SplitMix64::new(seed);
        let size = count * mechanism.dof();
        let mut samples = Self {
            q: Vec::with_capacity(size),
            qd: Vec::with_capacity(size),
            qdd: Vec::with_capacity(size),
            count,
        };
        for _ in 0..count {
            for link in mechanism.moving() {
                let revolute = link.joint == JointKind::Revolute;
                let unit = if revolute { 1.0 } else { length };
                let reach = if revolute { PI } else { length };
                samples.q.push(random.uniform(-reach, reach));
                samples.qd.push(rate * unit * random.uniform(-1.0, 1.0));
                samples
                    .qdd
                    .push(rate * rate * unit * random.uniform(-1.0, 1.0));
            }
        }
        samples
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
