//! Four roads to the same columns, and two to the same beta, against exact arithmetic.

mod common;

use common::Rng;
use common::modular::{P, fraction, reduced_echelon};
use roberval_linalg::{
    Matrix, Relations, Tolerance, deleted_from_null_space, equilibrate, qrii, relations_qr,
    relations_svd, staircase_qr, svd, unscale_relations, v22_condition,
};

/// An integer matrix with planted dependencies and its exact truth.
struct Planted {
    rows: Vec<Vec<i64>>,
    cols: usize,
    kept: Vec<usize>,
    /// One list of residues for each deleted column.
    relations: Vec<Vec<u64>>,
}

impl Planted {
    fn deleted(&self) -> Vec<usize> {
        (0..self.cols).filter(|j| !self.kept.contains(j)).collect()
    }

    fn w(&self) -> Matrix {
        Matrix::from_fn(self.rows.len(), self.cols, |i, j| self.rows[i][j] as f64)
    }
}

/// c columns of small integers; some are zero, copies, or small combinations of others, in any place.
fn planted(seed: u64, rows_per_column: usize) -> Planted {
    let mut rng = Rng::new(seed);
    let cols = 4 + rng.below(37) as usize;
    let rows = rows_per_column * cols;
    let mut columns: Vec<Vec<i64>> = (0..cols)
        .map(|_| (0..rows).map(|_| rng.below(19) as i64 - 9).collect())
        .collect();
    for j in 0..cols {
        if rng.below(3) != 0 {
            continue;
        }
        let mut sum = vec![0; rows];
        // 0 terms give a zero column, 1 a copy or a multiple.
        for _ in 0..rng.below(7) {
            let (other, factor) = (rng.below(cols as u64) as usize, rng.below(7) as i64 - 3);
            if other != j {
                sum.iter_mut()
                    .zip(&columns[other])
                    .for_each(|(s, x)| *s += factor * x);
            }
        }
        columns[j] = sum;
    }
    let rows: Vec<Vec<i64>> = (0..rows)
        .map(|i| columns.iter().map(|c| c[i]).collect())
        .collect();
    let (kept, relations) = reduced_echelon(&rows, cols);
    Planted {
        rows,
        cols,
        kept,
        relations,
    }
}

fn all_planted() -> impl Iterator<Item = (u64, usize, Planted)> {
    (0..200).flat_map(|seed| [1, 2].map(|r| (seed, r, planted(seed, r))))
}

#[test]
fn staircase_qrii_null_space_and_exact_elimination_choose_the_same_columns_in_400_of_400() {
    let (mut agreed, mut least_gap) = (0, f64::INFINITY);
    for (seed, rows_per_column, truth) in all_planted() {
        let place = format!("seed {seed}, r = {rows_per_column} c, c = {}", truth.cols);
        let (w, default) = (truth.w(), Tolerance::default());
        let staircase = staircase_qr(&w, &default).unwrap();
        assert_eq!(staircase.kept, truth.kept, "staircase, {place}");
        assert_eq!(staircase.deleted, truth.deleted(), "staircase, {place}");

        let pivoted = qrii(&w).unwrap();
        let decision = pivoted.decide(&default).unwrap();
        assert_eq!(decision.rank, truth.kept.len(), "QRII, {place}");
        assert_eq!(
            pivoted.leftmost(decision.rank).unwrap(),
            truth.kept,
            "QRII, {place}"
        );

        let singular = svd(&w).unwrap();
        assert_eq!(
            singular.decide(&default).unwrap().rank,
            truth.kept.len(),
            "SVD, {place}"
        );
        let v2 = singular.null_space(truth.kept.len());
        assert_eq!(
            deleted_from_null_space(&v2).unwrap(),
            truth.deleted(),
            "V2, {place}"
        );
        for d in [
            &staircase.decision,
            &decision,
            &singular.decide(&default).unwrap(),
        ] {
            least_gap = least_gap.min(d.gap.unwrap_or(f64::INFINITY));
            assert_eq!(d.ambiguous, Vec::<usize>::new(), "{place}");
        }
        agreed += 1;
    }
    println!("smallest gap {least_gap:.2e}");
    assert_eq!(agreed, 400);
}

/// What is left of relations after comparing them with the exact ones: the largest error over its
/// bound, and the largest error relative to the bound's own data error.
fn compare(found: Relations, truth: &Planted, place: &str) -> (f64, f64) {
    let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
    let mut cleaned = found.clone();
    cleaned.clean();
    for (j, column) in truth.relations.iter().enumerate() {
        for (i, &residue) in column.iter().enumerate() {
            let Some((n, d)) = fraction(residue) else {
                continue;
            };
            let exact = n as f64 / d as f64;
            let error = (found.beta[(i, j)] - exact).abs();
            assert!(
                error <= found.bound[(i, j)],
                "{place} ({i}, {j}): error {error:e}, bound {:e}",
                found.bound[(i, j)]
            );
            if error > 0.0 {
                worst = worst.max(error / found.bound[(i, j)]);
            }
            largest = largest.max(error);
            let clean = cleaned.beta[(i, j)];
            assert_eq!(
                clean == 0.0,
                n == 0,
                "{place} ({i}, {j}): {clean:e} for {n}/{d}"
            );
            assert!(
                clean != 0.0 || clean.to_bits() == 0,
                "{place}: a cleaned zero is +0"
            );
        }
    }
    (worst, largest)
}

