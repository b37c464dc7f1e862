//! Inputs on which faer 0.24.4 is reported to go wrong: ours must not.

mod common;

use common::{Rng, gram_ratio, orthogonality_ratio};
use roberval_linalg::{Matrix, RATIO_BAR, Tolerance, qrii, relations_qr, staircase_qr, svd};

/// faer #265: its unpivoted least squares was reported to give NaN here. The second column is parallel
/// to the first but for 1e-15 of its norm, yet the matrix is regular.
fn graded() -> Matrix {
    Matrix::from_row_major(3, 3, &[1e16, -1e15, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]).unwrap()
}

#[test]
fn the_matrix_of_faer_265_is_solved_or_called_singular_but_never_nan() {
    let w = graded();
    let exact = Tolerance::Relative {
        dependent: 0.0,
        independent: 0.0,
    };
    let staircase = staircase_qr(&w, &exact).unwrap();
    assert_eq!(staircase.kept, [0, 1, 2]);
    assert_eq!(staircase.diagonal, [1e16, 1.0, 1.0]);
    // Under the default tolerance 1e-15 of a column's norm is nothing.
    assert_eq!(
        staircase_qr(&w, &Tolerance::default()).unwrap().deleted,
        [1]
    );
    assert!(qrii(&w).unwrap().r.check_finite().is_ok());

    let right = [0.0, 1.0, 1.0];
    let both = Matrix::from_fn(3, 4, |i, j| if j < 3 { w[(i, j)] } else { right[i] });
    let relations = relations_qr(&both, &[0, 1, 2], &[3]).unwrap();
    for (beta, truth) in relations.beta.as_slice().iter().zip([0.1, 1.0, 1.0]) {
        assert!((beta - truth).abs() <= f64::EPSILON, "{beta} for {truth}");
    }
}

#[test]
fn faer_runs_on_one_thread_here() {
    // faer #273: products in parallel were silently wrong. Fails if someone turns faer's rayon on.
    assert!(matches!(faer::get_global_parallelism(), faer::Par::Seq));
}

#[test]
fn large_blocks_of_exact_zeros_as_in_faer_273_do_not_disturb_qrii_or_svd() {
    let mut rng = Rng::new(31);
    for n in [64, 120, 337] {
        // Symmetric, two blocks that do not touch: the structure that triggered the bug.
        let half = n / 2;
        let raw = rng.matrix(n, n);
        let w = Matrix::from_fn(n, n, |i, j| {
            if (i < half) == (j < half) {
                23.0 * (raw[(i, j)] + raw[(j, i)])
            } else {
                0.0
            }
        });
        let (pivoted, singular) = (qrii(&w).unwrap(), svd(&w).unwrap());
        assert!(pivoted.ratio < RATIO_BAR && singular.ratio < RATIO_BAR);
        assert!(gram_ratio(&w.select_columns(&pivoted.permutation), &pivoted.r) < 10.0);
        assert!(orthogonality_ratio(&singular.v) < 10.0);
    }
}

#[test]
fn many_small_matrices_of_the_size_that_failed_downstream_converge() {
    // An 11 x 11 SVD was reported not to converge (gam #2581).
    let mut rng = Rng::new(32);
    for trial in 0..2000 {
        let scale = 10_f64.powi((trial % 40) - 20);
        let w = Matrix::from_fn(11, 11, |i, j| {
            let x = rng.uniform();
            if (i + j + trial as usize).is_multiple_of(3) {
                scale * x
            } else {
                x
            }
        });
        assert!(svd(&w).unwrap().ratio < RATIO_BAR, "trial {trial}");
    }
}

#[test]
fn the_same_matrix_gives_the_same_bits_twice() {
    let w = Rng::new(33).matrix(130, 61);
    assert_eq!(qrii(&w).unwrap(), qrii(&w).unwrap());
    assert_eq!(svd(&w).unwrap(), svd(&w).unwrap());
    let default = Tolerance::default();
    assert_eq!(
        staircase_qr(&w, &default).unwrap(),
        staircase_qr(&w, &default).unwrap()
    );
}
