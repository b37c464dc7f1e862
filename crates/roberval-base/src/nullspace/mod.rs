//! Rank and choice link by link, without samples: the recursive parameter nullspace
//! algorithm (Wensing, Niemeyer, Slotine, arXiv 1711.03896), with rotor inertias.
//!
//! A change of a link's parameters that no motion shows can be moved into its antecedent.
//! It is such a change if, for every velocity that the antecedent can have, the link's
//! energy depends neither on its joint's velocity nor on its joint's position. These are
//! linear conditions on the ten or eleven parameters; b is the sum over the links of the
//! numbers of independent ones. The conditions need only the spans of what is attainable,
//! so that nothing is sampled. They share no code with the regressor: a witness of its
//! own for chains and trees.

mod attainable;
mod spatial;

use roberval_linalg::Echelon;
use roberval_mechanism::{JointKind, Mechanism};
use roberval_regressor::{AngleOrder, Body, Tree};
use roberval_scalar::Fp;

use crate::ExactError;
use crate::exact::in_some_field;
use attainable::Attainable;
use spatial::{Matrix6, Vector6, cross_matrix, energy_rate, outer, product, transposed};

/// Rank and choice of a chain or tree, link by link.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NullspaceDecision {
    /// The number of base parameters that each link contributes: the number of its
    /// columns that the paper's choice keeps. 0 for a link on a fixed joint.
    pub per_link: Vec<usize>,
    /// The columns that the paper's choice keeps, ascending.
    pub kept: Vec<usize>,
    /// b, the sum of `per_link`.
    pub rank: usize,
    /// The prime of the field.
    pub prime: u64,
    /// The seed of the prime and of the values that stand for generic angles.
    pub seed: u64,
}

/// Rank and paper's choice of the mechanism by the recursive parameter nullspace
/// algorithm, in one random prime field: an independent check of
/// [`crate::decide_exactly`], which is the same for all models.
///
/// # Errors
/// [`ExactError::NotInField`] if a number of the description has no place in any of many
/// prime fields.
pub fn nullspace_rank(mechanism: &Mechanism, seed: u64) -> Result<NullspaceDecision, ExactError> {
    let angles = AngleOrder::of(&mechanism.description);
    let space = mechanism.parameters();
    let decision = in_some_field(mechanism, angles, seed, 1, |exact, _| {
        let tree = exact.tree();
        let kept_of_links = kept_of_links(tree);
        let columns = |(link, kept): (usize, &Vec<usize>)| {
            let first = space.first_column(link);
            kept.iter().map(move |k| first + k).collect::<Vec<_>>()
        };
        let per_link: Vec<usize> = kept_of_links.iter().map(Vec::len).collect();
        NullspaceDecision {
            kept: kept_of_links.iter().enumerate().flat_map(columns).collect(),
            rank: per_link.iter().sum(),
            per_link,
            prime: exact.modulus().p(),
            seed,
        }
    })?;
    Ok(decision)
}

/// For each link, the places of its parameters that cannot be moved into its antecedent.
///
/// A parameter of the link goes if a change of it, and of the link's parameters before
/// it, is invisible: if its conditions depend on those of the parameters before it. The
/// leftmost independent columns of the conditions are what the paper's rule keeps.
fn kept_of_links(tree: &Tree<Fp<'_>>) -> Vec<Vec<usize>> {
    let mut of_links: Vec<Attainable<'_>> = Vec::with_capacity(tree.bodies.len());
    let mut kept = Vec::with_capacity(tree.bodies.len());
    for body in &tree.bodies {
        let carried = match body.antecedent {
            Some(a) => of_links[a].carried(body, tree.constants),
            None => Attainable::base(tree).carried(body, tree.constants),
        };
        let Some(joint) = joint_axis(body, tree.constants.zero) else {
            kept.push(Vec::new());
            of_links.push(carried);
            continue;
        };
        let cross = cross_matrix(&joint, tree.constants.zero);
        let mut attainable = carried.moved_by(&cross);
        kept.push(conditions(body, &joint, &cross, &attainable).kept());
        attainable.add_joint(&joint);
        of_links.push(attainable);
    }
    kept
}

/// S, the velocity of the link relative to its antecedent at unit joint velocity.
fn joint_axis<'m>(body: &Body<Fp<'m>>, zero: Fp<'m>) -> Option<Vector6<Fp<'m>>> {
    let [x, y, z] = body.axis;
    match body.joint {
        JointKind::Revolute => Some([x, y, z, zero, zero, zero]),
        JointKind::Prismatic => Some([zero, zero, zero, x, y, z]),
        JointKind::Fixed => None,
    }
}

/// The conditions on a change I of the link's inertia and Ia of its rotor's, as rows.
fn conditions<'m>(
    body: &Body<Fp<'m>>,
    joint: &Vector6<Fp<'m>>,
    cross: &Matrix6<Fp<'m>>,
    attainable: &Attainable<'m>,
) -> Echelon<'m> {
    let modulus = body.axis_squared.modulus();
    let zero = modulus.integer(0);
    let columns = if body.rotor { 11 } else { 10 };
    let mut rows = Echelon::new(modulus, columns);
    let mut insert = |square: &Matrix6<Fp<'m>>, rotor: Fp<'m>| {
        let mut row = [rotor; 11];
        row[..10].copy_from_slice(&energy_rate(square));
        rows.insert(&row[..columns]);
    };
    // S' I S + Ia = 0; the axis may be in units of its own.
    insert(&outer(joint, joint), body.axis_squared);
    // S' I w = 0, w being a velocity of the antecedent or gravity.
    for w in attainable.velocities().iter().chain(attainable.gravity()) {
        insert(&outer(joint, w), zero);
    }
    // w' I (S x w) = 0.
    for square in attainable.squares() {
        insert(&product(square, &transposed(cross)), zero);
    }
    rows
}
