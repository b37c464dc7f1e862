//! Rows of many samples: the checks of states, and the way to the lanes or past them.

use roberval_mechanism::{Mechanism, ParameterSpace};
use roberval_scalar::{Magnitude, Width, dispatch};

use crate::lanes::{Fault, Fill, FillTorques, Form, Pool, Robot};
use crate::packed::{Export, Projection};
use crate::scalar_path::{Motion, Motions, Rows, places};
use crate::states::check_length;
use crate::{
    BaseState, DynamicsWorkspace, Expansion, JointMotion, Model, NoValue, PackedLayout, Projected,
    RegressorError, States, Torques, Tree, dynamics,
};

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
    /// How rows of d follow from those of all joints, where some depend on others.
    projection: Option<Projection>,
    pool: Pool,
}

/// How rows are written.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Writing {
    /// Past the cache, where they would not stay anyway.
    pub past_cache: bool,
    /// Leave alone what is zero in every state: it is zero already, from earlier rows of the
    /// same columns or from the beginning: see [`Regressor::check_zeros`]. Without lanes all is
    /// written.
    pub keep_zeros: bool,
}

impl Writing {
    /// All of `out`, past the cache if it is too large to stay in it.
    fn whole(out: &[f64]) -> Self {
        Self {
            past_cache: size_of_val(out) > STREAM_BYTES,
            keep_zeros: false,
        }
    }
}

/// A choice of columns of a model, made ready.
#[derive(Debug, Clone)]
pub struct Columns {
    model: Model,
    columns: Vec<usize>,
    export: Export,
}

impl Columns {
    /// The columns, in the order asked for.
    #[must_use]
    pub fn columns(&self) -> &[usize] {
        &self.columns
    }
}

/// Results of more bytes than this are written past the cache: they would not stay in it.
pub const STREAM_BYTES: usize = 16 << 20;

