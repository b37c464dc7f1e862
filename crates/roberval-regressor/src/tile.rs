//! Joint states of as many samples as there are lanes.

use roberval_mechanism::JointKind;
use roberval_scalar::Lanes;

use crate::{BaseState, Constants, JointMotion, Layout, Model, Tree, TreeStates};

/// Coordinates of a base that floats, those of its attitude with it.
const BASE: usize = 7;

/// The states of one tile of samples, a sample a lane.
#[derive(Debug, Clone)]
pub(crate) struct Tile<V> {
    /// How the bodies move, as the recursion takes it; after them [`BASE`] coordinates of the
    /// base, and one for what lies beyond a table's last column.
    motion: Vec<JointMotion<V>>,
    bodies: usize,
    /// The columns of q, and of qd and qdd.
    positions: Columns,
    rates: Columns,
    /// The bodies whose joints turn, and those of them that lie in any way.
    turning: Vec<usize>,
    general: Vec<usize>,
    /// A copy of the last, incomplete tile's numbers.
    padded: Vec<f64>,
    /// A floating robot's base.
    pub base: Option<BaseState<V>>,
    /// The values of G, where joints depend on others.
    pub g: Vec<V>,
}

/// Where in [`Tile::motion`] the columns of a table of states belong.
#[derive(Debug, Clone)]
struct Columns {
    count: usize,
    /// As many as whole blocks have.
    places: Vec<usize>,
}

impl Columns {
    /// The columns of all joints, the base's first if there are any.
    fn new(tree: &Tree<f64>, of_base: usize, lanes: usize) -> Self {
        let bodies = tree.bodies.len();
        let more = if tree.is_floating() { of_base - 6 } else { 0 };
        let count = tree.dof + more;
        let mut places = vec![bodies + BASE; count.next_multiple_of(lanes)];
        if tree.is_floating() {
            for (k, place) in places.iter_mut().enumerate().take(of_base) {
                *place = bodies + k;
            }
        }
        for (j, body) in tree.bodies.iter().enumerate() {
            match body.variable {
                Some(variable) if body.joint != JointKind::Floating => places[variable + more] = j,
                _ => {}
            }
        }
        Self { count, places }
    }
}

impl<V: Lanes> Tile<V> {
    /// Room for a tile of this tree's states, and for so many values of G.
    pub(crate) fn new(tree: &Tree<f64>, g: usize) -> Self {
        let bodies = tree.bodies.len();
        let positions = Columns::new(tree, BASE, V::COUNT);
        let which = |like: fn(&crate::Body<f64>) -> bool| {
            let bodies = tree.bodies.iter().enumerate();
            let turning = bodies.filter(|(_, body)| body.joint == JointKind::Revolute);
            turning.filter(move |(_, body)| like(body)).map(|(j, _)| j)
        };
        Self {
            motion: vec![JointMotion::still(V::lift(0.0), V::lift(1.0)); bodies + BASE + 1],
            bodies,
            rates: Columns::new(tree, 6, V::COUNT),
            turning: which(|_| true).collect(),
            general: which(|body| body.layout == Layout::General).collect(),
            padded: vec![0.0; V::COUNT * positions.count.max(g) + V::COUNT],
            positions,
            base: None,
            g: vec![V::lift(0.0); g.next_multiple_of(V::COUNT)],
        }
    }

    /// How the bodies move.
    #[inline(always)]
    pub(crate) fn motion(&self) -> &[JointMotion<V>] {
        &self.motion[..self.bodies]
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
        let zero = V::lift(0.0);
        let states = &samples.states;
        let Self {
            motion,
            positions,
            rates,
            padded,
            ..
        } = self;
        let motion = &mut motion[..];
        let mut none = read(states.q, first, positions, padded, |k, x| motion[k].q = x);
        if model == Model::D0 {
            for motion in &mut *motion {
                motion.qd = zero;
            }
        } else {
            none = none + read(states.qd, first, rates, padded, |k, x| motion[k].qd = x);
        }
        if model == Model::H {
            for motion in &mut *motion {
                motion.qdd = zero;
            }
        } else {
            none = none + read(states.qdd, first, rates, padded, |k, x| motion[k].qdd = x);
        }
        self.move_bodies(tree);
        if !samples.g.is_empty() {
            let from = &samples.g[first * samples.g_width..];
            transpose(from, samples.g_width, &mut self.padded, |block, columns| {
                self.g[block * V::COUNT..][..V::COUNT].copy_from_slice(columns);
            });
        }
        none.is_zero()
    }

    #[inline(always)]
    fn move_bodies(&mut self, tree: &Tree<f64>) {
        if tree.is_floating() {
            self.base = Some(base_of(&self.motion[self.bodies..]));
        }
        let motion = &mut self.motion[..];
        let (pairs, last) = self.turning.as_chunks();
        for &[i, j] in pairs {
            let turned = V::sin_cos([motion[i].q, motion[j].q]);
            [
                (motion[i].sin, motion[i].cos),
                (motion[j].sin, motion[j].cos),
            ] = turned;
        }
        if let &[j] = last {
            [(motion[j].sin, motion[j].cos)] = V::sin_cos([motion[j].q]);
        }
        for &j in &self.general {
            motion[j].versine = V::lift(1.0) - motion[j].cos;
        }
    }
}

/// The base's state from its coordinates. A lane after the last sample has no attitude; any
/// will do.
#[inline(always)]
fn base_of<V: Lanes>(coordinates: &[JointMotion<V>]) -> BaseState<V> {
    let constants = Constants {
        zero: V::lift(0.0),
        one: V::lift(1.0),
        half: V::lift(0.5),
    };
    let [mut q, mut qd, mut qdd] = [[constants.zero; BASE]; 3];
    for (k, of) in coordinates.iter().enumerate().take(BASE) {
        (q[k], qd[k], qdd[k]) = (of.q, of.qd, of.qdd);
    }
    let squared = crate::base::squared_length([q[3], q[4], q[5], q[6]]);
    let inverse = constants.one.divide(squared).where_nonzero(squared);
    BaseState::of([&q, &qd, &qdd], constants, inverse)
}

/// Reads a tile from a table of states: `set(k, x)` gets what belongs at place k. Gives zeros,
/// or NaN somewhere as [`transpose`].
#[inline(always)]
fn read<V: Lanes>(
    table: &[f64],
    first: usize,
    columns: &Columns,
    padded: &mut [f64],
    mut set: impl FnMut(usize, V),
) -> V {
    let count = columns.count;
    transpose(&table[first * count..], count, padded, |block, numbers| {
        let places = &columns.places[block * V::COUNT..][..V::COUNT];
        for (&place, &number) in places.iter().zip(numbers) {
            set(place, number);
        }
    })
}

/// The columns of a table, a row a lane, in blocks: see [`Lanes::load_transposed`]. Gives zeros,
/// or NaN somewhere if not all numbers are finite, be it of these rows or of what follows them.
#[inline(always)]
fn transpose<V: Lanes>(
    from: &[f64],
    width: usize,
    padded: &mut [f64],
    put: impl FnMut(usize, &[V]),
) -> V {
    let blocks = width.div_ceil(V::COUNT);
    // Whole blocks read beyond the last row's end.
    let from = if from.len() < (V::COUNT - 1) * width + blocks * V::COUNT {
        let count = from.len().min(V::COUNT * width);
        padded[..count].copy_from_slice(&from[..count]);
        padded[count..].fill(0.0);
        &*padded
    } else {
        from
    };
    V::load_transposed(from, width, blocks, put)
}
