//! Constant angles as multiples of 2 pi/n and of few units.
//!
//! The decimals of a file are whole multiples N of one unit u, so that `exp(i a) = z^N` with
//! `z = exp(i u)`, which is transcendental (Lindemann): what holds for a random z holds for
//! the file as written, sums of angles that cancel included. Numbers of many digits have no
//! common unit with small N; then each group that has one gets its own, and the groups count
//! as independent.

use num_integer::Integer;
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive, Zero};
use roberval_mechanism::Mechanism;
use roberval_scalar::{LinearInPi, Quantity};

use super::angles::{AngleOrder, angles};

/// Multiples up to this share a unit: angles below a turn with seven decimals do. The failure
/// probability of one field grows with them, to 1e-6 on robots with dozens of such angles.
const MOST_STEPS: u64 = 1 << 26;

/// What is left of an angle without its whole multiples of 2 pi/n.
#[derive(Debug, Clone, PartialEq)]
enum Rest {
    /// So many radians.
    Radians(BigRational),
    /// So many half turns, with an unwieldy denominator.
    HalfTurns(BigRational),
    /// Another number (sqrt(2) rad), by its value.
    Other(f64),
}

impl Rest {
    /// How often `unit` goes into it; `None` if it does not, or too often.
    fn multiple_of(&self, unit: &Self) -> Option<i64> {
        let steps = match (self, unit) {
            (Self::Radians(x), Self::Radians(u)) | (Self::HalfTurns(x), Self::HalfTurns(u)) => {
                let ratio = x / u;
                ratio.is_integer().then(|| ratio.to_integer().to_i64())?
            }
            (Self::Other(x), Self::Other(u)) if x == u => Some(1),
            (Self::Other(x), Self::Other(u)) if *x == -u => Some(-1),
            _ => None,
        };
        steps.filter(|n| n.unsigned_abs() <= MOST_STEPS)
    }

    /// The largest unit of both.
    fn common(&self, other: &Self) -> Option<Self> {
        let unit = |a: &BigRational, b: &BigRational| {
            let numerator = (a.numer() * b.denom()).gcd(&(b.numer() * a.denom()));
            BigRational::new(numerator, a.denom() * b.denom())
        };
        Some(match (self, other) {
            (Self::Radians(a), Self::Radians(b)) => Self::Radians(unit(a, b)),
            (Self::HalfTurns(a), Self::HalfTurns(b)) => Self::HalfTurns(unit(a, b)),
            (Self::Other(a), Self::Other(b)) if a.abs() == b.abs() => self.clone(),
            _ => return None,
        })
    }

    fn abs(&self) -> Self {
        match self {
            Self::Radians(x) => Self::Radians(x.abs()),
            Self::HalfTurns(x) => Self::HalfTurns(x.abs()),
            Self::Other(x) => Self::Other(x.abs()),
        }
    }
}

/// A rotation whose powers stand for some of the robot's angles.
#[derive(Debug, Clone)]
pub struct AngleUnit {
    size: Rest,
    /// Different angles that are its multiples, as written.
    angles: Vec<(Rest, Quantity)>,
}

impl AngleUnit {
    /// Takes the angle in; false if some multiple would be too large.
    fn joins(&mut self, rest: &Rest, angle: &Quantity) -> bool {
        let Some(size) = self.size.common(rest) else {
            return false;
        };
        let few = |x: &Rest| x.multiple_of(&size).is_some();
        let fits = few(rest) && self.angles.iter().all(|(x, _)| few(x));
        if fits {
            self.size = size;
            if self.angles.iter().all(|(x, _)| x != rest) {
                self.angles.push((rest.clone(), angle.clone()));
            }
        }
        fits
    }

