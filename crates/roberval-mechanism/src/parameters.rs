use std::fmt;

/// The eleven standard inertial parameters of a link, in the paper's order
/// (Gautier 1991, eq. (3)).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum ParameterKind {
    /// Moment of inertia about x, kg m^2.
    XX,
    /// Product of inertia, kg m^2.
    XY,
    /// Product of inertia, kg m^2.
    XZ,
    /// Moment of inertia about y, kg m^2.
    YY,
    /// Product of inertia, kg m^2.
    YZ,
    /// Moment of inertia about z, kg m^2.
    ZZ,
    /// First moment along x, kg m.
    MX,
    /// First moment along y, kg m.
    MY,
    /// First moment along z, kg m.
    MZ,
    /// Mass, kg.
    M,
    /// Rotor inertia seen from the joint's side, kg m^2 (kg for a prismatic joint).
    Ia,
}

impl ParameterKind {
    /// All kinds in the paper's order.
    pub const ALL: [Self; 11] = [
        Self::XX,
        Self::XY,
        Self::XZ,
        Self::YY,
        Self::YZ,
        Self::ZZ,
        Self::MX,
        Self::MY,
        Self::MZ,
        Self::M,
        Self::Ia,
    ];

    /// The field's name for it: `XX`, ..., `M`, `Ia`.
    #[must_use]
    pub fn name(self) -> &'static str {
        [
            "XX", "XY", "XZ", "YY", "YZ", "ZZ", "MX", "MY", "MZ", "M", "Ia",
        ][self as usize]
    }
}

impl fmt::Display for ParameterKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// One standard parameter: which one, of which link.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct ParameterId {
    /// Index of the link, from 0.
    pub link: usize,
    /// Which of the eleven.
    pub kind: ParameterKind,
}

/// The columns of the regressor: the standard parameters link by link in the paper's
/// order. A link whose joint has no rotor of its own has ten columns, the others eleven, and
/// one without a body none.
///
/// This is the only place that knows where a parameter's column is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ParameterSpace {
    ids: Vec<ParameterId>,
    labels: Vec<String>,
    first: Vec<usize>,
}

impl ParameterSpace {
    /// The space of links given by name and by how many of the eleven they have.
    pub fn new<'a>(links: impl IntoIterator<Item = (&'a str, usize)>) -> Self {
        let mut space = Self {
            ids: Vec::new(),
            labels: Vec::new(),
            first: Vec::new(),
        };
        for (link, (name, count)) in links.into_iter().enumerate() {
            space.first.push(space.ids.len());
            for kind in &ParameterKind::ALL[..count] {
                space.ids.push(ParameterId { link, kind: *kind });
                space.labels.push(format!("{kind}_{name}"));
            }
        }
        space
    }

    /// Number of columns C.
    #[must_use]
    pub fn len(&self) -> usize {
        self.ids.len()
    }

    /// Whether there is no column at all.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.ids.is_empty()
    }

    /// The parameters in column order.
    #[must_use]
    pub fn ids(&self) -> &[ParameterId] {
        &self.ids
    }

    /// The labels `KIND_link` in column order.
    #[must_use]
    pub fn labels(&self) -> &[String] {
        &self.labels
    }

    /// The first column of a link (its `XX`); the other nine follow, then `Ia` if any. A
    /// link without parameters has none there.
    #[must_use]
    pub fn first_column(&self, link: usize) -> usize {
        self.first[link]
    }

    /// The column of a link's `Ia`, if the link has one.
    #[must_use]
    pub fn rotor_column(&self, link: usize) -> Option<usize> {
        let column = self.first[link] + 10;
        let id = self.ids.get(column)?;
        (id.link == link).then_some(column)
    }

    /// The column with this label.
    #[must_use]
    pub fn column(&self, label: &str) -> Option<usize> {
        self.labels.iter().position(|l| l == label)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_without_rotor_have_ten_columns() {
        let space = ParameterSpace::new([("a", 11), ("b", 10), ("c", 11)]);
        assert_eq!(space.len(), 32);
        assert_eq!(space.first_column(2), 21);
        assert_eq!(space.rotor_column(0), Some(10));
        assert_eq!(space.rotor_column(1), None);
        assert_eq!(space.column("Ia_c"), Some(31));
        assert_eq!(space.labels()[11], "XX_b");
    }
}
