//! Empty, tiny, huge and bad matrices: an answer or an error that names the place, never a panic.

mod common;

use common::Rng;
use roberval_linalg::{
    LinalgError, Matrix, PAPER_EPS_VAX, Relations, Tolerance, condition, deleted_from_null_space,
    equilibrate, plain_qr_diagonal, qrii, relations_qr, relations_svd, staircase_qr, svd,
    unscale_relations, v22_condition,
};

/// Rounding of a handful of operations on numbers about 1.
const FEW_EPS: f64 = 16.0 * f64::EPSILON;

fn tall() -> Matrix {
    // Column 2 = 2 col 0 - col 1; column 3 is zero; column 4 is new.
    Matrix::from_row_major(
        6,
        5,
        &[
            1., 2., 0., 0., 1., //
            3., 1., 5., 0., 0., //
            0., 2., -2., 0., 4., //
            1., 1., 1., 0., -3., //
            2., 0., 4., 0., 1., //
            5., 3., 7., 0., 2.,
        ],
    )
    .unwrap()
}

#[test]
fn three_roads_agree_on_a_matrix_done_by_hand() {
    let w = tall();
    let default = Tolerance::default();
    let staircase = staircase_qr(&w, &default).unwrap();
    assert_eq!(
        (&staircase.kept[..], &staircase.deleted[..]),
        (&[0, 1, 4][..], &[2, 3][..])
    );
    let pivoted = qrii(&w).unwrap();
    assert_eq!(
        pivoted
            .leftmost(pivoted.decide(&default).unwrap().rank)
            .unwrap(),
        staircase.kept
    );
    let s = svd(&w).unwrap();
    let b = s.decide(&default).unwrap().rank;
    let v2 = s.null_space(b);
    assert_eq!(deleted_from_null_space(&v2).unwrap(), staircase.deleted);

    let expected = [[2.0, 0.0], [-1.0, 0.0], [0.0, 0.0]];
    let by_qr = relations_qr(&w, &staircase.kept, &staircase.deleted).unwrap();
    let by_v2 = relations_svd(&v2, &staircase.kept, &staircase.deleted).unwrap();
    let by_svd = s.relations(b, &staircase.kept, &staircase.deleted).unwrap();
    for mut relations in [by_qr, by_v2, by_svd] {
        relations.clean();
        for (i, j) in (0..3).flat_map(|i| (0..2).map(move |j| (i, j))) {
            let (beta, truth) = (relations.beta[(i, j)], expected[i][j]);
            assert!(
                (beta - truth).abs() <= FEW_EPS && (truth != 0.0 || beta == 0.0),
                "({i},{j}) {beta}"
            );
        }
    }
}

fn default() -> Tolerance {
    Tolerance::default()
}

/// Everything on one matrix; the ranks by staircase, QRII and SVD.
fn ranks(w: &Matrix) -> [usize; 3] {
    let staircase = staircase_qr(w, &default()).unwrap();
    let pivoted = qrii(w).unwrap();
    let singular = svd(w).unwrap();
    let b = staircase.kept.len();
    assert_eq!(staircase.kept.len() + staircase.deleted.len(), w.cols());
    assert_eq!((staircase.r.rows(), staircase.r.cols()), (b, w.cols()));
    assert_eq!(plain_qr_diagonal(w).unwrap().len(), w.cols());
    assert_eq!(
        (pivoted.diagonal.len(), singular.sigma.len()),
        (w.cols(), w.cols())
    );
    let decisions = [
        staircase.decision.rank,
        pivoted.decide(&default()).unwrap().rank,
        singular.decide(&default()).unwrap().rank,
    ];
    assert_eq!(pivoted.leftmost(decisions[1]).unwrap(), staircase.kept);
    let v2 = singular.null_space(decisions[2]);
    assert_eq!(deleted_from_null_space(&v2).unwrap(), staircase.deleted);
    relations_qr(w, &staircase.kept, &staircase.deleted).unwrap();
    singular
        .relations(b, &staircase.kept, &staircase.deleted)
        .unwrap();
    decisions
}