#[test]
fn beta_by_both_routes_is_the_exact_one_within_its_bound_and_its_dust_is_cleaned_to_zero() {
    let mut worst = [(0.0_f64, 0.0_f64); 3];
    for (seed, rows_per_column, truth) in all_planted() {
        let place = format!("seed {seed}, r = {rows_per_column} c, c = {}", truth.cols);
        let (w, deleted) = (truth.w(), truth.deleted());
        let singular = svd(&w).unwrap();
        let v2 = singular.null_space(truth.kept.len());
        let found = [
            relations_qr(&w, &truth.kept, &deleted).unwrap(),
            singular
                .relations(truth.kept.len(), &truth.kept, &deleted)
                .unwrap(),
            relations_svd(&v2, &truth.kept, &deleted).unwrap(),
        ];
        for (worst, found) in worst.iter_mut().zip(found) {
            let (ratio, error) = compare(found, &truth, &place);
            *worst = (worst.0.max(ratio), worst.1.max(error));
        }
        assert!(v22_condition(&v2, &deleted).unwrap() < 1e6, "{place}");
    }
    for (route, (ratio, error)) in ["R1^-1 R2", "-V21 V22^-1 (sigma known)", "-V21 V22^-1"]
        .iter()
        .zip(worst)
    {
        println!("{route}: largest error {error:.2e}, largest error / bound {ratio:.2e}");
    }
}

#[test]
fn most_relations_are_small_fractions_so_the_comparison_is_not_empty() {
    let (mut entries, mut known, mut nonzero, mut broken) = (0, 0, 0, 0);
    for (_, _, truth) in all_planted() {
        for &residue in truth.relations.iter().flatten() {
            entries += 1;
            known += usize::from(fraction(residue).is_some());
            nonzero += usize::from(residue != 0);
            broken += usize::from(fraction(residue).is_some_and(|(_, d)| d != 1));
        }
    }
    println!("{entries} entries, {known} fractions, {nonzero} not zero, {broken} not integer");
    assert!(known * 100 > entries * 99 && nonzero > 3000 && broken > 500);
    assert_eq!(fraction(3), Some((3, 1)));
    assert_eq!(fraction(P - 2), Some((-2, 1)));
}

#[test]
fn column_scales_by_powers_of_two_change_neither_the_choice_nor_a_bit_of_beta() {
    let mut rng = Rng::new(11);
    for seed in 0..40 {
        let truth = planted(seed, 2);
        let w = truth.w();
        let powers: Vec<i32> = (0..truth.cols)
            .map(|_| rng.below(401) as i32 - 200)
            .collect();
        let scaled = Matrix::from_fn(w.rows(), w.cols(), |i, j| w[(i, j)] * 2_f64.powi(powers[j]));
        let default = Tolerance::default();
        let (plain, other) = (
            staircase_qr(&w, &default).unwrap(),
            staircase_qr(&scaled, &default).unwrap(),
        );
        assert_eq!((&plain.kept, &plain.ratios), (&other.kept, &other.ratios));
        let beta = relations_qr(&w, &plain.kept, &plain.deleted).unwrap();
        let beta_scaled = relations_qr(&scaled, &plain.kept, &plain.deleted).unwrap();
        let back =
            unscale_relations(&beta_scaled.beta, &powers, &plain.kept, &plain.deleted).unwrap();
        assert!(back == beta.beta, "seed {seed}");
        let (equilibrated, exponents) = equilibrate(&w);
        let beta_e = relations_qr(&equilibrated, &plain.kept, &plain.deleted)
            .unwrap()
            .beta;
        assert!(
            unscale_relations(&beta_e, &exponents, &plain.kept, &plain.deleted).unwrap()
                == beta.beta
        );
    }
}

#[test]
fn minimum_norm_parameters_act_alike_and_are_no_longer_than_any_other() {
    let mut rng = Rng::new(12);
    for seed in 0..50 {
        let truth = planted(seed, 2);
        let (w, b) = (truth.w(), truth.kept.len());
        let singular = svd(&w).unwrap();
        let x: Vec<f64> = (0..truth.cols).map(|_| rng.uniform()).collect();
        let xm = singular.minimum_norm(b, &x).unwrap();
        let act = |x: &[f64]| {
            w.matmul(&Matrix::from_columns(x.len(), &[x]).unwrap())
                .unwrap()
        };
        let difference = common::subtract(&act(&x), &act(&xm)).max_abs();
        // c eps sigma_1, the rounding of V against W.
        assert!(
            difference <= truth.cols as f64 * f64::EPSILON * singular.sigma[0].max(1.0),
            "{difference:e}"
        );
        let square = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>();
        assert!(square(&xm) <= square(&x) * (1.0 + 1e-12));
    }
}

#[test]
fn beta_of_a_rounded_matrix_stays_within_its_bound_and_loses_only_dust() {
    // Noise of 8 eps of the column's norm, half of what the bound allows a regressor to be off.
    const NOISE: f64 = 8.0 * f64::EPSILON;
    let mut rng = Rng::new(13);
    let mut worst = 0.0_f64;
    for (_, _, truth) in all_planted() {
        let exact = truth.w();
        let size = NOISE / (exact.rows() as f64).sqrt();
        let w = Matrix::from_fn(exact.rows(), exact.cols(), |i, j| {
            exact[(i, j)] + size * exact.column_norm(j) * rng.uniform()
        });
        let found = relations_qr(&w, &truth.kept, &truth.deleted()).unwrap();
        worst = worst.max(compare(found, &truth, "rounded").0);
    }
    println!("largest error / bound {worst:.2e}");
}
