//! The nonzeros of one tile of samples after the other, for who does not store them.

use roberval_scalar::Lanes;

use crate::lanes::Work;
use crate::tree_states::TreeStates;
use crate::{Model, Nonzero, Regressor, Sink};

/// Takes the numbers of a tile, slot by slot: see [`crate::Regressor::tile_entries`].
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

/// Numbers what the recursion gives; keeps it, packed, where it has to be projected first.
struct InTurn<'a, V, S> {
    at: usize,
    stage: Option<&'a mut [V]>,
    to: &'a mut S,
}

impl<V: Lanes, S: Slots<V>> InTurn<'_, V, S> {
    /// Hands on all of them: rows have one pattern for all columns of a link.
    #[inline(always)]
    fn put(&mut self, numbers: &[V], nonzero: impl Fn(usize) -> bool) {
        let Some(stage) = &mut self.stage else {
            self.to.put(self.at, numbers);
            self.at += numbers.len();
            return;
        };
        for (k, number) in numbers.iter().enumerate() {
            if nonzero(k) {
                stage[self.at] = *number;
                self.at += 1;
            }
        }
    }
}

impl<V: Lanes, S: Slots<V>> Sink<V> for InTurn<'_, V, S> {
    #[inline(always)]
    fn link(&mut self, _: usize, _: usize, columns: [V; 10], nonzero: Nonzero) {
        self.put(&columns, |k| nonzero.has(k));
    }

    #[inline(always)]
    fn rotor(&mut self, _: usize, _: usize, value: V) {
        self.put(&[value], |_| true);
    }
}
