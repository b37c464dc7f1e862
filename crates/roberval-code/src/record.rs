//! The models run through the recorder.

use std::str::FromStr;

use roberval_mechanism::{JointKind, Mechanism, ParameterSpace, VariableLaw};
use roberval_regressor::{
    Body, DynamicsWorkspace, EnergyWorkspace, JointMotion, Projected, SelectedRows, Shape,
    Transmission, Tree, dynamics, energy, newton_euler,
};

use crate::graph::{Graph, Recorded};
use crate::program::{Input, Program};

/// What the code computes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum What {
    /// Inverse dynamics tau(q, qd, qdd).
    #[default]
    Tau,
    /// The reduced regressor d1, n x b.
    Regressor,
    /// The energy row h1.
    Energy,
    /// The torques at rest: gravity.
    Gravity,
    /// The mass matrix, n x n.
    MassMatrix,
}

impl What {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Tau,
        Self::Regressor,
        Self::Energy,
        Self::Gravity,
        Self::MassMatrix,
    ];

    /// `tau`, `regressor`, `energy`, `gravity` or `mass`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Tau => "tau",
            Self::Regressor => "regressor",
            Self::Energy => "energy",
            Self::Gravity => "gravity",
            Self::MassMatrix => "mass",
        }
    }

    /// The shape of the result at one state, for n joint variables and b parameters.
    #[must_use]
    pub fn shape(self, n: usize, b: usize) -> Vec<usize> {
        match self {
            Self::Tau | Self::Gravity => vec![n],
            Self::Regressor => vec![n, b],
            Self::Energy => vec![b],
            Self::MassMatrix => vec![n, n],
        }
    }

    /// The joint states it takes.
    #[must_use]
    pub fn states(self) -> &'static [&'static str] {
        match self {
            Self::Tau | Self::Regressor => &["q", "qd", "qdd"],
            Self::Energy => &["q", "qd"],
            Self::Gravity | Self::MassMatrix => &["q"],
        }
    }

    /// Whether it takes parameters: the regressor and the energy row are multiplied by
    /// them.
    #[must_use]
    pub fn takes_parameters(self) -> bool {
        !matches!(self, Self::Regressor | Self::Energy)
    }
}

/// A word that is no [`What`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("code is written for {}", What::ALL.map(What::name).join(", "))]
pub struct UnknownWhat;

impl FromStr for What {
    type Err = UnknownWhat;

    fn from_str(name: &str) -> Result<Self, UnknownWhat> {
        let mut all = Self::ALL.into_iter();
        all.find(|what| what.name() == name).ok_or(UnknownWhat)
    }
}

/// Records one model of a mechanism. `columns` are the parameters that the code takes, in
/// this order; all others count as 0: the base parameters, or all. Friction adds to tau
/// two parameters a joint variable after them, Fv (viscous) and Fc (Coulomb).
#[must_use]
pub(crate) fn record(
    mechanism: &Mechanism,
    what: What,
    columns: &[usize],
    friction: bool,
) -> Program {
    // Mass may move between bodies only where not all standard parameters count; whether
    // that is worth it is seen by counting.
    let regroupings: &[bool] = match columns.len() < mechanism.parameters().len() {
        true if what.takes_parameters() => &[true, false],
        _ => &[false],
    };
    let record = |regroup: &bool| record_one(mechanism, what, columns, friction, *regroup);
    let programs = regroupings.iter().map(record);
    let cheapest = programs.min_by_key(Program::cost);
    cheapest.expect("there is one way at least")
}

fn record_one(
    mechanism: &Mechanism,
    what: What,
    columns: &[usize],
    friction: bool,
    regroup: bool,
) -> Program {
    let graph = Graph::default();
    let mut recorder = Recorder::new(&graph, mechanism, columns, regroup);
    let outputs = match what {
        What::Tau => recorder.tau(friction),
        What::Gravity => recorder.gravity(),
        What::MassMatrix => recorder.mass_matrix(),
        What::Regressor => recorder.regressor(columns),
        What::Energy => recorder.energy(columns),
    };
    let outputs = outputs.iter().map(|x| x.at).collect();
    let inputs = recorder.inputs;
    Program::new(graph, inputs, outputs)
}

struct Recorder<'g> {
    graph: &'g Graph,
    tree: Tree<Recorded<'g>>,
    shapes: Vec<Shape>,
    /// G: the joint variables that each independent coordinate moves.
    transmission: Transmission<Recorded<'g>>,
    /// The joint variables where the independent ones are 0; `None` if loops determine
    /// them: then the code takes them all, and G.
    offsets: Option<Vec<f64>>,
    /// The coordinates that the code takes: the independent ones, or all.
    taken: usize,
    /// Number of independent coordinates m.
    independent: usize,
    /// Whether mass moves between bodies as no motion can tell.
    regroup: bool,
    space: ParameterSpace,
    /// Number of parameters the code takes, friction not counted.
    width: usize,
    x: Vec<Recorded<'g>>,
    inputs: Vec<Input>,
}

