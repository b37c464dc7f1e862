//! The nonzeros of one tile of samples after the other, for who does not store them.

use roberval_scalar::Lanes;

use crate::lanes::Work;
use crate::tree_states::TreeStates;
use crate::{Model, Nonzero, Regressor, Sink};

/// Takes the packed numbers of a tile, slot by slot: see [`crate::PackedLayout`].
pub trait Slots<V> {
    /// The numbers of the slots from `first` on.
    fn put(&mut self, first: usize, numbers: &[V]);
}

/// Computes the rows of d, a tile at a time.
pub struct TileRows<V> {
    work: Work<V>,
    stage: Vec<V>,
    projected: Vec<V>,
}

impl<V: Lanes> TileRows<V> {
    /// Working memory for this robot.
    #[inline(always)]
    #[must_use]
    pub fn new(regressor: &Regressor) -> Self {
        let robot = regressor.robot();
        let slots = regressor.packed_layout(Model::D).entries().len();
        let of_tree = robot.projection.map_or(0, |p| p.tree_slots());
        Self {
            work: Work::new(robot),
            stage: vec![V::lift(0.0); of_tree],
            projected: vec![V::lift(0.0); if of_tree > 0 { slots } else { 0 }],
        }
    }

    /// The rows of the samples from `first` on. States must be finite.
    #[inline(always)]
    pub fn run(
        &mut self,
        regressor: &Regressor,
        states: &TreeStates<'_>,
        first: usize,
        to: &mut impl Slots<V>,
    ) {
        let robot = regressor.robot();
        let stage = robot.projection.map(|_| &mut self.stage[..]);
        let mut sink = InTurn { at: 0, stage, to };
        // Finite states: nothing can be wrong.
        let _ = self
            .work
            .run(robot.tree, Model::D, states, first, &mut sink);
        if let Some(projection) = robot.projection {
            projection.apply(self.work.g(), &self.stage, &mut self.projected);
            to.put(0, &self.projected);
        }
    }
}

/// Numbers the recursion's slots; keeps them where they have to be projected first.
struct InTurn<'a, V, S> {
    at: usize,
    stage: Option<&'a mut [V]>,
    to: &'a mut S,
}

impl<V: Lanes, S: Slots<V>> InTurn<'_, V, S> {
    #[inline(always)]
    fn put(&mut self, numbers: &[V]) {
        match &mut self.stage {
            None => self.to.put(self.at, numbers),
            Some(stage) => stage[self.at..self.at + numbers.len()].copy_from_slice(numbers),
        }
        self.at += numbers.len();
    }
}

impl<V: Lanes, S: Slots<V>> Sink<V> for InTurn<'_, V, S> {
    #[inline(always)]
    fn link(&mut self, _: usize, _: usize, columns: [V; 10], nonzero: Nonzero) {
        let (mut numbers, mut count) = (columns, 0);
        for k in 0..10 {
            if nonzero.has(k) {
                numbers[count] = columns[k];
                count += 1;
            }
        }
        self.put(&numbers[..count]);
    }

    #[inline(always)]
    fn rotor(&mut self, _: usize, _: usize, value: V) {
        self.put(&[value]);
    }
}
