//! Householder reflectors that annihilate a tile of rows against a triangular factor.
//!
//! Every lane is a problem of its own: lane l of the tile is annihilated against lane l
//! of R. Columns come in panels of at most four with the same rows; a panel is applied to
//! each panel after it in one go (compact WY form: `I - V T V'`), so that up to sixteen
//! sums stay in registers.
//!
//! A reflector's vector is the tile's column as it is, with an entry of its own (its head)
//! on R's row. The head has the sign that leaves R's row nearly as it was: a tile adds
//! little to what thousands before it gave. With the usual sign R would change its sign
//! with each tile, and each time be rounded by what it holds instead of by what is added.

use roberval_scalar::Lanes;

use crate::layout::{Panel, Segment};

/// The most columns of a panel.
pub(crate) const PANEL: usize = 4;

/// Annihilates the tile of a segment against its factor `r` (packed rows, see
/// [`Segment::row`]). The tile's contents are used up.
#[inline(always)]
pub(crate) fn annihilate<V: Lanes>(segment: &Segment, r: &mut [V], tile: &mut [V]) {
    for panel in &segment.panels {
        match panel.count {
            1 => eliminate::<V, 1>(segment, panel, r, tile),
            2 => eliminate::<V, 2>(segment, panel, r, tile),
            3 => eliminate::<V, 3>(segment, panel, r, tile),
            _ => eliminate::<V, 4>(segment, panel, r, tile),
        }
    }
}

/// One panel of K columns.
#[inline(always)]
fn eliminate<V: Lanes, const K: usize>(
    segment: &Segment,
    panel: &Panel,
    r: &mut [V],
    tile: &mut [V],
) {
    let (before, later) = tile.split_at_mut(panel.end());
    let (v, _) = before[panel.offset..].as_chunks_mut::<K>();
    let (t, heads) = factor(segment, panel, r, v);
    let mut rows = [0; K];
    for (k, row) in rows.iter_mut().enumerate() {
        // Where column 0 would be in this row of R.
        *row = segment.row(panel.first + k).wrapping_sub(panel.first + k);
    }
    for target in &panel.targets {
        let x = &mut later[target.offset - panel.end()..][..panel.rows * target.count];
        let block = Block {
            t: &t,
            heads: &heads,
            v,
            rows: rows.map(|row| row.wrapping_add(target.first)),
        };
        block.apply_to(target.count, r, x);
    }
}

/// The reflectors of a panel: leaves their vectors in the tile and returns T and the heads.
#[inline(always)]
fn factor<V: Lanes, const K: usize>(
    segment: &Segment,
    panel: &Panel,
    r: &mut [V],
    x: &mut [[V; K]],
) -> ([[V; K]; K], [V; K]) {
    let (mut t, mut heads) = ([[V::lift(0.0); K]; K], [V::lift(0.0); K]);
    let mut products = products(x);
    for j in 0..K {
        let row = &mut r[segment.row(panel.first + j)..][..K - j];
        (heads[j], products) = match j {
            0 => reflect::<V, K, 0>(row, x, &products, &mut t),
            1 => reflect::<V, K, 1>(row, x, &products, &mut t),
            2 => reflect::<V, K, 2>(row, x, &products, &mut t),
            _ => reflect::<V, K, 3>(row, x, &products, &mut t),
        };
    }
    (t, heads)
}

/// Reflects column J of a panel, `products` being those of the column with all of them and
/// `row` that of R, from the diagonal to the panel's end. Goes over the tile once and
/// returns the reflector's head and the products of the next column.
#[inline(always)]
fn reflect<V: Lanes, const K: usize, const J: usize>(
    row: &mut [V],
    x: &mut [[V; K]],
    products: &[V; K],
    t: &mut [[V; K]; K],
) -> (V, [V; K]) {
    let zero = V::lift(0.0);
    let (tau, head, diagonal) = reflector(row[0], products[J]);
    row[0] = diagonal;
    let mut sums = [zero; K];
    for c in J + 1..K {
        sums[c] = tau * head.mul_add(row[c - J], products[c]);
        row[c - J] = head.neg_mul_add(sums[c], row[c - J]);
    }
    extend::<V, K, J>(t, tau, products);
    let (mut even, mut odd) = ([zero; K], [zero; K]);
    let (pairs, last) = x.as_chunks_mut::<2>();
    for [first, second] in pairs {
        subtract::<V, K, J>(first, &sums);
        subtract::<V, K, J>(second, &sums);
        multiply::<V, K>(first, J + 1, &mut even);
        multiply::<V, K>(second, J + 1, &mut odd);
    }
    for row in last {
        subtract::<V, K, J>(row, &sums);
        multiply::<V, K>(row, J + 1, &mut even);
    }
    (head, total(even, odd))
}

/// One row of a panel: subtracts the multiples of entry J from those after it.
#[inline(always)]
fn subtract<V: Lanes, const K: usize, const J: usize>(row: &mut [V; K], sums: &[V; K]) {
    for c in J + 1..K {
        row[c] = row[J].neg_mul_add(sums[c], row[c]);
    }
}

/// Adds one row's products of column j with all columns. Nothing where there is no such column.
#[inline(always)]
fn multiply<V: Lanes, const K: usize>(row: &[V; K], j: usize, sums: &mut [V; K]) {
    if j < K {
        for c in 0..K {
            sums[c] = row[j].mul_add(row[c], sums[c]);
        }
    }
}

