//! The exact engine: rank and choice, beta, and the nullspace algorithm beside it.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use roberval_base::{Model, choose_exactly, decide_exactly, nullspace_rank};
use roberval_mechanism::{Mechanism, SourceFormat};
use roberval_testkit::{Angles, Family};

/// Five limbs of seven revolute joints, two of them on the end of the first, with lengths
/// in millimetres.
fn humanoid(angles: Angles) -> Mechanism {
    let family = Family {
        links: (35, 35),
        prismatic: 0.0,
        fixed: 0.0,
        angles,
        format: SourceFormat::Urdf,
        ..Family::default()
    };
    let mut robot = family.robot(35);
    for j in 0..35 {
        robot.links[j].antecedent = match j {
            0 | 7 | 14 => None,
            21 | 28 => Some("7".to_owned()),
            _ => Some(j.to_string()),
        };
    }
    Mechanism::new(&robot).expect("valid")
}

fn robots() -> Vec<(&'static str, Mechanism)> {
    let built_in = |name| {
        let description = roberval_formats::load(name).expect("in the catalogue");
        (name, Mechanism::new(&description).expect("valid"))
    };
    vec![
        built_in("puma560"),
        built_in("iiwa14"),
        built_in("panda"),
        ("humanoid35", humanoid(Angles::Right)),
        ("humanoid35_surds", humanoid(Angles::Fifteens)),
    ]
}

fn exact(c: &mut Criterion) {
    for (name, robot) in robots() {
        let order: Vec<usize> = (0..robot.parameters().len()).collect();
        c.bench_function(&format!("nullspace/{name}"), |b| {
            b.iter(|| nullspace_rank(black_box(&robot), 1));
        });
        c.bench_function(&format!("choice/{name}"), |b| {
            b.iter(|| choose_exactly(black_box(&robot), Model::D, &order, 1));
        });
        c.bench_function(&format!("beta/{name}"), |b| {
            b.iter(|| decide_exactly(black_box(&robot), Model::D, &order, 1));
        });
    }
}

criterion_group!(benches, exact);
criterion_main!(benches);