impl<'g> Recorder<'g> {
    fn new(graph: &'g Graph, mechanism: &Mechanism, columns: &[usize], regroup: bool) -> Self {
        let space = mechanism.parameters();
        let tree = Tree::of(mechanism);
        let shapes = Shape::of(&tree);
        let tree = tree.map(|x| Recorded::constant(graph, x));
        let loops = mechanism.assembly.is_some();
        let taken = match loops {
            true => mechanism.dof(),
            false => mechanism.independent(),
        };
        let mut inputs: Vec<Input> = (0..taken).map(Input::Q).collect();
        inputs.extend((0..taken).map(Input::Qd));
        inputs.extend((0..taken).map(Input::Qdd));
        let (rows, offsets) = laws(graph, mechanism, &mut inputs);
        let mut x = vec![tree.constants.zero; space.len()];
        for (place, &column) in columns.iter().enumerate() {
            x[column] = Recorded::input(graph, inputs.len());
            inputs.push(Input::Parameter(place));
        }
        Self {
            graph,
            tree,
            shapes,
            transmission: Transmission::from_rows(rows),
            offsets: (!loops).then_some(offsets),
            taken,
            independent: mechanism.independent(),
            regroup,
            space,
            width: columns.len(),
            x,
            inputs,
        }
    }

    /// The joint variables' rates of those of the independent coordinates: G.
    fn transmitted(&self, i: usize, rate: impl Fn(usize) -> Recorded<'g>) -> Recorded<'g> {
        let terms = self.transmission.row(i).map(|(place, g)| g * rate(place));
        terms.fold(self.zero(), |sum, term| sum + term)
    }

    fn q(&self, i: usize) -> Recorded<'g> {
        let input = |k: usize| Recorded::input(self.graph, k);
        match &self.offsets {
            None => input(i),
            Some(offsets) => {
                self.transmitted(i, input) + Recorded::constant(self.graph, offsets[i])
            }
        }
    }

