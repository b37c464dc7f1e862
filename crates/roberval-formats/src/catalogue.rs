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

macro_rules! robot {
    ($name:literal, $title:literal, $source:literal) => {
        CatalogueEntry {
            name: $name,
            title: $title,
            source: $source,
            toml: include_str!(concat!("../catalogue/", $name, ".toml")),
        }
    };
}

const CATALOGUE: &[CatalogueEntry] = &[
    robot!(
        "puma560",
        "PUMA 560, the paper's example",
        "M. Gautier, Numerical calculation of the base inertial parameters of robots, \
         Journal of Robotic Systems 8(4), 1991, Tables I and III"
    ),
    robot!(
        "two_link",
        "Planar two-link arm in the vertical plane",
        "the textbook example, length of our own"
    ),
    robot!(
        "scara",
        "SCARA, three revolute joints and a prismatic one",
        "W. Khalil and E. Dombre, Modeling, Identification and Control of Robots, 2002; \
         lengths of our own"
    ),
    robot!(
        "stanford",
        "Stanford arm, with a prismatic third joint",
        "R. Paul, Stanford AIM-177, 1972"
    ),
    robot!(
        "iiwa14",
        "KUKA LBR iiwa 14 R820, seven joints",
        "KUKA, data sheet of the LBR iiwa 14 R820"
    ),
    robot!(
        "lwr4",
        "KUKA LWR 4+, seven joints",
        "A. Jubien, M. Gautier and A. Janot, Dynamic identification of the Kuka \
         LightWeight robot, AIM 2014"
    ),
    robot!(
        "panda",
        "Franka Emika Panda, seven joints",
        "Franka, Control Interface documentation, Denavit-Hartenberg parameters"
    ),
    robot!(
        "ur5",
        "Universal Robots UR5",
        "Universal Robots, DH parameters for calculations of kinematics and dynamics"
    ),
    robot!(
        "ur10",
        "Universal Robots UR10",
        "Universal Robots, DH parameters for calculations of kinematics and dynamics"
    ),
    robot!(
        "rx90",
        "Staubli RX-90",
        "W. Khalil and E. Dombre, Modeling, Identification and Control of Robots, 2002"
    ),
    robot!(
        "tx40",
        "Staubli TX40",
        "M. Gautier and S. Briot, Global identification of joint drive gains and dynamic \
         parameters of robots, ASME JDSMC 136(5), 2014"
    ),
    robot!(
        "torso",
        "Torso with two arms, a tree",
        "proportions of our own"
    ),
    robot!(
        "hitachi_hpr",
        "HITACHI-HPR, a parallelogram: the paper's constraints on a stand-in geometry",
        "M. Gautier, Numerical calculation of the base inertial parameters of robots, \
         Journal of Robotic Systems 8(4), 1991, gives the constraints; the geometry there \
         is not published, this one is of our own"
    ),
    robot!(
        "sr400",
        "Acma SR400, a parallelogram",
        "W. Khalil and E. Dombre, Modeling, Identification and Control of Robots, 2002; \
         lengths of our own"
    ),
    robot!(
        "four_bar",
        "Planar four-bar linkage, a loop given by its cut joint",
        "the textbook example, lengths of our own"
    ),
    robot!(
        "delta",
        "Delta robot, two loops given by their cut joints",
        "R. Clavel, Delta, a fast robot with parallel geometry, ISIR 1988; rods with universal \
         joints and lengths of our own"
    ),
];
