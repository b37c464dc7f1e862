//! Ways to write the same thing.

use roberval_mechanism::Mechanism;
use roberval_regressor::{Shape, Tree};

use crate::composite::Meeting;
use crate::what::What;

/// A way of recording.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Way {
    /// Whether mass moves between bodies as no motion can tell.
    pub regroup: bool,
    /// Whether bodies get other frames.
    pub reframe: bool,
    /// How a mass matrix comes about.
    pub mass: Mass,
}

#[derive(Debug, Clone, Copy)]
pub(crate) enum Mass {
    /// By composite bodies.
    Composite(Meeting),
    /// Column after column, as torques of unit accelerations: cheap where many joints follow
    /// few coordinates.
    Columns,
}

impl Way {
    /// The ways worth counting.
    pub fn all(mechanism: &Mechanism, what: What, columns: usize) -> Vec<Self> {
        use Mass::{Columns, Composite};
        // Mass may move between bodies only where not all standard parameters count.
        let regroupings: &[bool] = match columns < mechanism.parameters().len() {
            true if what.takes_parameters() => &[true, false],
            _ => &[false],
        };
        let masses: &[Mass] = match what {
            What::MassMatrix if mechanism.closure.is_some() => &[
                Composite(Meeting::Carried),
                Composite(Meeting::Root),
                Columns,
            ],
            What::MassMatrix => &[Composite(Meeting::Carried), Composite(Meeting::Root)],
            _ => &[Columns],
        };
        // Results that go with parameters stay with the bodies' own frames.
        let right = Shape::of(&Tree::of(mechanism))
            .iter()
            .all(|shape| shape.right);
        let frames: &[bool] = match what.takes_parameters() && !right {
            true => &[false, true],
            false => &[false],
        };
        let mut ways = Vec::new();
        for &regroup in regroupings {
            for &reframe in frames {
                let way = |&mass| Self {
                    regroup,
                    reframe,
                    mass,
                };
                ways.extend(masses.iter().map(way));
            }
        }
        ways
    }
}
