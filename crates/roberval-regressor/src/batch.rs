use roberval_mechanism::{JointKind, Mechanism, ParameterSpace};
use roberval_scalar::{Magnitude, Scalar, Width, dispatch};

use crate::lanes::{BadTile, Fill, FillTorques, Form, Pool};
use crate::packed::Export;
use crate::sink::SelectedRows;
use crate::{
    BaseState, DenseRows, DynamicsWorkspace, EnergyWorkspace, Expansion, JointMotion, JointStates,
    NoValue, PackedLayout, Projected, Sink, Torques, Transmission, Tree, dynamics, energy,
};

/// The three models, each linear in the parameters X.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Model {
    /// d: the dynamic model (Gautier 1991, eq. (5)).
    #[default]
    D,
    /// d0: the dynamic model at rest (eq. (8)).
    D0,
    /// h: the energy model (eq. (10)); only its differences mean anything.
    H,
}

impl Model {
    /// All models.
    pub const ALL: [Self; 3] = [Self::D, Self::D0, Self::H];

    /// `d`, `d0` or `h`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::D => "d",
            Self::D0 => "d0",
            Self::H => "h",
        }
    }

    /// Rows a sample gives, for m independent joints (all n without constraints).
    #[must_use]
    pub fn rows(self, independent: usize) -> usize {
        match self {
            Self::D | Self::D0 => independent,
            Self::H => 1,
        }
    }
}

/// What is wrong with the arrays handed to a [`Regressor`].
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RegressorError {
    /// An array has the wrong number of entries.
    #[error("{array} has {found} entries, expected {expected} ({shape})")]
    Length {
        /// Which array.
        array: &'static str,
        /// What its shape should be.
        shape: String,
        /// Entries expected.
        expected: usize,
        /// Entries found.
        found: usize,
    },
    /// The attitude of a floating base is none.
    #[error(
        "q[{sample}, 3:7] has length {length}: the attitude of a floating base must be a quaternion (x, y, z, w) of length 1"
    )]
    Quaternion {
        /// Row, from 0.
        sample: usize,
        /// Its length.
        length: f64,
    },
    /// An entry is NaN or infinite.
    #[error("{array}[{sample}, {joint}] is {value}: joint states must be finite numbers")]
    NotFinite {
        /// Which array.
        array: &'static str,
        /// Row, from 0.
        sample: usize,
        /// Column, from 0.
        joint: usize,
        /// What was found.
        value: f64,
    },
    /// The constraints have no value at a state.
    #[error("sample {sample}: {error}")]
    NoValue {
        /// Row, from 0.
        sample: usize,
        /// What has no value.
        error: NoValue,
    },
}

/// The regressor of a mechanism over float samples.
///
/// Rows come as (N, m, C) for d (there G' d) and d0, (N, C) for h, in C order, so that a
/// reshape gives W. m is the number of independent variables: all n, unless couples make
/// some depend on others. The first six rows of a floating robot are the force and the
/// moment on its base, in the base's frame.
#[derive(Debug, Clone)]
pub struct Regressor {
    tree: Tree<f64>,
    expansion: Option<Expansion<f64>>,
    space: ParameterSpace,
    width: Width,
    /// The nonzeros of d and of h, and all columns from them.
    layouts: [PackedLayout; 2],
    exports: [Export; 2],
    pool: Pool,
}

/// Results of more bytes than this are written past the cache: they would not stay in it.
const STREAM_BYTES: usize = 16 << 20;

impl Regressor {
    /// The regressor of a mechanism.
    #[must_use]
    pub fn new(mechanism: &Mechanism) -> Self {
        let tree = Tree::of(mechanism);
        let space = mechanism.parameters();
        let layouts = [Model::D, Model::H].map(|model| PackedLayout::new(&tree, &space, model));
        let exports = [Model::D, Model::H].map(|model| {
            let layout = &layouts[family(model)];
            Export::new(layout, model.rows(tree.dof), space.len(), Some)
        });
        Self {
            tree,
            expansion: Expansion::in_floats(mechanism),
            space,
            width: Width::best(),
            layouts,
            exports,
            pool: Pool::default(),
        }
    }

    /// The same with lanes of this width, which the processor must have: batches then
    /// differ in rounding only.
    #[must_use]
    pub fn with_width(mut self, width: Width) -> Self {
        self.width = width;
        self
    }

