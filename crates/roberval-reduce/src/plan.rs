//! Where the recursion's numbers go in a tile: made once for a robot and a choice of
//! columns.

use roberval_regressor::Regressor;
use roberval_scalar::Width;

use crate::layout::{Layout, Segment};

/// Lane vectors of a row in a tile: enough to pay for reading R.
pub(crate) const GROUPS: usize = 16;

/// Independent factors that rows are dealt out to in turn, one a lane of the widest
/// processor. Narrower ones take some after the others: the numbers are the same.
pub(crate) const LEAVES: usize = 8;

/// Columns for friction, one a joint each, after those of the robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Friction {
    /// Torque proportional to qd.
    pub viscous: bool,
    /// Torque of the sign of qd (none at rest).
    pub coulomb: bool,
    /// Constant torque.
    pub offset: bool,
}

impl Friction {
    /// The names of the kinds of columns there are.
    #[must_use]
    pub fn names(self) -> Vec<&'static str> {
        let all = [
            (self.viscous, "viscous"),
            (self.coulomb, "coulomb"),
            (self.offset, "offset"),
        ];
        all.into_iter().filter(|k| k.0).map(|k| k.1).collect()
    }
}

/// Everything about tiles that does not depend on the samples.
#[derive(Debug, Clone)]
pub(crate) struct Plan {
    pub layout: Layout,
    /// The layouts in which factors are merged.
    pub triangles: Vec<Segment>,
    pub groups: usize,
    pub width: Width,
    /// Lane vectors of all segments' tiles; one more place takes what nobody asked for.
    pub tile: usize,
    /// Where each of the packed numbers goes, group after group.
    slots: Vec<u32>,
    /// Whether there are places that no number goes to: zeros.
    pub holes: bool,
    /// Whether there is friction.
    pub rubs: bool,
    /// The places of viscous, Coulomb and offset of each joint.
    pub friction: Vec<[Place; 3]>,
    /// The place of each joint's torque.
    pub right: Vec<Place>,
    /// All places of each row.
    pub rows: Vec<Vec<Place>>,
    /// Number of columns P, without the right-hand side.
    pub columns: usize,
    /// Coordinates of q, and rows of a sample.
    pub widths: [usize; 2],
}

impl Plan {
    pub(crate) fn new(regressor: &Regressor, columns: &[usize], friction: Friction) -> Self {
        let n = regressor.independent();
        // Nothing rubs where a robot floats.
        let first_joint = if regressor.tree().is_floating() { 6 } else { 0 };
        let entries = regressor.tile_entries();
        let mut rows: Vec<Vec<usize>> = vec![Vec::new(); columns.len()];
        let mut ids = vec![None; regressor.parameters().len()];
        for (id, &column) in columns.iter().enumerate() {
            ids[column] = Some(id);
        }
        for &(row, column) in &entries {
            if let Some(id) = ids[column] {
                rows[id].push(row);
            }
        }
        let kinds = [friction.viscous, friction.coulomb, friction.offset];
        let rubs = kinds.contains(&true);
        let mut first_of_kind = [None; 3];
        for (first, wanted) in first_of_kind.iter_mut().zip(kinds) {
            if wanted {
                *first = Some(rows.len());
                rows.extend((first_joint..n).map(|j| vec![j]));
            }
        }
        let right = rows.len();
        rows.push((0..n).collect());
        let layout = Layout::new(n, &rows, GROUPS);
        let places = Places::new(&layout, right + 1, n);
        let friction = (0..n).map(|j| {
            let at = j.checked_sub(first_joint);
            first_of_kind.map(|first| places.of(first.zip(at).map(|(first, at)| first + at), j))
        });
        Self {
            triangles: layout.segments.iter().map(Segment::triangle).collect(),
            groups: GROUPS,
            width: regressor.width(),
            tile: places.trash.of(0),
            slots: (0..GROUPS)
                .flat_map(|group| {
                    let place = |&(row, column)| places.of(ids[column], row).of(group) as u32;
                    entries.iter().map(place).collect::<Vec<_>>()
                })
                .collect(),
            holes: layout.is_full(),
            rubs,
            friction: friction.collect(),
            right: (0..n).map(|j| places.of(Some(right), j)).collect(),
            rows: places.rows(),
            columns: right,
            widths: [regressor.positions(), n],
            layout,
        }
    }

