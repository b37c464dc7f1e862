use roberval_mechanism::{Unphysical, unphysical};
use roberval_scalar::Quantity;

use super::joint::origin;
use super::node::Element;
use super::{Named, inertia::Inertia};
use crate::error::FormatError;

/// A `<link>`: its name and inertia.
pub(crate) struct Link {
    pub name: String,
    pub offset: usize,
    /// About the origin of the link's frame and in that frame.
    pub inertia: Option<Inertia>,
    /// Why no body could have the inertia.
    pub unphysical: Option<Unphysical>,
}

impl Named for Link {
    fn offset(&self) -> usize {
        self.offset
    }
}

impl Link {
    pub fn read(element: &Element, name: &str) -> Result<Self, FormatError> {
        let mut link = Self {
            name: name.to_owned(),
            offset: element.offset(),
            inertia: None,
            unphysical: None,
        };
        let Some(inertial) = element.child("inertial")? else {
            return Ok(link);
        };
        let missing = |tag: &str| {
            inertial.fault(
                crate::error::Code::Missing,
                format!("<inertial> has no <{tag}>"),
            )
        };
        let mass = inertial.child("mass")?.ok_or_else(|| missing("mass"))?;
        let tensor = inertial
            .child("inertia")?
            .ok_or_else(|| missing("inertia"))?;
        let mass = mass.required_number("value")?;
        let mut moments: [f64; 6] = [0.0; 6];
        for (moment, key) in moments
            .iter_mut()
            .zip(["ixx", "ixy", "ixz", "iyy", "iyz", "izz"])
        {
            let value: Quantity = tensor.required_number(key)?;
            *moment = value.value;
        }
        let central = Inertia::central(mass.value, moments);
        link.unphysical = unphysical(central.mass, &central.tensor);
        link.inertia = Some(central.placed(&origin(&inertial, name)?));
        Ok(link)
    }
}
