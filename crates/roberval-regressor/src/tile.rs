//! Joint states of as many samples as there are lanes.

use roberval_mechanism::JointKind;
use roberval_scalar::Lanes;

use crate::{JointMotion, Model, States, Tree};

/// The joint states of one tile of samples, a sample a lane.
#[derive(Debug)]
pub(crate) struct Tile<V> {
    /// q, qd, qdd of every joint variable, and room for whole transposed blocks.
    states: [Vec<V>; 3],
    /// A copy of the last, incomplete tile's numbers.
    padded: Vec<f64>,
    /// How the bodies move.
    pub motion: Vec<JointMotion<V>>,
    dof: usize,
}

impl<V: Lanes> Tile<V> {
    #[inline(always)]
    pub(crate) fn new(tree: &Tree<f64>) -> Self {
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

    /// Loads the samples from `first` on, zeros after the last one. Tells whether they
    /// are finite.
    #[inline(always)]
    pub(crate) fn load(&mut self, model: Model, states: &States<'_>, first: usize) -> bool {
        let mut sum = V::lift(0.0);
        let looked_at = match model {
            Model::D => [true; 3],
            Model::D0 => [true, false, true],
            Model::H => [true, true, false],
        };
        for (k, numbers) in [states.q, states.qd, states.qdd].into_iter().enumerate() {
            if !looked_at[k] {
                continue;
            }
            let from = &numbers[first * self.dof..];
            // Zero times anything but a finite number is NaN.
            for x in transposed(from, self.dof, &mut self.padded, &mut self.states[k]) {
                sum = x.mul_add(V::lift(0.0), sum);
            }
        }
        let mut sums = [0.0; roberval_scalar::MAX_LANES];
        sum.store(&mut sums);
        sums.iter().sum::<f64>() == 0.0
    }

    /// Turns the states into the motion of the bodies.
    #[inline(always)]
    pub(crate) fn set_motion(&mut self, tree: &Tree<f64>) {
        for (body, motion) in tree.bodies.iter().zip(&mut self.motion) {
            let Some(j) = body.variable else { continue };
            let [q, qd, qdd] = [&self.states[0], &self.states[1], &self.states[2]];
            (motion.qd, motion.qdd) = (qd[j], qdd[j]);
            if body.joint == JointKind::Prismatic {
                motion.q = q[j];
            } else {
                let (sin, cos) = q[j].sin_cos();
                (motion.sin, motion.cos) = (sin, cos);
                motion.versine = V::lift(1.0) - cos;
            }
        }
    }
}

/// The columns of a table of `dof` columns, a row a lane.
#[inline(always)]
fn transposed<'a, V: Lanes>(
    from: &[f64],
    dof: usize,
    padded: &mut [f64],
    to: &'a mut [V],
) -> impl Iterator<Item = V> + use<'a, V> {
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
    to[..dof].iter().copied()
}
