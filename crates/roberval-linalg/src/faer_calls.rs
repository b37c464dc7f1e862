//! The two factorisations taken from faer, always on one thread (faer #273: wrong products in parallel).
//! Callers scale the input and refuse NaN before, and check the result after.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::householder::{
    apply_block_householder_sequence_on_the_left_in_place_scratch as apply_q_scratch,
    apply_block_householder_sequence_on_the_left_in_place_with_conj as apply_q,
};
use faer::linalg::qr::col_pivoting::factor as pivoted;
use faer::linalg::svd::{self as faer_svd, ComputeSvdVectors};
use faer::{Conj, Mat, MatRef, Par};

use crate::Matrix;

const ONE_THREAD: Par = Par::Seq;

/// `A P = Q R` with column pivoting.
pub(crate) struct PivotedFactors {
    /// r x min(r, c), orthonormal columns.
    pub q: Matrix,
    /// min(r, c) x c, upper trapezoidal.
    pub r: Matrix,
    /// Position k holds column `permutation[k]` of A.
    pub permutation: Vec<usize>,
}

/// QR with column pivoting on norms.
pub(crate) fn pivoted_qr(a: &Matrix) -> PivotedFactors {
    let (rows, cols) = (a.rows(), a.cols());
    let size = rows.min(cols);
    let mut factors = to_faer(a);
    let block = faer::linalg::qr::no_pivoting::factor::recommended_block_size::<f64>(rows, cols);
    let mut coefficients = Mat::<f64>::zeros(block, size);
    let (mut forward, mut inverse) = (vec![0_usize; cols], vec![0_usize; cols]);
    pivoted::qr_in_place(
        factors.as_mut(),
        coefficients.as_mut(),
        &mut forward,
        &mut inverse,
        ONE_THREAD,
        MemStack::new(&mut MemBuffer::new(pivoted::qr_in_place_scratch::<
            usize,
            f64,
        >(
            rows,
            cols,
            block,
            ONE_THREAD,
            Default::default(),
        ))),
        Default::default(),
    );
    let mut q = Mat::<f64>::identity(rows, size);
    apply_q(
        factors.get(.., ..size),
        coefficients.as_ref(),
        Conj::No,
        q.as_mut(),
        ONE_THREAD,
        MemStack::new(&mut MemBuffer::new(apply_q_scratch::<f64>(
            rows, block, size,
        ))),
    );
    leave_vector_registers();
    let r = Matrix::from_fn(
        size,
        cols,
        |i, j| if i <= j { factors[(i, j)] } else { 0.0 },
    );
    PivotedFactors {
        q: from_faer(q.as_ref()),
        r,
        permutation: forward,
    }
}

/// `A = U diag(sigma) V'` of a square matrix; `None` if faer's iteration does not converge.
pub(crate) fn square_svd(a: &Matrix) -> Option<(Matrix, Vec<f64>, Matrix)> {
    let n = a.cols();
    let (mut u, mut v) = (Mat::<f64>::zeros(n, n), Mat::<f64>::zeros(n, n));
    let mut sigma = faer::diag::Diag::<f64>::zeros(n);
    let full = ComputeSvdVectors::Full;
    let scratch = faer_svd::svd_scratch::<f64>(n, n, full, full, ONE_THREAD, Default::default());
    let converged = faer_svd::svd(
        to_faer(a).as_ref(),
        sigma.as_mut(),
        Some(u.as_mut()),
        Some(v.as_mut()),
        ONE_THREAD,
        MemStack::new(&mut MemBuffer::new(scratch)),
        Default::default(),
    );
    leave_vector_registers();
    converged.ok()?;
    let sigma = (0..n).map(|i| sigma[i]).collect();
    Some((from_faer(u.as_ref()), sigma, from_faer(v.as_ref())))
}

/// faer's kernels come back with the upper halves of the vector registers in use (no `vzeroupper`), and
/// from then on the thread's SSE code, which is most of this program, runs three to four times slower.
/// A vectorised loop that the compiler ends properly puts that right.
fn leave_vector_registers() {
    let mut x = std::hint::black_box([1.0_f64; 16]);
    pulp::Arch::new().dispatch(|| x.iter_mut().for_each(|x| *x += *x));
    std::hint::black_box(x);
}

fn to_faer(a: &Matrix) -> Mat<f64> {
    Mat::from_fn(a.rows(), a.cols(), |i, j| a[(i, j)])
}

fn from_faer(a: MatRef<'_, f64>) -> Matrix {
    Matrix::from_fn(a.nrows(), a.ncols(), |i, j| a[(i, j)])
}
