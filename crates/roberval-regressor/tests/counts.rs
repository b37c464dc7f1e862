//! How many operations the kernel does: what a machine's mood does not change.

use std::cell::Cell;
use std::ops::{Add, Mul, Neg, Sub};

use roberval_mechanism::{JointKind, Mechanism};
use roberval_regressor::{DynamicsWorkspace, JointMotion, Sink, Tree, dynamics};
use roberval_scalar::{Lift, Scalar};

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
    fn link(&mut self, _: usize, _: usize, _: [Counted; 10]) {}
    fn rotor(&mut self, _: usize, _: usize, _: Counted) {}
}

fn operations(tree: &Tree<f64>) -> usize {
    let still = JointMotion {
        cos: Counted,
        sin: Counted,
        versine: Counted,
        q: Counted,
        qd: Counted,
        qdd: Counted,
    };
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
    // The prototype whose speed is the goal did 888 and 1172 without signs (and 3900 more if
    // blocks were carried to the ancestors instead of screws to the bodies).
    for (name, bound) in [("puma560", 1000), ("iiwa14", 1300)] {
        let count = operations(&built_in(name));
        println!("{name}: {count}");
        assert!(count <= bound, "{name}: {count} operations");
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
