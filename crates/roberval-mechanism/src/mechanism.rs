use std::sync::Arc;

use nalgebra::{Matrix3, Vector3};

use crate::clean::{CleanPolicy, Cleaned, clean};
use crate::{
    Assembly, AssemblyError, Closure, CoupleError, JointKind, LoopError, Motion, ParameterSpace,
    RobotDescription, TreeError, order, placement,
};

/// A valid robot with numbers: a chain or tree of links, each after its antecedent.
#[derive(Debug, Clone, PartialEq)]
pub struct Mechanism {
    /// The robot's name.
    pub name: String,
    /// Acceleration of gravity in the base frame, m/s^2.
    pub gravity: Vector3<f64>,
    /// The links in parameter order; a link's antecedent has a smaller index.
    pub links: Vec<Link>,
    /// How all joint variables follow from the independent ones; `None` where all are
    /// independent.
    pub closure: Option<Closure>,
    /// The branch on which the loops are closed; `None` without loops.
    pub assembly: Option<Arc<Assembly>>,
    /// What the numbers were made from: the exact engine reads the literals there.
    pub description: Arc<RobotDescription>,
    /// What was set right before, and the description as it was written; `None` for a
    /// description taken literally.
    pub cleaning: Option<Arc<Cleaning>>,
}

/// How a description was cleaned.
#[derive(Debug, Clone, PartialEq)]
pub struct Cleaning {
    /// The description as written.
    pub written: RobotDescription,
    /// The cleaned description, what was changed, and what was left alone.
    pub cleaned: Cleaned,
}

/// One link of a [`Mechanism`].
#[derive(Debug, Clone, PartialEq)]
pub struct Link {
    /// Index of the link in the description.
    pub in_file: usize,
    /// The link's name, unique in the robot.
    pub name: String,
    /// The joint's name where the format has one.
    pub joint_name: Option<String>,
    /// Index of the antecedent link; `None` is the base.
    pub antecedent: Option<usize>,
    /// What the joint allows.
    pub joint: JointKind,
    /// mu: whether the joint is driven.
    pub active: bool,
    /// Whether there is an Ia column.
    pub rotor: bool,
    /// Whether there are no columns at all: no body, only a motion.
    pub massless: bool,
    /// Constant rotation from this link's frame to the antecedent's at joint variable 0:
    /// its columns are the axes (s, n, a) of this frame in the antecedent's.
    pub rotation: Matrix3<f64>,
    /// Origin of the link's frame at joint variable 0, in the antecedent's frame, m.
    pub origin: Vector3<f64>,
    /// Unit joint axis in the link's frame.
    pub axis: Vector3<f64>,
    /// XX XY XZ YY YZ ZZ MX MY MZ M Ia about the frame's origin, where known.
    pub inertia: [Option<f64>; 11],
}

impl Link {
    /// What messages call the joint that moves the link: its own name, or else the link's.
    #[must_use]
    pub fn label(&self) -> &str {
        self.joint_name.as_deref().unwrap_or(&self.name)
    }

    /// How many standard parameters it has: ten, and Ia if there is a rotor; none without
    /// a body.
    #[must_use]
    pub fn columns(&self) -> usize {
        match (self.massless, self.rotor) {
            (true, _) => 0,
            (false, rotor) => 10 + usize::from(rotor),
        }
    }
}

/// A link that floats must be the base of all others.
fn check_floating(links: &[Link]) -> Result<(), MechanismError> {
    let Some(floating) = links.iter().find(|l| l.joint == JointKind::Floating) else {
        return Ok(());
    };
    if let Some(antecedent) = floating.antecedent {
        return Err(MechanismError::FloatingOnLink {
            link: floating.name.clone(),
            antecedent: links[antecedent].name.clone(),
        });
    }
    let beside = |l: &&Link| l.antecedent.is_none() && l.name != floating.name;
    match links.iter().find(beside) {
        None => Ok(()),
        Some(other) => Err(MechanismError::BesideFloating {
            link: other.name.clone(),
            floating: floating.name.clone(),
        }),
    }
}

/// A link without a body must carry one link.
fn check_massless(links: &[Link]) -> Result<(), MechanismError> {
    for (j, link) in links.iter().enumerate().filter(|(_, l)| l.massless) {
        let carried = links.iter().filter(|l| l.antecedent == Some(j)).count();
        if carried != 1 {
            return Err(MechanismError::Massless {
                link: link.name.clone(),
                links: carried,
            });
        }
    }
    Ok(())
}

