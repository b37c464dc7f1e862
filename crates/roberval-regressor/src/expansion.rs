use std::convert::Infallible;

use roberval_mechanism::{Closure, Mechanism, NotClosed, VariableLaw};
use roberval_scalar::{Quantity, Real};

use crate::Transmission;
use crate::formulas::Formulas;
use crate::loops::LoopExpansion;

/// The state of all n joints, and G.
#[derive(Debug, Clone)]
pub struct JointStates<T> {
    /// Positions q = F(qa).
    pub q: Vec<T>,
    /// Velocities qd = G qad.
    pub qd: Vec<T>,
    /// Accelerations qdd = G qadd + Gdot qad.
    pub qdd: Vec<T>,
    /// G.
    pub transmission: Transmission<T>,
}

/// From the state of the m independent coordinates to that of all n joints.
#[derive(Debug, Clone)]
pub struct Expansion<T>(Kind<T>);

#[derive(Debug, Clone)]
enum Kind<T> {
    /// Sums of multiples; where joints follow by expressions, these complete them.
    Couples(Affine<T>, Formulas<T>),
    Loops(LoopExpansion<T>),
}

/// q = G qa + q0.
#[derive(Debug, Clone)]
struct Affine<T> {
    independent: usize,
    /// G, of affine laws.
    transmission: Transmission<T>,
    /// q where qa = 0.
    offsets: Vec<T>,
}

/// The constraints have no value at a state.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NoValue {
    /// A number cannot be computed (a division by zero, a root of a negative number).
    #[error("{what} has no finite value")]
    Number {
        /// What has no value.
        what: String,
    },
    /// The mechanism cannot stand so.
    #[error(transparent)]
    NotClosed(#[from] NotClosed),
}

impl Expansion<f64> {
    /// The expansion of a mechanism in floats; `None` where all joints are independent.
    #[must_use]
    pub fn in_floats(mechanism: &Mechanism) -> Option<Self> {
        if let Some(assembly) = &mechanism.assembly {
            let linkage = assembly.linkage.clone();
            let loops = LoopExpansion::new(assembly.clone(), linkage, mechanism.base_variables());
            return Some(Self(Kind::Loops(loops)));
        }
        let closure = mechanism.closure.as_ref()?;
        let value = |quantity: &Quantity| Ok::<_, Infallible>(quantity.value);
        let Ok(affine) = Affine::of_closure(closure, value);
        let Ok(formulas) = Formulas::of(mechanism, closure, value);
        Some(Self(Kind::Couples(affine, formulas)))
    }
}

impl<T: Real> Expansion<T> {
    /// The expansion of a mechanism; `None` where all joints are independent.
    ///
    /// # Errors
    /// [`NoValue`] if a multiplier or an offset has no value in these numbers.
    pub fn of(mechanism: &Mechanism) -> Result<Option<Self>, NoValue> {
        let closure = mechanism.closure.as_ref();
        let value = |quantity: &Quantity| {
            let none = || NoValue::Number {
                what: format!("the number {:?} of a couple", quantity.text),
            };
            T::of_quantity(quantity, &mechanism.description.constants).ok_or_else(none)
        };
        let Some(closure) = closure else {
            return Ok(None);
        };
        let affine = Affine::of_closure(closure, value)?;
        let formulas = Formulas::of(mechanism, closure, value)?;
        Ok(Some(Self(Kind::Couples(affine, formulas))))
    }

    pub(crate) fn of_loops(loops: LoopExpansion<T>) -> Self {
        Self(Kind::Loops(loops))
    }

    /// All that it depends on, to tell robots apart.
    #[must_use]
    pub fn description(&self) -> String
    where
        T: std::fmt::Debug,
    {
        match &self.0 {
            Kind::Couples(affine, formulas) => format!("{affine:?} {formulas:?}"),
            Kind::Loops(loops) => loops.description(),
        }
    }

    /// m
    #[must_use]
    pub fn independent(&self) -> usize {
        match &self.0 {
            Kind::Couples(affine, _) => affine.independent,
            Kind::Loops(loops) => loops.independent(),
        }
    }

    /// Working memory for [`Expansion::expand`]. Loops are closed from the configuration
    /// there, at first the one that names the branch.
    #[must_use]
    pub fn states(&self) -> JointStates<T> {
        match &self.0 {
            Kind::Couples(affine, _) => affine.states(),
            Kind::Loops(loops) => loops.states(),
        }
    }

    /// The state of all joints at qa, qad, qadd (m numbers each).
    ///
    /// # Errors
    /// [`NoValue`] if the joints cannot stand there.
    ///
    /// # Panics
    /// If a slice is shorter than m.
    pub fn expand(&self, state: [&[T]; 3], states: &mut JointStates<T>) -> Result<(), NoValue> {
        match &self.0 {
            Kind::Couples(affine, formulas) => {
                affine.expand(state, states);
                formulas.expand(states)?;
            }
            Kind::Loops(loops) => loops.expand(state, states)?,
        }
        Ok(())
    }
}

/// A row of zeros with all places.
fn dense<T: Real>(closure: &Closure) -> Vec<(usize, T)> {
    let places = 0..closure.independent.len();
    places.map(|place| (place, T::from(0.0))).collect()
}

impl<T: Real> Affine<T> {
    fn of_closure<E>(
        closure: &Closure,
        value: impl Fn(&Quantity) -> Result<T, E>,
    ) -> Result<Self, E> {
        let mut rows = Vec::with_capacity(closure.laws.len());
        let mut offsets = Vec::with_capacity(closure.laws.len());
        for law in &closure.laws {
            let (row, offset) = match law {
                VariableLaw::Independent(place) => (vec![(*place, T::from(1.0))], T::from(0.0)),
                // To be filled at each state.
                VariableLaw::Formula(_) => (dense(closure), T::from(0.0)),
                // Mechanisms with loops have no affine expansion.
                VariableLaw::Implicit => (Vec::new(), T::from(0.0)),
                VariableLaw::Affine(law) => {
                    let term = |(place, m): &(usize, Quantity)| Ok((*place, value(m)?));
                    let row = law.terms.iter().map(term).collect::<Result<_, E>>()?;
                    (row, value(&law.offset)?)
                }
            };
            rows.push(row);
            offsets.push(offset);
        }
        Ok(Self {
            independent: closure.independent.len(),
            transmission: Transmission::from_rows(rows),
            offsets,
        })
    }

    fn states(&self) -> JointStates<T> {
        let zeros = vec![T::from(0.0); self.offsets.len()];
        JointStates {
            q: zeros.clone(),
            qd: zeros.clone(),
            qdd: zeros,
            transmission: self.transmission.clone(),
        }
    }

    fn expand(&self, [qa, qad, qadd]: [&[T]; 3], states: &mut JointStates<T>) {
        let zero = T::from(0.0);
        for (i, &offset) in self.offsets.iter().enumerate() {
            let [mut q, mut qd, mut qdd] = [offset, zero, zero];
            for (place, g) in self.transmission.row(i) {
                q = g.mul_add(qa[place], q);
                qd = g.mul_add(qad[place], qd);
                qdd = g.mul_add(qadd[place], qdd);
            }
            (states.q[i], states.qd[i], states.qdd[i]) = (q, qd, qdd);
        }
    }
}
