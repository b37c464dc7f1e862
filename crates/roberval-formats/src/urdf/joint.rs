use roberval_mechanism::{JointKind, Origin};
use roberval_scalar::Quantity;

use super::Named;
use super::node::Element;
use crate::error::{Code, FormatError};
use crate::words::{nearest, quoted};

/// A `<mimic>`: q = multiplier * q(joint) + offset.
pub(crate) struct Mimic {
    /// Name of the joint that is copied.
    pub joint: String,
    /// Factor, default 1.
    pub multiplier: Quantity,
    /// Offset, default 0.
    pub offset: Quantity,
}

/// A `<joint>` with its numbers as written.
pub(crate) struct Joint {
    pub name: String,
    pub offset: usize,
    /// That of the last part of a planar joint.
    pub kind: JointKind,
    /// Whether the child also slides in the plane at right angles to the axis.
    pub planar: bool,
    pub parent: String,
    pub child: String,
    pub origin: Origin,
    pub axis: [Quantity; 3],
    pub limits: Option<(f64, f64)>,
    pub mimic: Option<Mimic>,
}

impl Named for Joint {
    fn offset(&self) -> usize {
        self.offset
    }
}

impl Joint {
    pub fn read(element: &Element, name: &str) -> Result<Self, FormatError> {
        let (kind, limited) = kind(element)?;
        let has_axis = kind.has_axis();
        Ok(Self {
            name: name.to_owned(),
            offset: element.offset(),
            kind,
            planar: element.attribute("type")? == Some("planar"),
            parent: end(element, "parent")?,
            child: end(element, "child")?,
            origin: origin(element, name)?,
            axis: if has_axis { axis(element)? } else { x_axis() },
            limits: if limited { limits(element)? } else { None },
            mimic: if has_axis { mimic(element)? } else { None },
        })
    }
}

impl Joint {
    /// The joint that this one copies, and the multiplier.
    pub fn copies(&self) -> Option<(&str, f64)> {
        let mimic = self.mimic.as_ref()?;
        Some((&mimic.joint, mimic.multiplier.value))
    }
}

const TYPES: [&str; 6] = [
    "revolute",
    "continuous",
    "prismatic",
    "fixed",
    "floating",
    "planar",
];

/// What the joint allows, and whether it has limits.
fn kind(element: &Element) -> Result<(JointKind, bool), FormatError> {
    let name = element.required("type")?;
    let supported = "a joint is revolute, continuous, prismatic, fixed, floating or planar";
    match name {
        "revolute" => Ok((JointKind::Revolute, true)),
        "continuous" => Ok((JointKind::Revolute, false)),
        "prismatic" => Ok((JointKind::Prismatic, true)),
        "fixed" => Ok((JointKind::Fixed, false)),
        "floating" => Ok((JointKind::Floating, false)),
        "planar" => Ok((JointKind::Revolute, false)),
        other => {
            let what = format!("unknown joint type {}", quoted(other));
            let error = element.attribute_fault("type", Code::JointType, what);
            Err(match nearest(other, TYPES) {
                Some(near) => error.hint(format!("did you mean {near}?")),
                None => error.hint(supported),
            })
        }
    }
}

/// The link that `<parent>` or `<child>` names.
fn end(element: &Element, tag: &str) -> Result<String, FormatError> {
    match element.child(tag)? {
        Some(end) => Ok(end.required("link")?.to_owned()),
        None => Err(element
            .fault(Code::Missing, format!("the joint has no <{tag}>"))
            .hint(format!("write <{tag} link=\"...\"/>"))),
    }
}

/// The `<origin>` of a joint or inertial, zero where it is absent.
pub(super) fn origin(element: &Element, joint: &str) -> Result<Origin, FormatError> {
    let zeros = || [(); 3].map(|()| Quantity::zero());
    let (mut xyz, mut rpy) = (None, None);
    if let Some(origin) = element.first_child("origin") {
        if origin.attribute("quat_xyzw")?.is_some() {
            let what = "quaternions are not supported";
            return Err(origin
                .attribute_fault("quat_xyzw", Code::UnknownKey, what)
                .hint("write the orientation as rpy"));
        }
        xyz = origin.numbers("xyz")?;
        rpy = origin.numbers("rpy")?;
    }
    Ok(Origin {
        joint: joint.to_owned(),
        xyz: xyz.unwrap_or_else(zeros),
        rpy: rpy.unwrap_or_else(zeros),
    })
}

fn x_axis() -> [Quantity; 3] {
    let one = Quantity::parse_decimal("1").unwrap_or_else(|_| Quantity::zero());
    [one, Quantity::zero(), Quantity::zero()]
}

fn axis(element: &Element) -> Result<[Quantity; 3], FormatError> {
    let Some(node) = element.child("axis")? else {
        return Ok(x_axis());
    };
    let Some(axis) = node.numbers("xyz")? else {
        return Ok(x_axis());
    };
    if axis.iter().all(|x: &Quantity| x.value == 0.0) {
        return Err(node
            .attribute_fault("xyz", Code::ZeroAxis, "the joint axis is zero")
            .hint("write a direction such as 0 0 1"));
    }
    Ok(axis)
}

/// Lower and upper limit; URDF lets a lone one's partner be 0.
fn limits(element: &Element) -> Result<Option<(f64, f64)>, FormatError> {
    let Some(limit) = element.child("limit")? else {
        return Ok(None);
    };
    let (lower, upper) = (limit.number("lower")?, limit.number("upper")?);
    if lower.is_none() && upper.is_none() {
        return Ok(None);
    }
    let value = |x: Option<Quantity>| x.map_or(0.0, |x| x.value);
    Ok(Some((value(lower), value(upper))))
}

fn mimic(element: &Element) -> Result<Option<Mimic>, FormatError> {
    let Some(mimic) = element.child("mimic")? else {
        return Ok(None);
    };
    let one = || x_axis().into_iter().next().unwrap_or_else(Quantity::zero);
    Ok(Some(Mimic {
        joint: mimic.required("joint")?.to_owned(),
        multiplier: mimic.number("multiplier")?.unwrap_or_else(one),
        offset: mimic.number("offset")?.unwrap_or_else(Quantity::zero),
    }))
}
