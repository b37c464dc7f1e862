//! Matrices made to fool a rank decision: what we report, and which road sees through them.

mod common;

use common::{Rng, gram_ratio, with_singular_values};
use roberval_linalg::{Matrix, Tolerance, condition, qrii, staircase_qr, svd};

/// Reconstruction bar of all ratios here, as in lapack_ratios.rs.
const BAR: f64 = 10.0;

/// Kahan's matrix: diag(1, s, s^2, ..) times the unit upper triangle of -c. At every step of pivoting
/// all its columns have the same norm; shrinking each a little more than the one before keeps rounding
/// from breaking the ties.
fn kahan(n: usize, theta: f64) -> Matrix {
    const SHRINK: f64 = 1e-12;
    let (s, c) = theta.sin_cos();
    Matrix::from_fn(n, n, |i, j| {
        let entry = if i == j {
            1.0
        } else if i < j {
            -c
        } else {
            0.0
        };
        s.powi(i as i32) * entry * (1.0 - SHRINK * j as f64)
    })
}

/// `|T_ii| / sigma_i`: least and largest.
fn spread(w: &Matrix) -> (f64, f64) {
    let (t, s) = (qrii(w).unwrap().diagonal, svd(w).unwrap().sigma);
    t.iter()
        .zip(&s)
        .filter(|&(_, &s)| s > 0.0)
        .fold((f64::INFINITY, 0.0), |(least, most), (t, s)| {
            (least.min(t / s), most.max(t / s))
        })
}

#[test]
fn kahan_fools_qrii_and_the_staircase_and_the_svd_says_89_of_90() {
    let w = kahan(90, 1.2);
    let default = Tolerance::default();
    let (pivoted, singular) = (qrii(&w).unwrap(), svd(&w).unwrap());
    let last = pivoted.diagonal[89] / singular.sigma[89];
    println!(
        "Kahan: |T_nn| / sigma_n = {last:.2e}, sigma_n = {:.2e}",
        singular.sigma[89]
    );
    // The known weakness of pivoting on column norms: |T_nn| overstates sigma_n by eight decades.
    assert!(last > 1e7);
    assert_eq!(pivoted.decide(&default).unwrap().rank, 90);
    assert_eq!(staircase_qr(&w, &default).unwrap().decision.rank, 90);
    let by_svd = singular.decide(&default).unwrap();
    assert_eq!(by_svd.rank, 89);
    assert!(
        by_svd.gap.unwrap() > 1e8,
        "the gap is no matter of taste: {:?}",
        by_svd.gap
    );
    assert!(gram_ratio(&w.select_columns(&pivoted.permutation), &pivoted.r) < BAR);
}

#[test]
fn golub_klema_stewart_lacks_one_of_100_on_every_road_but_the_staircase() {
    // Upper triangle with 1 / sqrt(j) on and -1 / sqrt(j) above the diagonal.
    let w = Matrix::from_fn(100, 100, |i, j| {
        let size = 1.0 / ((j + 1) as f64).sqrt();
        if i == j {
            size
        } else if i < j {
            -size
        } else {
            0.0
        }
    });
    let (default, pivoted) = (Tolerance::default(), qrii(&w).unwrap());
    assert_eq!(svd(&w).unwrap().decide(&default).unwrap().rank, 99);
    assert_eq!(pivoted.decide(&default).unwrap().rank, 99);
    // No column is close to the span of those before it: the staircase tests columns, not the matrix.
    assert_eq!(staircase_qr(&w, &default).unwrap().decision.rank, 100);
    assert!(gram_ratio(&w.select_columns(&pivoted.permutation), &pivoted.r) < BAR);
}

#[test]
fn devils_stairs_keep_their_steps_in_the_diagonal_of_t() {
    let mut rng = Rng::new(21);
    let sigma: Vec<f64> = (0..100).map(|i| 1e-4_f64.powi(i / 20)).collect();
    let w = with_singular_values(150, 100, &sigma, &mut rng);
    let (least, most) = spread(&w);
    println!("devil's stairs: |T_ii| / sigma_i in {least:.2} .. {most:.2}");
    assert!(least > 0.1 && most < 10.0);
    for step in 1..5 {
        let between = 1e-4_f64.powi(step) * 1e2;
        let tolerance = Tolerance::Relative {
            dependent: between,
            independent: between,
        };
        assert_eq!(
            svd(&w).unwrap().decide(&tolerance).unwrap().rank,
            20 * step as usize
        );
        assert_eq!(
            qrii(&w).unwrap().decide(&tolerance).unwrap().rank,
            20 * step as usize
        );
    }
}

