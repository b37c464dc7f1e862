//! The regressor: one state, a batch of 1000, packed, base columns, torques; sine and cosine.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use roberval_base::{Options, Samples, base_parameters};
use roberval_benches::{robots, short};
use roberval_regressor::{Model, Regressor, Writing};
use roberval_scalar::{Lanes, Task, Width, dispatch};

const BATCH: usize = 1000;

fn rows(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("regressor");
    for (name, robot) in robots() {
        let regressor = Regressor::new(&robot);
        let models = [
            (Model::D, 1),
            (Model::D, BATCH),
            (Model::D0, BATCH),
            (Model::H, BATCH),
        ];
        for (model, count) in models {
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

/// The reduced model's columns, in the cache and past it.
fn columns(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("base columns");
    for (name, robot) in robots() {
        let regressor = Regressor::new(&robot);
        let base = base_parameters(&robot, &Options::default())
            .expect("a rank")
            .base;
        let columns = regressor.columns(Model::D, &base);
        for (what, count, past_cache, keep_zeros) in [
            ("in cache", 64, false, false),
            ("in cache, zeros kept", 64, false, true),
            ("past the cache", BATCH, true, false),
            ("past the cache, zeros kept", BATCH, true, true),
        ] {
            let writing = Writing {
                past_cache,
                keep_zeros,
            };
            let samples = Samples::draw(&robot, count, 1).expect("samples");
            let mut out = vec![0.0; count * robot.dof() * base.len()];
            group.throughput(Throughput::Elements(count as u64));
            group.bench_function(BenchmarkId::new(what, name), |b| {
                b.iter(|| {
                    let (to, states) = (&mut out, samples.states());
                    regressor.fill_part(Model::D, Some(&columns), states, to, writing)
                });
            });
        }
    }
}

/// Sine and cosine of 1024 angles.
struct SinCos<'a>(&'a [f64], &'a mut [f64]);

impl Task for SinCos<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes>(self) {
        let Self(angles, out) = self;
        for (x, out) in angles
            .chunks_exact(V::COUNT)
            .zip(out.chunks_exact_mut(V::COUNT))
        {
            let [(sin, cos)] = V::sin_cos([V::load(x)]);
            (sin + cos).store(out);
        }
    }
}

fn sin_cos(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("sin_cos");
    let angles: Vec<f64> = (0..1024).map(|k| 0.02 * f64::from(k) - 10.0).collect();
    let mut out = vec![0.0; 1024];
    group.throughput(Throughput::Elements(1024));
    for width in Width::ALL.into_iter().filter(|width| width.is_available()) {
        group.bench_function(BenchmarkId::new("1024", format!("{width:?}")), |b| {
            b.iter(|| dispatch(width, SinCos(&angles, &mut out)));
        });
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
    targets = rows, packed, columns, torques, sin_cos
}
criterion_main!(benches);
