use std::collections::HashMap;

use roberval_mechanism::{Closure, Mechanism, VariableLaw};
use roberval_scalar::{Formula, Jet, Quantity, Real};

use crate::{JointStates, NoValue};

/// Joints that follow others by expressions: F, G and Gdot qad by differentiating these.
#[derive(Debug, Clone)]
pub(crate) struct Formulas<T> {
    /// Variables with their expressions, each after those that it follows.
    formulas: Vec<(usize, Formula<usize>)>,
    /// Values of the numbers in them, by their texts.
    numbers: HashMap<String, T>,
    /// What messages call the joints.
    labels: Vec<String>,
    independent: usize,
}

impl<T: Real> Formulas<T> {
    /// The expressions of a mechanism; `value` gives the value of a number.
    pub fn of<E>(
        mechanism: &Mechanism,
        closure: &Closure,
        value: impl Fn(&Quantity) -> Result<T, E>,
    ) -> Result<Self, E> {
        let mut numbers = HashMap::new();
        let mut formulas = Vec::new();
        for &variable in &closure.formulas {
            if let VariableLaw::Formula(formula) = &closure.laws[variable] {
                for number in formula.constants() {
                    numbers.insert(number.text.clone(), value(number)?);
                }
                formulas.push((variable, formula.clone()));
            }
        }
        Ok(Self {
            formulas,
            numbers,
            labels: mechanism.moving().map(|l| l.label().to_owned()).collect(),
            independent: closure.independent.len(),
        })
    }

    /// Completes states in which all other joints have their places.
    pub fn expand(&self, states: &mut JointStates<T>) -> Result<(), NoValue> {
        let jet = |i: usize, states: &JointStates<T>| {
            let mut gradient = vec![T::from(0.0); self.independent];
            let row = states.transmission.row(i);
            row.for_each(|(place, g)| gradient[place] = g);
            Jet {
                value: states.q[i],
                rate: states.qd[i],
                second: states.qdd[i],
                gradient,
            }
        };
        let mut jets: Vec<Jet<T>> = (0..states.q.len()).map(|i| jet(i, states)).collect();
        let value = |x: &Quantity| self.numbers.get(&x.text).copied();
        for (variable, formula) in &self.formulas {
            let jet = formula.jet(&jets, &value, self.independent);
            let numbers = [jet.value, jet.rate, jet.second];
            let mut numbers = numbers.iter().chain(&jet.gradient);
            if !numbers.all(|x| x.to_f64().is_finite()) {
                return Err(NoValue::Number {
                    what: format!("the expression of the joint {:?}", self.labels[*variable]),
                });
            }
            states.q[*variable] = jet.value;
            states.qd[*variable] = jet.rate;
            states.qdd[*variable] = jet.second;
            let row = states.transmission.row_mut(*variable);
            row.copy_from_slice(&jet.gradient);
            jets[*variable] = jet;
        }
        Ok(())
    }
}
