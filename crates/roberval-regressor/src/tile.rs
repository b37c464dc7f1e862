//! Joint states of as many samples as there are lanes.

use roberval_mechanism::JointKind;
use roberval_scalar::{Lanes, MAX_LANES};

use crate::{Body, JointMotion, Layout, Model, States, Tree};

/// The joint states of one tile of samples, a sample a lane.
#[derive(Debug)]
pub struct Tile<V> {
    /// q, qd, qdd of every joint variable, and room for whole transposed blocks.
    states: [Vec<V>; 3],
    /// A copy of the last, incomplete tile's numbers.
    padded: Vec<f64>,
    /// How the bodies move, as the recursion takes it.
    pub motion: Vec<JointMotion<V>>,
    dof: usize,
}

impl<V: Lanes> Tile<V> {
    /// Room for a tile of this tree's states.
    #[inline(always)]
    #[must_use]
    pub fn new(tree: &Tree<f64>) -> Self {
        let zero = V::lift(0.0);
        let room = tree.dof.next_multiple_of(V::COUNT);
        let still = JointMotion {
            cos: V::lift(1.0),
            sin: zero,
            versine: zero,
            q: zero,
            qd: zero,
            qdd: zero,
        };
        Self {
            states: std::array::from_fn(|_| vec![zero; room]),
            padded: vec![0.0; V::COUNT * tree.dof + V::COUNT],
            motion: vec![still; tree.bodies.len()],
            dof: tree.dof,
        }
    }

    /// Loads the samples from `first` on, zeros after the last one, and sets the bodies in
    /// motion. Tells whether all states are finite.
    #[inline(always)]
    pub fn load(
        &mut self,
        tree: &Tree<f64>,
        model: Model,
        states: &States<'_>,
        first: usize,
    ) -> bool {
        let looked_at = match model {
            Model::D => [true; 3],
            Model::D0 => [true, false, true],
            Model::H => [true, true, false],
        };
        for (k, numbers) in [states.q, states.qd, states.qdd].into_iter().enumerate() {
            let to = &mut self.states[k];
            if looked_at[k] {
                transpose(&numbers[first * self.dof..], self.dof, &mut self.padded, to);
            } else {
                to.fill(V::lift(0.0));
            }
        }
        let mut sums = [V::lift(0.0); 3];
        let [q, qd, qdd] = &self.states;
        for (body, motion) in tree.bodies.iter().zip(&mut self.motion) {
            let Some(j) = body.variable else { continue };
            let states = [q[j], qd[j], qdd[j]];
            // Zero times anything but a finite number is NaN.
            for (sum, x) in sums.iter_mut().zip(states) {
                *sum = x.mul_add(V::lift(0.0), *sum);
            }
            set(motion, body, states);
        }
        let mut sum = [0.0; MAX_LANES];
        (sums[0] + sums[1] + sums[2]).store(&mut sum);
        sum.iter().sum::<f64>() == 0.0
    }
}

/// Sets a body in motion.
#[inline(always)]
fn set<V: Lanes>(motion: &mut JointMotion<V>, body: &Body<f64>, [q, qd, qdd]: [V; 3]) {
    (motion.qd, motion.qdd) = (qd, qdd);
    if body.joint == JointKind::Prismatic {
        motion.q = q;
        return;
    }
    let (sin, cos) = q.sin_cos();
    (motion.sin, motion.cos) = (sin, cos);
    if body.layout == Layout::General {
        motion.versine = V::lift(1.0) - cos;
    }
}

/// The columns of a table of `dof` columns, a row a lane.
#[inline(always)]
fn transpose<V: Lanes>(from: &[f64], dof: usize, padded: &mut [f64], to: &mut [V]) {
    // Whole blocks read beyond the last row's end.
    let from = if from.len() < (V::COUNT - 1) * dof + to.len() {
        let count = from.len().min(V::COUNT * dof);
        padded[..count].copy_from_slice(&from[..count]);
        padded[count..].fill(0.0);
        &*padded
    } else {
        from
    };
    for first in (0..dof).step_by(V::COUNT) {
        V::load_transposed(&from[first..], dof, &mut to[first..]);
    }
}
