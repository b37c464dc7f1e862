//! Generated robots: chains and trees of every kind the method must handle, named by a
//! seed. For tests and benches only.

mod couples;
mod style;

pub use couples::coupled;
use roberval_mechanism::{
    Geometry, JointKind, LinkDescription, MdhGeometry, Origin, RobotDescription, SourceFormat,
};
use roberval_scalar::{Decimal, Expr, Quantity, SplitMix64};
pub use style::{angles_mut, dusty, lengths_mut, literal_style, tilted};

/// What kind of robots to generate.
#[derive(Debug, Clone, Copy)]
pub struct Family {
    /// Fewest and most links.
    pub links: (usize, usize),
    /// Probability that a link branches off an earlier one instead of the last.
    pub branch: f64,
    /// Probability of a prismatic joint.
    pub prismatic: f64,
    /// Probability of a fixed joint (never the last link's).
    pub fixed: f64,
    /// Constant angles.
    pub angles: Angles,
    /// Modified Denavit-Hartenberg or URDF placements.
    pub format: SourceFormat,
}

/// Constant angles of a generated robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Angles {
    /// Multiples of 90 degrees: where regrouping happens.
    Right,
    /// Multiples of 15 degrees: those that cleaning knows.
    Fifteens,
    /// Whole degrees, rarely special.
    Oblique,
    /// Either, link by link.
    Mixed,
}

impl Default for Family {
    fn default() -> Self {
        Self {
            links: (1, 12),
            branch: 0.2,
            prismatic: 0.25,
            fixed: 0.1,
            angles: Angles::Mixed,
            format: SourceFormat::Mdh,
        }
    }
}

/// A joint in the plane at right angles to the link's own axis, in place of the joint of
/// a link with a URDF placement: the link follows two that have no body.
pub fn make_planar(robot: &mut RobotDescription, link: usize) {
    let turn = &mut robot.links[link];
    let Geometry::Placed { axis, .. } = &mut turn.geometry else {
        panic!("a URDF placement")
    };
    let unit = |k: usize| std::array::from_fn(|i| decimal(i64::from(i == k), 0));
    *axis = unit(2);
    let mut slide = turn.clone();
    turn.joint = JointKind::Revolute;
    turn.rotor = false;
    turn.geometry = Geometry::Placed {
        origins: Vec::new(),
        axis: unit(2),
    };
    slide.joint = JointKind::Prismatic;
    slide.massless = true;
    let mut slides = [slide.clone(), slide];
    for (k, slide) in slides.iter_mut().enumerate() {
        slide.name.push_str([".x", ".y"][k]);
        if let Geometry::Placed { axis, .. } = &mut slide.geometry {
            *axis = unit(k);
        }
    }
    slides[1].antecedent = Some(slides[0].name.clone());
    if let Geometry::Placed { origins, .. } = &mut slides[1].geometry {
        origins.clear();
    }
    turn.antecedent = Some(slides[1].name.clone());
    robot.links.splice(link..link, slides);
}

impl Family {
    /// The robot of this family with this seed.
    #[must_use]
    pub fn robot(&self, seed: u64) -> RobotDescription {
        let mut random = SplitMix64::new(seed);
        let count = self.links.0 + random.below(self.links.1 - self.links.0 + 1);
        let links = (0..count)
            .map(|j| self.link(j, j + 1 == count, &mut random))
            .collect();
        RobotDescription {
            name: format!("generated {seed}"),
            gravity: gravity(&mut random),
            constants: Vec::new(),
            links,
            couples: Vec::new(),
            loops: Vec::new(),
            format: self.format,
            warnings: Vec::new(),
        }
    }

