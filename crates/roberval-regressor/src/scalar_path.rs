//! Sample after sample, in any scalar: what the lanes are checked against.

use roberval_mechanism::{JointKind, ParameterSpace};
use roberval_scalar::Scalar;

use crate::{
    BaseState, DenseRows, DynamicsWorkspace, EnergyWorkspace, Expansion, JointMotion, JointStates,
    Model, Projected, RegressorError, SelectedRows, Sink, States, Transmission, Tree, dynamics,
    energy,
};

/// How base and joints move in one sample.
#[derive(Debug, Clone)]
pub(crate) struct Motion<T> {
    /// A floating robot's base.
    pub base: Option<BaseState<T>>,
    /// One entry a body.
    pub joints: Vec<JointMotion<T>>,
}

impl<T> Default for Motion<T> {
    fn default() -> Self {
        Self {
            base: None,
            joints: Vec::new(),
        }
    }
}

/// How all joints move, sample by sample.
pub(crate) struct Motions<'a> {
    tree: &'a Tree<f64>,
    expansion: Option<&'a Expansion<f64>>,
    expanded: Option<JointStates<f64>>,
    /// m zeros.
    still: Vec<f64>,
    model: Model,
    states: States<'a>,
    motion: Motion<f64>,
}

/// The motion of base and joints, and G of a mechanism with constraints.
pub(crate) type Moving<'a> = (&'a Motion<f64>, Option<&'a Transmission<f64>>);

impl<'a> Motions<'a> {
    pub(crate) fn new(
        tree: &'a Tree<f64>,
        expansion: Option<&'a Expansion<f64>>,
        model: Model,
        states: States<'a>,
    ) -> Self {
        Self {
            tree,
            expansion,
            expanded: expansion.map(Expansion::states),
            still: vec![0.0; expansion.map_or(tree.dof, Expansion::independent)],
            model,
            states,
            motion: Motion::default(),
        }
    }

    pub(crate) fn at(&mut self, sample: usize) -> Result<Moving<'_>, RegressorError> {
        let m = self.still.len();
        let span = sample * m..(sample + 1) * m;
        let positions = m + usize::from(self.tree.is_floating());
        let q = &self.states.q[sample * positions..(sample + 1) * positions];
        let States { qd, qdd, .. } = self.states;
        let state = [q, &qd[span.clone()], &qdd[span]];
        let [q, qd, qdd] = self.model.taken(state, &self.still);
        if self.tree.is_floating() {
            let constants = self.tree.constants;
            self.motion.base = Some(BaseState::read([q, qd, qdd], constants, f64::recip));
        }
        let q = self.tree.variables(q);
        let state = match (self.expansion, &mut self.expanded) {
            (Some(expansion), Some(expanded)) => {
                expansion
                    .expand([q, qd, qdd], expanded)
                    .map_err(|error| RegressorError::NoValue { sample, error })?;
                [&expanded.q[..], &expanded.qd, &expanded.qdd]
            }
            _ => [q, qd, qdd],
        };
        self.motion.joints.clear();
        let bodies = self.tree.bodies.iter();
        self.motion.joints.extend(bodies.map(|body| {
            let [q, qd, qdd] = state.map(|x| body.variable.map_or(0.0, |at| x[at]));
            match body.joint {
                JointKind::Revolute => JointMotion::revolute(q, qd, qdd),
                _ => JointMotion::prismatic(q, qd, qdd),
            }
        }));
        let transmission = self.expanded.as_ref().map(|e| &e.transmission);
        Ok((&self.motion, transmission))
    }
}

/// Writes the rows of one sample, all columns or a choice of them.
pub(crate) struct Rows<'a, T> {
    tree: &'a Tree<T>,
    space: &'a ParameterSpace,
    /// For a choice: each column's place, and how many are chosen.
    choice: Option<(Vec<Option<u32>>, usize)>,
    dynamics: DynamicsWorkspace<T>,
    energy: EnergyWorkspace<T>,
}

impl<'a, T: Scalar> Rows<'a, T> {
    pub(crate) fn new(
        tree: &'a Tree<T>,
        space: &'a ParameterSpace,
        columns: Option<&[usize]>,
    ) -> Self {
        let choice = columns.map(|columns| (places(columns, space.len()), columns.len()));
        Self {
            tree,
            space,
            choice,
            dynamics: DynamicsWorkspace::new(tree),
            energy: EnergyWorkspace::new(tree),
        }
    }

    /// The rows at a motion: of all joints, or with G of the independent ones.
    pub(crate) fn write(
        &mut self,
        model: Model,
        motion: &Motion<T>,
        transmission: Option<&Transmission<T>>,
        rows: &mut [T],
    ) {
        rows.fill(self.tree.constants.zero);
        let space = self.space;
        match self.choice.take() {
            None => self.run(model, motion, transmission, &mut DenseRows { space, rows }),
            Some((places, width)) => {
                let mut sink = SelectedRows {
                    space,
                    places: &places,
                    width,
                    rows,
                };
                self.run(model, motion, transmission, &mut sink);
                self.choice = Some((places, width));
            }
        }
    }

    fn run(
        &mut self,
        model: Model,
        motion: &Motion<T>,
        transmission: Option<&Transmission<T>>,
        sink: &mut impl Sink<T>,
    ) {
        if let Some(base) = &motion.base {
            self.dynamics.move_base(self.tree, base);
            self.energy.move_base(self.tree, base);
        }
        let motion = &motion.joints;
        match (model, transmission) {
            (Model::H, _) => energy(self.tree, motion, &mut self.energy, sink),
            (_, None) => dynamics(self.tree, motion, &mut self.dynamics, sink),
            (_, Some(transmission)) => {
                let mut sink = Projected {
                    transmission,
                    inner: sink,
                };
                dynamics(self.tree, motion, &mut self.dynamics, &mut sink);
            }
        }
    }
}

/// Each column's place among the chosen ones.
pub(crate) fn places(columns: &[usize], width: usize) -> Vec<Option<u32>> {
    let mut places = vec![None; width];
    for (place, &column) in columns.iter().enumerate() {
        places[column] = Some(place as u32);
    }
    places
}
