//! Householder elimination from left to right: the one loop behind staircase QR, plain QR,
//! the reduction of a tall matrix to its triangle, and the least squares solution of `W1 beta = W2`.

use roberval_scalar::cancellation_point;

use crate::Matrix;
use crate::scale::{add_multiple, dot, norm};

/// Residuals below this are flushed to zero: their reflector would be built from subnormals.
/// The matrices reduced here are scaled to about 1, so nothing that matters is so small.
const SMALLEST_RESIDUAL: f64 = 1e-290;

/// An echelon form `W = Q R`.
pub(crate) struct Echelon {
    /// Columns that took a row, increasing.
    pub kept: Vec<usize>,
    /// The echelon form, `kept.len()` x c.
    pub r: Matrix,
    /// Norm of the part of each column that the kept columns before it do not explain.
    pub residuals: Vec<f64>,
    reflectors: Matrix,
    taus: Vec<f64>,
}

/// Reduces `w` from left to right; `takes_row(j, residual)` says whether column j uses a row.
/// Once the rows are used up no further column is asked, and its residual is 0.
///
/// `w` has to be scaled (globally or by columns) so that squares of its entries do not overflow.
pub(crate) fn eliminate(w: &Matrix, mut takes_row: impl FnMut(usize, f64) -> bool) -> Echelon {
    let (rows, cols) = (w.rows(), w.cols());
    let mut form = Echelon {
        kept: Vec::new(),
        r: Matrix::zeros(rows.min(cols), cols),
        residuals: vec![0.0; cols],
        reflectors: Matrix::zeros(rows, cols.min(rows)),
        taus: Vec::new(),
    };
    let mut x = vec![0.0; rows];
    for j in 0..cols {
        cancellation_point();
        let rank = form.kept.len();
        x.copy_from_slice(w.col(j));
        form.apply_q_transposed(&mut x);
        form.r.col_mut(j)[..rank].copy_from_slice(&x[..rank]);
        let residual = norm(&x[rank..]);
        form.residuals[j] = residual;
        if rank < rows && takes_row(j, residual) {
            let v = &mut form.reflectors.col_mut(rank)[rank..];
            v.copy_from_slice(&x[rank..]);
            let (r_jj, tau) = make_reflector(v, residual);
            form.r.col_mut(j)[rank] = r_jj;
            form.taus.push(tau);
            form.kept.push(j);
        }
    }
    let used: Vec<usize> = (0..form.kept.len()).collect();
    form.r = form.r.select_rows(&used);
    form
}

impl Echelon {
    /// `x <- Q' x` for a vector of r entries.
    pub(crate) fn apply_q_transposed(&self, x: &mut [f64]) {
        for (p, &tau) in self.taus.iter().enumerate() {
            reflect(&self.reflectors.col(p)[p..], tau, &mut x[p..]);
        }
    }
}

/// Turns `x`, of 2-norm `norm`, into the v (`v[0] = 1`) of `H = I - tau v v'` with
/// `H x = (r, 0, .., 0)'`; gives (r, tau).
pub(crate) fn make_reflector(x: &mut [f64], norm: f64) -> (f64, f64) {
    let head = x[0];
    if norm < SMALLEST_RESIDUAL || x[1..].iter().all(|&x| x == 0.0) {
        x.fill(0.0);
        x[0] = 1.0;
        return (head, 0.0);
    }
    let r = -norm.copysign(head);
    let scale = head - r;
    x[1..].iter_mut().for_each(|x| *x /= scale);
    x[0] = 1.0;
    (r, -scale / r)
}

/// `x <- (I - tau v v') x`.
pub(crate) fn reflect(v: &[f64], tau: f64, x: &mut [f64]) {
    if tau != 0.0 {
        let factor = -tau * dot(v, x);
        add_multiple(x, factor, v);
    }
}
