//! The states of all joints of the tree, where some depend on others.

use std::ops::Range;

use crate::{Expansion, JointStates, Model, NoValue, States, Tree};

/// Samples as all joints of the tree move.
#[derive(Debug, Clone, Copy)]
pub struct TreeStates<'a> {
    /// Of all n joints.
    pub states: States<'a>,
    /// The values of G, sample after sample; none where all joints are independent.
    pub g: &'a [f64],
    /// How many a sample has.
    pub g_width: usize,
}

impl<'a> TreeStates<'a> {
    /// The states of a robot whose joints are all independent.
    #[must_use]
    pub fn of(states: States<'a>) -> Self {
        Self {
            states,
            g: &[],
            g_width: 0,
        }
    }
}

/// The states of all joints in some samples.
#[derive(Debug, Clone, Default)]
pub struct Expanded {
    q: Vec<f64>,
    qd: Vec<f64>,
    qdd: Vec<f64>,
    g: Vec<f64>,
    g_width: usize,
}

impl Expanded {
    /// Takes these samples (as far as there are any) of the independent joints, zeros for what
    /// the model does not look at. Loops are closed from the first configuration, one sample
    /// after the other.
    ///
    /// # Errors
    /// The first sample at which the constraints have no value.
    pub fn fill(
        &mut self,
        tree: &Tree<f64>,
        expansion: &Expansion<f64>,
        states: States<'_>,
        samples: Range<usize>,
        model: Model,
    ) -> Result<(), (usize, NoValue)> {
        let m = expansion.independent();
        let floating = usize::from(tree.is_floating());
        let zeros = vec![0.0; m];
        let mut joints: JointStates<f64> = expansion.states();
        for array in [&mut self.q, &mut self.qd, &mut self.qdd, &mut self.g] {
            array.clear();
        }
        for sample in samples.start..samples.end.min(states.q.len() / (m + floating)) {
            let span = sample * m..(sample + 1) * m;
            let q = &states.q[sample * (m + floating)..(sample + 1) * (m + floating)];
            let [_, qd, qdd] =
                model.taken([q, &states.qd[span.clone()], &states.qdd[span]], &zeros);
            let state = [tree.variables(q), qd, qdd];
            expansion
                .expand(state, &mut joints)
                .map_err(|error| (sample, error))?;
            let base = 6 * floating;
            self.q.extend(&q[..base + floating]);
            self.q.extend(&joints.q[base..]);
            self.qd.extend(&joints.qd);
            self.qdd.extend(&joints.qdd);
            self.g.extend(joints.transmission.values());
        }
        self.g_width = joints.transmission.values().len();
        Ok(())
    }

    /// The states last taken.
    #[must_use]
    pub fn states(&self) -> TreeStates<'_> {
        TreeStates {
            states: States {
                q: &self.q,
                qd: &self.qd,
                qdd: &self.qdd,
            },
            g: &self.g,
            g_width: self.g_width,
        }
    }
}