#[test]
fn empty_and_tiny_matrices_have_the_rank_one_expects() {
    for (rows, cols) in [(0, 0), (0, 1), (1, 0), (0, 5), (5, 0)] {
        assert_eq!(ranks(&Matrix::zeros(rows, cols)), [0; 3], "{rows} x {cols}");
        assert_eq!(condition(&Matrix::zeros(rows, cols)), Ok(1.0));
    }
    for (rows, cols) in [(1, 1), (1, 4), (4, 1), (7, 3), (3, 7)] {
        assert_eq!(
            ranks(&Matrix::zeros(rows, cols)),
            [0; 3],
            "zero {rows} x {cols}"
        );
        assert_eq!(condition(&Matrix::zeros(rows, cols)), Ok(f64::INFINITY));
        let full = Matrix::from_fn(rows, cols, |i, j| 1.0 / (1 + i + 2 * j) as f64);
        assert_eq!(ranks(&full), [rows.min(cols); 3], "full {rows} x {cols}");
    }
    assert_eq!(
        ranks(&Matrix::from_row_major(1, 1, &[-3.0]).unwrap()),
        [1; 3]
    );
    assert_eq!(
        svd(&Matrix::from_row_major(1, 1, &[-3.0]).unwrap())
            .unwrap()
            .sigma,
        [3.0]
    );
}

#[test]
fn a_wide_matrix_keeps_at_most_as_many_columns_as_it_has_rows() {
    let mut rng = Rng::new(41);
    for (rows, cols) in [(2, 5), (10, 11), (7, 30)] {
        let w = rng.matrix(rows, cols);
        assert_eq!(ranks(&w), [rows; 3]);
        let staircase = staircase_qr(&w, &default()).unwrap();
        assert_eq!(staircase.kept, (0..rows).collect::<Vec<_>>());
        assert!(staircase.ratios[rows..].iter().all(|&x| x == 0.0));
    }
}

#[test]
fn the_answer_does_not_depend_on_the_unit_down_to_1e_minus_300_and_up_to_1e300() {
    let w = tall();
    let reference = staircase_qr(&w, &default()).unwrap();
    let sigma = svd(&w).unwrap().sigma;
    for power in [-1000, -990, -500, 500, 990, 1000] {
        let unit = 2_f64.powi(power);
        let scaled = Matrix::from_fn(6, 5, |i, j| w[(i, j)] * unit);
        assert_eq!(ranks(&scaled), [3; 3], "2^{power}");
        let staircase = staircase_qr(&scaled, &default()).unwrap();
        assert_eq!(
            (&staircase.kept, &staircase.ratios),
            (&reference.kept, &reference.ratios)
        );
        for (s, t) in svd(&scaled).unwrap().sigma.iter().zip(&sigma) {
            assert!(
                (s / unit - t).abs() <= FEW_EPS * sigma[0],
                "2^{power}: {s} for {t}"
            );
        }
        let norms = [scaled.column_norm(0) / unit, scaled.frobenius_norm() / unit];
        assert!((norms[0] - 40_f64.sqrt()).abs() < FEW_EPS * 10.0);
        assert!(norms[1].is_finite() && norms[1] > norms[0]);
    }
}

#[test]
fn columns_in_wildly_different_units_are_each_judged_by_their_own_norm() {
    let w = tall();
    let units = [1e-300, 1e300, 1e-150, 1.0, 1e200];
    let scaled = Matrix::from_fn(6, 5, |i, j| w[(i, j)] * units[j]);
    let staircase = staircase_qr(&scaled, &default()).unwrap();
    assert_eq!(staircase.kept, [0, 1, 4]);
    let (equilibrated, _) = equilibrate(&scaled);
    assert_eq!(ranks(&equilibrated), [3; 3]);
}

#[test]
fn subnormal_entries_are_handled_like_any_other() {
    let w = Matrix::from_row_major(3, 2, &[5e-324, 1e-320, 0.0, 3e-320, 1e-320, 0.0]).unwrap();
    assert_eq!(ranks(&w), [2; 3]);
    assert!(w.column_norm(1) > 3.1e-320 && w.column_norm(1) < 3.2e-320);
}

