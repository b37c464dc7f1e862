//! What generated code costs, and what it reads.

use roberval_base::{BaseParameters, Options, base_parameters};
use roberval_code::{Code, Input, Op, Request, What};
use roberval_mechanism::{Mechanism, SourceFormat};
use roberval_testkit::{Angles, Family};

fn answer(name: &str) -> BaseParameters {
    let robot = roberval_formats::load(name).expect("a built-in robot");
    let mechanism = Mechanism::new(&robot).expect("a valid robot");
    base_parameters(&mechanism, &Options::default()).expect("an answer")
}

fn code(mechanism: &Mechanism, what: What, columns: &[usize]) -> Code {
    code_without(mechanism, what, columns, &[])
}

fn code_without(mechanism: &Mechanism, what: What, columns: &[usize], no_effect: &[usize]) -> Code {
    let request = Request {
        what,
        columns,
        no_effect,
        friction: false,
    };
    Code::new(mechanism, &request).expect("code")
}

/// A chain of so many revolute joints.
fn chain(joints: usize, angles: Angles, format: SourceFormat, seed: u64) -> Mechanism {
    let family = Family {
        links: (joints, joints),
        branch: 0.0,
        prismatic: 0.0,
        fixed: 0.0,
        angles,
        format,
    };
    Mechanism::new(&family.robot(seed)).expect("a valid robot")
}

/// Multiplications and additions of composite rigid bodies written for no robot in
/// particular, as R. Featherstone counts them for a chain of n joints: 612 and 510 for 7.
fn generic(n: usize) -> (usize, usize) {
    (10 * n * n + 22 * n - 32, 6 * n * n + 37 * n - 43)
}

#[test]
fn a_mass_matrix_is_cheaper_than_composite_bodies_of_any_robot() {
    use SourceFormat::{Mdh, Urdf};
    for (joints, angles, format) in [
        (2, Angles::Right, Mdh),
        (7, Angles::Right, Urdf),
        (7, Angles::Oblique, Mdh),
        (7, Angles::Oblique, Urdf),
        (15, Angles::Mixed, Mdh),
        (30, Angles::Mixed, Urdf),
    ] {
        for seed in 0..5 {
            let mechanism = chain(joints, angles, format, seed);
            let all: Vec<usize> = (0..mechanism.parameters().len()).collect();
            let count = code(&mechanism, What::MassMatrix, &all).count();
            let (mul, add) = generic(joints);
            assert!(
                count.mul <= mul && count.add <= add,
                "{joints} joints, {angles:?}, seed {seed}: {count:?}, generic {mul} and {add}"
            );
        }
    }
}

#[test]
fn a_mass_matrix_grows_as_the_square_of_the_joints() {
    let cost = |joints| {
        let mechanism = chain(joints, Angles::Right, SourceFormat::Mdh, 1);
        let all: Vec<usize> = (0..mechanism.parameters().len()).collect();
        code(&mechanism, What::MassMatrix, &all)
            .count()
            .arithmetic()
    };
    let (short, long) = (cost(20), cost(40));
    // Four times for the square, eight for the cube.
    assert!(long < 5 * short, "{short} for 20 joints, {long} for 40");
}

#[test]
fn arms_have_the_counts_that_the_documentation_gives() {
    for (name, what, mul, add) in [
        ("puma560", What::Tau, 251, 228),
        ("puma560", What::MassMatrix, 140, 128),
        ("stanford", What::Tau, 222, 201),
        ("stanford", What::MassMatrix, 95, 86),
        ("rx90", What::Tau, 238, 217),
        ("iiwa14", What::Tau, 291, 267),
        ("iiwa14", What::MassMatrix, 167, 147),
    ] {
        let answer = answer(name);
        let count = code(&answer.mechanism, what, &answer.base).count();
        assert_eq!((count.mul, count.add), (mul, add), "{name} {what:?}");
    }
}

#[test]
fn parameters_without_effect_are_not_read() {
    let catalogue = roberval_formats::catalogue().iter();
    let names = catalogue.map(|entry| entry.name);
    for name in names.filter(|name| !["delta", "four_bar"].contains(name)) {
        let answer = answer(name);
        let all: Vec<usize> = (0..answer.parameters.len()).collect();
        let code = code_without(&answer.mechanism, What::Tau, &all, &answer.no_effect);
        for program in code.prepare.iter().chain([&code.main]) {
            for op in &program.nodes {
                let Op::Input(k) = *op else { continue };
                if let Input::Parameter(at) = program.inputs[k as usize] {
                    let label = &code.parameters[at];
                    assert!(!answer.no_effect.contains(&at), "{name} reads {label}");
                }
            }
        }
    }
}
