//! A program with its parameters and their names.

use roberval_mechanism::{JointKind, Mechanism};

use crate::names::identifier;
use crate::program::{Count, Program};
use crate::record::record;
use crate::what::What;

/// What code is asked for.
#[derive(Debug, Clone)]
pub struct Request<'a> {
    /// What it computes.
    pub what: What,
    /// The parameters it takes, columns of the mechanism's parameters: the base
    /// parameters, or all. Those not named count as 0.
    pub columns: &'a [usize],
    /// Columns that are known to have no effect, which the code then does not read. Not all
    /// of that shows in the recursions: it may take that `cos^2 + sin^2 = 1`.
    pub no_effect: &'a [usize],
    /// Whether tau has friction: two parameters more a joint, Fv (viscous) and Fc
    /// (Coulomb): `Fv qd + Fc sign(qd)`.
    pub friction: bool,
}

/// Why there is no such code.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CodeError {
    /// Friction was asked of something else than tau.
    #[error("friction is a part of tau only, not of {}", .0.name())]
    Friction(What),
}

/// Straight-line code of one model of a robot.
#[derive(Debug, Clone)]
pub struct Code {
    /// What it computes.
    pub what: What,
    /// The robot's name as in its file.
    pub robot: String,
    /// The link that floats, if the base does: q begins with the seven coordinates of its
    /// place and attitude, qd and qdd with six, as [`roberval_regressor::States`] says.
    pub floating: Option<String>,
    /// The joint variables that it takes, the independent ones (all, if there are loops):
    /// the link that each moves, and whether by turning.
    pub joints: Vec<(String, JointKind)>,
    /// Number of independent variables m: the torques', and a floating base's six.
    pub independent: usize,
    /// Whether loops determine joint variables: then q, qd and qdd are those of all n
    /// joints, and the code takes also G (n x m, qd = G qad).
    pub loops: bool,
    /// Names of the parameters it takes, or of the columns it gives.
    pub parameters: Vec<String>,
    /// Names of the links.
    pub links: Vec<String>,
    /// What need be done once for a set of parameters, if anything.
    pub prepare: Option<Program>,
    /// What is done at every state.
    pub main: Program,
}

impl Code {
    /// The code of a mechanism.
    ///
    /// # Errors
    /// [`CodeError`] if the request makes no sense.
    pub fn new(mechanism: &Mechanism, request: &Request<'_>) -> Result<Self, CodeError> {
        let what = request.what;
        if request.friction && what != What::Tau {
            return Err(CodeError::Friction(what));
        }
        let program = record(mechanism, request);
        let (prepare, main) = match program.divided() {
            Some((prepare, main)) => (Some(prepare), main),
            None => (None, program),
        };
        let space = mechanism.parameters();
        let labels = request.columns.iter().map(|&c| space.labels()[c].clone());
        let mut parameters: Vec<String> = labels.collect();
        let moving = mechanism.links.iter().filter(|l| l.joint.has_axis());
        let moving: Vec<_> = moving.map(|l| (l.name.clone(), l.joint)).collect();
        if request.friction {
            let names = moving
                .iter()
                .flat_map(|(name, _)| ["Fv", "Fc"].map(|f| format!("{f}_{name}")));
            parameters.extend(names);
        }
        let loops = mechanism.assembly.is_some();
        let joints = match &mechanism.closure {
            Some(closure) if !loops => {
                let independent = closure.independent.iter();
                let joints = independent.filter_map(|i| i.checked_sub(mechanism.base_variables()));
                joints.map(|i| moving[i].clone()).collect()
            }
            _ => moving,
        };
        Ok(Self {
            what,
            robot: mechanism.name.clone(),
            floating: mechanism
                .is_floating()
                .then(|| mechanism.links[0].name.clone()),
            joints,
            independent: mechanism.independent(),
            loops,
            parameters,
            links: mechanism.links.iter().map(|l| l.name.clone()).collect(),
            prepare,
            main,
        })
    }

    /// The name of the function: the robot's as an identifier, and what it computes.
    #[must_use]
    pub fn function(&self) -> String {
        format!("{}_{}", identifier(&self.robot), self.what.name())
    }

    /// How many numbers q has.
    #[must_use]
    pub fn positions(&self) -> usize {
        self.joints.len() + if self.floating.is_some() { 7 } else { 0 }
    }

    /// How many numbers qd has, and qdd.
    #[must_use]
    pub fn velocities(&self) -> usize {
        self.joints.len() + if self.floating.is_some() { 6 } else { 0 }
    }

    /// The shape of the result at one state.
    #[must_use]
    pub fn shape(&self) -> Vec<usize> {
        self.what.shape(self.independent, self.parameters.len())
    }

    /// Whether it takes G: there are loops, and torques to project.
    #[must_use]
    pub fn takes_transmission(&self) -> bool {
        self.loops && self.what != What::Energy
    }

    /// The operations at every state.
    #[must_use]
    pub fn count(&self) -> Count {
        self.main.count()
    }

    /// The operations that are done once for a set of parameters.
    #[must_use]
    pub fn count_once(&self) -> Count {
        self.prepare
            .as_ref()
            .map_or_else(Count::default, Program::count)
    }

    /// The operations at every state, link by link.
    #[must_use]
    pub fn count_by_link(&self) -> Vec<Count> {
        self.main.count_by_link(self.links.len())
    }
}