    /// Rows of a sample.
    pub(crate) fn n(&self) -> usize {
        self.widths[1]
    }

    /// Where the packed numbers of a group go.
    #[inline(always)]
    pub(crate) fn slots(&self, group: usize) -> &[u32] {
        let count = self.slots.len() / self.groups;
        &self.slots[group * count..][..count]
    }

    /// Samples in a tile.
    pub(crate) fn samples(&self) -> usize {
        self.groups * LEAVES
    }

    /// Numbers of the leaves' factors of all segments.
    pub(crate) fn factor(&self) -> usize {
        let vectors: usize = self.layout.segments.iter().map(Segment::factor).sum();
        vectors * LEAVES
    }

    /// Tiles of a block: each block has factors of its own, which are merged in a fixed
    /// order. Long enough for merges not to matter.
    pub(crate) fn block(&self) -> usize {
        let samples = (256 * self.columns).next_power_of_two().max(1 << 15);
        samples / self.samples()
    }
}

/// Where a column's numbers on a row are in the tile: one lane vector a group.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Place {
    first: u32,
    stride: u32,
}

impl Place {
    /// The place of a group.
    #[inline(always)]
    pub(crate) fn of(self, group: usize) -> usize {
        self.first as usize + group * self.stride as usize
    }
}

/// The place of each column on each row.
struct Places {
    table: Vec<Place>,
    n: usize,
    trash: Place,
}

impl Places {
    fn new(layout: &Layout, columns: usize, n: usize) -> Self {
        let all: usize = layout.segments.iter().map(Segment::tile).sum();
        let trash = Place {
            first: all as u32,
            stride: 0,
        };
        let mut table = vec![trash; columns * n];
        let mut start = 0;
        for (segment, rows) in layout.segments.iter().zip(&layout.rows) {
            for shape in &segment.columns {
                let first = shape.begin / GROUPS;
                for k in 0..shape.rows / GROUPS {
                    table[shape.id * n + rows[first + k]] = Place {
                        first: (start + shape.offset + k * GROUPS * shape.stride) as u32,
                        stride: shape.stride as u32,
                    };
                }
            }
            start += segment.tile();
        }
        Self { table, n, trash }
    }

    fn of(&self, column: Option<usize>, row: usize) -> Place {
        column.map_or(self.trash, |column| self.table[column * self.n + row])
    }

    fn rows(&self) -> Vec<Vec<Place>> {
        let inside = |row: usize| {
            let places = self.table.iter().skip(row).step_by(self.n);
            places
                .copied()
                .filter(|&place| place != self.trash)
                .collect()
        };
        (0..self.n).map(inside).collect()
    }
}

#[cfg(test)]
mod tests {
    use roberval_mechanism::Mechanism;
    use roberval_testkit::Family;

    use super::*;

    #[test]
    fn trees_with_sliders_and_floating_bases_have_no_holes_in_their_columns() {
        let mut sliders = 0;
        for seed in 0..60 {
            let robot = Family::default().robot(seed);
            for robot in [robot.clone().with_floating_base(), robot] {
                let robot = Mechanism::new(&robot).expect("valid");
                let regressor = Regressor::new(&robot);
                sliders += regressor
                    .tree()
                    .bodies
                    .iter()
                    .filter(|body| body.joint == roberval_mechanism::JointKind::Prismatic)
                    .count();
                let columns: Vec<usize> = (0..regressor.parameters().len()).collect();
                let plan = Plan::new(&regressor, &columns, Friction::default());
                assert!(!plan.holes, "robot {seed}");
            }
        }
        assert!(sliders > 0, "no robot has a slider");
    }
}
