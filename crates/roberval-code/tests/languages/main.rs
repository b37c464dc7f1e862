//! Generated code in four languages against the library.

mod cases;
mod drivers;
mod generated;

use cases::{Case, cases};
use drivers::Driver;

/// Straight-line code and the library round differently; values are a few tens at most,
/// and errors are taken against the largest value of a result.
const TOLERANCE: f64 = 1e-12;

/// Compares what a driver's program printed with what the library says.
fn check(driver: &Driver) {
    let cases = cases();
    let Some(printed) = driver.run(cases) else {
        return;
    };
    let mut printed = printed.split_whitespace();
    for case in cases {
        for (sample, expected) in case.expected.iter().enumerate() {
            let scale = expected.iter().fold(1.0_f64, |m, x| m.max(x.abs()));
            for (at, expected) in expected.iter().enumerate() {
                let word = printed.next().expect("as many numbers as there are");
                let found: f64 = word.parse().expect("a number");
                let error = (found - expected).abs() / scale;
                assert!(
                    error <= TOLERANCE,
                    "{}: sample {sample}, entry {at}: {found} for {expected}",
                    case.code.function()
                );
            }
        }
    }
    assert_eq!(printed.next(), None);
}

#[test]
fn there_are_twenty_robots_with_trees_prismatic_joints_couples_and_loops_among_them() {
    let cases = cases();
    let mut robots: Vec<&str> = cases.iter().map(|c| c.code.robot.as_str()).collect();
    robots.dedup();
    assert!(robots.len() >= 20, "{robots:?}");
    assert!(cases.iter().any(Case::branches));
    assert!(cases.iter().any(Case::slides));
    assert!(cases.iter().any(Case::is_coupled));
    assert!(cases.iter().any(Case::follows_expressions));
    assert!(cases.iter().any(Case::has_loops));
    assert!(cases.iter().any(Case::floats));
}

#[test]
fn c_gives_the_librarys_numbers() {
    check(&drivers::C);
}

#[test]
fn rust_gives_the_librarys_numbers() {
    check(&drivers::RUST);
}

#[test]
fn numpy_gives_the_librarys_numbers() {
    check(&drivers::PYTHON);
}

#[test]
fn octave_gives_the_librarys_numbers() {
    check(&drivers::OCTAVE);
}