    fn qd(&self, i: usize) -> Recorded<'g> {
        let input = |k: usize| Recorded::input(self.graph, self.taken + k);
        match &self.offsets {
            None => input(i),
            Some(_) => self.transmitted(i, input),
        }
    }

    fn qdd(&self, i: usize) -> Recorded<'g> {
        let input = |k: usize| Recorded::input(self.graph, 2 * self.taken + k);
        match &self.offsets {
            None => input(i),
            Some(_) => self.transmitted(i, input),
        }
    }

    /// How the bodies move; velocities and accelerations of the joint variables as given.
    fn motion(
        &self,
        qd: impl Fn(usize) -> Recorded<'g>,
        qdd: impl Fn(usize) -> Recorded<'g>,
    ) -> Vec<JointMotion<Recorded<'g>>> {
        let (zero, one) = (self.tree.constants.zero, self.tree.constants.one);
        let of_body = |(j, body): (usize, &Body<Recorded<'g>>)| {
            self.graph.set_link(j);
            let still = JointMotion {
                cos: one,
                sin: zero,
                versine: zero,
                q: zero,
                qd: zero,
                qdd: zero,
            };
            let Some(i) = body.variable else { return still };
            let q = self.q(i);
            let moving = JointMotion {
                qd: qd(i),
                qdd: qdd(i),
                ..still
            };
            match body.joint {
                JointKind::Revolute => JointMotion {
                    cos: q.cos(),
                    sin: q.sin(),
                    versine: one - q.cos(),
                    ..moving
                },
                _ => JointMotion { q, ..moving },
            }
        };
        let bodies = self.tree.bodies.iter().enumerate();
        bodies.map(of_body).collect()
    }

    /// G' tau: the torques of the independent coordinates.
    fn projected(&self, tau: &[Recorded<'g>]) -> Vec<Recorded<'g>> {
        let mut torques = vec![self.zero(); self.independent];
        for (i, tau) in tau.iter().enumerate() {
            for (place, g) in self.transmission.row(i) {
                torques[place] = torques[place] + g * *tau;
            }
        }
        torques
    }

    fn zero(&self) -> Recorded<'g> {
        self.tree.constants.zero
    }

    fn newton_euler(&self, motion: &[JointMotion<Recorded<'g>>]) -> Vec<Recorded<'g>> {
        let parameters = (&self.space, &self.x[..]);
        newton_euler(
            &self.tree,
            &self.shapes,
            motion,
            parameters,
            self.regroup,
            |link| {
                self.graph.set_link(link);
            },
        )
    }

    fn tau(&mut self, friction: bool) -> Vec<Recorded<'g>> {
        let mut tau = self.newton_euler(&self.motion(|i| self.qd(i), |i| self.qdd(i)));
        let moving: Vec<usize> = (0..self.tree.bodies.len())
            .filter(|&j| friction && self.tree.bodies[j].variable.is_some())
            .collect();
        for (i, j) in moving.into_iter().enumerate() {
            self.graph.set_link(j);
            let qd = self.qd(i);
            let first = self.inputs.len();
            let [fv, fc] = [first, first + 1].map(|at| Recorded::input(self.graph, at));
            let place = self.width + 2 * i;
            self.inputs
                .extend([Input::Parameter(place), Input::Parameter(place + 1)]);
            tau[i] = tau[i] + fv * qd + fc * qd.sign();
        }
        self.projected(&tau)
    }

    fn gravity(&mut self) -> Vec<Recorded<'g>> {
        let zero = self.zero();
        self.projected(&self.newton_euler(&self.motion(|_| zero, |_| zero)))
    }

    /// Column k: the torques of a unit acceleration of coordinate k, without gravity. The
    /// matrix is symmetric: what is above the diagonal is taken from below.
    fn mass_matrix(&mut self) -> Vec<Recorded<'g>> {
        let (zero, one) = (self.zero(), self.tree.constants.one);
        self.tree.gravity = [zero; 3];
        let m = self.independent;
        let mut matrix = vec![zero; m * m];
        for k in 0..m {
            let unit = |i: usize| self.transmitted(i, |place| if place == k { one } else { zero });
            let column = self.projected(&self.newton_euler(&self.motion(|_| zero, unit)));
            for i in 0..=k {
                matrix[i * m + k] = column[i];
                matrix[k * m + i] = column[i];
            }
        }
        matrix
    }

    fn regressor(&mut self, columns: &[usize]) -> Vec<Recorded<'g>> {
        let motion = self.motion(|i| self.qd(i), |i| self.qdd(i));
        self.rows(columns, self.independent, |tree, sink| {
            let mut sink = Projected {
                transmission: &self.transmission,
                inner: sink,
            };
            dynamics(tree, &motion, &mut DynamicsWorkspace::new(tree), &mut sink);
        })
    }

    fn energy(&mut self, columns: &[usize]) -> Vec<Recorded<'g>> {
        let motion = self.motion(|i| self.qd(i), |_| self.zero());
        self.rows(columns, 1, |tree, sink| {
            energy(tree, &motion, &mut EnergyWorkspace::new(tree), sink);
        })
    }

    fn rows(
        &self,
        columns: &[usize],
        count: usize,
        fill: impl FnOnce(&Tree<Recorded<'g>>, &mut SelectedRows<'_, Recorded<'g>>),
    ) -> Vec<Recorded<'g>> {
        let mut places = vec![None; self.space.len()];
        for (place, &column) in columns.iter().enumerate() {
            places[column] = Some(place as u32);
        }
        let mut rows = vec![self.zero(); count * columns.len()];
        let mut sink = SelectedRows {
            space: &self.space,
            places: &places,
            width: columns.len(),
            rows: &mut rows,
        };
        fill(&self.tree, &mut sink);
        rows
    }
}

/// A row of G: places in qa and what they do.
type Row<'g> = Vec<(usize, Recorded<'g>)>;

/// The law of each joint variable: its row of G, and where it stands when the independent
/// coordinates are 0. Where loops determine a variable, its row is taken as inputs.
fn laws<'g>(
    graph: &'g Graph,
    mechanism: &Mechanism,
    inputs: &mut Vec<Input>,
) -> (Vec<Row<'g>>, Vec<f64>) {
    let number = |x: f64| Recorded::constant(graph, x);
    let Some(closure) = &mechanism.closure else {
        let law = |i: usize| (vec![(i, number(1.0))], 0.0);
        return (0..mechanism.dof()).map(law).unzip();
    };
    let loops = mechanism.assembly.is_some();
    let law = |(i, law): (usize, &VariableLaw)| match law {
        VariableLaw::Independent(place) => (vec![(*place, number(1.0))], 0.0),
        VariableLaw::Affine(law) if !loops => {
            let terms = law.terms.iter().map(|(place, g)| (*place, number(g.value)));
            (terms.collect(), law.offset.value)
        }
        // Expressions are refused before.
        VariableLaw::Affine(_) | VariableLaw::Implicit | VariableLaw::Formula(_) => {
            let row = (0..closure.independent.len()).map(|k| {
                inputs.push(Input::G(i, k));
                (k, Recorded::input(graph, inputs.len() - 1))
            });
            (row.collect(), 0.0)
        }
    };
    closure.laws.iter().enumerate().map(law).unzip()
}