impl Regressor {
    /// The regressor of a mechanism.
    #[must_use]
    pub fn new(mechanism: &Mechanism) -> Self {
        let tree = Tree::of(mechanism);
        let space = mechanism.parameters();
        let expansion = Expansion::in_floats(mechanism);
        let mut layouts = [Model::D, Model::H].map(|m| PackedLayout::new(&tree, &space, m));
        let mut independent = tree.dof;
        let projection = expansion.as_ref().map(|expansion| {
            independent = expansion.independent();
            let g = expansion.states().transmission;
            let (projection, projected) =
                Projection::new(&layouts[0], &space, &g, (tree.dof, independent));
            layouts[0] = projected;
            projection
        });
        let exports = [Model::D, Model::H].map(|model| {
            let layout = &layouts[family(model)];
            Export::new(layout, model.rows(independent), space.len(), Some)
        });
        Self {
            tree,
            expansion,
            projection,
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

    /// Row and column of the numbers that [`crate::TileRows`] hands on: for each link the same
    /// rows for all its inertial columns, zeros of every state with them.
    #[must_use]
    pub fn tile_entries(&self) -> Vec<(usize, usize)> {
        self.packed_layout(Model::D).given()
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
        self.fill_packed_part(model, states, out, Writing::whole(out).past_cache)
    }

    /// As [`Regressor::fill_packed`] for a part of a larger batch, past the cache if told so.
    ///
    /// # Errors
    /// As [`Regressor::fill_packed`].
    pub fn fill_packed_part(
        &self,
        model: Model,
        states: States<'_>,
        out: &mut [f64],
        past_cache: bool,
    ) -> Result<(), RegressorError> {
        let samples = self.check_for_lanes(model, states)?;
        let layout = self.packed_layout(model);
        let lanes = self.lanes();
        let expected = layout.len(samples, lanes);
        if out.len() != expected {
            let shape = format!("{samples} samples in tiles of {lanes}");
            check_length("out", expected, out.len(), &shape)?;
        }
        let form = Form::Packed(layout.entries().len());
        let writing = Writing {
            past_cache,
            keep_zeros: false,
        };
        self.run(model, states, form, self.width, out, writing)
    }

    /// The robot's constants.
    #[must_use]
    pub fn tree(&self) -> &Tree<f64> {
        &self.tree
    }

    /// How the other joints follow, where they do.
    #[must_use]
    pub fn expansion(&self) -> Option<&Expansion<f64>> {
        self.expansion.as_ref()
    }

    pub(crate) fn robot(&self) -> Robot<'_> {
        Robot {
            tree: &self.tree,
            expansion: self.expansion.as_ref(),
            projection: self.projection.as_ref(),
        }
    }

    /// The lanes of batches.
    #[must_use]
    pub fn width(&self) -> Width {
        self.width
    }

    /// Whether batches go by lanes.
    fn in_lanes(&self) -> bool {
        self.width > Width::Plain
    }

    /// The lanes for so many samples: one lane for one.
    fn width_for(&self, samples: usize) -> Width {
        match samples {
            0 | 1 => self.width.min(Width::narrow()),
            _ => self.width,
        }
    }

    /// Whether a floating base has attitudes.
    ///
    /// # Errors
    /// [`RegressorError::Quaternion`] names the first that is none.
    pub fn check_attitudes(&self, states: States<'_>) -> Result<(), RegressorError> {
        if !self.tree.is_floating() {
            return Ok(());
        }
        states.check_quaternions(self.positions())
    }

    /// The number of samples, once it is sure that they fit. The lanes themselves look for
    /// what is not finite, but not before joints have been expanded.
    fn check_for_lanes(&self, model: Model, states: States<'_>) -> Result<usize, RegressorError> {
        if self.expansion.is_some() {
            return self.check(model, states);
        }
        let samples = states.count(self.positions(), self.independent())?;
        self.check_attitudes(states)?;
        Ok(samples)
    }

    /// Fills `out` by lanes.
    fn run(
        &self,
        model: Model,
        states: States<'_>,
        form: Form<'_>,
        width: Width,
        out: &mut [f64],
        writing: Writing,
    ) -> Result<(), RegressorError> {
        let task = Fill {
            pool: &self.pool,
            robot: self.robot(),
            model,
            states,
            form,
            writing,
            out,
        };
        dispatch(width, task).map_err(|fault| self.fault(fault, model, states))
    }

    /// What went wrong in a batch.
    #[cold]
    fn fault(&self, fault: Fault, model: Model, states: States<'_>) -> RegressorError {
        let widths = (self.positions(), self.independent());
        match fault {
            Fault::NoValue(sample, error) => RegressorError::NoValue { sample, error },
            Fault::Tile(first) => states.not_finite(model, first, widths).unwrap_or_else(|| {
                let what = "the state of a joint that follows others".to_owned();
                let error = NoValue::Number { what };
                let sample = first;
                RegressorError::NoValue { sample, error }
            }),
        }
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

    /// The number of samples N, once it is sure that the states fit the robot, as far as the
    /// model looks at them.
    ///
    /// # Errors
    /// [`RegressorError`] if an array has the wrong length, a state is not finite or an
    /// attitude is none.
    pub fn check(&self, model: Model, states: States<'_>) -> Result<usize, RegressorError> {
        states.check(model, (self.positions(), self.independent()))
    }

    /// A choice of a model's columns, in the order given, ready for many batches.
    ///
    /// # Panics
    /// If there is no such column.
    #[must_use]
    pub fn columns(&self, model: Model, columns: &[usize]) -> Columns {
        let places = places(columns, self.space.len());
        let place = |column: usize| places[column].map(|place| place as usize);
        let rows = model.rows(self.independent());
        let layout = &self.layouts[family(model)];
        Columns {
            model,
            export: Export::new(layout, rows, columns.len(), place),
            columns: columns.to_vec(),
        }
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
        self.fill_part(model, None, states, out, Writing::whole(out))
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
        let columns = self.columns(model, columns);
        self.fill_part(model, Some(&columns), states, out, Writing::whole(out))
    }

    /// Whether `out` has zeros to keep, before a batch is written: a look at both ends of each
    /// gap between the numbers of its first and its last sample.
    ///
    /// # Errors
    /// [`RegressorError::NotZero`] names the first number among them.
    pub fn check_zeros(
        &self,
        model: Model,
        columns: Option<&Columns>,
        out: &[f64],
    ) -> Result<(), RegressorError> {
        let export = self.export(model, columns);
        if !self.in_lanes() {
            return Ok(());
        }
        let Some(at) = export.not_zero(out) else {
            return Ok(());
        };
        let ([sample, row, column], value) = (export.place(at), out[at]);
        Err(RegressorError::NotZero {
            sample,
            row,
            column,
            value,
        })
    }

    /// How the rows of a choice of columns are written, or of all.
    fn export<'a>(&'a self, model: Model, columns: Option<&'a Columns>) -> &'a Export {
        columns.map_or(&self.exports[family(model)], |columns| &columns.export)
    }

    /// All columns, or those of `columns`, for a part of a larger batch.
    ///
    /// # Errors
    /// [`RegressorError`] if an array has the wrong length or a state is not finite.
    pub fn fill_part(
        &self,
        model: Model,
        columns: Option<&Columns>,
        states: States<'_>,
        out: &mut [f64],
        writing: Writing,
    ) -> Result<(), RegressorError> {
        let model = columns.map_or(model, |columns| columns.model);
        let width = columns.map_or(self.space.len(), |c| c.columns.len());
        if self.in_lanes() {
            let samples = self.check_for_lanes(model, states)?;
            check_out(model, samples, self.independent(), width, out.len())?;
            let form = Form::Rows(self.export(model, columns));
            return self.run(model, states, form, self.width_for(samples), out, writing);
        }
        let samples = self.check(model, states)?;
        check_out(model, samples, self.independent(), width, out.len())?;
        let mut motions = self.motions(model, states);
        let mut rows = Rows::new(&self.tree, &self.space, columns.map(Columns::columns));
        let size = model.rows(self.independent()) * width;
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
        let samples = self.check(model, states)?;
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
    /// Lanes carry forces inward, as Newton and Euler do; without lanes they are the rows times X.
    ///
    /// # Errors
    /// [`RegressorError`] if an array has the wrong length or a state is not finite.
    pub fn torques(
        &self,
        x: &[f64],
        states: States<'_>,
        out: &mut [f64],
    ) -> Result<(), RegressorError> {
        let samples = self.check_for_lanes(Model::D, states)?;
        check_length("x", self.space.len(), x.len(), "one number a parameter")?;
        check_out(Model::D, samples, self.independent(), 1, out.len())?;
        if self.in_lanes() {
            let task = FillTorques {
                pool: &self.pool,
                robot: self.robot(),
                space: &self.space,
                independent: self.independent(),
                states,
                x,
                out,
            };
            return dispatch(self.width_for(samples), task)
                .map_err(|f| self.fault(f, Model::D, states));
        }
        self.check(Model::D, states)?;
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
        let samples = self.check(Model::D, states)?;
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
        Motions::new(&self.tree, self.expansion.as_ref(), model, states)
    }
}

/// d and d0 have the same nonzeros, h has others.
fn family(model: Model) -> usize {
    usize::from(model == Model::H)
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
