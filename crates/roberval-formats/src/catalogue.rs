/// A built-in robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CatalogueEntry {
    /// The name under which [`crate::load`] finds it.
    pub name: &'static str,
    /// What robot it is.
    pub title: &'static str,
    /// Where its numbers come from.
    pub source: &'static str,
    /// Its robot TOML.
    pub toml: &'static str,
}

/// The built-in robots.
#[must_use]
pub fn catalogue() -> &'static [CatalogueEntry] {
    CATALOGUE
}

/// The built-in robot of this name.
pub(crate) fn entry(name: &str) -> Option<&'static CatalogueEntry> {
    CATALOGUE.iter().find(|entry| entry.name == name)
}

const CATALOGUE: &[CatalogueEntry] = &[CatalogueEntry {
    name: "puma560",
    title: "PUMA 560, the paper's example",
    source: "M. Gautier, Numerical calculation of the base inertial parameters of robots, \
             Journal of Robotic Systems 8(4), 1991, Tables I and III",
    toml: include_str!("../catalogue/puma560.toml"),
}];
