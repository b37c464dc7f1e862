use std::sync::Arc;

use nalgebra::{Matrix3, Vector3};

use crate::clean::{CleanPolicy, Cleaned, clean};
use crate::{
    Assembly, AssemblyError, Closure, CoupleError, JointKind, LoopError, ParameterSpace,
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
            mechanism.close_loops(&antecedents)?;
        }
        Ok(mechanism)
    }

    /// Number of joint variables n of the tree (fixed joints have none).
    #[must_use]
    pub fn dof(&self) -> usize {
        self.moving().count()
    }

    /// The links with a joint variable, in the order of the variables.
    pub fn moving(&self) -> impl Iterator<Item = &Link> {
        self.links.iter().filter(|l| l.joint != JointKind::Fixed)
    }

    /// Number of independent joint variables m: those that determine all n.
    #[must_use]
    pub fn independent(&self) -> usize {
        let all = |c: &Closure| c.independent.len();
        self.closure.as_ref().map_or_else(|| self.dof(), all)
    }

    /// The links whose joints are independent, in the order of the states and torques.
    #[must_use]
    pub fn independent_joints(&self) -> Vec<&Link> {
        let moving: Vec<&Link> = self.moving().collect();
        match &self.closure {
            None => moving,
            Some(closure) => closure.independent.iter().map(|&v| moving[v]).collect(),
        }
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
        ParameterSpace::new(self.links.iter().map(|l| (l.name.as_str(), l.rotor)))
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
