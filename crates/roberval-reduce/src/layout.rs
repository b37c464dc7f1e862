//! Which columns a row can have, so that zeros are neither stored nor computed.
//!
//! Row i of a sample has entries in the columns of the links that joint i carries. The
//! rows are cut into segments, chains of joints without a branch, each with a triangular
//! factor of its own over the columns of all links beyond. Within a segment a link's
//! column has entries on the rows from the segment's first joint to the link's, and a
//! column of one joint alone (Ia, friction) on that joint's row only: such columns come
//! first, because their reflectors then meet no other row.

use crate::annihilate::PANEL;

/// A column of a segment's tile.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Shape {
    /// Which column of the whole matrix.
    pub id: usize,
    /// Its first row in the segment, and how many rows it has.
    pub begin: usize,
    pub rows: usize,
    /// Where its first row is in the tile, and how far its rows are apart.
    pub offset: usize,
    pub stride: usize,
}

/// Consecutive columns with the same rows. They lie in the tile row by row: a row of the
/// panel is `count` numbers side by side.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Panel {
    /// The first one's index in the segment.
    pub first: usize,
    pub count: usize,
    pub begin: usize,
    pub rows: usize,
    /// Where it is in the tile.
    pub offset: usize,
    /// The later panels that have the panel's rows (the others have none of them).
    pub targets: Vec<Target>,
}

/// What the reflectors of a panel are applied to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Target {
    /// The panel's first column in the segment, and how many it has.
    pub first: usize,
    pub count: usize,
    /// Where the rows in common are in the tile.
    pub offset: usize,
}

impl Panel {
    /// Where the panel ends in the tile.
    pub(crate) fn end(&self) -> usize {
        self.offset + self.rows * self.count
    }

    /// What an earlier panel does to this one.
    fn target_of(&self, earlier: &Self) -> Option<Target> {
        let inside =
            self.begin <= earlier.begin && earlier.begin + earlier.rows <= self.begin + self.rows;
        inside.then(|| Target {
            first: self.first,
            count: self.count,
            offset: self.offset + (earlier.begin - self.begin) * self.count,
        })
    }
}

/// Rows that share a triangular factor.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Segment {
    /// The columns in the order of elimination.
    pub columns: Vec<Shape>,
    pub panels: Vec<Panel>,
}

impl Segment {
    /// A segment of columns (id, first row, rows). Columns with the same rows must follow
    /// each other.
    pub(crate) fn new(columns: impl IntoIterator<Item = (usize, usize, usize)>) -> Self {
        let columns: Vec<(usize, usize, usize)> = columns.into_iter().collect();
        let mut segment = Self {
            columns: Vec::with_capacity(columns.len()),
            panels: Vec::new(),
        };
        for alike in columns.chunk_by(|a, b| (a.1, a.2) == (b.1, b.2)) {
            // As few panels as there can be, and as equal: 5 columns are 3 and 2.
            let panels = alike.len().div_ceil(PANEL);
            let mut rest = alike;
            for panel in 0..panels {
                let (of_panel, others) = rest.split_at(rest.len().div_ceil(panels - panel));
                segment.push(of_panel);
                rest = others;
            }
        }
        segment.aim();
        segment
    }

    /// Appends a panel of columns with the same rows.
    fn push(&mut self, columns: &[(usize, usize, usize)]) {
        let (_, begin, rows) = columns[0];
        let (first, offset, count) = (self.columns.len(), self.tile(), columns.len());
        for (k, &(id, ..)) in columns.iter().enumerate() {
            self.columns.push(Shape {
                id,
                begin,
                rows,
                offset: offset + k,
                stride: count,
            });
        }
        self.panels.push(Panel {
            first,
            count,
            begin,
            rows,
            offset,
            targets: Vec::new(),
        });
    }

    /// Finds each panel's targets.
    fn aim(&mut self) {
        for p in 0..self.panels.len() {
            let (earlier, later) = self.panels.split_at_mut(p + 1);
            let panel = &mut earlier[p];
            let targets = later.iter().filter_map(|other| other.target_of(panel));
            panel.targets = targets.collect();
        }
    }

    /// Numbers of a tile.
    pub(crate) fn tile(&self) -> usize {
        self.panels.last().map_or(0, Panel::end)
    }

    /// Where row k of the packed triangular factor begins, with its diagonal.
    #[inline(always)]
    pub(crate) fn row(&self, k: usize) -> usize {
        let n = self.columns.len();
        k * n - k * (k.max(1) - 1) / 2
    }

