//! LAPACK's ratios of QRII, staircase QR and the SVD over its matrix types and sizes.

mod common;

use common::lapack::{Case, TYPES, case};
use common::{Rng, gram_ratio, orthogonality_ratio, spectrum_ratio, unit};
use roberval_linalg::{Matrix, Tolerance, equilibrate, qrii, staircase_qr, svd};

/// LAPACK passes below 30; a ratio counts errors in units of max(r, c) eps, and ours are near 1.
const BAR: f64 = 10.0;

/// |T_ii| may rise by 1e-10, relative (and by rounding of |T11|): what QRII promises.
const MONOTONE: f64 = 1.0 + 1e-10;

/// The largest ratio of every kind, with where it was.
#[derive(Default)]
struct Worst(Vec<(&'static str, f64, String)>);

impl Worst {
    fn note(&mut self, kind: &'static str, ratio: f64, case: &Case) {
        let place = format!("{} {} x {}", case.name, case.w.rows(), case.w.cols());
        assert!(ratio < BAR, "{kind}: ratio {ratio} at {place}");
        match self.0.iter_mut().find(|entry| entry.0 == kind) {
            None => self.0.push((kind, ratio, place)),
            Some(entry) if entry.1 < ratio => *entry = (kind, ratio, place),
            Some(_) => {}
        }
    }

    fn print(&self) {
        for (kind, ratio, place) in &self.0 {
            println!("max {kind} {ratio:.3} at {place}");
        }
    }
}

/// The matrix with its largest entry brought to about 1 by a power of two, for test-side squares.
fn tamed(w: &Matrix, by: f64) -> Matrix {
    Matrix::from_fn(w.rows(), w.cols(), |i, j| w[(i, j)] * by)
}

fn taming_factor(w: &Matrix) -> f64 {
    let largest = w.max_abs();
    if largest > 1e100 {
        2_f64.powi(-997)
    } else if largest < 1e-100 && largest > 0.0 {
        2_f64.powi(997)
    } else {
        1.0
    }
}

fn check(case: &Case, worst: &mut Worst) {
    let w = &case.w;
    let by = taming_factor(w);
    let tame = tamed(w, by);
    let svd_w = svd(w).unwrap();
    worst.note("svd probe", svd_w.ratio, case);
    worst.note("svd orthogonality", orthogonality_ratio(&svd_w.v), case);
    let sv = Matrix::from_fn(w.cols(), w.cols(), |i, j| {
        by * svd_w.sigma[i] * svd_w.v[(j, i)]
    });
    worst.note("svd W'W = V S^2 V'", gram_ratio(&tame, &sv), case);
    assert!(
        svd_w.sigma.windows(2).all(|s| s[0] >= s[1]),
        "{}",
        case.name
    );
    let truth = case.sigma.as_ref().unwrap_or(&svd_w.sigma);
    worst.note("svd sigma", spectrum_ratio(&svd_w.sigma, truth, w), case);

    let pivoted = qrii(w).unwrap();
    worst.note("qrii probe", pivoted.ratio, case);
    let unpivoted = tame.select_columns(&pivoted.permutation);
    worst.note(
        "qrii W'W = T'T",
        gram_ratio(&unpivoted, &tamed(&pivoted.r, by)),
        case,
    );
    worst.note(
        "qrii sigma(T)",
        spectrum_ratio(&svd(&pivoted.r).unwrap().sigma, truth, w),
        case,
    );
    for (i, t) in pivoted.diagonal.windows(2).enumerate() {
        assert!(
            t[1] <= t[0] * MONOTONE + unit(w) * pivoted.diagonal[0],
            "{}: |T_ii| rises at {i} from {:e} to {:e}",
            case.name,
            t[0],
            t[1]
        );
    }

    // What LAPACK would keep: only rounding counts as dependent.
    let rounding = w.rows().max(w.cols()).max(1) as f64 * f64::EPSILON;
    let tolerance = Tolerance::Relative {
        dependent: rounding,
        independent: rounding,
    };
    let staircase = staircase_qr(w, &tolerance).unwrap();
    worst.note(
        "staircase W'W = R'R",
        gram_ratio(&tame, &tamed(&staircase.r, by)),
        case,
    );
    worst.note(
        "staircase sigma(R)",
        spectrum_ratio(&svd(&staircase.r).unwrap().sigma, truth, w),
        case,
    );
}

#[test]
fn ratios_stay_below_ten_for_every_type_at_lapack_sizes() {
    let (mut rng, mut worst) = (Rng::new(3), Worst::default());
    for rows in [0, 1, 2, 3, 5, 10, 50] {
        for cols in [0, 1, 2, 3, 5, 10, 50] {
            for kind in 0..TYPES {
                check(&case(kind, rows, cols, &mut rng), &mut worst);
            }
        }
    }
    worst.print();
}

#[test]
fn ratios_stay_below_ten_for_every_size_up_to_66_square_tall_and_wide() {
    let (mut rng, mut worst) = (Rng::new(4), Worst::default());
    for n in 0..=66 {
        for (k, (rows, cols)) in [(n, n), (2 * n + 1, n), (n, 2 * n)].into_iter().enumerate() {
            for kind in [(n + 8 * k) % TYPES, (3 * n + 11 + k) % TYPES] {
                check(&case(kind, rows, cols, &mut rng), &mut worst);
            }
        }
    }
    worst.print();
}

#[test]
fn ratios_stay_below_ten_at_110_and_400_columns() {
    let (mut rng, mut worst) = (Rng::new(5), Worst::default());
    for kind in 0..TYPES {
        check(&case(kind, 110, 110, &mut rng), &mut worst);
        check(&case(kind, 110, 55, &mut rng), &mut worst);
    }
    check(&case(19, 800, 400, &mut rng), &mut worst);
    check(&case(20, 400, 400, &mut rng), &mut worst);
    worst.print();
}

#[test]
fn columns_zeroed_by_lapack_types_are_the_ones_deleted() {
    let mut rng = Rng::new(6);
    for kind in 10..18 {
        for (rows, cols) in [(40, 20), (20, 20), (66, 65)] {
            let case = case(kind, rows, cols, &mut rng);
            let zero: Vec<usize> = (0..cols)
                .filter(|&j| case.w.column_norm(j) == 0.0)
                .collect();
            let default = Tolerance::default();
            let staircase = staircase_qr(&case.w, &default).unwrap();
            assert_eq!(staircase.deleted, zero, "{} {rows} x {cols}", case.name);
            let pivoted = qrii(&case.w).unwrap();
            let rank = pivoted.decide(&default).unwrap().rank;
            assert_eq!(rank, cols - zero.len(), "{} {rows} x {cols}", case.name);
            assert_eq!(pivoted.leftmost(rank).unwrap(), staircase.kept);
            assert_eq!(svd(&case.w).unwrap().decide(&default).unwrap().rank, rank);
        }
    }
}

#[test]
fn equilibrating_brings_every_norm_between_the_roots_of_a_half_and_two() {
    let mut rng = Rng::new(7);
    for kind in 0..TYPES {
        let case = case(kind, 30, 20, &mut rng);
        let (scaled, exponents) = equilibrate(&case.w);
        for j in 0..20 {
            let norm = scaled.column_norm(j);
            let zero = case.w.column_norm(j) == 0.0;
            assert!(
                if zero {
                    norm == 0.0
                } else {
                    norm >= 0.5_f64.sqrt() * (1.0 - f64::EPSILON)
                        && norm < 2_f64.sqrt() * (1.0 + f64::EPSILON)
                },
                "{}: {norm}",
                case.name
            );
            for i in 0..30 {
                assert_eq!(
                    scaled[(i, j)] * 2_f64.powi(-exponents[j]),
                    case.w[(i, j)],
                    "exact in {}",
                    case.name
                );
            }
        }
    }
}
