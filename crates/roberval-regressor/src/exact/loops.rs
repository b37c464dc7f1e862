//! Loops in a prime field: random points of the variety of their closed configurations.
//!
//! Of each loop two joints are found from the others, which stand at random points of the
//! circle: a dyad. Let e be the axis of the first, P a point on it, and A and B the frames of
//! the cut. Where the axes are parallel, the second joint must make |B - P| = |A - P| (or,
//! if the first one slides, bring A and B to one height across e); where they all meet in a
//! point, b . e = a . e for the axes a, b of the cut. Neither depends on the first joint, and
//! both are linear in the cosine and the sine of the second: one square root. The first joint
//! then takes B to A.
//!
//! A point has a root with probability 1/2 unless the radicand is a square of a function (or
//! a constant times one) of the points before. If it never is, the variety is irreducible:
//! a random point of it is a generic one of every assembly mode. Where some radicand is
//! always a square, or never, the branches are varieties of their own, and are not told apart
//! here.

use roberval_mechanism::{
    Configuration, Cut, LinkFrame, Linkage, LoopFrames, Mechanism, Origin, Pose, in_linkage,
};
use roberval_scalar::vector::{Vec3, cross, dot, scale, sub};
use roberval_scalar::{Fp, Modulus, SplitMix64, cancellation_point};

use super::angles::{AngleOrder, Angles};
use super::closure::ExactClosure;
use super::geometry::{pose, tree};
use super::linear::solve;
use super::model::{FieldNumbers, NotInField, position, variable_bodies};
use crate::{JointMotion, Transmission, Tree};

/// Radicands that are all squares, or all none, before they count as always such: a radicand
/// of which half are squares does so with probability 2^-63.
const SAME_SYMBOL: usize = 64;

/// Loops at most: a point on k of them takes 2^k attempts.
const MOST_DYADS: usize = 8;

/// Why loops have no points in prime fields that are easy to find.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum NotClosed {
    /// Not one dyad after another.
    #[error(
        "the loops are not planar or spherical ones of which each is closed by two joints from those before it"
    )]
    Dyads,
    /// A radicand is a square.
    #[error("the loops can be closed on several branches that are varieties of their own")]
    Branches,
    /// Couples beside loops.
    #[error("the robot has couples beside loops")]
    Couples,
}

/// The loops of a mechanism.
#[derive(Debug, Clone)]
pub(super) struct ExactLoops<'m> {
    linkage: Linkage<Fp<'m>>,
    dyads: Vec<Dyad>,
    independent: Vec<usize>,
    dependent: Vec<usize>,
    /// Variables of a base that floats, which stand before those of joints.
    first: usize,
    numbers: [Fp<'m>; 3],
}

/// Two joints that close a loop.
#[derive(Debug, Clone)]
struct Dyad {
    number: usize,
    first: usize,
    second: usize,
    kind: Kind,
    /// Variables of the loop that stand before.
    others: Vec<usize>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// Parallel axes; the first joint turns.
    Planar,
    /// Parallel axes; the first joint slides at right angles to them.
    Sliding,
    /// Axes that meet in a point.
    Spherical,
}

/// What became of a dyad at a random place.
enum Closing {
    Done,
    /// A radicand without a root.
    NoRoot,
    /// A denominator is 0.
    Singular,
}

type Motions<'m> = Vec<JointMotion<Fp<'m>>>;

impl<'m> ExactLoops<'m> {
    /// The loops of a mechanism that has some; `free` draws the position of a joint.
    pub fn of(
        mechanism: &Mechanism,
        tree: &Tree<Fp<'m>>,
        numbers: &mut FieldNumbers<'m, '_>,
        random: &mut SplitMix64,
        mut free: impl FnMut(usize, &mut SplitMix64) -> JointMotion<Fp<'m>>,
    ) -> Result<Result<Self, NotClosed>, NotInField> {
        let Some(assembly) = &mechanism.assembly else {
            return Ok(Err(NotClosed::Dyads));
        };
        if !mechanism.description.couples.is_empty() {
            return Ok(Err(NotClosed::Couples));
        }
        let linkage = field_linkage(mechanism, tree, |origin| pose(origin, numbers))?;
        let mut loops = Self {
            linkage,
            dyads: Vec::new(),
            independent: assembly.independent.clone(),
            dependent: assembly.dependent(),
            first: mechanism.base_variables(),
            numbers: [tree.constants.zero, tree.constants.one, tree.constants.half],
        };
        if let Err(reason) = loops.find_dyads(random, &mut free) {
            return Ok(Err(reason));
        }
        let irreducible = loops.check_branches(random, &mut free);
        Ok(irreducible.map(|()| loops))
    }