    /// Where the numbers of [`Regressor::fill_packed`] belong.
    #[must_use]
    pub fn packed_layout(&self, model: Model) -> &PackedLayout {
        &self.layouts[family(model)]
    }

    /// Samples in a tile of [`Regressor::fill_packed`].
    #[must_use]
    pub fn lanes(&self) -> usize {
        self.width.lanes()
    }

    /// The nonzeros of all columns, in tiles: see [`PackedLayout`]. Fills `out`
    /// ([`PackedLayout::len`] numbers).
    ///
    /// # Errors
    /// [`RegressorError`] if an array has the wrong length or a state is not finite.
    pub fn fill_packed(
        &self,
        model: Model,
        states: States<'_>,
        out: &mut [f64],
    ) -> Result<(), RegressorError> {
        let samples = states.count(self.dof(), self.dof())?;
        let layout = self.packed_layout(model);
        let lanes = self.lanes();
        let expected = layout.len(samples, lanes);
        if out.len() != expected {
            let shape = format!("{samples} samples in tiles of {lanes}");
            check_length("out", expected, out.len(), &shape)?;
        }
        let form = Form::Packed(layout.entries().len());
        self.run(model, states, form, self.width, out)
    }

    /// The robot's constants, if its rows are those of all joints: then the recursion over
    /// lanes gives them.
    #[must_use]
    pub fn unconstrained(&self) -> Option<&Tree<f64>> {
        (self.expansion.is_none() && !self.tree.is_floating()).then_some(&self.tree)
    }

    /// The lanes of batches.
    #[must_use]
    pub fn width(&self) -> Width {
        self.width
    }

    /// Whether batches go by lanes: where joints depend on others G comes with every sample.
    fn in_lanes(&self) -> bool {
        self.width > Width::Plain && self.unconstrained().is_some()
    }

    /// The lanes for so many samples: one lane for one.
    fn width_for(&self, samples: usize) -> Width {
        match samples {
            0 | 1 => self.width.min(Width::narrow()),
            _ => self.width,
        }
    }

    /// Fills `out` by lanes.
    fn run(
        &self,
        model: Model,
        states: States<'_>,
        form: Form<'_>,
        width: Width,
        out: &mut [f64],
    ) -> Result<(), RegressorError> {
        let task = Fill {
            pool: &self.pool,
            tree: &self.tree,
            model,
            states,
            form,
            stream: size_of_val(out) > STREAM_BYTES,
            out,
        };
        dispatch(width, task).map_err(|bad| states.fault(bad, self.dof()))
    }

    /// Number of degrees of freedom n of the tree.
    #[must_use]
    pub fn dof(&self) -> usize {
        self.tree.dof
    }

    /// Number of independent variables m: the states' and the rows'.
    #[must_use]
    pub fn independent(&self) -> usize {
        let constrained = self.expansion.as_ref().map(Expansion::independent);
        constrained.unwrap_or(self.tree.dof)
    }

    /// Number of coordinates of q: m, or m + 1 for a floating robot.
    #[must_use]
    pub fn positions(&self) -> usize {
        self.independent() + usize::from(self.tree.is_floating())
    }

    /// The parameters in column order.
    #[must_use]
    pub fn parameters(&self) -> &ParameterSpace {
        &self.space
    }

    /// The number of samples N, once it is sure that the states fit the robot.
    ///
    /// # Errors
    /// [`RegressorError`] if an array has the wrong length, a state is not finite or an
    /// attitude is none.
    pub fn check(&self, states: States<'_>) -> Result<usize, RegressorError> {
        states.check(self.positions(), self.independent())
    }

    /// All columns of a model: fills `out` (N x rows x C).
    ///
    /// # Errors
    /// [`RegressorError`] if an array has the wrong length or a state is not finite.
    pub fn fill(
        &self,
        model: Model,
        states: States<'_>,
        out: &mut [f64],
    ) -> Result<(), RegressorError> {
        let width = self.space.len();
        if self.in_lanes() {
            let samples = states.count(self.dof(), self.dof())?;
            check_out(model, samples, self.dof(), width, out.len())?;
            let export = &self.exports[family(model)];
            let width = self.width_for(samples);
            return self.run(model, states, Form::Rows(export), width, out);
        }
        let samples = self.check(states)?;
        check_out(model, samples, self.independent(), width, out.len())?;
        let mut motions = self.motions(model, states);
        let mut rows = Rows::new(&self.tree, &self.space, None);
        let size = model.rows(self.independent()) * width;
        for (sample, out) in out.chunks_exact_mut(size.max(1)).enumerate() {
            let (motion, transmission) = motions.at(sample)?;
            rows.write(model, motion, transmission, out);
        }
        Ok(())
    }

