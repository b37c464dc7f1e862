//! Loops in the regressor: passive joints from the independent ones.

use std::sync::{Arc, OnceLock};

use roberval_mechanism::{
    Assembly, LinkFrame, Linkage, Mechanism, NotClosed, Pose, Walk, couple_laws,
};
use roberval_scalar::{DoubleDouble, Quantity, Real};

use crate::{JointStates, NotInField, Transmission, Tree};

/// All joints of a mechanism with loops: the configuration follows in doubles from the
/// one before, and is then closed in the numbers asked for.
#[derive(Debug, Clone)]
pub(crate) struct LoopExpansion<T> {
    assembly: Arc<Assembly>,
    linkage: Linkage<T>,
    /// Configurations on the branch from which others may be reached.
    landmarks: Arc<OnceLock<Vec<Vec<f64>>>>,
}

/// Landmarks, and how many of the nearest are tried.
const LANDMARKS: (usize, usize) = (64, 8);

/// The seed of the walk to the landmarks.
const SEED: u64 = 0x1a_4d;

impl<T: Real> LoopExpansion<T> {
    pub fn new(assembly: Arc<Assembly>, linkage: Linkage<T>) -> Self {
        Self {
            assembly,
            linkage,
            landmarks: Arc::default(),
        }
    }

    /// All that it depends on, without what it has found out since.
    pub fn description(&self) -> String
    where
        T: std::fmt::Debug,
    {
        format!("{:?} {:?}", self.assembly, self.linkage)
    }

    pub fn independent(&self) -> usize {
        self.assembly.independent.len()
    }

    pub fn states(&self) -> JointStates<T> {
        let start = &self.assembly.start;
        let zeros = vec![T::from(0.0); start.len()];
        let rows = vec![dense(&vec![T::from(0.0); self.independent()]); start.len()];
        JointStates {
            q: start.iter().map(|&q| T::from(q)).collect(),
            qd: zeros.clone(),
            qdd: zeros,
            transmission: Transmission::from_rows(rows),
        }
    }

    pub fn expand(&self, state: [&[T]; 3], states: &mut JointStates<T>) -> Result<(), NotClosed> {
        let doubles = |x: &[T]| -> Vec<f64> { x.iter().map(|x| x.to_f64()).collect() };
        let near = self.reach(&doubles(&states.q), &doubles(state[0]))?;
        let motion = self.linkage.motion(&self.assembly, &near, state)?;
        states.q = motion.q;
        states.qd = motion.qd;
        states.qdd = motion.qdd;
        for (i, row) in motion.g.iter().enumerate() {
            states.transmission.row_mut(i).copy_from_slice(row);
        }
        Ok(())
    }
}

impl<T> LoopExpansion<T> {
    /// The configuration at qa, from the last one or, where the straight way from there is
    /// barred, from another on the branch.
    fn reach(&self, last: &[f64], qa: &[f64]) -> Result<Vec<f64>, NotClosed> {
        let assembly = &*self.assembly;
        let first = match assembly.reach(last, qa) {
            Ok(reached) => return Ok(reached),
            Err(error) => error,
        };
        let landmarks = self.landmarks.get_or_init(|| {
            let mut walk = Walk::new(assembly, SEED);
            let walked = std::iter::from_fn(|| walk.next_configuration());
            let start = std::iter::once(assembly.start.clone());
            start.chain(walked).take(LANDMARKS.0).collect()
        });
        let distance = |q: &[f64]| -> f64 {
            let each = assembly.independent.iter().zip(qa);
            each.map(|(&k, x)| (q[k] - x) * (q[k] - x)).sum()
        };
        let mut nearest: Vec<(f64, &Vec<f64>)> =
            landmarks.iter().map(|q| (distance(q), q)).collect();
        nearest.sort_by(|a, b| a.0.total_cmp(&b.0));
        let nearest = nearest.iter().take(LANDMARKS.1);
        let reached = nearest.map(|(_, q)| assembly.reach(q, qa));
        reached.flatten().next().ok_or(first)
    }
}

fn dense<T: Copy>(row: &[T]) -> Vec<(usize, T)> {
    row.iter().copied().enumerate().collect()
}

/// The linkage of a mechanism in pairs of doubles: its tree, with axes of length 1, is
/// known in them, and `poses` places the frames of its loops.
pub(crate) fn precise_linkage(
    mechanism: &Mechanism,
    assembly: &Assembly,
    tree: &Tree<DoubleDouble>,
    poses: impl FnMut(&roberval_mechanism::Origin) -> Result<Pose<DoubleDouble>, NotInField>,
) -> Result<Linkage<DoubleDouble>, NotInField> {
    let constants: &[(String, Quantity)] = &mechanism.description.constants;
    let loops = mechanism.loop_frames(poses)?;
    let couples = couple_laws(mechanism.couples().as_ref(), constants);
    let links = tree.bodies.iter().map(|body| LinkFrame {
        antecedent: body.antecedent,
        joint: body.joint,
        pose: Pose {
            rotation: body.rotation,
            origin: body.origin,
        },
        axis: body.axis,
    });
    Ok(Linkage::new(
        links.collect(),
        loops,
        couples.ok_or(NotInField::Inverse)?,
        assembly.linkage.unit(),
    ))
}
