//! Couples as equations beside those of loops.

use roberval_scalar::{Quantity, Real};

use crate::{Closure, VariableLaw};

/// The equation `q = sum of multiplier * q(other) + offset` of one joint variable.
#[derive(Debug, Clone, PartialEq)]
pub struct CoupleLaw<T> {
    variable: usize,
    /// Variables and multipliers.
    terms: Vec<(usize, T)>,
    offset: T,
}

/// The couples of a closure as equations (rad and m); `None` where a number has no value.
pub fn couple_laws<T: Real>(
    closure: Option<&Closure>,
    constants: &[(String, Quantity)],
) -> Option<Vec<CoupleLaw<T>>> {
    let Some(closure) = closure else {
        return Some(Vec::new());
    };
    let laws = closure.laws.iter().enumerate();
    laws.filter_map(|(variable, law)| match law {
        VariableLaw::Affine(law) => Some((variable, law)),
        // Robots with loops have no formulas.
        VariableLaw::Independent(_) | VariableLaw::Implicit | VariableLaw::Formula(_) => None,
    })
    .map(|(variable, law)| {
        let value = |x: &Quantity| T::of_quantity(x, constants);
        let term = |(place, x): &(usize, Quantity)| Some((closure.independent[*place], value(x)?));
        Some(CoupleLaw {
            variable,
            terms: law.terms.iter().map(term).collect::<Option<_>>()?,
            offset: value(&law.offset)?,
        })
    })
    .collect()
}

impl<T: Real> CoupleLaw<T> {
    /// The same with each variable measured in `unit`.
    pub(super) fn in_units(self, unit: impl Fn(usize) -> T) -> Self {
        let own = unit(self.variable);
        let term = |(k, multiplier): (usize, T)| (k, multiplier * unit(k) / own);
        Self {
            variable: self.variable,
            terms: self.terms.into_iter().map(term).collect(),
            offset: self.offset / own,
        }
    }

    pub(super) fn has(&self, variable: usize) -> bool {
        self.variable == variable || self.terms.iter().any(|(k, _)| *k == variable)
    }

    pub(super) fn residual(&self, q: &[T]) -> T {
        let sum = self
            .terms
            .iter()
            .fold(self.offset, |sum, &(k, m)| m.mul_add(q[k], sum));
        q[self.variable] - sum
    }

    pub(super) fn derivative(&self, dof: usize) -> Vec<T> {
        let mut row = vec![T::from(0.0); dof];
        row[self.variable] = T::from(1.0);
        self.terms.iter().for_each(|&(k, m)| row[k] = row[k] - m);
        row
    }
}
