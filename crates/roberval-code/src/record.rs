//! The models run through the recorder.

use roberval_mechanism::{JointKind, Mechanism, ParameterSpace};
use roberval_regressor::{
    BaseState, Body, DynamicsWorkspace, EnergyWorkspace, JointMotion, Moments, Projected,
    SelectedRows, Shape, Transmission, Tree, dynamics, energy, newton_euler,
};
use roberval_scalar::Jet;
use roberval_scalar::vector::{Mat3, apply};

use crate::code::Request;
use crate::composite::{Composite, Meeting};
use crate::coordinates::Coordinates;
use crate::frames::Frames;
use crate::graph::Graph;
use crate::program::{Input, Program};
use crate::recorded::Recorded;
use crate::turns::congruent;
use crate::way::{Mass, Way};
use crate::what::What;

/// Records one model of a mechanism: of all ways the cheapest, as counting says.
#[must_use]
pub(crate) fn record(mechanism: &Mechanism, request: &Request<'_>) -> Program {
    let ways = Way::all(mechanism, request.what, request.columns.len()).into_iter();
    let programs = ways.map(|way| record_one(mechanism, request, way));
    let cheapest = programs.min_by_key(Program::cost);
    cheapest.expect("there is one way at least")
}

fn record_one(mechanism: &Mechanism, request: &Request<'_>, way: Way) -> Program {
    let graph = Graph::default();
    let mut recorder = Recorder::new(&graph, mechanism, request, way);
    let outputs = match request.what {
        What::Tau => recorder.tau(request.friction),
        What::Gravity => recorder.gravity(),
        What::MassMatrix => recorder.mass_matrix(way.mass),
        What::Regressor => recorder.regressor(request.columns),
        What::Energy => recorder.energy(request.columns),
    };
    let outputs = outputs.iter().map(|x| x.at).collect();
    let inputs = recorder.inputs;
    Program::new(graph, inputs, outputs).factored()
}

/// How base and bodies move.
struct Motion<'g> {
    base: Option<BaseState<Recorded<'g>>>,
    /// One entry a body.
    joints: Vec<JointMotion<Recorded<'g>>>,
}

struct Recorder<'g> {
    graph: &'g Graph,
    tree: Tree<Recorded<'g>>,
    shapes: Vec<Shape>,
    /// G: the joint variables that each independent coordinate moves.
    transmission: Transmission<Recorded<'g>>,
    /// How each joint variable moves: by the independent coordinates; if loops determine
    /// them, the code takes them all, and G.
    joints: Vec<Jet<Recorded<'g>>>,
    /// Where a base that floats is and how it moves.
    base: Option<BaseState<Recorded<'g>>>,
    /// What is added to the angle of each body's joint.
    offsets: Vec<Recorded<'g>>,
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

/// XX, XY, XZ, YY, YZ, ZZ, MX, MY, MZ, M in a new frame, given the rotation to the old one.
fn reframe<'g>(x: &mut [Recorded<'g>], rotation: &Mat3<Recorded<'g>>) {
    let &mut [xx, xy, xz, yy, yz, zz, mx, my, mz, mass] = x else {
        unreachable!("ten parameters");
    };
    let back = [0, 1, 2].map(|i| [0, 1, 2].map(|k| rotation[k][i]));
    let inertia = congruent(&back, &[[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]);
    let [[xx, xy, xz], [_, yy, yz], [_, _, zz]] = inertia;
    let [mx, my, mz] = apply(&back, [mx, my, mz]);
    x.copy_from_slice(&[xx, xy, xz, yy, yz, zz, mx, my, mz, mass]);
}

impl<'g> Recorder<'g> {
    fn new(graph: &'g Graph, mechanism: &Mechanism, request: &Request<'_>, way: Way) -> Self {
        let space = mechanism.parameters();
        let mut tree = Tree::of(mechanism);
        let frames = way.reframe.then(|| Frames::of(&tree));
        if let Some(frames) = &frames {
            tree = frames.tree.clone();
        }
        let shapes = Shape::of(&tree);
        let tree = tree.map(|x| Recorded::constant(graph, x));
        let Coordinates {
            joints,
            base,
            mut inputs,
        } = Coordinates::of(graph, mechanism, tree.constants);
        let rows = joints.iter().map(|joint| {
            let row = joint.gradient.iter().copied().enumerate();
            let acts = row.filter(|(_, g)| g.value() != Some(0.0));
            acts.collect()
        });
        let transmission = Transmission::from_rows(rows);
        let mut x = vec![tree.constants.zero; space.len()];
        let columns = request.columns.iter().enumerate();
        for (place, &column) in columns.filter(|(_, c)| !request.no_effect.contains(c)) {
            x[column] = Recorded::parameter(graph, inputs.len());
            inputs.push(Input::Parameter(place));
        }
        let mut offsets = vec![tree.constants.zero; tree.bodies.len()];
        if let Some(frames) = frames {
            offsets = frames
                .offsets
                .iter()
                .map(|x| Recorded::constant(graph, *x))
                .collect();
            for (j, rotation) in frames.rotations.iter().enumerate() {
                let rotation = rotation.map(|row| row.map(|x| Recorded::constant(graph, x)));
                if !tree.bodies[j].massless {
                    reframe(&mut x[space.first_column(j)..][..10], &rotation);
                }
            }
        }
        Self {
            graph,
            tree,
            shapes,
            transmission,
            joints,
            base,
            offsets,
            independent: mechanism.independent(),
            regroup: way.regroup,
            space,
            width: request.columns.len(),
            x,
            inputs,
        }
    }

