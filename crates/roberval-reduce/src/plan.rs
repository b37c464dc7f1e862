//! Where the recursion's numbers go in a tile: made once for a robot and a choice of
//! columns.

use roberval_regressor::{Model, Regressor};
use roberval_scalar::Width;

use crate::layout::{Layout, Segment};

/// Lane vectors of a row in a tile: enough to pay for reading R.
pub(crate) const GROUPS: usize = 8;

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
    /// The places of the ten columns of each link on each row, in the recursion's order.
    pub links: Vec<[u32; 10]>,
    /// The place of each link's Ia.
    pub rotors: Vec<u32>,
    /// The places of viscous, Coulomb and offset of each joint.
    pub friction: Vec<[u32; 3]>,
    /// The place of each joint's torque.
    pub right: Vec<u32>,
    /// All places of each row.
    pub rows: Vec<Vec<u32>>,
    /// Number of columns P, without the right-hand side.
    pub columns: usize,
}

impl Plan {
    pub(crate) fn new(regressor: &Regressor, columns: &[usize], friction: Friction) -> Self {
        let n = regressor.dof();
        let entries = regressor.packed_layout(Model::D).entries();
        let mut rows: Vec<Vec<usize>> = vec![Vec::new(); columns.len()];
        let mut ids = vec![None; regressor.parameters().len()];
        for (id, &column) in columns.iter().enumerate() {
            ids[column] = Some(id);
        }
        for &(row, column) in entries {
            if let Some(id) = ids[column] {
                rows[id].push(row);
            }
        }
        let kinds = [friction.viscous, friction.coulomb, friction.offset];
        let mut first_of_kind = [None; 3];
        for (first, wanted) in first_of_kind.iter_mut().zip(kinds) {
            if wanted {
                *first = Some(rows.len());
                rows.extend((0..n).map(|j| vec![j]));
            }
        }
        let right = rows.len();
        rows.push((0..n).collect());
        let layout = Layout::new(n, &rows, GROUPS);
        let places = Places::new(&layout, right + 1, n);
        let mut plan = Self {
            triangles: layout.segments.iter().map(Segment::triangle).collect(),
            groups: GROUPS,
            width: regressor.width(),
            tile: places.trash as usize,
            links: Vec::new(),
            rotors: Vec::new(),
            friction: (0..n)
                .map(|j| first_of_kind.map(|first| places.of(first.map(|first| first + j), j)))
                .collect(),
            right: (0..n).map(|j| places.of(Some(right), j)).collect(),
            rows: places.rows(),
            columns: right,
            layout,
        };
        plan.take(regressor, entries, &ids, &places);
        plan
    }

    /// Sorts the packed entries into tens and rotors.
    fn take(
        &mut self,
        regressor: &Regressor,
        entries: &[(usize, usize)],
        ids: &[Option<usize>],
        places: &Places,
    ) {
        let space = regressor.parameters();
        let mut at = 0;
        while let Some(&(row, column)) = entries.get(at) {
            let link = space.ids()[column].link;
            if space.rotor_column(link) == Some(column) {
                self.rotors.push(places.of(ids[column], row));
                at += 1;
                continue;
            }
            self.links
                .push(std::array::from_fn(|k| places.of(ids[column + k], row)));
            at += 10;
        }
    }

    /// Samples in a tile.
    pub(crate) fn samples(&self) -> usize {
        self.groups * self.width.lanes()
    }

    /// Numbers of the lane factors of all segments.
    pub(crate) fn factor(&self) -> usize {
        let vectors: usize = self.layout.segments.iter().map(Segment::factor).sum();
        vectors * self.width.lanes()
    }

    /// Tiles of a block: each block has factors of its own, which are merged in a fixed
    /// order. Long enough for merges not to matter.
    pub(crate) fn block(&self) -> usize {
        let samples = (256 * self.columns).next_power_of_two().max(1 << 15);
        samples / self.samples()
    }
}

/// The place of each column on each row.
struct Places {
    table: Vec<u32>,
    n: usize,
    trash: u32,
}

impl Places {
    fn new(layout: &Layout, columns: usize, n: usize) -> Self {
        let all: usize = layout.segments.iter().map(Segment::tile).sum();
        let trash = all as u32;
        let mut table = vec![trash; columns * n];
        let mut start = 0;
        for (segment, rows) in layout.segments.iter().zip(&layout.rows) {
            for shape in &segment.columns {
                let first = shape.begin / GROUPS;
                for k in 0..shape.rows / GROUPS {
                    let place = start + shape.offset + k * GROUPS;
                    table[shape.id * n + rows[first + k]] = place as u32;
                }
            }
            start += segment.tile();
        }
        Self { table, n, trash }
    }

    fn of(&self, column: Option<usize>, row: usize) -> u32 {
        column.map_or(self.trash, |column| self.table[column * self.n + row])
    }

    fn rows(&self) -> Vec<Vec<u32>> {
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
