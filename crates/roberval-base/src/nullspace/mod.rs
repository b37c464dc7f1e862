//! Rank and choice link by link, without samples: the recursive parameter nullspace
//! algorithm (Wensing, Niemeyer, Slotine, arXiv 1711.03896), with rotor inertias.
//!
//! A change of a link's parameters that no motion shows can be moved into its antecedent.
//! It is such a change if, for every velocity that the antecedent can have, the link's
//! energy depends neither on its joint's velocity nor on its joint's position. These are
//! linear conditions on the ten or eleven parameters; b is the sum over the links of the
//! numbers of independent ones. All ten of a floating base's parameters are visible, and
//! links on it meet all velocities. The conditions need only the spans of what is attainable,
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
use spatial::{Matrix6, Vector6, cross_matrix, energy_rate, outer, product, transform, transposed};

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
/// [`crate::decide_exactly`], which is the same for all models. The algorithm knows trees:
/// constraints are opened.
///
/// # Errors
/// [`ExactError::NotInField`] if a number of the description has no place in any of many
/// prime fields.
pub fn nullspace_rank(mechanism: &Mechanism, seed: u64) -> Result<NullspaceDecision, ExactError> {
    let angles = AngleOrder::of(mechanism);
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
    let mut of_links: Vec<(Attainable<'_>, Vec<Condition<'_>>)> = Vec::new();
    let mut kept = Vec::with_capacity(tree.bodies.len());
    let base = (Attainable::base(tree), Vec::new());
    for body in &tree.bodies {
        if body.joint == JointKind::Floating {
            kept.push((0..10).collect());
            of_links.push((Attainable::free(tree), Vec::new()));
            continue;
        }
        let (antecedent, inherited) = body.antecedent.map_or(&base, |a| &of_links[a]);
        let (own, mut conditions) = step(antecedent, body);
        conditions.extend(inherited.iter().map(|c| c.carried(body)));
        if body.massless {
            kept.push(Vec::new());
        } else {
            kept.push(leftmost(body, &conditions));
            conditions.clear();
        }
        of_links.push((own, conditions));
    }
    kept
}

/// A condition on a change I of a link's inertia and Ia of its rotor's: the sum of `u' I v`
/// over the matrix, a sum of `u v'`, and `rotor Ia` is zero.
struct Condition<'m> {
    motion: Matrix6<Fp<'m>>,
    rotor: Fp<'m>,
}

impl<'m> Condition<'m> {
    /// The same for the link on a massless one, which can hide nothing: what is moved
    /// into it must be invisible there too.
    fn carried(&self, body: &Body<Fp<'m>>) -> Self {
        let zero = body.axis_squared.modulus().integer(0);
        let x = transform(&body.rotation, body.origin, zero);
        Self {
            motion: product(&product(&x, &self.motion), &transposed(&x)),
            rotor: zero,
        }
    }
}

/// The leftmost parameters with independent conditions.
fn leftmost<'m>(body: &Body<Fp<'m>>, conditions: &[Condition<'m>]) -> Vec<usize> {
    let columns = if body.rotor { 11 } else { 10 };
    let mut rows = Echelon::new(body.axis_squared.modulus(), columns);
    for condition in conditions {
        let mut row = [condition.rotor; 11];
        row[..10].copy_from_slice(&energy_rate(&condition.motion));
        rows.insert(&row[..columns]);
    }
    rows.kept()
}

/// What a link on a joint with an axis or a fixed one can meet, from its antecedent's, and the conditions on its parameters
/// (none for a link on a fixed joint: all of it can be moved).
fn step<'m>(
    antecedent: &Attainable<'m>,
    body: &Body<Fp<'m>>,
) -> (Attainable<'m>, Vec<Condition<'m>>) {
    let zero = body.axis_squared.modulus().integer(0);
    let carried = antecedent.carried(body);
    let Some(joint) = joint_axis(body, zero) else {
        return (carried, Vec::new());
    };
    let cross = cross_matrix(&joint, zero);
    let mut attainable = carried.moved_by(&cross);
    let rows = conditions(body, &joint, &cross, &attainable);
    attainable.add_joint(&joint);
    (attainable, rows)
}