    /// Where the variables of joints begin.
    pub fn first_joint(&self) -> usize {
        self.first
    }

    /// Dyad after dyad, each with two joints that none before it has.
    fn find_dyads(
        &mut self,
        random: &mut SplitMix64,
        free: &mut impl FnMut(usize, &mut SplitMix64) -> JointMotion<Fp<'m>>,
    ) -> Result<(), NotClosed> {
        let motions: Motions<'m> = (0..self.linkage.dof()).map(|k| free(k, random)).collect();
        let place = self.place(&motions);
        let count = self.linkage.loops().len();
        let mut open = self.dependent.clone();
        let (mut dyads, mut done) = (Vec::new(), vec![false; count]);
        while !open.is_empty() {
            let of = |number: usize| {
                let variables = self.linkage.between(number).iter().map(|(k, _)| *k);
                let (unknown, others): (Vec<usize>, Vec<usize>) =
                    variables.partition(|k| open.contains(k));
                <[usize; 2]>::try_from(unknown).ok().map(|u| (u, others))
            };
            let mut candidates = (0..count).filter(|&l| !done[l]);
            let next = candidates.find_map(|number| {
                let (unknown, others) = of(number)?;
                let (kind, [first, second]) = self.kind(number, unknown, &place)?;
                Some(Dyad {
                    number,
                    first,
                    second,
                    kind,
                    others,
                })
            });
            let dyad = next.ok_or(NotClosed::Dyads)?;
            open.retain(|k| ![dyad.first, dyad.second].contains(k));
            done[dyad.number] = true;
            dyads.push(dyad);
        }
        if dyads.len() > MOST_DYADS {
            return Err(NotClosed::Dyads);
        }
        self.dyads = dyads;
        Ok(())
    }

    /// How two joints of a loop close it, and which of them is the first, judged at a random
    /// place where it is open.
    fn kind(
        &self,
        number: usize,
        [i, j]: [usize; 2],
        place: &Configuration<'_, Fp<'m>>,
    ) -> Option<(Kind, [usize; 2])> {
        let [a, b] = place.frames(number);
        let cut = self.linkage.loops()[number].cut;
        let slides = |k: usize| self.linkage.is_length(k);
        let joints = self.linkage.between(number).iter().map(|(k, _)| *k);
        let normal = place.joint(joints.clone().find(|&k| !slides(k))?).0;
        let is_planar = |k: usize| {
            let e = place.joint(k).0;
            if slides(k) {
                dot(e, normal).is_zero()
            } else {
                is_zero(cross(e, normal))
            }
        };
        let is_spherical = |k: usize| {
            let (e, p) = place.joint(k);
            !slides(k) && is_zero(cross(e, sub(a.origin, p)))
        };
        let apart = sub(b.origin, a.origin);
        if joints.clone().all(is_planar) && dot(apart, normal).is_zero() {
            // A spherical joint closes a plane as a revolute one does.
            let [u, v] = [a.axis(2), b.axis(2)];
            let closes = match cut {
                Cut::Spherical => true,
                Cut::Revolute => is_zero(cross(u, normal)) && is_zero(sub(u, v)),
                _ => false,
            };
            return match (closes, slides(i), slides(j)) {
                (true, false, false) => Some((Kind::Planar, [i, j])),
                (true, true, false) => Some((Kind::Sliding, [i, j])),
                (true, false, true) => Some((Kind::Sliding, [j, i])),
                _ => None,
            };
        }
        let meet = cut == Cut::Revolute && is_zero(apart) && joints.clone().all(is_spherical);
        meet.then_some((Kind::Spherical, [i, j]))
    }

