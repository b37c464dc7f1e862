//! Loops in the regressor: passive joints from the independent ones.

use std::sync::{Arc, OnceLock};

use roberval_mechanism::{Assembly, Linkage, Mechanism, NotClosed, Pose, Walk, couple_laws};
use roberval_scalar::{Quantity, Real};

use crate::exact::link_frames;
use crate::{JointStates, NotInField, Transmission, Tree};

/// All joints of a mechanism with loops: the configuration follows in doubles from the
/// one before, and is then closed in the numbers asked for.
#[derive(Debug, Clone)]
pub(crate) struct LoopExpansion<T> {
    assembly: Arc<Assembly>,
    linkage: Linkage<T>,
    /// Variables of a base that floats, which stand before those of joints.
    first: usize,
    /// Configurations on the branch from which others may be reached.
    landmarks: Arc<OnceLock<Vec<Vec<f64>>>>,
}

/// Tried from the nearest on. The straight way from the start is often barred: rods of a
/// Delta robot need some dozens to be reached wherever its arms lead them.
const LANDMARKS: usize = 256;

/// The seed of the walk to the landmarks.
const SEED: u64 = 0x1a_4d;

impl<T: Real> LoopExpansion<T> {
    pub fn new(assembly: Arc<Assembly>, linkage: Linkage<T>, first: usize) -> Self {
        Self {
            assembly,
            first,
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
        self.first + self.assembly.independent.len()
    }

    pub fn states(&self) -> JointStates<T> {
        let start = &self.assembly.start;
        let zeros = vec![T::from(0.0); self.first + start.len()];
        let base = (0..self.first).map(|i| vec![(i, T::from(1.0))]);
        let places = self.first..self.independent();
        let row: Vec<(usize, T)> = places.map(|place| (place, T::from(0.0))).collect();
        let rows = base.chain(vec![row; start.len()]);
        let still = vec![0.0; self.first];
        JointStates {
            q: still.iter().chain(start).map(|&q| T::from(q)).collect(),
            qd: zeros.clone(),
            qdd: zeros,
            transmission: Transmission::from_rows(rows),
        }
    }

    pub fn expand(&self, state: [&[T]; 3], states: &mut JointStates<T>) -> Result<(), NotClosed> {
        let doubles = |x: &[T]| -> Vec<f64> { x.iter().map(|x| x.to_f64()).collect() };
        let first = self.first;
        let joints = state.map(|x| &x[first..]);
        let near = self.reach(&doubles(&states.q[first..]), &doubles(joints[0]))?;
        let motion = self.linkage.motion(&self.assembly, &near, joints)?;
        let all = [&mut states.q, &mut states.qd, &mut states.qdd];
        let of_joints = [motion.q, motion.qd, motion.qdd];
        for ((all, base), of_joints) in all.into_iter().zip(state).zip(of_joints) {
            all[..first].copy_from_slice(&base[..first]);
            all[first..].copy_from_slice(&of_joints);
        }
        for (i, row) in motion.g.iter().enumerate() {
            states.transmission.row_mut(first + i).copy_from_slice(row);
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
            start.chain(walked).take(LANDMARKS).collect()
        });
        let distance = |q: &[f64]| -> f64 {
            let each = assembly.independent.iter().zip(qa);
            each.map(|(&k, x)| (q[k] - x) * (q[k] - x)).sum()
        };
        let mut nearest: Vec<(f64, &Vec<f64>)> =
            landmarks.iter().map(|q| (distance(q), q)).collect();
        nearest.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut reached = nearest.iter().map(|(_, q)| assembly.reach(q, qa));
        reached.find_map(Result::ok).ok_or(first)
    }
}

/// The linkage of a mechanism in numbers of any precision: its tree, with axes of length
/// 1, is known in them, and `poses` places the frames of its loops.
pub(crate) fn precise_linkage<T: Real>(
    mechanism: &Mechanism,
    assembly: &Assembly,
    tree: &Tree<T>,
    poses: impl FnMut(&roberval_mechanism::Origin) -> Result<Pose<T>, NotInField>,
) -> Result<Linkage<T>, NotInField> {
    let constants: &[(String, Quantity)] = &mechanism.description.constants;
    let loops = mechanism.loop_frames(poses)?;
    let couples = couple_laws(
        mechanism.couples().as_ref(),
        mechanism.base_variables(),
        constants,
    );
    Ok(Linkage::new(
        link_frames(tree),
        loops,
        couples.ok_or(NotInField::Inverse)?,
        assembly.linkage.unit(),
    ))
}
