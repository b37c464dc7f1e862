//! The three factorisations on matrices of the sizes of a 6-joint and a 36-joint robot,
//! with a quarter of the columns dependent.

use criterion::{BenchmarkId, Criterion, SamplingMode, criterion_group, criterion_main};
use roberval_benches::short;
use roberval_linalg::{Matrix, Tolerance, qrii, staircase_qr, svd};

/// Rows x columns of the given rank, full of fixed numbers without a pattern.
fn matrix(rows: usize, cols: usize, rank: usize) -> Matrix {
    let mut x = 0.5_f64;
    let mut next = |_, _| {
        x = 3.999 * x * (1.0 - x);
        x - 0.5
    };
    let left = Matrix::from_fn(rows, rank, &mut next);
    let right = Matrix::from_fn(rank, cols, &mut next);
    left.matmul(&right).expect("shapes fit")
}

fn factorisations(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("linalg");
    group.sampling_mode(SamplingMode::Flat);
    for (rows, cols) in [(110, 55), (800, 400)] {
        let w = matrix(rows, cols, cols * 3 / 4);
        let size = format!("{rows} x {cols}");
        group.bench_function(BenchmarkId::new("staircase", &size), |b| {
            b.iter(|| staircase_qr(&w, &Tolerance::default()));
        });
        group.bench_function(BenchmarkId::new("qrii", &size), |b| b.iter(|| qrii(&w)));
        group.bench_function(BenchmarkId::new("svd", &size), |b| b.iter(|| svd(&w)));
    }
}

criterion_group! {
    name = benches;
    config = short();
    targets = factorisations
}
criterion_main!(benches);
