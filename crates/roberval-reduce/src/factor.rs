//! The R factor of least squares, in the user's order of columns.

use roberval_scalar::{Lanes, Task, dispatch_one};

use crate::annihilate::annihilate;
use crate::layout::Segment;
use crate::plan::{LEAVES, Plan};
use crate::tiles::spread;

/// A diagonal entry below this many eps of its column's norm leaves a coefficient
/// undetermined: rounding of the factorisation alone could have made it.
const UNDETERMINED: f64 = 64.0;

/// The triangular factor of `[W tau]`: all that least squares needs of the samples.
///
/// `R` is P x P with nonnegative diagonal, `Q'tau` has P entries and the norm of the
/// residual is the last diagonal entry.
#[derive(Debug, Clone, PartialEq)]
pub struct Factor {
    columns: usize,
    /// Packed rows of the (P+1) x (P+1) triangle.
    r: Vec<f64>,
    samples: u64,
}

/// The columns of W do not determine all coefficients.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Unsolvable {
    /// A column has only zeros.
    #[error("column {column} is zero in all these data")]
    Zero {
        /// The first such column, from 0.
        column: usize,
    },
    /// The data do not tell a column from those before it.
    #[error("column {column} depends on the columns before it in these data")]
    Undetermined {
        /// The first such column, from 0.
        column: usize,
    },
    /// The squares of the samples are beyond floats.
    #[error(
        "column {column} of R is no number: squares of samples or weights overflowed, start anew with data in other units"
    )]
    Overflow {
        /// The first such column, from 0; the one after the last is the torque's.
        column: usize,
    },
}

impl Factor {
    /// The factor of no samples.
    pub(crate) fn empty(columns: usize) -> Self {
        Self {
            columns,
            r: vec![0.0; whole(columns, 0).factor()],
            samples: 0,
        }
    }

    pub(crate) fn from_parts(columns: usize, r: Vec<f64>, samples: u64) -> Option<Self> {
        (r.len() == whole(columns, 0).factor()).then_some(Self {
            columns,
            r,
            samples,
        })
    }

    /// The factor of all rows from the lane factors of all segments.
    pub(crate) fn of_lanes(plan: &Plan, lanes: &[f64], samples: u64) -> Self {
        let mut r = dispatch_one(Gather { plan, lanes });
        normalise(plan.columns, &mut r);
        Self {
            columns: plan.columns,
            r,
            samples,
        }
    }

    /// Number of columns P, without the right-hand side.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Number of samples N.
    #[must_use]
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// The packed rows of the (P+1) x (P+1) triangle, Q'tau in its last column.
    #[must_use]
    pub fn packed(&self) -> &[f64] {
        &self.r
    }

    /// Entry (i, j) of the (P+1) x (P+1) triangle.
    ///
    /// # Panics
    /// If there is no such entry.
    #[must_use]
    pub fn entry(&self, i: usize, j: usize) -> f64 {
        assert!(
            i <= self.columns && j <= self.columns,
            "no entry ({i}, {j})"
        );
        if i > j {
            return 0.0;
        }
        let n = self.columns + 1;
        self.r[i * n - i * (i.max(1) - 1) / 2 + j - i]
    }

    /// The norm of tau - W x at the least-squares x.
    #[must_use]
    pub fn residual_norm(&self) -> f64 {
        self.entry(self.columns, self.columns)
    }

    /// The factor of these samples and others: the same as that of all samples at once.
    /// The order matters for the last bits.
    ///
    /// # Panics
    /// If the columns are not as many.
    #[must_use]
    pub fn merge(&self, other: &Self) -> Self {
        assert_eq!(self.columns, other.columns, "factors of the same columns");
        let mut r = self.r.clone();
        dispatch_one(MergeOne {
            triangle: whole(self.columns, 0).triangle(),
            r: &mut r,
            later: &other.r,
        });
        normalise(self.columns, &mut r);
        Self {
            columns: self.columns,
            r,
            samples: self.samples + other.samples,
        }
    }

