use std::convert::Infallible;

use roberval_mechanism::{Closure, Mechanism, VariableLaw};
use roberval_scalar::{Quantity, Real};

use crate::Transmission;

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
pub struct Expansion<T> {
    independent: usize,
    /// G, of affine laws.
    transmission: Transmission<T>,
    /// q where qa = 0.
    offsets: Vec<T>,
}

/// The constraints have no value: a number cannot be computed (a division by zero, a root
/// of a negative number), or the mechanism cannot stand so.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{what} has no finite value")]
pub struct NoValue {
    /// What has no value.
    pub what: String,
}

impl Expansion<f64> {
    /// The expansion of a mechanism in floats; `None` where all joints are independent.
    #[must_use]
    pub fn in_floats(mechanism: &Mechanism) -> Option<Self> {
        let closure = mechanism.closure.as_ref()?;
        let value = |quantity: &Quantity| Ok::<_, Infallible>(quantity.value);
        let Ok(expansion) = Self::of_closure(closure, value);
        Some(expansion)
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
            let none = || NoValue {
                what: format!("the number {:?} of a couple", quantity.text),
            };
            T::of_quantity(quantity, &mechanism.description.constants).ok_or_else(none)
        };
        closure.map(|c| Self::of_closure(c, value)).transpose()
    }

    fn of_closure<E>(
        closure: &Closure,
        value: impl Fn(&Quantity) -> Result<T, E>,
    ) -> Result<Self, E> {
        let mut rows = Vec::with_capacity(closure.laws.len());
        let mut offsets = Vec::with_capacity(closure.laws.len());
        for law in &closure.laws {
            let (row, offset) = match law {
                VariableLaw::Independent(place) => (vec![(*place, T::from(1.0))], T::from(0.0)),
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

    /// m
    #[must_use]
    pub fn independent(&self) -> usize {
        self.independent
    }

    /// Working memory for [`Expansion::expand`].
    #[must_use]
    pub fn states(&self) -> JointStates<T> {
        let zeros = vec![T::from(0.0); self.offsets.len()];
        JointStates {
            q: zeros.clone(),
            qd: zeros.clone(),
            qdd: zeros,
            transmission: self.transmission.clone(),
        }
    }

    /// The state of all joints at qa, qad, qadd (m numbers each).
    ///
    /// # Errors
    /// [`NoValue`] if the joints cannot stand there.
    ///
    /// # Panics
    /// If a slice is shorter than m.
    pub fn expand(
        &self,
        [qa, qad, qadd]: [&[T]; 3],
        states: &mut JointStates<T>,
    ) -> Result<(), NoValue> {
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
        Ok(())
    }
}
