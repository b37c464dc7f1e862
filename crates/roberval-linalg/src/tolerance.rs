//! When is a number zero: tau, and the rank decision with its gap.

use crate::LinalgError;

/// The unit roundoff behind the paper's printed tau: VAX D-floating, 2^-56.
/// `55 * 68.553 * PAPER_EPS_VAX` is its 5.23e-14.
pub const PAPER_EPS_VAX: f64 = 1.0 / (1_u64 << 56) as f64;

/// The rule for "numerically zero".
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tolerance {
    /// The paper's: `tau = r |T11| eps` (QRII), `r max|Rii| eps` (QR), `r sigma1 eps` (SVD),
    /// with r the rows of W. The paper's eps is [`PAPER_EPS_VAX`]; `f64::EPSILON` is IEEE's.
    Paper {
        /// The eps of the formulas above.
        eps: f64,
    },
    /// Relative to the column's own norm (staircase) or to the largest of the spectrum (QRII, SVD):
    /// at most `dependent` is dependent, at least `independent` is independent. Between the two a
    /// value counts as independent, but is flagged as ambiguous.
    Relative {
        /// At or below this ratio: dependent.
        dependent: f64,
        /// At or above this ratio: independent beyond doubt.
        independent: f64,
    },
}

impl Default for Tolerance {
    /// `Relative { dependent: 1e-10, independent: 1e-5 }`: on 400 random robots with clean geometry
    /// the smallest kept ratio was 2.6e-2 and the largest dropped one 1.1e-13; twists of one degree
    /// bring the smallest kept singular value to 1e-4 of the largest.
    fn default() -> Self {
        Tolerance::Relative {
            dependent: Tolerance::DEPENDENT,
            independent: 1e-5,
        }
    }
}

/// The numerical rank, and how clear the decision was.
#[derive(Debug, Clone, PartialEq)]
pub struct RankDecision {
    /// b.
    pub rank: usize,
    /// The c numbers judged. QRII: `|T_ii|`; SVD: `sigma_i` (nonincreasing, 0 beyond row r).
    /// Staircase, in column order: `residual_j / norm_j` (relative tolerance) or `|R_jj|` (the paper's).
    pub spectrum: Vec<f64>,
    /// The absolute threshold tau on the spectrum: a value above it counts.
    pub tolerance: f64,
    /// Smallest value that counts over largest value that does not (`spectrum_b / spectrum_{b+1}`).
    /// `None` where one side is empty (b = 0 or b = c); infinite where the values below are all 0.
    pub gap: Option<f64>,
    /// Indices into `spectrum` of the values in the grey zone of [`Tolerance::Relative`].
    /// Always empty under [`Tolerance::Paper`].
    pub ambiguous: Vec<usize>,
}

impl Tolerance {
    /// `dependent` of the default.
    pub(crate) const DEPENDENT: f64 = 1e-10;

    /// Refuses eps or ratios that are negative, not finite or in the wrong order.
    pub(crate) fn check(&self) -> Result<(), LinalgError> {
        let bad = |name, value, expected| {
            Err(LinalgError::Tolerance {
                name,
                value,
                expected,
            })
        };
        let usable = |x: f64| x.is_finite() && x >= 0.0;
        match *self {
            Tolerance::Paper { eps } if !usable(eps) => {
                bad("eps", eps, "must be finite and not negative")
            }
            Tolerance::Relative { dependent, .. } if !usable(dependent) || dependent >= 1.0 => {
                bad("dependent", dependent, "must lie in [0, 1)")
            }
            Tolerance::Relative {
                dependent,
                independent,
            } if !usable(independent) || independent < dependent => bad(
                "independent",
                independent,
                "must be finite and not below dependent",
            ),
            _ => Ok(()),
        }
    }

    /// Decides on a spectrum ordered from large to small, of a matrix with `rows` rows.
    pub(crate) fn decide(
        &self,
        spectrum: &[f64],
        rows: usize,
    ) -> Result<RankDecision, LinalgError> {
        self.check()?;
        let largest = spectrum.first().copied().unwrap_or(0.0);
        let (tau, sure) = match *self {
            Tolerance::Paper { eps } => (rows as f64 * largest * eps, 0.0),
            Tolerance::Relative {
                dependent,
                independent,
            } => (dependent * largest, independent * largest),
        };
        let rank = spectrum.iter().take_while(|&&t| t > tau).count();
        let counts: Vec<bool> = (0..spectrum.len()).map(|i| i < rank).collect();
        Ok(RankDecision::new(spectrum.to_vec(), &counts, tau, sure))
    }
}

impl RankDecision {
    /// The decision in which `spectrum[i]` counts iff `counts[i]`; what counts below `sure` is ambiguous.
    pub(crate) fn new(spectrum: Vec<f64>, counts: &[bool], tolerance: f64, sure: f64) -> Self {
        let side = |wanted| {
            spectrum
                .iter()
                .zip(counts)
                .filter(move |&(_, &c)| c == wanted)
                .map(|(&s, _)| s)
        };
        let rank = side(true).count();
        let above = side(true).fold(f64::INFINITY, f64::min);
        let below = side(false).fold(0.0, f64::max);
        let gap = (rank > 0 && rank < spectrum.len()).then(|| above / below);
        let ambiguous = (0..spectrum.len())
            .filter(|&i| counts[i] && spectrum[i] < sure)
            .collect();
        RankDecision {
            rank,
            spectrum,
            tolerance,
            gap,
            ambiguous,
        }
    }
}