    /// The coefficients x that make the norm of tau - W x smallest: P numbers.
    ///
    /// # Errors
    /// [`Unsolvable`] names the first column that is zero, depends on those before it or
    /// overflowed.
    pub fn solve(&self) -> Result<Vec<f64>, Unsolvable> {
        let p = self.columns;
        let finite = |&column: &usize| (0..=column).all(|i| self.entry(i, column).is_finite());
        if let Some(column) = (0..=p).find(|column| !finite(column)) {
            return Err(Unsolvable::Overflow { column });
        }
        for column in 0..p {
            let squares = (0..=column).map(|i| self.entry(i, column).powi(2));
            let norm = squares.sum::<f64>().sqrt();
            if norm == 0.0 {
                return Err(Unsolvable::Zero { column });
            }
            if self.entry(column, column) <= UNDETERMINED * f64::EPSILON * norm {
                return Err(Unsolvable::Undetermined { column });
            }
        }
        let mut x = vec![0.0; p];
        for i in (0..p).rev() {
            let known: f64 = (i + 1..p).map(|j| self.entry(i, j) * x[j]).sum();
            x[i] = (self.entry(i, p) - known) / self.entry(i, i);
        }
        Ok(x)
    }
}

/// All columns and the right-hand side with this many full rows.
fn whole(columns: usize, rows: usize) -> Segment {
    Segment::new((0..=columns).map(|id| (id, 0, rows)))
}

/// Makes the diagonal nonnegative: the factor is then unique.
fn normalise(columns: usize, r: &mut [f64]) {
    let segment = whole(columns, 0);
    for i in 0..=columns {
        let row = &mut r[segment.row(i)..segment.row(i + 1)];
        if row[0] < 0.0 {
            for x in row {
                *x = -*x;
            }
        }
    }
}

/// Merges one factor into another, lane by lane.
struct MergeOne<'a> {
    triangle: Segment,
    r: &'a mut [f64],
    later: &'a [f64],
}

impl Task for MergeOne<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes>(self) {
        let mut r = singles::<V>(self.r);
        let later = singles::<V>(self.later);
        let mut tile = vec![V::lift(0.0); self.triangle.tile()];
        spread(&self.triangle, &later, &mut tile);
        annihilate(&self.triangle, &mut r, &mut tile);
        store(&r, self.r);
    }
}

/// One factor of all columns from the lane factors: the lanes of a segment are merged, then
/// the segments' rows annihilated together.
struct Gather<'a> {
    plan: &'a Plan,
    lanes: &'a [f64],
}

impl Task for Gather<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn run<V: Lanes>(self) -> Vec<f64> {
        let (plan, count) = (self.plan, LEAVES);
        let mut rest = self.lanes;
        let merged: Vec<Vec<V>> = plan
            .layout
            .segments
            .iter()
            .zip(&plan.triangles)
            .map(|(segment, triangle)| {
                let (lanes, others) = rest.split_at(segment.factor() * count);
                rest = others;
                merge_lanes::<V>(triangle, lanes, count)
            })
            .collect();
        let rows: usize = plan.layout.segments.iter().map(|s| s.columns.len()).sum();
        let all = whole(plan.columns, rows);
        let mut tile = vec![V::lift(0.0); all.tile()];
        let mut start = 0;
        for (segment, r) in plan.layout.segments.iter().zip(&merged) {
            for row in 0..segment.columns.len() {
                for (shape, x) in segment.columns[row..].iter().zip(&r[segment.row(row)..]) {
                    let to = &all.columns[shape.id];
                    tile[to.offset + (start + row) * to.stride] = *x;
                }
            }
            start += segment.columns.len();
        }
        let mut r = vec![V::lift(0.0); all.factor()];
        annihilate(&all, &mut r, &mut tile);
        let mut numbers = vec![0.0; r.len()];
        store(&r, &mut numbers);
        numbers
    }
}

/// One factor from those of all lanes, in their order.
#[inline(always)]
fn merge_lanes<V: Lanes>(triangle: &Segment, lanes: &[f64], count: usize) -> Vec<V> {
    let lane = |l: usize| -> Vec<f64> { lanes.iter().copied().skip(l).step_by(count).collect() };
    let mut r = singles::<V>(&lane(0));
    let mut tile = vec![V::lift(0.0); triangle.tile()];
    for l in 1..count {
        tile.fill(V::lift(0.0));
        spread(triangle, &singles::<V>(&lane(l)), &mut tile);
        annihilate(triangle, &mut r, &mut tile);
    }
    r
}

/// Numbers as single lanes.
#[inline(always)]
fn singles<V: Lanes>(numbers: &[f64]) -> Vec<V> {
    numbers.chunks_exact(V::COUNT).map(V::load).collect()
}

#[inline(always)]
fn store<V: Lanes>(lanes: &[V], numbers: &mut [f64]) {
    for (x, to) in lanes.iter().zip(numbers.chunks_exact_mut(V::COUNT)) {
        x.store(to);
    }
}