    /// Whether every radicand has a root now and then, but not always.
    fn check_branches(
        &self,
        random: &mut SplitMix64,
        free: &mut impl FnMut(usize, &mut SplitMix64) -> JointMotion<Fp<'m>>,
    ) -> Result<(), NotClosed> {
        let mut seen = vec![[0; 2]; self.dyads.len()];
        while seen.iter().any(|[no, yes]| *no == 0 || *yes == 0) {
            cancellation_point();
            let mut motions: Motions<'m> =
                (0..self.linkage.dof()).map(|k| free(k, random)).collect();
            let mut closed = true;
            for (dyad, seen) in self.dyads.iter().zip(&mut seen) {
                let closing = self.close(dyad, &mut motions, random);
                match closing {
                    Closing::Done => seen[1] += 1,
                    Closing::NoRoot => seen[0] += 1,
                    Closing::Singular => return Err(NotClosed::Branches),
                }
                if seen.contains(&0) && seen.iter().any(|n| *n >= SAME_SYMBOL) {
                    return Err(NotClosed::Branches);
                }
                if !matches!(closing, Closing::Done) {
                    closed = false;
                    break;
                }
            }
            let residual = |motions| self.place(motions).residual();
            if closed && residual(&motions).iter().any(|x| !x.is_zero()) {
                return Err(NotClosed::Dyads); // a loop beside those that were closed
            }
        }
        Ok(())
    }

    /// The two joints of a dyad from those before it; which root is taken is random.
    fn close(&self, dyad: &Dyad, motions: &mut Motions<'m>, random: &mut SplitMix64) -> Closing {
        let [zero, one, half] = self.numbers;
        motions[dyad.first] = self.turned(one, zero);
        let mut miss = |cos, sin| {
            motions[dyad.second] = self.turned(cos, sin);
            self.miss(dyad, &self.place(motions))
        };
        let (ahead, back, aside) = (miss(one, zero), miss(-one, zero), miss(zero, one));
        // f0 + fc cos + fs sin = 0
        let (f0, fc) = ((ahead + back) * half, (ahead - back) * half);
        let fs = aside - f0;
        let squared = fc * fc + fs * fs;
        let Some(inverse) = squared.inverse() else {
            return Closing::Singular;
        };
        let Some(root) = (squared - f0 * f0).sqrt() else {
            return Closing::NoRoot;
        };
        let y = if random.next_u64() & 1 == 1 {
            root
        } else {
            -root
        };
        let cos = -(fc * f0 + fs * y) * inverse;
        let sin = (fc * y - fs * f0) * inverse;
        motions[dyad.second] = self.turned(cos, sin);
        match self.first(dyad, &self.place(motions)) {
            Some(first) => {
                motions[dyad.first] = first;
                Closing::Done
            }
            None => Closing::Singular,
        }
    }