    /// A choice of columns, in the order given: the reduced models d1 and h1. Fills
    /// `out` (N x rows x b).
    ///
    /// # Errors
    /// [`RegressorError`] if an array has the wrong length or a state is not finite.
    pub fn fill_columns(
        &self,
        model: Model,
        columns: &[usize],
        states: States<'_>,
        out: &mut [f64],
    ) -> Result<(), RegressorError> {
        if self.in_lanes() {
            let samples = states.count(self.dof(), self.dof())?;
            check_out(model, samples, self.dof(), columns.len(), out.len())?;
            let layout = &self.layouts[family(model)];
            let places = places(columns, self.space.len());
            let place = |column: usize| places[column].map(|place| place as usize);
            let export = Export::new(layout, model.rows(self.dof()), columns.len(), place);
            let width = self.width_for(samples);
            return self.run(model, states, Form::Rows(&export), width, out);
        }
        let samples = self.check(states)?;
        check_out(model, samples, self.independent(), columns.len(), out.len())?;
        let mut motions = self.motions(model, states);
        let mut rows = Rows::new(&self.tree, &self.space, Some(columns));
        let size = model.rows(self.independent()) * columns.len();
        for (sample, out) in out.chunks_exact_mut(size.max(1)).enumerate() {
            let (motion, transmission) = motions.at(sample)?;
            rows.write(model, motion, transmission, out);
        }
        Ok(())
    }

    /// The entrywise magnitudes of [`Regressor::fill`]: what the entries would be if
    /// nothing cancelled. An entry below a few eps of its magnitude is rounding noise.
    ///
    /// # Errors
    /// [`RegressorError`] if an array has the wrong length or a state is not finite.
    pub fn fill_magnitudes(
        &self,
        model: Model,
        states: States<'_>,
        out: &mut [f64],
    ) -> Result<(), RegressorError> {
        let samples = self.check(states)?;
        let width = self.space.len();
        check_out(model, samples, self.independent(), width, out.len())?;
        let tree = self.tree.magnitude();
        let mut motions = self.motions(model, states);
        let mut sizes = Motion::default();
        let mut rows = Rows::new(&tree, &self.space, None);
        let size = model.rows(self.independent()) * width;
        let mut magnitudes = vec![Magnitude::default(); size];
        for (sample, out) in out.chunks_exact_mut(size.max(1)).enumerate() {
            let (motion, transmission) = motions.at(sample)?;
            sizes.base = motion.base.as_ref().map(BaseState::magnitude);
            sizes.joints.clear();
            let joints = motion.joints.iter().map(JointMotion::magnitude);
            sizes.joints.extend(joints);
            let transmission = transmission.map(|g| g.map(Magnitude::of));
            rows.write(model, &sizes, transmission.as_ref(), &mut magnitudes);
            for (out, magnitude) in out.iter_mut().zip(&magnitudes) {
                *out = magnitude.value();
            }
        }
        Ok(())
    }

    /// The torques Gamma = d X of the standard parameters `x` (C numbers): N x n.
    ///
    /// # Errors
    /// [`RegressorError`] if an array has the wrong length or a state is not finite.
    pub fn torques(
        &self,
        x: &[f64],
        states: States<'_>,
        out: &mut [f64],
    ) -> Result<(), RegressorError> {
        let samples = states.count(self.positions(), self.independent())?;
        check_length("x", self.space.len(), x.len(), "one number a parameter")?;
        check_out(Model::D, samples, self.independent(), 1, out.len())?;
        if self.in_lanes() {
            let task = FillTorques {
                pool: &self.pool,
                tree: &self.tree,
                space: &self.space,
                states,
                x,
                out,
            };
            return dispatch(self.width_for(samples), task)
                .map_err(|b| states.fault(b, self.dof()));
        }
        self.check(states)?;
        let mut motions = self.motions(Model::D, states);
        let mut workspace = DynamicsWorkspace::new(&self.tree);
        for (sample, torques) in out.chunks_exact_mut(self.independent()).enumerate() {
            torques.fill(0.0);
            let (motion, transmission) = motions.at(sample)?;
            if let Some(base) = &motion.base {
                workspace.move_base(&self.tree, base);
            }
            let mut sink = Torques {
                space: &self.space,
                x,
                torques,
            };
            match transmission {
                None => dynamics(&self.tree, &motion.joints, &mut workspace, &mut sink),
                Some(transmission) => {
                    let inner = &mut sink;
                    let mut sink = Projected {
                        transmission,
                        inner,
                    };
                    dynamics(&self.tree, &motion.joints, &mut workspace, &mut sink);
                }
            }
        }
        Ok(())
    }