/// Why a description is not a mechanism.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MechanismError {
    /// There is nothing to analyse.
    #[error(
        "the robot \"{robot}\" has no link that a joint carries, so that nothing moves: give it at least one moving joint"
    )]
    Empty {
        /// The robot's name.
        robot: String,
    },
    /// No joint moves.
    #[error("the robot \"{robot}\" has no moving joint: every joint is fixed")]
    Rigid {
        /// The robot's name.
        robot: String,
    },
    /// The links do not form a tree on the base.
    #[error(transparent)]
    Tree(#[from] TreeError),
    /// A link floats that is not the base of all others.
    #[error(
        "link \"{link}\" floats on \"{antecedent}\": only the first link may float, on the base and with all others on it"
    )]
    FloatingOnLink {
        /// The link.
        link: String,
        /// Its antecedent.
        antecedent: String,
    },
    /// A link stands on the base beside one that floats.
    #[error(
        "link \"{link}\" stands on the base beside the floating link \"{floating}\": all links must stand on the floating one, and be analysed without it if they do not"
    )]
    BesideFloating {
        /// The link.
        link: String,
        /// The one that floats.
        floating: String,
    },
    /// Loops on a base that floats.
    #[error(
        "the robot \"{robot}\" has loops and floats: roberval analyses either, not both; couples may replace loops"
    )]
    FloatingLoops {
        /// The robot's name.
        robot: String,
    },
    /// A link without a body carries none, or several.
    #[error(
        "link \"{link}\" is massless and carries {links} links: one that only stands between two motions carries one"
    )]
    Massless {
        /// The link.
        link: String,
        /// How many links it carries.
        links: usize,
    },
    /// A couple that cannot be.
    #[error(transparent)]
    Couple(#[from] CoupleError),
    /// A loop that is none.
    #[error(transparent)]
    Loop(#[from] LoopError),
    /// Loops that cannot be assembled or moved.
    #[error("the robot \"{robot}\": {error}")]
    Assembly {
        /// The robot's name.
        robot: String,
        /// Why.
        error: AssemblyError,
    },
    /// A number that must be finite is not.
    #[error("link \"{link}\": {field} is {value}, which is not a finite number")]
    NotFinite {
        /// The link.
        link: String,
        /// What is not finite.
        field: String,
        /// What was found.
        value: f64,
    },
    /// A joint axis without direction.
    #[error("link \"{link}\": the joint axis is (0, 0, 0); give it a direction such as 0 0 1")]
    ZeroAxis {
        /// The link.
        link: String,
    },
}

impl Mechanism {
    /// The mechanism of a description whose rounded angles and dust are set right first
    /// ([`clean`]).
    ///
    /// # Errors
    /// A [`MechanismError`] that names the link and the field.
    pub fn cleaned(
        description: &RobotDescription,
        policy: &CleanPolicy,
    ) -> Result<Self, MechanismError> {
        let cleaned = clean(description, policy);
        let mechanism = Self::new(&cleaned.description)?;
        Ok(Self {
            cleaning: Some(Arc::new(Cleaning {
                written: description.clone(),
                cleaned,
            })),
            ..mechanism
        })
    }

    /// The mechanism of a description taken literally: links ordered, geometry as numbers.
    ///
    /// # Errors
    /// A [`MechanismError`] that names the link and the field.
    pub fn new(description: &RobotDescription) -> Result<Self, MechanismError> {
        if description.links.is_empty() {
            return Err(MechanismError::Empty {
                robot: description.name.clone(),
            });
        }
        let antecedents = description.antecedents()?;
        let order = order::antecedents_first(&antecedents);
        let mut position = vec![0; order.len()];
        for (index, &in_file) in order.iter().enumerate() {
            position[in_file] = index;
        }
        let gravity = Vector3::from_fn(|i, _| description.gravity[i].value);
        placement::finite(gravity.iter(), "base", "gravity")?;
        let links = order
            .iter()
            .map(|&in_file| {
                let antecedent = antecedents[in_file].map(|a| position[a]);
                placement::link(&description.links[in_file], in_file, antecedent)
            })
            .collect::<Result<Vec<_>, _>>()?;
        check_floating(&links)?;
        check_massless(&links)?;
        let closure = Closure::of(description, &order)?;
        let mut mechanism = Self {
            name: description.name.clone(),
            gravity,
            links,
            closure,
            assembly: None,
            description: Arc::new(description.clone()),
            cleaning: None,
        };
        if mechanism.dof() == 0 {
            return Err(MechanismError::Rigid {
                robot: mechanism.name,
            });
        }
        if !description.loops.is_empty() {
            if mechanism.is_floating() {
                return Err(MechanismError::FloatingLoops {
                    robot: mechanism.name,
                });
            }
            mechanism.close_loops(&antecedents)?;
        }
        Ok(mechanism)
    }

    /// Number of degrees of freedom n of the tree: a fixed joint has none, a floating base
    /// six.
    #[must_use]
    pub fn dof(&self) -> usize {
        self.motions().count()
    }

    /// What the velocity of each of the n variables measures.
    pub fn motions(&self) -> impl Iterator<Item = Motion> {
        let links = self.links.iter();
        links.flat_map(|l| l.joint.motions().iter().copied())
    }

    /// Whether the first link is a base that floats.
    #[must_use]
    pub fn is_floating(&self) -> bool {
        let first = self.links.first();
        first.is_some_and(|l| l.joint == JointKind::Floating)
    }

    /// The link of each of the n variables, in their order: a floating one stands six times.
    pub fn moving(&self) -> impl Iterator<Item = &Link> {
        let links = self.links.iter();
        links.flat_map(|l| std::iter::repeat_n(l, l.joint.dof()))
    }

    /// Number of independent joint variables m: those that determine all n.
    #[must_use]
    pub fn independent(&self) -> usize {
        let all = |c: &Closure| c.independent.len();
        self.closure.as_ref().map_or_else(|| self.dof(), all)
    }

    /// Whether all constraints, if there are any, are sums of multiples: those that prime
    /// fields hold.
    #[must_use]
    pub fn is_affine(&self) -> bool {
        let no_formula = |closure: &Closure| closure.formulas.is_empty();
        self.assembly.is_none() && self.closure.as_ref().is_none_or(no_formula)
    }

    /// Number of coordinates of a position: m, or m + 1 for a floating robot, whose attitude
    /// is a quaternion.
    #[must_use]
    pub fn positions(&self) -> usize {
        self.independent() + usize::from(self.is_floating())
    }

    /// What the velocity of each of the m independent variables measures.
    #[must_use]
    pub fn independent_motions(&self) -> Vec<Motion> {
        self.of_independent(self.motions().collect())
    }

    /// The independent ones of what there is for each of the n variables.
    pub(crate) fn of_independent<T: Clone>(&self, all: Vec<T>) -> Vec<T> {
        match &self.closure {
            None => all,
            Some(closure) => closure
                .independent
                .iter()
                .map(|&v| all[v].clone())
                .collect(),
        }
    }

    /// The links whose joints are independent, in the order of the states and torques.
    #[must_use]
    pub fn independent_joints(&self) -> Vec<&Link> {
        self.of_independent(self.moving().collect())
    }

    /// What the description's couples say, of a mechanism with loops or without.
    #[must_use]
    pub fn couples(&self) -> Option<Closure> {
        let order: Vec<usize> = self.links.iter().map(|l| l.in_file).collect();
        // A mechanism's couples have been found to be valid.
        Closure::of(&self.description, &order).unwrap_or_default()
    }

    /// The standard parameters as columns.
    #[must_use]
    pub fn parameters(&self) -> ParameterSpace {
        ParameterSpace::new(self.links.iter().map(|l| (l.name.as_str(), l.columns())))
    }

    /// The known standard parameters X in column order; what the robot file does not
    /// give counts as zero. `None` if no link has any value.
    #[must_use]
    pub fn standard_parameters(&self) -> Option<Vec<f64>> {
        let known = |l: &Link| l.inertia.iter().any(Option::is_some);
        self.links.iter().any(known).then(|| {
            self.parameters()
                .ids()
                .iter()
                .map(|id| self.links[id.link].inertia[id.kind as usize].unwrap_or(0.0))
                .collect()
        })
    }

    /// A length that is typical of the robot, m: the largest distance between a joint
    /// and its antecedent, or 1 where all joints meet in a point.
    #[must_use]
    pub fn characteristic_length(&self) -> f64 {
        let largest = self
            .links
            .iter()
            .map(|l| l.origin.norm())
            .fold(0.0, f64::max);
        if largest > 0.0 { largest } else { 1.0 }
    }
}