    /// What the second joint has to bring to 0.
    fn miss(&self, dyad: &Dyad, place: &Configuration<'_, Fp<'m>>) -> Fp<'m> {
        let [a, b] = place.frames(dyad.number);
        let (e, p) = place.joint(dyad.first);
        let squared = |x: Vec3<Fp<'m>>| dot(x, x);
        match dyad.kind {
            Kind::Planar => squared(sub(b.origin, p)) - squared(sub(a.origin, p)),
            Kind::Sliding => {
                let normal = place.joint(dyad.second).0;
                dot(cross(normal, e), sub(b.origin, a.origin))
            }
            Kind::Spherical => dot(sub(b.axis(2), a.axis(2)), e),
        }
    }

    /// The first joint, which stands at 0, so that it closes the loop.
    fn first(&self, dyad: &Dyad, place: &Configuration<'_, Fp<'m>>) -> Option<JointMotion<Fp<'m>>> {
        let [zero, one, _] = self.numbers;
        let [a, b] = place.frames(dyad.number);
        let (e, p) = place.joint(dyad.first);
        let mut between = self.linkage.between(dyad.number).iter();
        let moves_b = between.any(|&(k, moves_b)| k == dyad.first && moves_b);
        let [from, to] = if moves_b { [b, a] } else { [a, b] };
        let [u, v] = match dyad.kind {
            Kind::Sliding => {
                let q = dot(e, sub(to.origin, from.origin));
                return Some(JointMotion {
                    q,
                    ..self.turned(one, zero)
                });
            }
            Kind::Planar => [sub(from.origin, p), sub(to.origin, p)],
            Kind::Spherical => [from.axis(2), to.axis(2)],
        };
        let across = |x: Vec3<Fp<'m>>| sub(x, scale(e, dot(x, e)));
        let inverse = dot(across(u), across(u)).inverse()?;
        let (cos, sin) = (dot(across(u), across(v)), dot(e, cross(u, v)));
        Some(self.turned(cos * inverse, sin * inverse))
    }

    /// A revolute joint at a point of the circle, at rest.
    fn turned(&self, cos: Fp<'m>, sin: Fp<'m>) -> JointMotion<Fp<'m>> {
        let [zero, one, _] = self.numbers;
        JointMotion {
            cos,
            sin,
            versine: one - cos,
            ..JointMotion::still(zero, one)
        }
    }

    fn place(&self, motions: &[JointMotion<Fp<'m>>]) -> Configuration<'_, Fp<'m>> {
        place(&self.linkage, motions)
    }

    /// A random motion of all joints, a base that floats being still, and G.
    pub fn motions(
        &self,
        rest: bool,
        random: &mut SplitMix64,
        mut free: impl FnMut(usize, &mut SplitMix64) -> JointMotion<Fp<'m>>,
    ) -> (Motions<'m>, Transmission<Fp<'m>>) {
        loop {
            cancellation_point();
            let mut motions: Motions<'m> =
                (0..self.linkage.dof()).map(|k| free(k, random)).collect();
            let mut dyads = self.dyads.iter();
            let closed =
                dyads.all(|dyad| matches!(self.close(dyad, &mut motions, random), Closing::Done));
            if !closed {
                continue;
            }
            if let Some(transmission) = self.follow(rest, random, &mut motions) {
                let [zero, one, _] = self.numbers;
                let base = vec![self.turned(one, zero); self.first];
                return ([base, motions].concat(), transmission);
            }
        }
    }

    /// Velocities and accelerations of all joints from random ones of the independent; `None`
    /// in a singular configuration.
    fn follow(
        &self,
        rest: bool,
        random: &mut SplitMix64,
        motions: &mut Motions<'m>,
    ) -> Option<Transmission<Fp<'m>>> {
        let zero = self.numbers[0];
        let place = self.place(motions);
        let jacobian = place.jacobian();
        let columns = |of: &[usize], row: &Vec<Fp<'m>>| -> Vec<Fp<'m>> {
            of.iter().map(|&k| row[k]).collect()
        };
        let dependent: Vec<_> = jacobian
            .iter()
            .map(|row| columns(&self.dependent, row))
            .collect();
        let led: Vec<_> = jacobian
            .iter()
            .map(|row| columns(&self.independent, row))
            .collect();
        let mut g = vec![vec![zero; self.independent.len()]; motions.len()];
        for (place, &k) in self.independent.iter().enumerate() {
            g[k][place] = self.numbers[1];
        }
        for (&k, row) in self.dependent.iter().zip(solve(&dependent, &led)?) {
            g[k] = row.into_iter().map(|x| -x).collect();
        }
        let mut draw = |zero_instead: bool| -> Vec<Fp<'m>> {
            let modulus = zero.modulus();
            let each = self.independent.iter();
            each.map(|_| modulus.random(random))
                .map(|x| if zero_instead { zero } else { x })
                .collect()
        };
        let (qad, qadd) = (draw(rest), draw(false));
        let times = |x: &[Fp<'m>]| -> Vec<Fp<'m>> {
            let row = |row: &Vec<Fp<'m>>| row.iter().zip(x).fold(zero, |sum, (&g, &x)| sum + g * x);
            g.iter().map(row).collect()
        };
        let (qd, mut qdd) = (times(&qad), times(&qadd));
        let bias: Vec<Vec<Fp<'m>>> = place.bias(&qd).into_iter().map(|x| vec![x]).collect();
        for (&k, row) in self.dependent.iter().zip(solve(&dependent, &bias)?) {
            qdd[k] = qdd[k] - row[0];
        }
        for ((motion, qd), qdd) in motions.iter_mut().zip(qd).zip(qdd) {
            (motion.qd, motion.qdd) = (qd, qdd);
        }
        let sparse = |row: Vec<Fp<'m>>| -> Vec<(usize, Fp<'m>)> {
            (self.first..)
                .zip(row)
                .filter(|(_, x)| !x.is_zero())
                .collect()
        };
        let base = (0..self.first).map(|i| vec![(i, self.numbers[1])]);
        let joints = g.into_iter().map(sparse);
        Some(Transmission::from_rows(base.chain(joints)))
    }

    /// An upper bound of the degree of a row's entries in the random values, times that of
    /// the variety they are drawn from (the number of zeros of a function on it is at most
    /// their product times those of a plane).
    ///
    /// With d the degree of a joint's rotation in the half-angle tangents (2 for a free
    /// one) and D the sum of those before a dyad, the coefficients f have degree 2 D, the
    /// second joint 4 D, the first three times 5 D, the radicand 4 D, and its square root
    /// doubles. Cramer's rule with r rows of J, of degree S = sum of all d each, gives G;
    /// velocities enter twice.
    pub fn degree(&self, steps: u64) -> u64 {
        let mut degrees = vec![2_u64; self.linkage.dof()];
        let mut variety = 1_u64;
        for dyad in &self.dyads {
            let before = dyad.others.iter().map(|&k| degrees[k]);
            let before = before.fold(steps.max(1), u64::saturating_add);
            degrees[dyad.second] = before.saturating_mul(4);
            degrees[dyad.first] = before.saturating_mul(15);
            variety = variety.saturating_mul(before.saturating_mul(8));
        }
        let sum = degrees.into_iter().fold(steps, u64::saturating_add);
        let r = self.dependent.len() as u64;
        let rows = (9 + 8 * r).saturating_mul(sum).saturating_add(4);
        rows.saturating_mul(variety)
    }
}