#[test]
fn values_between_the_two_thresholds_are_flagged_and_the_others_are_not() {
    let mut rng = Rng::new(22);
    let sigma = [1.0, 0.5, 1e-3, 1e-6, 1e-8, 1e-13, 0.0];
    let w = with_singular_values(20, 7, &sigma, &mut rng);
    let decision = svd(&w).unwrap().decide(&Tolerance::default()).unwrap();
    assert_eq!((decision.rank, &decision.ambiguous[..]), (5, &[3, 4][..]));
    assert!(
        (decision.gap.unwrap() / 1e5 - 1.0).abs() < 1e-2,
        "{:?}",
        decision.gap
    );
    let staircase = staircase_qr(&w, &Tolerance::default()).unwrap();
    assert!(!staircase.decision.ambiguous.is_empty());
    assert!(
        staircase
            .decision
            .ambiguous
            .iter()
            .all(|j| staircase.kept.contains(j))
    );
}

#[test]
fn hilbert_and_the_growth_matrix_keep_t_near_the_singular_values() {
    let hilbert = Matrix::from_fn(12, 12, |i, j| 1.0 / (i + j + 1) as f64);
    let (least, most) = spread(&hilbert);
    println!("Hilbert 12: |T_ii| / sigma_i in {least:.2} .. {most:.2}");
    assert!(least > 0.1 && most < 10.0);
    // Condition of the 12 x 12 Hilbert matrix, 1.7e16: at the edge of doubles.
    assert!(condition(&hilbert).unwrap() > 1e15);
    // The 5 x 5 one is known to all digits: 4.766072502425608e5.
    let small = Matrix::from_fn(5, 5, |i, j| 1.0 / (i + j + 1) as f64);
    assert!((condition(&small).unwrap() / 4.766072502425608e5 - 1.0).abs() < 1e-9);

    // Doubles at every step of Gaussian elimination, harmless for orthogonal transformations.
    let growth = Matrix::from_fn(80, 80, |i, j| {
        if i == j || j == 79 {
            1.0
        } else if i > j {
            -1.0
        } else {
            0.0
        }
    });
    assert_eq!(
        staircase_qr(&growth, &Tolerance::default())
            .unwrap()
            .decision
            .rank,
        80
    );
    assert!(
        gram_ratio(
            &growth,
            &staircase_qr(&growth, &Tolerance::default()).unwrap().r
        ) < BAR
    );
}

#[test]
fn a_square_matrix_with_an_early_dependent_column_is_ranked_by_the_staircase_not_by_plain_qr() {
    // The plain reflector of the zero column uses up the only row that the next column needs.
    let w = Matrix::from_row_major(2, 2, &[0.0, 1.0, 0.0, 0.0]).unwrap();
    assert_eq!(roberval_linalg::plain_qr_diagonal(&w).unwrap(), [0.0, 0.0]);
    let staircase = staircase_qr(&w, &Tolerance::default()).unwrap();
    assert_eq!((staircase.kept, staircase.deleted), (vec![1], vec![0]));
}

#[test]
fn a_column_of_dust_below_the_rank_is_not_chosen_by_qrii() {
    let mut rng = Rng::new(23);
    for dusty in 0..6 {
        let full = rng.matrix(20, 6);
        let w = Matrix::from_fn(
            20,
            6,
            |i, j| if j == dusty { 1e-16 } else { 1.0 } * full[(i, j)],
        );
        let pivoted = qrii(&w).unwrap();
        let rank = pivoted.decide(&Tolerance::default()).unwrap().rank;
        let others: Vec<usize> = (0..6).filter(|&j| j != dusty).collect();
        assert_eq!(pivoted.leftmost(rank).unwrap(), others);
        // The staircase judges a column by its own norm: structural zeros have to be taken out before.
        assert_eq!(
            staircase_qr(&w, &Tolerance::default())
                .unwrap()
                .decision
                .rank,
            6
        );
    }
}

#[test]
fn the_relative_threshold_is_a_fraction_of_the_columns_own_norm() {
    let tolerance = Tolerance::Relative {
        dependent: 1e-3,
        independent: 1e-2,
    };
    for (rest, norm, rank) in [
        (1.2e-3, 1.3, 1),
        (1.4e-3, 1.3, 2),
        (0.8e-3, 0.75, 2),
        (0.7e-3, 0.75, 1),
    ] {
        let along = f64::sqrt(norm * norm - rest * rest);
        let w = Matrix::from_row_major(2, 2, &[1.0, along, 0.0, rest]).unwrap();
        assert_eq!(
            staircase_qr(&w, &tolerance).unwrap().decision.rank,
            rank,
            "{rest} of {norm}"
        );
    }
}
