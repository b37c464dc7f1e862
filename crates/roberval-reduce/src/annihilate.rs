//! Householder reflectors that annihilate a tile of rows against a triangular factor.
//!
//! Every lane is a problem of its own: lane l of the tile is annihilated against lane l
//! of R. Columns come in panels of at most four with the same rows; a panel is applied to
//! the columns after it in one go (compact WY form: `I - V T V'`), four columns at a time
//! so that sixteen sums stay in registers.

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
    let rows = panel.rows;
    let first = segment.columns[panel.first].offset;
    let (tile, later) = tile[first..].split_at_mut(K * rows);
    let t = factor::<V, K>(segment, panel, r, tile);
    let v = &*tile;
    let start = first + K * rows;
    let mut column = panel.first + K;
    let end = segment.columns.len();
    while column < end {
        let wide = if V::REGISTERS >= 32 { 4 } else { 2 };
        let fits = column + wide <= end
            && (column..column + wide).all(|column| panel.touches(segment, column));
        if fits && V::REGISTERS >= 32 {
            apply::<V, K, 4>(segment, panel, column, &t, v, r, later, start);
            column += wide;
        } else if fits {
            apply::<V, K, 2>(segment, panel, column, &t, v, r, later, start);
            column += wide;
        } else {
            if panel.touches(segment, column) {
                apply::<V, K, 1>(segment, panel, column, &t, v, r, later, start);
            }
            column += 1;
        }
    }
}

/// The reflectors of a panel: leaves their vectors in the tile (their leading ones, which
/// stand on R's rows, are implied) and returns T.
#[inline(always)]
fn factor<V: Lanes, const K: usize>(
    segment: &Segment,
    panel: &Panel,
    r: &mut [V],
    tile: &mut [V],
) -> [[V; K]; K] {
    let (rows, zero) = (panel.rows, V::lift(0.0));
    let mut t = [[zero; K]; K];
    for j in 0..K {
        let (before, from_here) = tile.split_at_mut(j * rows);
        let (x, after) = from_here.split_at_mut(rows);
        let at = segment.row(panel.first + j);
        let (tau, scale, beta) = reflector(r[at], square(x));
        r[at] = beta;
        for x in x.iter_mut() {
            *x = *x * scale;
        }
        for (c, y) in after.chunks_exact_mut(rows).take(K - 1 - j).enumerate() {
            let entry = &mut r[at + 1 + c];
            let sum = tau * (*entry + dot(x, y));
            *entry = *entry - sum;
            for (y, x) in y.iter_mut().zip(&*x) {
                *y = x.neg_mul_add(sum, *y);
            }
        }
        // T(0..j, j) = -tau T(0..j, 0..j) V(0..j)' v
        let mut products = [zero; K];
        for (product, v) in products.iter_mut().zip(before.chunks_exact(rows)) {
            *product = -(tau * dot(v, x));
        }
        for i in 0..j {
            let mut sum = zero;
            for l in i..j {
                sum = t[i][l].mul_add(products[l], sum);
            }
            t[i][j] = sum;
        }
        t[j][j] = tau;
    }
    t
}

/// tau, the factor that makes the vector's first entry 1, and the new diagonal entry, of
/// the reflector that annihilates entries of squared length `sigma` below `alpha`. No
/// reflection where there is nothing to annihilate.
#[inline(always)]
fn reflector<V: Lanes>(alpha: V, sigma: V) -> (V, V, V) {
    let norm = alpha.mul_add(alpha, sigma).sqrt();
    let beta = -norm.with_sign_of(alpha);
    let head = alpha - beta;
    let scale = V::lift(1.0).divide(head).where_nonzero(sigma);
    let tau = (-head.divide(beta)).where_nonzero(sigma);
    let kept = alpha - alpha.where_nonzero(sigma);
    (tau, scale, beta.where_nonzero(sigma) + kept)
}

/// Applies a panel to C columns from `column` on: `X - V T' (V' X)`.
#[allow(clippy::too_many_arguments)] // all are slices of the same three arrays
#[inline(always)]
fn apply<V: Lanes, const K: usize, const C: usize>(
    segment: &Segment,
    panel: &Panel,
    column: usize,
    t: &[[V; K]; K],
    v: &[V],
    r: &mut [V],
    later: &mut [V],
    start: usize,
) {
    let (rows, zero) = (panel.rows, V::lift(0.0));
    let mut places = [const { 0..0 }; C];
    for (c, place) in places.iter_mut().enumerate() {
        let shape = &segment.columns[column + c];
        let begin = shape.offset - start + panel.begin - shape.begin;
        *place = begin..begin + rows;
    }
    let Ok(x) = later.get_disjoint_mut(places) else {
        return; // columns do not overlap
    };
    let mut v_of: [&[V]; K] = [&[]; K];
    for (k, slot) in v_of.iter_mut().enumerate() {
        *slot = &v[k * rows..][..rows];
    }
    let mut sums = [[zero; C]; K];
    for i in 0..rows {
        let mut entries = [zero; C];
        for c in 0..C {
            entries[c] = x[c][i];
        }
        for k in 0..K {
            let v = v_of[k][i];
            for c in 0..C {
                sums[k][c] = v.mul_add(entries[c], sums[k][c]);
            }
        }
    }
    // The reflectors' leading ones meet R's rows.
    let mut at = [0; K];
    for k in 0..K {
        let row = panel.first + k;
        at[k] = segment.row(row) + column - row;
        for c in 0..C {
            sums[k][c] = sums[k][c] + r[at[k] + c];
        }
    }
    let mut z = [[zero; C]; K];
    for k in 0..K {
        for c in 0..C {
            for l in 0..=k {
                z[k][c] = t[l][k].mul_add(sums[l][c], z[k][c]);
            }
            r[at[k] + c] = r[at[k] + c] - z[k][c];
        }
    }
    for i in 0..rows {
        // All is read before anything is written: the compiler cannot know that they differ.
        let (mut v, mut entries) = ([zero; K], [zero; C]);
        for k in 0..K {
            v[k] = v_of[k][i];
        }
        for c in 0..C {
            entries[c] = x[c][i];
        }
        for k in 0..K {
            for c in 0..C {
                entries[c] = v[k].neg_mul_add(z[k][c], entries[c]);
            }
        }
        for c in 0..C {
            x[c][i] = entries[c];
        }
    }
}

/// x' y in two interleaved sums.
#[inline(always)]
fn dot<V: Lanes>(x: &[V], y: &[V]) -> V {
    let (mut even, mut odd) = (V::lift(0.0), V::lift(0.0));
    let (mut x, mut y) = (x.chunks_exact(2), y.chunks_exact(2));
    for (x, y) in x.by_ref().zip(y.by_ref()) {
        even = x[0].mul_add(y[0], even);
        odd = x[1].mul_add(y[1], odd);
    }
    for (x, y) in x.remainder().iter().zip(y.remainder()) {
        even = x.mul_add(*y, even);
    }
    even + odd
}

#[inline(always)]
fn square<V: Lanes>(x: &[V]) -> V {
    dot(x, x)
}
