//! How many operations the kernel does: what a machine's mood does not change.

use std::cell::Cell;
use std::ops::{Add, Mul, Neg, Sub};
use std::process::Command;

use roberval_mechanism::{JointKind, Mechanism};
use roberval_regressor::{
    DynamicsWorkspace, JointMotion, Model, Nonzero, Regressor, Sink, States, Tree, dynamics,
};
use roberval_scalar::{Lift, Scalar, Width};

thread_local! {
    static COUNT: Cell<usize> = const { Cell::new(0) };
}

/// A number that counts what is done to it; a fused product and sum counts once.
#[derive(Clone, Copy)]
struct Counted;

fn one() -> Counted {
    COUNT.set(COUNT.get() + 1);
    Counted
}

impl Add for Counted {
    type Output = Self;
    fn add(self, _: Self) -> Self {
        one()
    }
}

impl Sub for Counted {
    type Output = Self;
    fn sub(self, _: Self) -> Self {
        one()
    }
}

impl Mul for Counted {
    type Output = Self;
    fn mul(self, _: Self) -> Self {
        one()
    }
}

impl Neg for Counted {
    type Output = Self;
    fn neg(self) -> Self {
        one()
    }
}

impl Scalar for Counted {
    fn mul_add(self, _: Self, _: Self) -> Self {
        one()
    }

    fn neg_mul_add(self, _: Self, _: Self) -> Self {
        one()
    }
}

impl Lift<f64> for Counted {
    fn lift(_: f64) -> Self {
        Self
    }
}

struct Nowhere;

impl Sink<Counted> for Nowhere {
    fn link(&mut self, _: usize, _: usize, _: [Counted; 10], _: Nonzero) {}
    fn rotor(&mut self, _: usize, _: usize, _: Counted) {}
}

fn operations(tree: &Tree<f64>) -> usize {
    let still = JointMotion::still(Counted, Counted);
    let mut workspace = DynamicsWorkspace::new(tree);
    COUNT.set(0);
    dynamics(
        tree,
        &vec![still; tree.bodies.len()],
        &mut workspace,
        &mut Nowhere,
    );
    COUNT.get()
}

fn built_in(name: &str) -> Tree<f64> {
    let description = roberval_formats::load(name).expect("in the catalogue");
    Tree::of(&Mechanism::new(&description).expect("valid"))
}

#[test]
fn a_row_of_a_link_costs_some_forty_operations() {
    // Signs are counted. Carrying blocks to the ancestors instead of screws to the bodies would
    // take 3900 more. Of U each body counts all nine entries of its antecedent's, of which lanes
    // make the columns that its origin meets.
    for (name, expected) in [("puma560", 946), ("iiwa14", 1288)] {
        assert_eq!(operations(&built_in(name)), expected, "{name}");
    }
}

/// The robot and how often its regressor is to be evaluated, for the process under callgrind.
const COUNTED: &str = "ROBERVAL_COUNTED";

#[test]
#[ignore = "the next test runs it under callgrind"]
fn evaluates_one_sample_after_the_other() {
    let asked = std::env::var(COUNTED).expect("set by the next test");
    let (name, times) = asked.split_once(' ').expect("a name and a number");
    let description = roberval_formats::load(name).expect("in the catalogue");
    let robot = Mechanism::new(&description).expect("valid");
    let regressor = Regressor::new(&robot).with_width(Width::narrow());
    let numbers: Vec<f64> = (1..=robot.dof()).map(|j| 0.1 * j as f64).collect();
    let [q, qd, qdd] = [&numbers[..]; 3];
    let mut out = vec![0.0; robot.dof() * regressor.parameters().len()];
    for _ in 0..times.parse().expect("a number") {
        let states = States { q, qd, qdd };
        regressor.fill(Model::D, states, &mut out).expect("finite");
    }
    assert!(out.iter().any(|x| *x != 0.0));
}

/// Instructions of this test process, or why they cannot be counted.
fn instructions(name: &str, times: usize) -> Result<usize, String> {
    let program = std::env::current_exe().map_err(|e| e.to_string())?;
    let run = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(program)
        .args([
            "--exact",
            "--ignored",
            "evaluates_one_sample_after_the_other",
        ])
        .env(COUNTED, format!("{name} {times}"))
        .output()
        .map_err(|e| format!("valgrind: {e}"))?;
    let report = String::from_utf8_lossy(&run.stderr);
    let collected = report.lines().find_map(|l| l.split_once("Collected :"));
    let (_, count) = collected.ok_or_else(|| format!("valgrind: {report}"))?;
    assert!(run.status.success(), "{report}");
    count.trim().parse().map_err(|_| count.to_owned())
}

#[test]
fn a_sample_costs_so_many_instructions() {
    /// Counted: 5861 and 7243, with the checks of a test build. Another compiler may do a
    /// little worse.
    const BOUNDS: [(&str, usize); 2] = [("puma560", 6_400), ("iiwa14", 7_900)];
    for (name, bound) in BOUNDS {
        match (instructions(name, 50), instructions(name, 250)) {
            (Ok(few), Ok(many)) => {
                let count = (many - few) / 200;
                println!("{name}: {count} instructions a sample");
                assert!(count <= bound, "{name}: {count} instructions a sample");
            }
            (Err(reason), _) | (_, Err(reason)) => {
                println!("skipped: {reason}");
                return;
            }
        }
    }
}

#[test]
fn own_rows_have_slots_only_for_what_such_a_joint_can_feel() {
    let slots = |robot: &Mechanism| {
        let regressor = Regressor::new(robot);
        regressor.packed_layout(Model::D).entries().len()
    };
    let puma = roberval_formats::load("puma560").expect("in the catalogue");
    let robot = Mechanism::new(&puma).expect("valid");
    // 15 rows of other joints with ten columns; on the own rows eight, and three (inertia about
    // the axis, moments across it) where nothing else moves the link; six rotors.
    assert_eq!(slots(&robot), 15 * 10 + 5 * 8 + 3 + 6);
    let place = "alpha = 0\nd = 0.1\ntheta = 0\nr = 0\n";
    let stand = format!("[[link]]\nname = 'a'\nantecedent = 'base'\njoint = 'fixed'\n{place}");
    for (joint, expected) in [("revolute", 3 + 1), ("prismatic", 4 + 1)] {
        let link = format!("[[link]]\nname = 'b'\nantecedent = 'a'\njoint = '{joint}'\n{place}");
        let text = format!("name = 'arm'\n{stand}{link}");
        let described = roberval_formats::parse_toml(&text, "arm").expect("valid");
        let robot = Mechanism::new(&described).expect("valid");
        assert_eq!(slots(&robot), expected, "{joint}");
    }
}

#[test]
fn an_arm_along_other_axes_costs_as_much() {
    // The same arm with its frames' axes renamed in turn, as a URDF may have them.
    let tree = built_in("iiwa14");
    let expected = operations(&tree);
    let turn = |v: [f64; 3]| [v[2], v[0], v[1]];
    let mut turned = tree.clone();
    for body in &mut turned.bodies {
        body.rotation = turn_rows(body.rotation.map(turn));
        body.origin = turn(body.origin);
        body.axis = turn(body.axis);
        body.layout = roberval_regressor::Layout::of(
            JointKind::Revolute,
            &body.rotation,
            &body.origin,
            &body.axis,
        );
    }
    turned.gravity = turn(turned.gravity);
    assert_eq!(operations(&turned), expected);
}

fn turn_rows(a: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    [a[2], a[0], a[1]]
}
