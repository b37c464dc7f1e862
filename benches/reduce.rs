//! Streaming least squares: joint states and torques to R, one thread; merging.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use roberval_base::{Options, Samples, base_parameters};
use roberval_benches::{robots, short};
use roberval_reduce::{Friction, Reduction, Samples as Measured, Weights};
use roberval_regressor::Regressor;

const BATCH: usize = 8192;

fn reduce(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("reduce");
    group.throughput(Throughput::Elements(BATCH as u64));
    let speeds = Friction {
        viscous: true,
        coulomb: true,
        offset: false,
    };
    for (name, robot) in robots() {
        let base = base_parameters(&robot, &Options::default())
            .expect("a rank")
            .base;
        let samples = Samples::draw(&robot, BATCH, 1).expect("samples");
        let tau = vec![1.0; BATCH * robot.dof()];
        for (what, friction) in [("base", Friction::default()), ("base, friction", speeds)] {
            let reduction = Reduction::new(Regressor::new(&robot), &base, friction);
            let mut reduction = reduction.expect("no constraints").with_threads(1);
            group.bench_function(BenchmarkId::new(what, name), |b| {
                b.iter(|| {
                    reduction.update(&Measured {
                        states: samples.states(),
                        tau: &tau,
                        weights: Weights::Equal,
                    })
                });
            });
        }
    }
}

/// What a cluster does with two factors, and what a checkpoint costs.
fn merge(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("factor");
    for (name, robot) in robots() {
        let base = base_parameters(&robot, &Options::default())
            .expect("a rank")
            .base;
        let samples = Samples::draw(&robot, 512, 1).expect("samples");
        let tau = vec![1.0; 512 * robot.dof()];
        let mut reduction =
            Reduction::new(Regressor::new(&robot), &base, Friction::default()).expect("columns");
        reduction
            .update(&Measured {
                states: samples.states(),
                tau: &tau,
                weights: Weights::Equal,
            })
            .expect("finite");
        let factor = reduction.factor();
        group.bench_function(BenchmarkId::new("of all lanes", name), |b| {
            b.iter(|| reduction.factor());
        });
        group.bench_function(BenchmarkId::new("merge", name), |b| {
            b.iter(|| factor.merge(&factor));
        });
        group.bench_function(BenchmarkId::new("checkpoint", name), |b| {
            b.iter(|| reduction.to_bytes(&[]));
        });
    }
}

criterion_group! {
    name = benches;
    config = short();
    targets = reduce, merge
}
criterion_main!(benches);
