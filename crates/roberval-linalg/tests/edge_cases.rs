//! Empty, tiny, huge and bad matrices: an answer or an error that names the place, never a panic.

use roberval_linalg::{
    Matrix, Tolerance, deleted_from_null_space, qrii, relations_qr, relations_svd, staircase_qr,
    svd,
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