    /// Numbers of the factor.
    pub(crate) fn factor(&self) -> usize {
        self.row(self.columns.len())
    }

    /// The layout in which another factor of this segment is annihilated as a tile: its
    /// rows are a triangle, in steps of a panel.
    pub(crate) fn triangle(&self) -> Self {
        let n = self.columns.len();
        let rows = |column: usize| ((column / PANEL + 1) * PANEL).min(n);
        let columns = self.columns.iter().enumerate();
        Self::new(columns.map(|(column, shape)| (shape.id, 0, rows(column))))
    }
}

/// The segments of a mechanism's rows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Layout {
    pub segments: Vec<Segment>,
    /// The rows of each segment, from the base.
    pub rows: Vec<Vec<usize>>,
    /// Whether columns have room on rows where they have no entry.
    full: bool,
}

impl Layout {
    /// The layout of columns with entries on the rows listed, `groups` lane vectors a row.
    /// The last column is the right-hand side, which every row has.
    pub(crate) fn new(dof: usize, columns: &[Vec<usize>], groups: usize) -> Self {
        let parents = parents(dof, columns);
        let (left, _) = columns.split_at(columns.len() - 1);
        if !left
            .iter()
            .all(|rows| rows.len() < 2 || is_path(rows, &parents))
        {
            // Rows of another structure, as constraints make them: all are full.
            let full = (0..columns.len()).map(|id| (id, 0, dof * groups));
            return Self {
                segments: vec![Segment::new(full)],
                rows: vec![(0..dof).collect()],
                full: true,
            };
        }
        let chains = chains(dof, &parents);
        let segments = chains
            .iter()
            .map(|chain| Segment::new(shapes(chain, columns, groups)))
            .collect();
        Self {
            segments,
            rows: chains,
            full: false,
        }
    }

    /// Whether columns have room on rows where they have no entry, which must be kept zero.
    pub(crate) fn is_full(&self) -> bool {
        self.full
    }
}

/// Whether the rows are those from the base to the last of them.
fn is_path(rows: &[usize], parents: &[Option<usize>]) -> bool {
    parents[rows[0]].is_none()
        && rows
            .windows(2)
            .all(|pair| parents[pair[1]] == Some(pair[0]))
}

/// The columns of a chain's segment: those of one row alone, then by their last row, then
/// the right-hand side.
fn shapes(
    chain: &[usize],
    columns: &[Vec<usize>],
    groups: usize,
) -> impl Iterator<Item = (usize, usize, usize)> {
    let mut shapes: Vec<(bool, usize, usize, usize)> = Vec::new();
    let right = columns.len() - 1;
    for (id, rows) in columns.iter().enumerate() {
        let inside = |row: &&usize| chain.contains(row);
        let places: Vec<usize> = rows
            .iter()
            .filter(inside)
            .filter_map(|row| chain.iter().position(|r| r == row))
            .collect();
        let (Some(&low), Some(&high)) = (places.iter().min(), places.iter().max()) else {
            continue;
        };
        if id == right {
            continue;
        }
        let alone = low == high && rows.len() == 1 && low > 0;
        shapes.push((!alone, if alone { low } else { high }, low, id));
    }
    // Columns of one row alone come first; of the others those with fewer rows.
    shapes.sort_unstable();
    shapes.push((true, chain.len() - 1, 0, right));
    shapes.into_iter().map(move |(prefix, high, low, id)| {
        let begin = if prefix { 0 } else { low };
        (id, begin * groups, (high + 1 - begin) * groups)
    })
}

/// Cuts the rows into chains: a row goes on with the one before it unless others do too.
fn chains(dof: usize, parents: &[Option<usize>]) -> Vec<Vec<usize>> {
    let mut chains: Vec<Vec<usize>> = Vec::new();
    for row in 0..dof {
        let only = |parent: usize| parents.iter().filter(|p| **p == Some(parent)).count() == 1;
        let chain = parents[row]
            .filter(|&parent| only(parent))
            .and_then(|parent| chains.iter_mut().find(|c| c.last() == Some(&parent)));
        match chain {
            Some(chain) => chain.push(row),
            None => chains.push(vec![row]),
        }
    }
    chains
}

/// The joint that carries each joint: the row before it on the paths of its columns.
fn parents(dof: usize, columns: &[Vec<usize>]) -> Vec<Option<usize>> {
    let mut parents = vec![None; dof];
    for rows in &columns[..columns.len() - 1] {
        for pair in rows.windows(2) {
            parents[pair[1]] = Some(pair[0]);
        }
    }
    parents
}