    /// The states of all n joint variables of the tree, those included that follow others by
    /// couples or loops: q, qd and qdd, N x n each (q of a floating robot N x (n + 1)).
    ///
    /// # Errors
    /// [`RegressorError`] if an array has the wrong length, a state is not finite, or the
    /// constraints have no value there.
    pub fn expand(&self, states: States<'_>) -> Result<[Vec<f64>; 3], RegressorError> {
        let m = self.independent();
        let samples = self.check(states)?;
        let mut all: [Vec<f64>; 3] = Default::default();
        let mut expanded = self.expansion.as_ref().map(Expansion::states);
        let positions = self.positions();
        for sample in 0..samples {
            let span = sample * m..(sample + 1) * m;
            let q = &states.q[sample * positions..(sample + 1) * positions];
            let state = [
                self.tree.variables(q),
                &states.qd[span.clone()],
                &states.qdd[span],
            ];
            let joints = match (&self.expansion, &mut expanded) {
                (Some(expansion), Some(expanded)) => {
                    expansion
                        .expand(state, expanded)
                        .map_err(|error| RegressorError::NoValue { sample, error })?;
                    [&expanded.q[..], &expanded.qd, &expanded.qdd]
                }
                _ => state,
            };
            let base = if self.tree.is_floating() { 6 } else { 0 };
            all[0].extend(&q[..positions - m + base]);
            all[0].extend(&joints[0][base..]);
            all[1].extend(joints[1]);
            all[2].extend(joints[2]);
        }
        Ok(all)
    }

    fn motions<'a>(&'a self, model: Model, states: States<'a>) -> Motions<'a> {
        Motions {
            tree: &self.tree,
            expansion: self.expansion.as_ref(),
            expanded: self.expansion.as_ref().map(Expansion::states),
            still: vec![0.0; self.independent()],
            rest: model == Model::D0,
            states,
            motion: Motion::default(),
        }
    }
}

/// N states of the m independent variables, row-major.
///
/// Coordinates stand in link order (rad or m, per s, per s^2). Those of a floating robot
/// begin as Pinocchio's do: q with the base's position and attitude x y z qx qy qz qw, qd
/// with the velocity of the base's origin and its angular velocity, both in the base's
/// frame, qdd with the rates of these six numbers (the spatial acceleration: the origin's
/// own is `dv + w x v`).
#[derive(Debug, Clone, Copy)]
pub struct States<'a> {
    /// Positions, N x m, or N x (m + 1) for a floating robot.
    pub q: &'a [f64],
    /// Velocities, N x m.
    pub qd: &'a [f64],
    /// Accelerations, N x m (h does not look at them).
    pub qdd: &'a [f64],
}

/// A quaternion is scaled to length 1 if it is as near to it as this: numbers written with
/// three digits are, and an attitude in other coordinates hardly ever.
const QUATERNION_ROUNDING: f64 = 1e-2;

