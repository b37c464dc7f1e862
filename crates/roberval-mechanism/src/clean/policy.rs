/// How far an angle may lie from a multiple of pi/12 and still be a rounding of it, rad.
///
/// It covers every rounding to four or more decimals (half of 1e-4) and every truncation
/// (3.1415), but not an angle that someone measured: a calibration gives 1e-3 rad.
const ANGLE: f64 = 1e-4;

/// How far an angle may lie from a multiple of pi/12 and still look like a rounding of
/// it, rad: 1.57, 3.14, 1.571 and, 5.4e-3 away, 0.78. At two decimals an angle of the
/// robot's own is as likely, so these are shown and left alone. Half a degree is 8.7e-3.
const NEAR_MISS: f64 = 5.5e-3;

/// The longest length that is dust, m: no joint is placed to a micrometre, and the dust
/// of real files is 1e-17 to 1e-9 m.
const LENGTH: f64 = 1e-6;

/// The largest component of a direction, relative to its length, that is dust: a
/// direction written with six decimals has this error.
const DIRECTION: f64 = 1e-6;

/// A change of at most this size (rad, m or relative) is one of the last digit of a
/// double: two units in the last place of pi, as conversions from degrees have.
pub(super) const LAST_DIGIT: f64 = 1e-15;

/// Whether a description is cleaned.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum CleanMode {
    /// The description is taken as written.
    Off,
    /// Roundings and dust are set right, near misses only shown.
    #[default]
    Default,
    /// Near misses are set right too.
    Aggressive,
}

/// What [`super::clean`] sets right.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CleanPolicy {
    /// Whether and how boldly to clean.
    pub mode: CleanMode,
    /// Largest rounding error of an angle, rad.
    pub angle: f64,
    /// Largest distance of a near miss, rad.
    pub near_miss: f64,
    /// Longest length that is dust, m.
    pub length: f64,
    /// Largest component of an axis or of gravity that is dust, relative to its length.
    pub direction: f64,
}

impl Default for CleanPolicy {
    fn default() -> Self {
        Self {
            mode: CleanMode::Default,
            angle: ANGLE,
            near_miss: NEAR_MISS,
            length: LENGTH,
            direction: DIRECTION,
        }
    }
}

impl CleanPolicy {
    /// The description as written: no changes, no near misses.
    #[must_use]
    pub fn literal() -> Self {
        Self {
            mode: CleanMode::Off,
            ..Self::default()
        }
    }

    /// The default, and near misses are set right too.
    #[must_use]
    pub fn aggressive() -> Self {
        Self {
            mode: CleanMode::Aggressive,
            ..Self::default()
        }
    }
}