/// S, the velocity of the link relative to its antecedent at unit joint velocity.
fn joint_axis<'m>(body: &Body<Fp<'m>>, zero: Fp<'m>) -> Option<Vector6<Fp<'m>>> {
    let [x, y, z] = body.axis;
    match body.joint {
        JointKind::Revolute => Some([x, y, z, zero, zero, zero]),
        JointKind::Prismatic => Some([zero, zero, zero, x, y, z]),
        JointKind::Fixed | JointKind::Floating => None,
    }
}

/// The conditions on a change of the link's inertia and of its rotor's.
fn conditions<'m>(
    body: &Body<Fp<'m>>,
    joint: &Vector6<Fp<'m>>,
    cross: &Matrix6<Fp<'m>>,
    attainable: &Attainable<'m>,
) -> Vec<Condition<'m>> {
    let zero = body.axis_squared.modulus().integer(0);
    let mut conditions = Vec::new();
    let mut insert = |motion, rotor| conditions.push(Condition { motion, rotor });
    // S' I S + Ia = 0; the axis may be in units of its own.
    insert(outer(joint, joint), body.axis_squared);
    // S' I w = 0, w being a velocity of the antecedent or gravity.
    for w in attainable.velocities().iter().chain(attainable.gravity()) {
        insert(outer(joint, w), zero);
    }
    // w' I (S x w) = 0.
    for square in attainable.squares() {
        insert(product(square, &transposed(cross)), zero);
    }
    conditions
}

#[cfg(test)]
mod tests {
    use super::*;
    use roberval_mechanism::SourceFormat;
    use roberval_scalar::SplitMix64;
    use roberval_testkit::Family;
    use spatial::apply;

    /// Squares of this many velocities span all 21 dimensions, if they can.
    const DRAWS: usize = 30;

    /// A velocity of a body at random joint positions and velocities.
    fn velocity<'m>(
        parent: &Vector6<Fp<'m>>,
        body: &Body<Fp<'m>>,
        random: &mut SplitMix64,
    ) -> Vector6<Fp<'m>> {
        let modulus = body.axis_squared.modulus();
        let (zero, one) = (modulus.integer(0), modulus.integer(1));
        let carried = apply(&transform(&body.rotation, body.origin, zero), parent);
        let Some(joint) = joint_axis(body, zero) else {
            return carried;
        };
        // Rodrigues: 1 - sin C + versine C C, for a sliding joint 1 - q C as C C = 0.
        let t = modulus.random(random);
        let inverse = (one + t * t * body.axis_squared)
            .inverse()
            .expect("zero for two t at most");
        let (sine, versine) = ((t + t) * inverse, (t + t) * inverse * t);
        let cross = cross_matrix(&joint, zero);
        let once = apply(&cross, &carried);
        let twice = apply(&cross, &once);
        let rate = modulus.random(random);
        std::array::from_fn(|i| carried[i] - sine * once[i] + versine * twice[i] + rate * joint[i])
    }

    #[test]
    fn the_spans_are_those_of_velocities_at_random_positions() {
        for seed in 0..60 {
            let family = Family {
                format: [SourceFormat::Mdh, SourceFormat::Urdf][seed as usize % 2],
                ..Family::default()
            };
            let robot = Mechanism::new(&family.robot(seed)).expect("valid");
            let angles = AngleOrder::of(&robot);
            in_some_field(&robot, angles, seed, 1, |exact, random| {
                let tree = exact.tree();
                let zero = tree.constants.zero;
                let mut draws: Vec<Vec<Vector6<_>>> = Vec::new();
                let mut spans: Vec<Attainable<'_>> = Vec::new();
                for (j, body) in tree.bodies.iter().enumerate() {
                    let base = Attainable::base(tree);
                    let still = vec![[zero; 6]; DRAWS];
                    let parents = body.antecedent.map_or(&still, |a| &draws[a]);
                    let drawn: Vec<_> = parents.iter().map(|u| velocity(u, body, random)).collect();
                    let antecedent = body.antecedent.map_or(&base, |a| &spans[a]);
                    let (span, _) = step(antecedent, body);
                    assert_eq!(span.dimensions_with(&[]), span.dimensions_with(&drawn));
                    assert_eq!(
                        Attainable::of_velocities(&drawn).dimensions_with(&[]),
                        span.dimensions_with(&[]),
                        "robot {seed}, body {j}"
                    );
                    draws.push(drawn);
                    spans.push(span);
                }
            })
            .expect("in a field");
        }
    }
}
