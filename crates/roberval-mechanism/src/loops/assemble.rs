//! From a mechanism with loops to its assembly.

use std::sync::Arc;

use nalgebra::{Matrix3, Vector3};

use super::{Assembly, LinkFrame, Linkage, LoopFrames, Pose, ResolvedLoop, couple_laws};
use crate::{Closure, Link, Mechanism, MechanismError, Origin, VariableLaw};

impl Mechanism {
    /// Closes the loops of the description: finds the branch, the mobility and the
    /// independent joints, driven ones before others.
    pub(crate) fn close_loops(
        &mut self,
        antecedents: &[Option<usize>],
    ) -> Result<(), MechanismError> {
        let description = &self.description;
        let resolved = ResolvedLoop::all(description, antecedents)?;
        let loops = self.resolved_frames(&resolved, |origin| pose(origin.placement()));
        let links = self.links.iter().map(link_frame).collect();
        let couples =
            couple_laws(self.closure.as_ref(), &description.constants).unwrap_or_default();
        let unit = self.unit_of_length(&loops);
        let linkage = Linkage::new(links, loops, couples, unit);
        let mut near = Vec::new();
        for (found, written) in resolved.iter().zip(&description.loops) {
            for (&link, (_, value)) in found.near.iter().zip(&written.near) {
                let variable = self.moving().position(|l| l.in_file == link);
                near.extend(variable.map(|k| (k, value.value)));
            }
        }
        let active: Vec<bool> = self.moving().map(|l| l.active).collect();
        let (mut order, passive): (Vec<usize>, Vec<usize>) =
            (0..active.len()).partition(|&k| active[k]);
        order.extend(passive);
        let assembly =
            Assembly::of(linkage, &near, &order).map_err(|error| MechanismError::Assembly {
                robot: self.name.clone(),
                error,
            })?;
        let place = |k: usize| assembly.independent.binary_search(&k);
        let law = |k: usize| place(k).map_or(VariableLaw::Implicit, VariableLaw::Independent);
        self.closure = Some(Closure {
            laws: (0..active.len()).map(law).collect(),
            independent: assembly.independent.clone(),
            formulas: Vec::new(),
        });
        self.assembly = Some(Arc::new(assembly));
        Ok(())
    }

    /// The frames of the description's loops, `place` turning what is written into poses.
    ///
    /// # Panics
    /// Never on a valid mechanism: its loops have been resolved before.
    pub fn loop_frames<T, E>(
        &self,
        mut place: impl FnMut(&Origin) -> Result<Pose<T>, E>,
    ) -> Result<Vec<LoopFrames<T>>, E> {
        let antecedents = self.description.antecedents().unwrap_or_default();
        let resolved = ResolvedLoop::all(&self.description, &antecedents).unwrap_or_default();
        let mut poses = Vec::new();
        for written in &self.description.loops {
            let [a, b] = &written.frames;
            poses.extend([place(a)?, place(b)?]);
        }
        let mut poses = poses.into_iter();
        Ok(self.resolved_frames(&resolved, |_| poses.next().expect("two poses a loop")))
    }

    fn resolved_frames<T>(
        &self,
        resolved: &[ResolvedLoop],
        mut place: impl FnMut(&Origin) -> Pose<T>,
    ) -> Vec<LoopFrames<T>> {
        let index =
            |link: Option<usize>| link.and_then(|l| self.links.iter().position(|k| k.in_file == l));
        let each = resolved.iter().zip(&self.description.loops);
        each.map(|(found, written)| LoopFrames {
            links: found.links.map(index),
            poses: written.frames.each_ref().map(&mut place),
            cut: written.cut,
        })
        .collect()
    }

    /// A power of two next to the robot's length.
    fn unit_of_length(&self, loops: &[LoopFrames<f64>]) -> f64 {
        let lengths = loops.iter().flat_map(|l| &l.poses);
        let lengths = lengths.map(|p| Vector3::from(p.origin).norm());
        let links = self.links.iter().map(|l| l.origin.norm());
        let largest = lengths.chain(links).fold(0.0, f64::max);
        if largest > 0.0 {
            largest.log2().round().exp2()
        } else {
            1.0
        }
    }
}

fn pose((rotation, origin): (Matrix3<f64>, Vector3<f64>)) -> Pose<f64> {
    Pose {
        rotation: std::array::from_fn(|i| std::array::from_fn(|j| rotation[(i, j)])),
        origin: origin.into(),
    }
}

fn link_frame(link: &Link) -> LinkFrame<f64> {
    LinkFrame {
        antecedent: link.antecedent,
        joint: link.joint,
        pose: pose((link.rotation, link.origin)),
        axis: link.axis.into(),
    }
}
