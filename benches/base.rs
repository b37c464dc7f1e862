//! The whole method, each model by each engine, and the search for scaled samples.

use std::ops::ControlFlow;

use criterion::{BenchmarkId, Criterion, SamplingMode, criterion_group, criterion_main};
use roberval_base::{Engine, Model, Options, ScalingOptions, base_parameters, scale};
use roberval_benches::{coupled_robots, robots, short};

fn base(criterion: &mut Criterion) {
    for (name, robot) in robots() {
        let mut group = criterion.benchmark_group(format!("base_parameters, {name}"));
        group.sampling_mode(SamplingMode::Flat);
        for model in Model::ALL {
            for engine in Engine::ALL {
                let options = Options {
                    model,
                    engine,
                    ..Options::default()
                };
                let id = BenchmarkId::new(model.name(), engine.name());
                group.bench_function(id, |b| b.iter(|| base_parameters(&robot, &options)));
            }
        }
    }
}

/// The SR400 takes less than 20 ms, the humanoid less than 1 s.
fn coupled(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("base_parameters, coupled");
    group.sampling_mode(SamplingMode::Flat);
    let options = Options::default();
    for (name, robot) in coupled_robots() {
        group.bench_function(name, |b| b.iter(|| base_parameters(&robot, &options)));
    }
}

fn scaling(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("scale");
    group.sampling_mode(SamplingMode::Flat);
    let options = ScalingOptions::default();
    for (name, robot) in robots().into_iter().take(2) {
        group.bench_function(BenchmarkId::new("h", name), |b| {
            b.iter(|| scale(&robot, &options, |_| ControlFlow::Continue(())));
        });
    }
}

criterion_group! {
    name = benches;
    config = short();
    targets = base, coupled, scaling
}
criterion_main!(benches);
