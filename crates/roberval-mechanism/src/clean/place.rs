//! The numbers of a description that decide its structure, one by one.

use std::fmt;

use roberval_scalar::Quantity;

use crate::{Geometry, Origin, RobotDescription};

/// Which number of a link (or of the robot, for gravity) it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Field {
    /// A component of gravity in the base frame.
    Gravity(usize),
    /// gamma of a modified Denavit-Hartenberg frame.
    Gamma,
    /// b of a modified Denavit-Hartenberg frame.
    B,
    /// alpha of a modified Denavit-Hartenberg frame.
    Alpha,
    /// d of a modified Denavit-Hartenberg frame.
    D,
    /// theta of a modified Denavit-Hartenberg frame.
    Theta,
    /// r of a modified Denavit-Hartenberg frame.
    R,
    /// A component of a URDF origin's position.
    Xyz(usize),
    /// Roll, pitch or yaw of a URDF origin.
    Rpy(usize),
    /// A component of a URDF joint's axis.
    Axis(usize),
}

/// What a size is measured in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Unit {
    /// rad: an angle's distance from the multiple of pi/12.
    Angle,
    /// m: a length's distance from zero.
    Length,
    /// A component of a direction, relative to the direction's length.
    Direction,
}

impl Field {
    /// What the size of a change of this number is measured in.
    #[must_use]
    pub fn unit(self) -> Unit {
        match self {
            Self::Gamma | Self::Alpha | Self::Theta | Self::Rpy(_) => Unit::Angle,
            Self::B | Self::D | Self::R | Self::Xyz(_) => Unit::Length,
            Self::Gravity(_) | Self::Axis(_) => Unit::Direction,
        }
    }
}

impl fmt::Display for Field {
    /// As in the files: `alpha`, `rpy[0]`, `axis[2]`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Gamma => f.write_str("gamma"),
            Self::B => f.write_str("b"),
            Self::Alpha => f.write_str("alpha"),
            Self::D => f.write_str("d"),
            Self::Theta => f.write_str("theta"),
            Self::R => f.write_str("r"),
            Self::Gravity(k) => write!(f, "gravity[{k}]"),
            Self::Xyz(k) => write!(f, "xyz[{k}]"),
            Self::Rpy(k) => write!(f, "rpy[{k}]"),
            Self::Axis(k) => write!(f, "axis[{k}]"),
        }
    }
}

/// Where a number stands: the link's index (0 for gravity), the origin's index in the
/// link's chain (0 where there is none), the field; or the loop's index and which of its
/// two frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Place {
    pub link: usize,
    pub origin: usize,
    pub field: Field,
    pub in_loop: bool,
}

/// A number of the description with the length of the direction that it belongs to.
pub(super) struct Literal<'d> {
    pub place: Place,
    pub quantity: &'d Quantity,
    /// Length of the axis or of gravity; 1 for angles and lengths.
    pub norm: f64,
    /// The origin the number belongs to.
    pub origin: Option<&'d Origin>,
}

/// The angles, lengths and directions of a description: everything that decides its
/// structure. The axis of a joint that needs none has no meaning and is left out.
pub(super) fn literals(description: &RobotDescription) -> Vec<Literal<'_>> {
    let mut all = Vec::new();
    vector(&mut all, &description.gravity, 0, Field::Gravity);
    for (link, written) in description.links.iter().enumerate() {
        match &written.geometry {
            Geometry::Mdh(g) => {
                let numbers = [
                    (Field::Gamma, &g.gamma),
                    (Field::B, &g.b),
                    (Field::Alpha, &g.alpha),
                    (Field::D, &g.d),
                    (Field::Theta, &g.theta),
                    (Field::R, &g.r),
                ];
                all.extend(numbers.map(|(field, quantity)| Literal {
                    place: Place {
                        link,
                        origin: 0,
                        field,
                        in_loop: false,
                    },
                    quantity,
                    norm: 1.0,
                    origin: None,
                }));
            }
            Geometry::Placed { origins, axis } => {
                for (index, origin) in origins.iter().enumerate() {
                    let place = Place {
                        link,
                        origin: index,
                        field: Field::Xyz(0),
                        in_loop: false,
                    };
                    placement(&mut all, place, origin);
                }
                if written.joint.has_axis() {
                    vector(&mut all, axis, link, Field::Axis);
                }
            }
        }
    }
    for (number, closure) in description.loops.iter().enumerate() {
        for (side, frame) in closure.frames.iter().enumerate() {
            let place = Place {
                link: number,
                origin: side,
                field: Field::Xyz(0),
                in_loop: true,
            };
            placement(&mut all, place, frame);
        }
    }
    all
}

fn placement<'d>(all: &mut Vec<Literal<'d>>, place: Place, origin: &'d Origin) {
    let mut three = |numbers: &'d [Quantity; 3], field: fn(usize) -> Field| {
        for (k, quantity) in numbers.iter().enumerate() {
            all.push(Literal {
                place: Place {
                    field: field(k),
                    ..place
                },
                quantity,
                norm: 1.0,
                origin: Some(origin),
            });
        }
    };
    three(&origin.xyz, Field::Xyz);
    three(&origin.rpy, Field::Rpy);
}

fn vector<'d>(
    all: &mut Vec<Literal<'d>>,
    numbers: &'d [Quantity; 3],
    link: usize,
    field: fn(usize) -> Field,
) {
    let norm = length(numbers);
    all.extend(numbers.iter().enumerate().map(|(k, quantity)| Literal {
        place: Place {
            link,
            origin: 0,
            field: field(k),
            in_loop: false,
        },
        quantity,
        norm,
        origin: None,
    }));
}

/// The Euclidean norm, without overflow.
fn length(numbers: &[Quantity; 3]) -> f64 {
    let [x, y, z] = numbers.each_ref().map(|q| q.value);
    x.hypot(y).hypot(z).min(f64::MAX)
}

/// The number at a place, to be changed; `None` where the description has none.
pub(super) fn at(description: &mut RobotDescription, place: Place) -> Option<&mut Quantity> {
    if let Field::Gravity(k) = place.field {
        return description.gravity.get_mut(k);
    }
    if place.in_loop {
        let closure = description.loops.get_mut(place.link)?;
        let frame = closure.frames.get_mut(place.origin)?;
        return match place.field {
            Field::Xyz(k) => frame.xyz.get_mut(k),
            Field::Rpy(k) => frame.rpy.get_mut(k),
            _ => None,
        };
    }
    match &mut description.links.get_mut(place.link)?.geometry {
        Geometry::Mdh(g) => match place.field {
            Field::Gamma => Some(&mut g.gamma),
            Field::B => Some(&mut g.b),
            Field::Alpha => Some(&mut g.alpha),
            Field::D => Some(&mut g.d),
            Field::Theta => Some(&mut g.theta),
            Field::R => Some(&mut g.r),
            _ => None,
        },
        Geometry::Placed { origins, axis } => match place.field {
            Field::Axis(k) => axis.get_mut(k),
            Field::Xyz(k) => origins.get_mut(place.origin)?.xyz.get_mut(k),
            Field::Rpy(k) => origins.get_mut(place.origin)?.rpy.get_mut(k),
            _ => None,
        },
    }
}