    /// The joint variables' rates of those of the independent coordinates: G.
    fn transmitted(&self, i: usize, rate: impl Fn(usize) -> Recorded<'g>) -> Recorded<'g> {
        let terms = self.transmission.row(i).map(|(place, g)| g * rate(place));
        terms.fold(self.zero(), |sum, term| sum + term)
    }

    /// How base and bodies move; velocities and accelerations of the joint variables as given.
    fn motion(
        &self,
        qd: impl Fn(usize) -> Recorded<'g>,
        qdd: impl Fn(usize) -> Recorded<'g>,
    ) -> Motion<'g> {
        let (zero, one) = (self.zero(), self.tree.constants.one);
        let still = JointMotion::still(zero, one);
        let of_body = |(j, body): (usize, &Body<Recorded<'g>>)| {
            self.graph.set_link(j);
            let Some(i) = body.variable.filter(|_| body.joint.has_axis()) else {
                return still;
            };
            let q = self.joints[i].value + self.offsets[j];
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
        Motion {
            joints: bodies.map(of_body).collect(),
            base: self.base.map(|base| BaseState {
                v: [0, 1, 2].map(&qd),
                w: [3, 4, 5].map(&qd),
                dv: [0, 1, 2].map(&qdd),
                dw: [3, 4, 5].map(&qdd),
                ..base
            }),
        }
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

    fn newton_euler(&self, motion: &Motion<'g>) -> Vec<Recorded<'g>> {
        let parameters = (&self.space, &self.x[..]);
        newton_euler(
            &self.tree,
            &self.shapes,
            (motion.base.as_ref(), &motion.joints),
            parameters,
            self.regroup,
            |link| {
                self.graph.set_link(link);
            },
        )
    }

    fn tau(&mut self, friction: bool) -> Vec<Recorded<'g>> {
        let mut tau =
            self.newton_euler(&self.motion(|i| self.joints[i].rate, |i| self.joints[i].second));
        let joints = self.tree.bodies.iter().enumerate();
        let joints = joints.filter(|(_, body)| friction && body.joint.has_axis());
        for (count, (j, body)) in joints.enumerate() {
            let Some(i) = body.variable else { continue };
            self.graph.set_link(j);
            let qd = self.joints[i].rate;
            let first = self.inputs.len();
            let [fv, fc] = [first, first + 1].map(|at| Recorded::parameter(self.graph, at));
            let place = self.width + 2 * count;
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

    /// G' M G, without gravity.
    fn mass_matrix(&mut self, mass: Mass) -> Vec<Recorded<'g>> {
        self.tree.gravity = [self.zero(); 3];
        match mass {
            Mass::Columns => self.mass_matrix_by_columns(),
            Mass::Composite(meeting) => self.mass_matrix_of_composites(meeting),
        }
    }

    /// Column k: the torques of a unit acceleration of coordinate k. The matrix is symmetric:
    /// what is above the diagonal is taken from below.
    fn mass_matrix_by_columns(&self) -> Vec<Recorded<'g>> {
        let (zero, one) = (self.zero(), self.tree.constants.one);
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

    fn mass_matrix_of_composites(&self, meeting: Meeting) -> Vec<Recorded<'g>> {
        let zero = self.zero();
        let parameters = (&self.space, &self.x[..]);
        let own = Moments::of(&self.tree, &self.shapes, parameters, self.regroup);
        let composite = Composite {
            graph: self.graph,
            tree: &self.tree,
            shapes: &self.shapes,
            motion: &self.motion(|_| zero, |_| zero).joints,
        };
        let mut joints = composite.mass_matrix(&own, meeting);
        for (j, body) in self.tree.bodies.iter().enumerate() {
            if let Some(i) = body.variable.filter(|_| body.rotor) {
                self.graph.set_link(j);
                joints[i][i] = joints[i][i] + self.x[self.space.first_column(j) + 10];
            }
        }
        // M G, then G' M G above the diagonal.
        let half: Vec<_> = joints.iter().map(|row| self.projected(row)).collect();
        let m = self.independent;
        let mut matrix = vec![zero; m * m];
        for k in 0..m {
            let column: Vec<_> = half.iter().map(|row| row[k]).collect();
            let column = self.projected(&column);
            for i in 0..=k {
                matrix[i * m + k] = column[i];
                matrix[k * m + i] = column[i];
            }
        }
        matrix
    }

    fn regressor(&mut self, columns: &[usize]) -> Vec<Recorded<'g>> {
        let motion = self.motion(|i| self.joints[i].rate, |i| self.joints[i].second);
        self.rows(columns, self.independent, |tree, sink| {
            let mut sink = Projected {
                transmission: &self.transmission,
                inner: sink,
            };
            let mut workspace = DynamicsWorkspace::new(tree);
            if let Some(base) = &motion.base {
                workspace.move_base(tree, base);
            }
            dynamics(tree, &motion.joints, &mut workspace, &mut sink);
        })
    }

    fn energy(&mut self, columns: &[usize]) -> Vec<Recorded<'g>> {
        let motion = self.motion(|i| self.joints[i].rate, |_| self.zero());
        self.rows(columns, 1, |tree, sink| {
            let mut workspace = EnergyWorkspace::new(tree);
            if let Some(base) = &motion.base {
                workspace.move_base(tree, base);
            }
            energy(tree, &motion.joints, &mut workspace, sink);
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