#[test]
fn a_norm_above_the_largest_double_is_an_overflow_error_not_an_infinity() {
    let w = Matrix::from_fn(50, 3, |i, j| if j == i { 0.0 } else { f64::MAX });
    assert!(w.column_norm(0).is_infinite());
    assert!(matches!(
        staircase_qr(&w, &default()),
        Err(LinalgError::Overflow { .. })
    ));
    assert!(matches!(
        plain_qr_diagonal(&w),
        Err(LinalgError::Overflow { .. })
    ));
    assert!(matches!(qrii(&w), Err(LinalgError::Overflow { .. })));
    assert!(matches!(svd(&w), Err(LinalgError::Overflow { .. })));
    let (equilibrated, _) = equilibrate(&w);
    assert_eq!(ranks(&equilibrated), [3; 3]);
}

#[test]
fn nan_and_infinity_are_named_by_row_and_column_everywhere() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut w = tall();
        w[(4, 3)] = bad;
        w[(5, 4)] = f64::NAN;
        let errors = [
            w.check_finite().unwrap_err(),
            staircase_qr(&w, &default()).unwrap_err(),
            plain_qr_diagonal(&w).unwrap_err(),
            qrii(&w).unwrap_err(),
            svd(&w).unwrap_err(),
            condition(&w).unwrap_err(),
            deleted_from_null_space(&w).unwrap_err(),
            relations_qr(&w, &[0], &[1]).unwrap_err(),
            relations_svd(&w, &[5], &[0, 1, 2, 3, 4]).unwrap_err(),
        ];
        for error in errors {
            assert!(
                matches!(error, LinalgError::NotFinite { row: 4, col: 3, .. }),
                "{error}"
            );
            assert!(error.to_string().contains("(4, 3)"), "{error}");
        }
    }
}

#[test]
fn shapes_indices_and_tolerances_that_do_not_fit_are_refused_with_what_would_be_right() {
    let w = tall();
    let shape = |error: LinalgError| assert!(matches!(error, LinalgError::Shape { .. }), "{error}");
    shape(Matrix::from_row_major(2, 3, &[0.0; 5]).unwrap_err());
    shape(Matrix::from_row_major(usize::MAX, 2, &[]).unwrap_err());
    shape(Matrix::from_columns(2, &[vec![1.0, 2.0], vec![3.0]]).unwrap_err());
    shape(w.matmul(&w).unwrap_err());
    shape(relations_qr(&w, &[0, 5], &[1]).unwrap_err());
    shape(relations_qr(&w, &[0], &[9]).unwrap_err());
    let singular = svd(&w).unwrap();
    let v2 = singular.null_space(3);
    shape(relations_svd(&v2, &[0, 1], &[4]).unwrap_err());
    shape(relations_svd(&v2, &[0, 1, 7], &[2, 3]).unwrap_err());
    shape(v22_condition(&v2, &[7]).unwrap_err());
    shape(singular.minimum_norm(3, &[1.0]).unwrap_err());
    shape(singular.minimum_norm(6, &[1.0; 5]).unwrap_err());
    shape(qrii(&w).unwrap().leftmost(6).unwrap_err());
    shape(unscale_relations(&Matrix::zeros(1, 1), &[0], &[0], &[1]).unwrap_err());
    assert_eq!(singular.null_space(9).cols(), 0);
    for tolerance in [
        Tolerance::Paper { eps: f64::NAN },
        Tolerance::Paper { eps: -1.0 },
        Tolerance::Relative {
            dependent: 1.0,
            independent: 2.0,
        },
        Tolerance::Relative {
            dependent: -1e-3,
            independent: 1.0,
        },
        Tolerance::Relative {
            dependent: 1e-3,
            independent: 1e-4,
        },
        Tolerance::Relative {
            dependent: 1e-3,
            independent: f64::INFINITY,
        },
    ] {
        let refused = |error| assert!(matches!(error, LinalgError::Tolerance { .. }));
        refused(staircase_qr(&w, &tolerance).unwrap_err());
        refused(qrii(&w).unwrap().decide(&tolerance).unwrap_err());
        refused(singular.decide(&tolerance).unwrap_err());
    }
}

