//! Joint states of as many samples as there are lanes.

use roberval_mechanism::JointKind;
use roberval_scalar::Lanes;

use crate::{BaseState, Body, Constants, JointMotion, Layout, Model, Tree, TreeStates};

/// The states of one tile of samples, a sample a lane.
#[derive(Debug, Clone)]
pub(crate) struct Tile<V> {
    /// q, qd, qdd of every coordinate, and room for whole transposed blocks.
    states: [Vec<V>; 3],
    /// A copy of the last, incomplete tile's numbers.
    padded: Vec<f64>,
    /// How the bodies move, as the recursion takes it.
    pub motion: Vec<JointMotion<V>>,
    /// A floating robot's base.
    pub base: Option<BaseState<V>>,
    /// The values of G, where joints depend on others.
    pub g: Vec<V>,
    /// Coordinates of q, and of qd and qdd.
    positions: usize,
    dof: usize,
}

impl<V: Lanes> Tile<V> {
    /// Room for a tile of this tree's states, and for so many values of G.
    #[inline(always)]
    pub(crate) fn new(tree: &Tree<f64>, g: usize) -> Self {
        let zero = V::lift(0.0);
        let positions = tree.dof + usize::from(tree.is_floating());
        let room = positions.next_multiple_of(V::COUNT);
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
            padded: vec![0.0; V::COUNT * positions.max(g) + V::COUNT],
            motion: vec![still; tree.bodies.len()],
            base: None,
            g: vec![zero; g.next_multiple_of(V::COUNT)],
            positions,
            dof: tree.dof,
        }
    }

    /// Loads the samples from `first` on, zeros after the last one, and sets the bodies in
    /// motion. Tells whether all states are finite.
    #[inline(always)]
    pub(crate) fn load(
        &mut self,
        tree: &Tree<f64>,
        model: Model,
        samples: &TreeStates<'_>,
        first: usize,
    ) -> bool {
        let looked_at = match model {
            Model::D => [true; 3],
            Model::D0 => [true, false, true],
            Model::H => [true, true, false],
        };
        let states = [samples.states.q, samples.states.qd, samples.states.qdd];
        let widths = [self.positions, self.dof, self.dof];
        let mut none = V::lift(0.0);
        for (k, numbers) in states.into_iter().enumerate() {
            let (to, width) = (&mut self.states[k], widths[k]);
            if !looked_at[k] {
                to.fill(V::lift(0.0));
                continue;
            }
            let numbers = &numbers[first * width..];
            none = none + transpose(numbers, width, &mut self.padded, to);
        }
        self.move_bodies(tree);
        if !samples.g.is_empty() {
            let count = samples.g_width;
            transpose(
                &samples.g[first * count..],
                count,
                &mut self.padded,
                &mut self.g,
            );
        }
        none.is_zero()
    }

    #[inline(always)]
    fn move_bodies(&mut self, tree: &Tree<f64>) {
        let [q, qd, qdd] = &self.states;
        if tree.is_floating() {
            let constants = Constants {
                zero: V::lift(0.0),
                one: V::lift(1.0),
                half: V::lift(0.5),
            };
            self.base = Some(base_of([q, qd, qdd], constants));
        }
        let n = tree.dof;
        let (q, qd, qdd) = (&tree.variables(q)[..n], &qd[..n], &qdd[..n]);
        for (body, motion) in tree.bodies.iter().zip(&mut self.motion) {
            if body.joint == JointKind::Floating {
                continue;
            }
            let Some(j) = body.variable else { continue };
            set(motion, body, [q[j], qd[j], qdd[j]]);
        }
    }
}

/// The base's state. A lane after the last sample has no attitude; any will do.
#[inline(always)]
fn base_of<V: Lanes>(state: [&Vec<V>; 3], constants: Constants<V>) -> BaseState<V> {
    let [q, qd, qdd] = state;
    let squared = crate::base::squared_length([q[3], q[4], q[5], q[6]]);
    let inverse = V::lift(1.0).divide(squared).where_nonzero(squared);
    BaseState::of([q, qd, qdd], constants, inverse)
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

/// The columns of a table of `width` columns, a row a lane. Gives zeros, or NaN somewhere if
/// not all numbers are finite, be it of these rows or of what follows them.
#[inline(always)]
fn transpose<V: Lanes>(from: &[f64], width: usize, padded: &mut [f64], to: &mut [V]) -> V {
    let mut none = V::lift(0.0);
    if V::COUNT == 1 {
        for (to, from) in to.iter_mut().zip(&from[..width]) {
            *to = V::load(std::slice::from_ref(from));
            none = to.mul_add(V::lift(0.0), none);
        }
        return none;
    }
    // Whole blocks read beyond the last row's end.
    let from = if from.len() < (V::COUNT - 1) * width + to.len() {
        let count = from.len().min(V::COUNT * width);
        padded[..count].copy_from_slice(&from[..count]);
        padded[count..].fill(0.0);
        &*padded
    } else {
        from
    };
    let blocks = to.chunks_exact_mut(V::COUNT).take(width.div_ceil(V::COUNT));
    for (k, block) in blocks.enumerate() {
        none = none + V::load_transposed(&from[k * V::COUNT..], width, block);
    }
    none
}
