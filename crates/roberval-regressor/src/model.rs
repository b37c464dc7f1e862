//! The three models: which rows they have and what of the states they look at.

/// The three models, each linear in the parameters X.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Model {
    /// d: the dynamic model (Gautier 1991, eq. (5)).
    #[default]
    D,
    /// d0: the dynamic model at rest (eq. (8)).
    D0,
    /// h: the energy model (eq. (10)); only its differences mean anything.
    H,
}

impl Model {
    /// All models.
    pub const ALL: [Self; 3] = [Self::D, Self::D0, Self::H];

    /// `d`, `d0` or `h`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::D => "d",
            Self::D0 => "d0",
            Self::H => "h",
        }
    }

    /// Rows a sample gives, for m independent joints (all n without constraints).
    #[must_use]
    pub fn rows(self, independent: usize) -> usize {
        match self {
            Self::D | Self::D0 => independent,
            Self::H => 1,
        }
    }

    /// Which of q, qd and qdd it looks at: at rest qd is zero, and energy takes no qdd.
    #[must_use]
    pub fn takes(self) -> [bool; 3] {
        [true, self != Self::D0, self != Self::H]
    }

    /// A state, but zeros for what it does not look at.
    pub(crate) fn taken<'a>(self, state: [&'a [f64]; 3], zeros: &'a [f64]) -> [&'a [f64]; 3] {
        let mut taken = state;
        for (array, takes) in taken.iter_mut().zip(self.takes()) {
            if !takes {
                *array = zeros;
            }
        }
        taken
    }
}
