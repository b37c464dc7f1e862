//! Loops in the regressor: passive joints from the independent ones.

use std::sync::Arc;

use roberval_mechanism::{Assembly, LinkFrame, Linkage, Mechanism, NotClosed, Pose, couple_laws};
use roberval_scalar::{DoubleDouble, Quantity, Real};

use crate::{JointStates, NotInField, Transmission, Tree};

/// All joints of a mechanism with loops: the configuration follows in doubles from the
/// one before, and is then closed in the numbers asked for.
#[derive(Debug, Clone)]
pub(crate) struct LoopExpansion<T> {
    assembly: Arc<Assembly>,
    linkage: Linkage<T>,
}

impl<T: Real> LoopExpansion<T> {
    pub fn new(assembly: Arc<Assembly>, linkage: Linkage<T>) -> Self {
        Self { assembly, linkage }
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
        let near = self
            .assembly
            .reach(&doubles(&states.q), &doubles(state[0]))?;
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