    fn link(&self, j: usize, last: bool, random: &mut SplitMix64) -> LinkDescription {
        let joint = match random.uniform(0.0, 1.0) {
            x if x < self.prismatic => JointKind::Prismatic,
            x if x < self.prismatic + self.fixed && !last => JointKind::Fixed,
            _ => JointKind::Revolute,
        };
        let antecedent = match j {
            0 => None,
            _ if random.uniform(0.0, 1.0) < self.branch => random.below(j + 1).checked_sub(1),
            _ => Some(j - 1),
        };
        let moves = joint != JointKind::Fixed;
        LinkDescription {
            name: (j + 1).to_string(),
            joint_name: None,
            antecedent: antecedent.map(|a| (a + 1).to_string()),
            joint,
            active: moves,
            rotor: moves && random.uniform(0.0, 1.0) < 0.8,
            geometry: self.geometry(j, random),
            inertia: std::array::from_fn(|_| Some(decimal(random.below(2000) as i64 - 1000, -3))),
            massless: false,
            limits: None,
        }
    }

    fn geometry(&self, j: usize, random: &mut SplitMix64) -> Geometry {
        if self.format == SourceFormat::Mdh {
            return Geometry::Mdh(Box::new(MdhGeometry {
                gamma: self.angle(random, 0.3),
                b: length(random, 0.2),
                alpha: self.angle(random, 0.9),
                d: length(random, 0.5),
                theta: self.angle(random, 0.3),
                r: length(random, 0.5),
            }));
        }
        let origin = Origin {
            joint: format!("joint {}", j + 1),
            xyz: std::array::from_fn(|_| length(random, 0.5)),
            rpy: std::array::from_fn(|_| self.angle(random, 0.5)),
        };
        let mut axis: [i64; 3] = [0; 3];
        axis[random.below(3)] = if random.below(2) == 0 { 1 } else { -1 };
        if self.angles != Angles::Right && random.below(3) == 0 {
            axis = std::array::from_fn(|_| random.below(9) as i64 - 4);
            axis[2] = axis[2].abs() + 1;
        }
        Geometry::Placed {
            origins: vec![origin],
            axis: axis.map(|x| decimal(x, 0)),
        }
    }

    fn angle(&self, random: &mut SplitMix64, probability: f64) -> Quantity {
        if random.uniform(0.0, 1.0) >= probability {
            return degrees(0);
        }
        let (first, step) = match self.angles {
            Angles::Right => (-90, 90),
            Angles::Fifteens => (-180, 15),
            Angles::Oblique => (-180, 1),
            Angles::Mixed if random.below(3) > 0 => (-90, 90),
            Angles::Mixed => (-180, 1),
        };
        degrees(first + step * random.below(360 / step as usize) as i64)
    }
}

/// Along an axis, tilted, or none.
fn gravity(random: &mut SplitMix64) -> [Quantity; 3] {
    let mut g = [0; 3];
    match random.below(4) {
        0 => g = std::array::from_fn(|_| random.below(2000) as i64 - 1000),
        1 => {}
        _ => g[random.below(3)] = if random.below(2) == 0 { 981 } else { -981 },
    }
    g.map(|x| decimal(x, -2))
}

fn length(random: &mut SplitMix64, probability: f64) -> Quantity {
    let mm = random.below(1000) as i64 - 300;
    let zero = random.uniform(0.0, 1.0) >= probability;
    decimal(if zero { 0 } else { mm }, -3)
}

/// `mantissa * 10^exponent`, written as a decimal.
#[must_use]
pub fn decimal(mantissa: i64, exponent: i32) -> Quantity {
    let text = format!("{mantissa}e{exponent}");
    Quantity {
        value: text.parse().expect("a decimal"),
        expr: number(mantissa, exponent),
        text,
    }
}

/// An angle written in whole degrees.
#[must_use]
pub fn degrees(degrees: i64) -> Quantity {
    let per_degree = Expr::Div(Box::new(Expr::Pi), Box::new(number(180, 0)));
    Quantity {
        text: format!("{degrees} deg"),
        expr: Expr::Mul(Box::new(number(degrees, 0)), Box::new(per_degree)),
        value: (degrees as f64).to_radians(),
    }
}

fn number(mantissa: i64, exponent: i32) -> Expr {
    let decimal = Decimal::parse(&format!("{mantissa}e{exponent}"));
    Expr::Number(decimal.expect("a decimal"))
}