impl States<'_> {
    /// The arrays with their widths, for so many coordinates of a position and of a velocity.
    fn arrays(&self, positions: usize, velocities: usize) -> [(&'static str, &[f64], usize); 3] {
        [
            ("q", self.q, positions),
            ("qd", self.qd, velocities),
            ("qdd", self.qdd, velocities),
        ]
    }

    /// The number of samples N, if the lengths agree.
    fn count(&self, positions: usize, velocities: usize) -> Result<usize, RegressorError> {
        let samples = self.q.len() / positions;
        for (array, values, width) in self.arrays(positions, velocities) {
            if values.len() != samples * width {
                let shape = format!("{samples} samples x {width} coordinates");
                check_length(array, samples * width, values.len(), &shape)?;
            }
        }
        Ok(samples)
    }

    /// What is not finite in a tile.
    #[cold]
    fn fault(&self, bad: BadTile, dof: usize) -> RegressorError {
        let BadTile(first) = bad;
        let rest = |values: &[f64]| values[first * dof..].iter().position(|x| !x.is_finite());
        let arrays = [("q", self.q), ("qd", self.qd), ("qdd", self.qdd)];
        let found = arrays.map(|(array, values)| (rest(values), array, values));
        let (at, array, values) = found
            .into_iter()
            .find(|(at, ..)| at.is_some())
            .expect("a tile is bad because of a state");
        let at = first * dof + at.unwrap_or(0);
        RegressorError::NotFinite {
            array,
            sample: at / dof,
            joint: at % dof,
            value: values[at],
        }
    }

    /// The number of samples N, all finite.
    fn check(&self, positions: usize, velocities: usize) -> Result<usize, RegressorError> {
        let samples = self.count(positions, velocities)?;
        for (array, values, width) in self.arrays(positions, velocities) {
            if let Some(at) = values.iter().position(|x| !x.is_finite()) {
                return Err(RegressorError::NotFinite {
                    array,
                    sample: at / width,
                    joint: at % width,
                    value: values[at],
                });
            }
        }
        if positions > velocities {
            self.check_quaternions(positions)?;
        }
        Ok(samples)
    }

    fn check_quaternions(&self, positions: usize) -> Result<(), RegressorError> {
        for (sample, q) in self.q.chunks_exact(positions).enumerate() {
            let length = q[3..7].iter().map(|x| x * x).sum::<f64>().sqrt();
            let near_one = (length - 1.0).abs() <= QUATERNION_ROUNDING;
            if !near_one {
                return Err(RegressorError::Quaternion { sample, length });
            }
        }
        Ok(())
    }
}

/// How base and joints move in one sample.
#[derive(Debug, Clone)]
struct Motion<T> {
    /// A floating robot's base.
    base: Option<BaseState<T>>,
    /// One entry a body.
    joints: Vec<JointMotion<T>>,
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
struct Motions<'a> {
    tree: &'a Tree<f64>,
    expansion: Option<&'a Expansion<f64>>,
    expanded: Option<JointStates<f64>>,
    /// m zeros.
    still: Vec<f64>,
    /// Whether velocities count as zero (d0).
    rest: bool,
    states: States<'a>,
    motion: Motion<f64>,
}

/// The motion of base and joints, and G of a mechanism with constraints.
type Moving<'a> = (&'a Motion<f64>, Option<&'a Transmission<f64>>);

impl Motions<'_> {
    fn at(&mut self, sample: usize) -> Result<Moving<'_>, RegressorError> {
        let m = self.still.len();
        let span = sample * m..(sample + 1) * m;
        let positions = m + usize::from(self.tree.is_floating());
        let q = &self.states.q[sample * positions..(sample + 1) * positions];
        let qdd = &self.states.qdd[span.clone()];
        let qd = if self.rest {
            &self.still[..]
        } else {
            &self.states.qd[span]
        };
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
struct Rows<'a, T> {
    tree: &'a Tree<T>,
    space: &'a ParameterSpace,
    /// For a choice: each column's place, and how many are chosen.
    choice: Option<(Vec<Option<u32>>, usize)>,
    dynamics: DynamicsWorkspace<T>,
    energy: EnergyWorkspace<T>,
}

impl<'a, T: Scalar> Rows<'a, T> {
    fn new(tree: &'a Tree<T>, space: &'a ParameterSpace, columns: Option<&[usize]>) -> Self {
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
    fn write(
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

/// d and d0 have the same nonzeros, h has others.
fn family(model: Model) -> usize {
    usize::from(model == Model::H)
}

/// Each column's place among the chosen ones.
fn places(columns: &[usize], width: usize) -> Vec<Option<u32>> {
    let mut places = vec![None; width];
    for (place, &column) in columns.iter().enumerate() {
        places[column] = Some(place as u32);
    }
    places
}

fn check_out(
    model: Model,
    samples: usize,
    dof: usize,
    width: usize,
    found: usize,
) -> Result<(), RegressorError> {
    let expected = samples * model.rows(dof) * width;
    if found == expected {
        return Ok(());
    }
    let rows = model.rows(dof);
    let shape = format!("{samples} samples x {rows} rows x {width} columns");
    check_length("out", expected, found, &shape)
}

fn check_length(
    array: &'static str,
    expected: usize,
    found: usize,
    shape: &str,
) -> Result<(), RegressorError> {
    if found == expected {
        return Ok(());
    }
    Err(RegressorError::Length {
        array,
        shape: shape.to_owned(),
        expected,
        found,
    })
}
