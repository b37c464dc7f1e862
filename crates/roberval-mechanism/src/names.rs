//! What the coordinates of a robot are called.

use crate::{JointKind, Link, Mechanism};

/// The position of a floating base and its attitude, a quaternion whose last number is real.
const POSITIONS: [&str; 7] = ["x", "y", "z", "qx", "qy", "qz", "qw"];
/// Its velocities.
const VELOCITIES: [&str; 6] = ["vx", "vy", "vz", "wx", "wy", "wz"];
/// The forces and moments on it.
const FORCES: [&str; 6] = ["fx", "fy", "fz", "mx", "my", "mz"];

impl Mechanism {
    /// The independent coordinates of q: a joint's name (its link's where it has none); a floating
    /// link L has `L.x L.y L.z L.qx L.qy L.qz L.qw`.
    #[must_use]
    pub fn position_names(&self) -> Vec<String> {
        self.coordinates(&POSITIONS)
    }

    /// The coordinates of qd and qdd: those of q, a floating link's `L.vx .. L.wz`.
    #[must_use]
    pub fn velocity_names(&self) -> Vec<String> {
        self.coordinates(&VELOCITIES)
    }

    /// The rows of d: the joints, and a floating link's wrench `L.fx .. L.mz`.
    #[must_use]
    pub fn row_names(&self) -> Vec<String> {
        self.coordinates(&FORCES)
    }

    /// The titles of the columns of a table of states, for q, qd and qdd: `q_1`, or by name
    /// `q_L.x` for a floating robot, whose links may have numbers for names.
    #[must_use]
    pub fn state_titles(&self) -> [Vec<String>; 3] {
        let names = [
            self.position_names(),
            self.velocity_names(),
            self.velocity_names(),
        ];
        let mut array = ["q", "qd", "qdd"].into_iter();
        names.map(|names| {
            let array = array.next().unwrap_or_default();
            let title = |(number, name): (usize, String)| match self.is_floating() {
                true => format!("{array}_{name}"),
                false => format!("{array}_{number}"),
            };
            (1..).zip(names).map(title).collect()
        })
    }

    fn coordinates(&self, of_floating: &[&str]) -> Vec<String> {
        let floating = self.links.iter().filter(|l| l.joint == JointKind::Floating);
        let base =
            floating.flat_map(|l| of_floating.iter().map(move |x| format!("{}.{x}", l.name)));
        let joints = self.independent_joints().into_iter();
        let joints = joints.filter(|l| l.joint.has_axis());
        let name = |l: &Link| l.joint_name.as_ref().unwrap_or(&l.name).clone();
        base.chain(joints.map(name)).collect()
    }
}
