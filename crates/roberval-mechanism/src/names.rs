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

    /// The titles of the columns of a table of states, for q, qd and qdd.
    #[must_use]
    pub fn state_titles(&self) -> [Vec<String>; 3] {
        ["q", "qd", "qdd"].map(|array| self.column_titles(array))
    }

    /// The titles of an array's columns: `q_1`, or by name `q_L.x` for a floating robot, and
    /// where a joint or link has the number of another joint for its name.
    #[must_use]
    pub fn column_titles(&self, array: &str) -> Vec<String> {
        let by_name = self.is_floating() || self.has_misleading_names();
        let title = |(number, name): (usize, String)| match by_name {
            true => format!("{array}_{name}"),
            false => format!("{array}_{number}"),
        };
        (1..).zip(self.column_names(array)).map(title).collect()
    }

    /// The coordinates of an array: of q, of qd and qdd, or of what has a number a row of d.
    #[must_use]
    pub fn column_names(&self, array: &str) -> Vec<String> {
        match array {
            "q" => self.position_names(),
            "qd" | "qdd" => self.velocity_names(),
            _ => self.row_names(),
        }
    }

    /// Whether a joint's or a link's name is the number of another joint.
    fn has_misleading_names(&self) -> bool {
        let joints = self.independent_joints();
        let numbers: Vec<String> = (1..=joints.len()).map(|j| j.to_string()).collect();
        joints.iter().zip(&numbers).any(|(link, own)| {
            let misleads = |name: &String| name != own && numbers.contains(name);
            misleads(&link.name) || link.joint_name.as_ref().is_some_and(misleads)
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