#[test]
fn dependent_kept_columns_are_singular_not_silently_solved() {
    let w = tall();
    for kept in [&[0, 1, 2][..], &[0, 3], &[0, 1, 4, 4]] {
        let error = relations_qr(&w, kept, &[4]).unwrap_err();
        assert!(
            matches!(error, LinalgError::Singular { .. }),
            "{kept:?}: {error}"
        );
    }
    // Column 3 is zero, so V2 has the row (0, 1): rows 0 and 3 are regular, rows 3 and 4 are not.
    let v2 = svd(&w).unwrap().null_space(3);
    assert!(relations_svd(&v2, &[1, 2, 4], &[0, 3]).is_ok());
    assert!(matches!(
        relations_svd(&v2, &[0, 1, 2], &[3, 4]),
        Err(LinalgError::Singular { .. })
    ));
    let flat = Matrix::from_fn(4, 2, |_, j| 0.5 * f64::from(j == 0));
    assert!(matches!(
        deleted_from_null_space(&flat),
        Err(LinalgError::Singular { rank: 1, .. })
    ));
}

#[test]
fn the_papers_tau_is_its_printed_number_and_needs_the_vax_eps() {
    // Gautier 1991: r = 55, |T11| = 68.553, tau printed as 5.23e-14.
    let tau = 55.0 * 68.553 * PAPER_EPS_VAX;
    assert_eq!(format!("{tau:.2e}"), "5.23e-14");
    assert_eq!(format!("{:.2e}", 55.0 * 68.553 * f64::EPSILON), "8.37e-13");

    let mut diagonal = Matrix::zeros(55, 3);
    for (j, value) in [68.553, 1.0, 5.3e-14].into_iter().enumerate() {
        diagonal[(j, j)] = value;
    }
    let vax = Tolerance::Paper { eps: PAPER_EPS_VAX };
    let ieee = Tolerance::Paper { eps: f64::EPSILON };
    for (tolerance, rank) in [(vax, 3), (ieee, 2)] {
        let decisions = [
            staircase_qr(&diagonal, &tolerance).unwrap().decision,
            qrii(&diagonal).unwrap().decide(&tolerance).unwrap(),
            svd(&diagonal).unwrap().decide(&tolerance).unwrap(),
        ];
        for decision in decisions {
            assert_eq!(decision.rank, rank);
            let Tolerance::Paper { eps } = tolerance else {
                unreachable!()
            };
            assert!((decision.tolerance / (55.0 * 68.553 * eps) - 1.0).abs() < FEW_EPS);
            assert!(
                (decision.spectrum[2] / 5.3e-14 - 1.0).abs() < 1e-2
                    && decision.ambiguous.is_empty()
            );
        }
    }
}

#[test]
fn the_gap_is_the_ratio_of_the_values_on_both_sides_of_the_cut() {
    let gap = |values: &[f64]| {
        let n = values.len();
        let w = Matrix::from_fn(n, n, |i, j| if i == j { values[i] } else { 0.0 });
        let by_svd = svd(&w).unwrap().decide(&default()).unwrap().gap;
        assert_eq!(qrii(&w).unwrap().decide(&default()).unwrap().gap, by_svd);
        by_svd
    };
    assert_eq!(gap(&[4.0, 2.0]), None);
    assert_eq!(gap(&[0.0, 0.0]), None);
    assert_eq!(gap(&[4.0, 2.0, 0.0]), Some(f64::INFINITY));
    assert_eq!(gap(&[4.0, 2.0, 2_f64.powi(-60)]), Some(2_f64.powi(61)));
}

#[test]
fn an_exact_multiple_is_related_exactly_and_an_unrelated_column_has_a_bound_as_large_as_its_rest() {
    let w = Matrix::from_row_major(3, 3, &[1., 0.5, 0., 2., 1., 0., -3., -1.5, 1e-3]).unwrap();
    let found: Relations = relations_qr(&w, &[0], &[1, 2]).unwrap();
    assert_eq!(found.beta[(0, 0)], 0.5);
    assert!(found.bound[(0, 0)] < 1e-14);
    // Column 2 is no multiple of column 0: no digit of its coefficient is certain, and the bound says so.
    assert!(found.bound[(0, 1)] >= 0.5 * found.beta[(0, 1)].abs());
}
