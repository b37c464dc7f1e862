//! What code computes.

use std::str::FromStr;

/// What the code computes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum What {
    /// Inverse dynamics tau(q, qd, qdd).
    #[default]
    Tau,
    /// The reduced regressor d1, n x b.
    Regressor,
    /// The energy row h1.
    Energy,
    /// The torques at rest: gravity.
    Gravity,
    /// The mass matrix, n x n.
    MassMatrix,
}

impl What {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Tau,
        Self::Regressor,
        Self::Energy,
        Self::Gravity,
        Self::MassMatrix,
    ];

    /// `tau`, `regressor`, `energy`, `gravity` or `mass`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Tau => "tau",
            Self::Regressor => "regressor",
            Self::Energy => "energy",
            Self::Gravity => "gravity",
            Self::MassMatrix => "mass",
        }
    }

    /// The shape of the result at one state, for n joint variables and b parameters.
    #[must_use]
    pub fn shape(self, n: usize, b: usize) -> Vec<usize> {
        match self {
            Self::Tau | Self::Gravity => vec![n],
            Self::Regressor => vec![n, b],
            Self::Energy => vec![b],
            Self::MassMatrix => vec![n, n],
        }
    }

    /// The joint states it takes.
    #[must_use]
    pub fn states(self) -> &'static [&'static str] {
        match self {
            Self::Tau | Self::Regressor => &["q", "qd", "qdd"],
            Self::Energy => &["q", "qd"],
            Self::Gravity | Self::MassMatrix => &["q"],
        }
    }

    /// Whether it takes parameters: the regressor and the energy row are multiplied by
    /// them.
    #[must_use]
    pub fn takes_parameters(self) -> bool {
        !matches!(self, Self::Regressor | Self::Energy)
    }
}

/// A word that is no [`What`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("code is written for {}", What::ALL.map(What::name).join(", "))]
pub struct UnknownWhat;

impl FromStr for What {
    type Err = UnknownWhat;

    fn from_str(name: &str) -> Result<Self, UnknownWhat> {
        let mut all = Self::ALL.into_iter();
        all.find(|what| what.name() == name).ok_or(UnknownWhat)
    }
}
