//! The regressor: one state, a batch of 1000, and torques without storing d.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use roberval_base::Samples;
use roberval_benches::{robots, short};
use roberval_regressor::{Model, Regressor};
use roberval_scalar::Width;

const BATCH: usize = 1000;

fn rows(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("regressor");
    for (name, robot) in robots() {
        let regressor = Regressor::new(&robot);
        for (model, count) in [(Model::D, 1), (Model::D, BATCH), (Model::H, BATCH)] {
            let samples = Samples::draw(&robot, count, 1).expect("samples");
            let size = count * model.rows(robot.dof()) * regressor.parameters().len();
            let mut out = vec![0.0; size];
            group.throughput(Throughput::Elements(count as u64));
            let id = BenchmarkId::new(format!("{} x {count}", model.name()), name);
            group.bench_function(id, |b| {
                b.iter(|| regressor.fill(model, samples.states(), &mut out));
            });
        }
    }
}

/// The nonzeros alone, into memory that stays in the cache, by lanes of every width.
fn packed(criterion: &mut Criterion) {
    const CACHED: usize = 64;
    let mut group = criterion.benchmark_group("packed");
    group.throughput(Throughput::Elements(CACHED as u64));
    for (name, robot) in robots() {
        let samples = Samples::draw(&robot, CACHED, 1).expect("samples");
        for width in Width::ALL.into_iter().filter(|width| width.is_available()) {
            let regressor = Regressor::new(&robot).with_width(width);
            for model in [Model::D, Model::H] {
                let size = regressor
                    .packed_layout(model)
                    .len(CACHED, regressor.lanes());
                let mut out = vec![0.0; size];
                let id = BenchmarkId::new(format!("{} {width:?}", model.name()), name);
                group.bench_function(id, |b| {
                    b.iter(|| regressor.fill_packed(model, samples.states(), &mut out));
                });
            }
        }
    }
}

fn torques(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("torques");
    group.throughput(Throughput::Elements(BATCH as u64));
    for (name, robot) in robots() {
        let regressor = Regressor::new(&robot);
        let samples = Samples::draw(&robot, BATCH, 1).expect("samples");
        let x = vec![1.0; regressor.parameters().len()];
        let mut out = vec![0.0; BATCH * robot.dof()];
        group.bench_function(BenchmarkId::new(format!("x {BATCH}"), name), |b| {
            b.iter(|| regressor.torques(&x, samples.states(), &mut out));
        });
    }
}

criterion_group! {
    name = benches;
    config = short();
    targets = rows, packed, torques
}
criterion_main!(benches);