/// The products of column 0 with all columns.
#[inline(always)]
fn products<V: Lanes, const K: usize>(x: &[[V; K]]) -> [V; K] {
    let (mut even, mut odd) = ([V::lift(0.0); K], [V::lift(0.0); K]);
    let (pairs, last) = x.as_chunks::<2>();
    for [first, second] in pairs {
        multiply(first, 0, &mut even);
        multiply(second, 0, &mut odd);
    }
    for row in last {
        multiply(row, 0, &mut even);
    }
    total(even, odd)
}

#[inline(always)]
fn total<V: Lanes, const K: usize>(mut even: [V; K], odd: [V; K]) -> [V; K] {
    for c in 0..K {
        even[c] = even[c] + odd[c];
    }
    even
}

/// Column J of T: `T(0..J, J) = -tau T(0..J, 0..J) V(0..J)' v`, and tau on the diagonal.
#[inline(always)]
fn extend<V: Lanes, const K: usize, const J: usize>(
    t: &mut [[V; K]; K],
    tau: V,
    products: &[V; K],
) {
    for i in 0..J {
        let mut sum = V::lift(0.0);
        for l in i..J {
            sum = t[i][l].neg_mul_add(products[l], sum);
        }
        t[i][J] = tau * sum;
    }
    t[J][J] = tau;
}

/// tau, the head and the new diagonal entry of the reflector that annihilates entries x of
/// squared length `sigma` below `alpha`: `I - tau (head; x) (head; x)'`. No reflection where
/// there is nothing to annihilate.
#[inline(always)]
fn reflector<V: Lanes>(alpha: V, sigma: V) -> (V, V, V) {
    // Squares below this, lost beside it, would make tau infinite.
    let tiny = V::lift(TINY);
    let some = (sigma + tiny) - tiny;
    let diagonal = alpha.mul_add(alpha, sigma).sqrt().with_sign_of(alpha);
    // alpha - diagonal, without the difference.
    let sum = alpha + diagonal;
    let head = (-sigma).divide(sum).where_nonzero(some);
    // 2 / (sigma + head^2), each factor within the range of floats.
    let tau = (sum.divide(diagonal) * V::lift(1.0).divide(sigma)).where_nonzero(some);
    let kept = alpha - alpha.where_nonzero(some);
    (tau, head, diagonal.where_nonzero(some) + kept)
}

/// The square of 1e-144.
const TINY: f64 = 1e-288;

/// The reflectors of a panel of K columns, and where the rows of R that they stand on have
/// the first column of a target.
struct Block<'a, V, const K: usize> {
    t: &'a [[V; K]; K],
    heads: &'a [V; K],
    v: &'a [[V; K]],
    rows: [usize; K],
}

impl<V: Lanes, const K: usize> Block<'_, V, K> {
    /// Applies the reflectors to a target's columns in the tile and in R.
    #[inline(always)]
    fn apply_to(&self, columns: usize, r: &mut [V], x: &mut [V]) {
        // As many columns at a time as there are registers for K sums each.
        let all = V::REGISTERS >= 32;
        match columns {
            1 => self.apply::<1, 1>(0, r, x),
            2 => self.apply::<2, 2>(0, r, x),
            3 if all => self.apply::<3, 3>(0, r, x),
            3 => {
                self.apply::<3, 2>(0, r, x);
                self.apply::<3, 1>(2, r, x);
            }
            _ if all => self.apply::<4, 4>(0, r, x),
            _ => {
                self.apply::<4, 2>(0, r, x);
                self.apply::<4, 2>(2, r, x);
            }
        }
    }

    /// Applies them to C columns, from the one `from` on, of the W in a row:
    /// `X - V T' (V' X)`.
    #[inline(always)]
    fn apply<const W: usize, const C: usize>(&self, from: usize, r: &mut [V], x: &mut [V]) {
        let (x, _) = x.as_chunks_mut::<W>();
        let mut sums = [[V::lift(0.0); C]; K];
        for (v, x) in self.v.iter().zip(&*x) {
            for k in 0..K {
                for c in 0..C {
                    sums[k][c] = v[k].mul_add(x[from + c], sums[k][c]);
                }
            }
        }
        self.turn(from, r, &mut sums);
        for (v, x) in self.v.iter().zip(x) {
            // All is read before anything is written: the compiler cannot know that they differ.
            let mut entries = [V::lift(0.0); C];
            for c in 0..C {
                entries[c] = x[from + c];
                for k in 0..K {
                    entries[c] = v[k].neg_mul_add(sums[k][c], entries[c]);
                }
            }
            for (x, entry) in x[from..].iter_mut().zip(entries) {
                *x = entry;
            }
        }
    }

    /// From the products of the vectors with the tile's columns to the vectors' multiples
    /// that are subtracted, which R is the first to see: the heads meet its rows.
    #[inline(always)]
    fn turn<const C: usize>(&self, from: usize, r: &mut [V], sums: &mut [[V; C]; K]) {
        for k in 0..K {
            let row = &r[self.rows[k] + from..][..C];
            for c in 0..C {
                sums[k][c] = self.heads[k].mul_add(row[c], sums[k][c]);
            }
        }
        for k in (0..K).rev() {
            let row = &mut r[self.rows[k] + from..][..C];
            for c in 0..C {
                let mut z = self.t[k][k] * sums[k][c];
                for l in 0..K {
                    if l < k {
                        z = self.t[l][k].mul_add(sums[l][c], z);
                    }
                }
                sums[k][c] = z;
                row[c] = self.heads[k].neg_mul_add(z, row[c]);
            }
        }
    }
}