/// Whether the couples of a mechanism close the loops of its description, wherever its
/// joints are.
///
/// # Errors
/// [`NotInField`] if a number of the description has no place in this field.
pub fn couples_close_loops(
    mechanism: &Mechanism,
    modulus: &Modulus,
    order: AngleOrder,
    seed: u64,
) -> Result<bool, NotInField> {
    let mut random = SplitMix64::new(seed);
    let pi = modulus.random(&mut random);
    let angles = Angles::new(modulus, mechanism, order, 1, &mut random);
    let mut numbers = FieldNumbers::new(mechanism, angles, pi, &[])?;
    let tree = tree(mechanism, &mut numbers)?;
    let Some(closure) = ExactClosure::of(mechanism, &mut numbers)? else {
        return Ok(false);
    };
    let linkage = field_linkage(mechanism, &tree, |origin| pose(origin, &mut numbers))?;
    let joints = variable_bodies(&tree);
    let free =
        |k: usize, _, _, random: &mut SplitMix64| position(joints[k], tree.constants, random);
    let motions = closure.motions(tree.constants, true, &mut random, free);
    let closed = place(&linkage, &motions[mechanism.base_variables()..]).residual();
    Ok(closed.iter().all(|x| x.is_zero()))
}

fn place<'a, 'm>(
    linkage: &'a Linkage<Fp<'m>>,
    motions: &[JointMotion<Fp<'m>>],
) -> Configuration<'a, Fp<'m>> {
    let q: Vec<Fp<'m>> = motions.iter().map(|m| m.q).collect();
    linkage.placed(&q, |k, link| {
        let JointMotion {
            cos, sin, versine, ..
        } = motions[k];
        link.moved(motions[k].q, [cos, sin, versine])
    })
}

fn is_zero(x: Vec3<Fp<'_>>) -> bool {
    x.iter().all(|x| x.is_zero())
}

/// The linkage of a mechanism whose tree is known in the field, without its couples.
pub(super) fn field_linkage<'m>(
    mechanism: &Mechanism,
    tree: &Tree<Fp<'m>>,
    poses: impl FnMut(&Origin) -> Result<Pose<Fp<'m>>, NotInField>,
) -> Result<Linkage<Fp<'m>>, NotInField> {
    let loops: Vec<LoopFrames<Fp<'m>>> = mechanism.loop_frames(poses)?;
    let numbers = [tree.constants.zero, tree.constants.one];
    Ok(Linkage::of_numbers(
        link_frames(tree),
        loops,
        Vec::new(),
        numbers,
    ))
}

/// The bodies of a tree as a linkage has them.
pub(crate) fn link_frames<T: Copy>(tree: &Tree<T>) -> Vec<LinkFrame<T>> {
    let frame = |body: &crate::Body<T>| LinkFrame {
        antecedent: body.antecedent,
        joint: in_linkage(body.joint),
        pose: Pose {
            rotation: body.rotation,
            origin: body.origin,
        },
        axis: body.axis,
    };
    tree.bodies.iter().map(frame).collect()
}
