//! Joints that follow from others, as a certificate writes them.
//!
//! Each coordinate that joints follow is named by its own joint. A revolute joint that
//! follows coordinates x by multipliers m stands at the product of the powers m root(x) of
//! random circle points, turned by a constant angle.

use num_traits::One;
use roberval_mechanism::{Geometry, JointKind, Link, LinkDescription, Mechanism, VariableLaw};
use roberval_regressor::{AngleUnits, CouplePowers, coupled};
use roberval_scalar::{LinearInPi, Quantity};
use serde_json::{Map, Value, json};

use super::numbers::{exact_text, root_of_fraction};
use super::{CertificateError, angle};

/// The couples of a mechanism.
pub(super) struct Couples<'a> {
    mechanism: &'a Mechanism,
    units: &'a AngleUnits<'a>,
    /// The moving links.
    joints: Vec<&'a Link>,
    coupled: Vec<bool>,
    powers: Option<CouplePowers>,
}

impl<'a> Couples<'a> {
    pub fn of(
        mechanism: &'a Mechanism,
        units: &'a AngleUnits<'a>,
    ) -> Result<Self, CertificateError> {
        let couples = Self {
            mechanism,
            units,
            joints: mechanism.moving().collect(),
            coupled: coupled(mechanism),
            powers: CouplePowers::of(mechanism),
        };
        if couples.powers.as_ref().is_some_and(|p| !p.complete) {
            let first = couples.coupled.iter().position(|c| *c).unwrap_or(0);
            return Err(couples.refused(first));
        }
        Ok(couples)
    }

    fn refused(&self, variable: usize) -> CertificateError {
        CertificateError::Couple {
            joint: self.joints[variable].label().to_owned(),
        }
    }

    /// The root of each coordinate that others follow.
    pub fn roots(&self) -> Value {
        let mut roots = Map::new();
        if let (Some(closure), Some(powers)) = (&self.mechanism.closure, &self.powers) {
            for (&variable, &root) in closure.independent.iter().zip(&powers.roots) {
                if self.coupled[variable] {
                    roots.insert(self.joints[variable].name.clone(), root.into());
                }
            }
        }
        Value::Object(roots)
    }

    /// `[start, [[coordinate, multiplier], ...]]` of a coupled joint, else null; the start is
    /// an angle [s, k, unit] or a length.
    pub fn couple(&self, variable: Option<usize>) -> Result<Value, CertificateError> {
        let Some(variable) = variable.filter(|&v| self.coupled[v]) else {
            return Ok(Value::Null);
        };
        let Some(closure) = &self.mechanism.closure else {
            return Ok(Value::Null);
        };
        let link = self.joints[variable];
        let zero = Quantity::zero();
        let (terms, offset) = match &closure.laws[variable] {
            VariableLaw::Independent(_) => (vec![json!([link.name, "1"])], &zero),
            // These have no exact decision.
            VariableLaw::Implicit | VariableLaw::Formula(_) => return Ok(Value::Null),
            VariableLaw::Affine(law) => {
                let term = |(place, m): &(usize, Quantity)| {
                    let coordinate = &self.joints[closure.independent[*place]].name;
                    Ok(json!([coordinate, self.multiplier(link, m)?]))
                };
                let terms = law.terms.iter().map(term);
                (terms.collect::<Result<_, CertificateError>>()?, &law.offset)
            }
        };
        let constants = &self.mechanism.description.constants;
        let start = match link.joint {
            JointKind::Revolute => json!(angle(offset, constants, self.units)?),
            _ => json!(exact_text(offset, constants)?),
        };
        Ok(json!([start, terms]))
    }

    /// A fraction for a revolute joint, any number for a prismatic one.
    fn multiplier(&self, link: &Link, m: &Quantity) -> Result<String, CertificateError> {
        let constants = &self.mechanism.description.constants;
        let exact = LinearInPi::of(&m.expr, constants);
        match exact.as_ref().and_then(LinearInPi::as_rational) {
            Some(x) if link.joint == JointKind::Revolute => Ok(x.to_string()),
            _ => exact_text(m, constants),
        }
    }

    /// The axis of a joint, of length 1 if it is coupled.
    pub fn axis(
        &self,
        variable: Option<usize>,
        link: &LinkDescription,
        axis: [String; 3],
    ) -> Result<[String; 3], CertificateError> {
        let Some(variable) = variable.filter(|&v| self.coupled[v]) else {
            return Ok(axis);
        };
        let Geometry::Placed { axis: written, .. } = &link.geometry else {
            return Ok(axis);
        };
        let constants = &self.mechanism.description.constants;
        let square = |x: &Quantity| {
            let exact = LinearInPi::of(&x.expr, constants)?;
            exact.as_rational().map(|x| x * x)
        };
        let [Some(x), Some(y), Some(z)] = written.each_ref().map(square) else {
            return Err(self.refused(variable));
        };
        let squared = x + y + z;
        if squared.is_one() {
            return Ok(axis);
        }
        let inverse = root_of_fraction(&squared.recip());
        Ok(axis.map(|x| {
            if x == "0" {
                x
            } else {
                format!("{x}*{inverse}")
            }
        }))
    }
}