    /// The unit as an angle r or s pi; else an angle of the robot that is it, or minus it.
    ///
    /// # Errors
    /// That angle.
    pub fn exact(&self) -> Result<LinearInPi, &Quantity> {
        let zero = BigRational::zero;
        let (rational, half_turns) = match &self.size {
            Rest::Radians(x) => (x.clone(), zero()),
            Rest::HalfTurns(x) => (zero(), x.clone()),
            Rest::Other(_) => return Err(&self.angles[0].1),
        };
        Ok(LinearInPi {
            rational,
            half_turns,
        })
    }

    /// `0.123456789 (with 0.246913578)`: its angles as written.
    fn text(&self) -> String {
        let mut texts = self.angles.iter().map(|(_, angle)| angle.text.as_str());
        let first = texts.next().unwrap_or_default().to_owned();
        let others: Vec<&str> = texts.collect();
        if others.is_empty() {
            return first;
        }
        format!("{first} (with {})", others.join(", "))
    }
}

/// An angle as `half_turns pi`, whole n-th parts of a turn, plus a multiple of a unit.
#[derive(Debug, Clone, PartialEq)]
pub struct AngleParts {
    /// The part that is a multiple of 2 pi/n, over pi.
    pub half_turns: BigRational,
    /// A unit, by its index, and how often it is taken; `None` if nothing is left.
    pub multiple: Option<(usize, i64)>,
}

/// The units of a robot's angles.
#[derive(Debug, Clone)]
pub struct AngleUnits<'d> {
    robot: &'d Mechanism,
    order: AngleOrder,
    units: Vec<AngleUnit>,
}

impl<'d> AngleUnits<'d> {
    /// The units of all constant angles, whole multiples of 2 pi/`order` being out.
    #[must_use]
    pub fn of(robot: &'d Mechanism, order: AngleOrder) -> Self {
        let units = Vec::new();
        let mut all = Self {
            robot,
            order,
            units,
        };
        for angle in angles(robot) {
            if let Some(rest) = all.halves(angle).1
                && !all.units.iter_mut().any(|unit| unit.joins(&rest, angle))
            {
                let size = rest.abs();
                let angles = vec![(rest, angle.clone())];
                all.units.push(AngleUnit { size, angles });
            }
        }
        all
    }

    /// The units.
    #[must_use]
    pub fn units(&self) -> &[AngleUnit] {
        &self.units
    }

    /// The parts of one of the robot's angles.
    #[must_use]
    pub fn parts(&self, angle: &Quantity) -> AngleParts {
        let (half_turns, rest) = self.halves(angle);
        let multiple = |rest: Rest| {
            let mut units = self.units.iter().enumerate();
            units.find_map(|(k, unit)| Some((k, rest.multiple_of(&unit.size)?)))
        };
        AngleParts {
            half_turns,
            multiple: rest.and_then(multiple),
        }
    }

    /// The angles for which generic ones stand, as written, a text for each unit. One unit in
    /// radians is exact.
    #[must_use]
    pub fn generic(&self) -> Vec<String> {
        let radians = |unit: &&AngleUnit| matches!(unit.size, Rest::Radians(_));
        let exact = self.units.iter().filter(radians).count() == 1;
        let generic = self.units.iter().filter(|unit| !(exact && radians(unit)));
        generic.map(AngleUnit::text).collect()
    }

    /// Whole n-th parts of a turn, over pi, and the rest.
    fn halves(&self, angle: &Quantity) -> (BigRational, Option<Rest>) {
        let zero = BigRational::zero();
        let Some(exact) = LinearInPi::of(&angle.expr, &self.robot.description.constants) else {
            return (zero, Some(Rest::Other(angle.value)));
        };
        let (radians, half_turns) = (exact.rational, exact.half_turns);
        match (radians.is_zero(), self.order.steps(&half_turns).is_some()) {
            (true, true) => (half_turns, None),
            (false, true) => (half_turns, Some(Rest::Radians(radians))),
            (true, false) => (zero, Some(Rest::HalfTurns(half_turns))),
            (false, false) => (zero, Some(Rest::Other(angle.value))),
        }
    }
}
