//! The variables that the code takes, and how they move base and joints.

use roberval_mechanism::{AffineLaw, Mechanism, VariableLaw};
use roberval_regressor::{BaseState, Constants, squared_length};
use roberval_scalar::Jet;

use crate::graph::Graph;
use crate::program::Input;
use crate::recorded::Recorded;

/// How many coordinates a position of the code has more than a velocity: a quaternion has
/// four numbers for three.
pub(crate) fn more_positions(mechanism: &Mechanism) -> usize {
    usize::from(mechanism.is_floating())
}

/// What the code is told of a state, and what follows from it.
pub(crate) struct Coordinates<'g> {
    /// How each joint variable moves: by the independent coordinates; if loops determine
    /// them, the code takes them all, and G. Of a base's six only the rates mean anything.
    pub joints: Vec<Jet<Recorded<'g>>>,
    /// Where a base that floats is and how it moves.
    pub base: Option<BaseState<Recorded<'g>>>,
    /// The inputs of a state.
    pub inputs: Vec<Input>,
}

impl<'g> Coordinates<'g> {
    /// Those of a mechanism.
    pub fn of(graph: &'g Graph, mechanism: &Mechanism, constants: Constants<Recorded<'g>>) -> Self {
        let loops = mechanism.assembly.is_some();
        let (n, m) = (mechanism.dof(), mechanism.independent());
        let velocities = if loops { n } else { m };
        let positions = velocities + more_positions(mechanism);
        let mut inputs: Vec<Input> = (0..positions).map(Input::Q).collect();
        inputs.extend((0..velocities).map(Input::Qd));
        inputs.extend((0..velocities).map(Input::Qdd));
        let input = |at: usize| Recorded::input(graph, at);
        let variable = |k: usize, gradient| Jet {
            value: input(k + more_positions(mechanism)),
            rate: input(positions + k),
            second: input(positions + velocities + k),
            gradient,
        };
        let base = mechanism.is_floating().then(|| {
            let q = [0, 1, 2, 3, 4, 5, 6].map(input);
            let six = |first: usize| [0, 1, 2, 3, 4, 5].map(|k| input(first + k));
            let (qd, qdd) = (six(positions), six(positions + velocities));
            let square = squared_length([q[3], q[4], q[5], q[6]]);
            BaseState::of([&q, &qd, &qdd], constants, constants.one / square)
        });
        let mut coordinates = Self {
            joints: Vec::with_capacity(n),
            base,
            inputs,
        };
        coordinates.move_joints(graph, mechanism, &variable);
        coordinates
    }

    /// The joint variables from those that the code takes; G is taken where loops give it.
    fn move_joints(
        &mut self,
        graph: &'g Graph,
        mechanism: &Mechanism,
        variable: &impl Fn(usize, Vec<Recorded<'g>>) -> Jet<Recorded<'g>>,
    ) {
        let (loops, m) = (mechanism.assembly.is_some(), mechanism.independent());
        let number = |x: f64| Recorded::constant(graph, x);
        let unit = |k: usize| -> Vec<_> {
            let entry = |i: usize| number(if i == k { 1.0 } else { 0.0 });
            (0..m).map(entry).collect()
        };
        let independent: Vec<_> = match loops {
            true => Vec::new(),
            false => (0..m).map(|k| variable(k, unit(k))).collect(),
        };
        let Some(closure) = &mechanism.closure else {
            self.joints = independent;
            return;
        };
        for (i, law) in closure.laws.iter().enumerate() {
            let joint = match law {
                VariableLaw::Independent(place) if loops => variable(i, unit(*place)),
                VariableLaw::Independent(place) => independent[*place].clone(),
                VariableLaw::Affine(law) if !loops => sum(&independent, law, &number),
                // Joints that follow by expressions come below.
                VariableLaw::Formula(_) => Jet::constant(number(0.0), m),
                VariableLaw::Affine(_) | VariableLaw::Implicit => {
                    let first = self.inputs.len();
                    self.inputs.extend((0..m).map(|k| Input::G(i, k)));
                    let row = (first..self.inputs.len()).map(|at| Recorded::input(graph, at));
                    variable(i, row.collect())
                }
            };
            self.joints.push(joint);
        }
        for &i in &closure.formulas {
            if let VariableLaw::Formula(formula) = &closure.laws[i] {
                self.joints[i] = formula.jet(&self.joints, &|x| number(x.value), m);
            }
        }
    }
}

/// The sum of multiples that a law says.
fn sum<'g>(
    coordinates: &[Jet<Recorded<'g>>],
    law: &AffineLaw,
    number: &impl Fn(f64) -> Recorded<'g>,
) -> Jet<Recorded<'g>> {
    let offset = Jet::constant(number(law.offset.value), coordinates.len());
    let terms = law.terms.iter();
    terms.fold(offset, |sum, (place, factor)| {
        sum.combined(number(1.0), &coordinates[*place], number(factor.value))
    })
}
