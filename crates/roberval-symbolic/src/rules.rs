//! The closed-form rules of Gautier and Khalil, for chains and trees.
//!
//! A rule moves inertial parameters where no motion can tell, or finds that they do nothing:
//! each is a vector v of parameters with W v = 0, known from the joints' axes alone. The
//! parameter of largest subscript in it goes. (M. Gautier, W. Khalil, Direct calculation of
//! minimum set of inertial parameters of serial robots, IEEE Trans. Robotics and Automation
//! 6(3), 1990; W. Khalil, F. Bennis, M. Gautier, The use of the generalized links to
//! determine the minimum inertial parameters of robots, J. Robotic Systems 7(2), 1990.)
//! What the rules leave is found by elimination.

mod moments;

use std::fmt;

use roberval_mechanism::{JointKind, Mechanism, ParameterSpace};
use roberval_regressor::{Body, ExactModel, Tree};
use roberval_scalar::{Fp, SplitMix64};

use moments::{Moments, Vec3, cross, dot, returned, unit_inertia};

/// Samples at which each rule's vector is checked.
const CHECKS: usize = 2;

/// What removes a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Origin {
    /// The link never turns: only its mass counts.
    NeverTurns,
    /// The link turns about one direction only: other moments do nothing.
    OneDirection,
    /// The link turns about a fixed axis along gravity.
    AxisAlongGravity,
    /// A rotor whose speed is the link's own about the axis.
    Rotor,
    /// Mass along a revolute joint's axis is the antecedent's as well.
    RevoluteAxis,
    /// A link does not turn against its antecedent across a prismatic joint.
    PrismaticJoint,
    /// A link slides along the only direction about which its antecedent turns.
    ParallelSlide,
    /// A link does not move against its antecedent.
    FixedJoint,
    /// No rule: found by elimination.
    Elimination,
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NeverTurns => "rule: a link that never turns has only mass",
            Self::OneDirection => "rule: a link that turns about one direction",
            Self::AxisAlongGravity => "rule: an axis that stands still along gravity",
            Self::Rotor => "rule: a rotor turns (slides) as its link does",
            Self::RevoluteAxis => "rule: mass along a revolute joint's axis",
            Self::PrismaticJoint => "rule: no turn across a prismatic joint",
            Self::ParallelSlide => "rule: a slide along the only direction of turning",
            Self::FixedJoint => "rule: no motion across a fixed joint",
            Self::Elimination => "elimination, where the rules end",
        })
    }
}

/// How a link can turn, seen in its frame.
#[derive(Debug, Clone, Copy)]
enum Turning<'m> {
    Never,
    About(Vec3<Fp<'m>>),
    Freely,
}

/// For each column that goes, which rule removes it; columns in the order of `order`, in
/// which later ones go first. Rules that do not hold are left out (there should be none).
pub(crate) fn removed_by_rules<'m>(
    mechanism: &Mechanism,
    exact: &ExactModel<'m>,
    order: &[usize],
    random: &mut SplitMix64,
) -> Vec<(usize, Origin)> {
    let mut rules = Rules {
        tree: exact.tree(),
        space: mechanism.parameters(),
        found: Vec::new(),
    };
    rules.apply();
    let vectors = rules.found;
    let holds = holding(&vectors, exact, mechanism, random);
    debug_assert!(holds.iter().all(|holds| *holds), "a rule is wrong");
    let mut rows: Vec<(usize, Vec<Fp<'m>>)> = Vec::new();
    let mut removed = Vec::new();
    for ((origin, vector), _) in vectors.iter().zip(holds).filter(|(_, holds)| *holds) {
        let mut row: Vec<Fp<'m>> = order.iter().map(|&c| vector[c]).collect();
        for (pivot, other) in &rows {
            let factor = row[*pivot];
            if !factor.is_zero() {
                row.iter_mut()
                    .zip(other)
                    .for_each(|(x, y)| *x = *x - factor * *y);
            }
        }
        let Some(pivot) = row.iter().rposition(|x| !x.is_zero()) else {
            continue;
        };
        let inverse = row[pivot].inverse().expect("not zero");
        row.iter_mut().for_each(|x| *x = *x * inverse);
        for (_, other) in &mut rows {
            let factor = other[pivot];
            other
                .iter_mut()
                .zip(&row)
                .for_each(|(x, y)| *x = *x - factor * *y);
        }
        rows.push((pivot, row));
        removed.push((order[pivot], *origin));
    }
    removed
}

/// Which vectors the dynamic model does not see, at random states.
fn holding<'m>(
    vectors: &[(Origin, Vec<Fp<'m>>)],
    exact: &ExactModel<'m>,
    mechanism: &Mechanism,
    random: &mut SplitMix64,
) -> Vec<bool> {
    let zero = exact.modulus().integer(0);
    let columns = mechanism.parameters().len();
    let mut rows = vec![zero; mechanism.independent() * columns];
    let mut work = exact.workspace();
    let mut holds = vec![true; vectors.len()];
    for _ in 0..CHECKS {
        exact.fill(roberval_base::Model::D, random, &mut work, &mut rows);
        for ((_, vector), holds) in vectors.iter().zip(&mut holds) {
            let product = |row: &[Fp<'m>]| {
                let terms = row.iter().zip(vector).map(|(a, b)| *a * *b);
                terms.fold(zero, |sum, x| sum + x)
            };
            *holds &= rows.chunks_exact(columns).all(|row| product(row).is_zero());
        }
    }
    holds
}

struct Rules<'a, 'm> {
    tree: &'a Tree<Fp<'m>>,
    space: ParameterSpace,
    found: Vec<(Origin, Vec<Fp<'m>>)>,
}

impl<'m> Rules<'_, 'm> {
    fn apply(&mut self) {
        let tree = self.tree;
        let mut turnings: Vec<Turning<'m>> = Vec::new();
        for (j, body) in tree.bodies.iter().enumerate() {
            if body.joint == JointKind::Floating {
                turnings.push(Turning::Freely);
                continue;
            }
            let parent = body.antecedent.map_or(Turning::Never, |a| turnings[a]);
            let turning = self.turning(body, parent);
            if body.massless {
                turnings.push(turning);
                continue;
            }
            match turning {
                Turning::Never => self.never_turns(j),
                Turning::About(e) => self.one_direction(j, e),
                Turning::Freely => {}
            }
            if let (Turning::Never, JointKind::Revolute) = (parent, body.joint) {
                self.axis_along_gravity(j);
            }
            self.rotor(j, parent);
            self.across_the_joint(j);
            self.parallel_slide(j, parent);
            turnings.push(turning);
        }
    }

    fn turning(&self, body: &Body<Fp<'m>>, parent: Turning<'m>) -> Turning<'m> {
        let turned = match parent {
            Turning::Never if body.joint == JointKind::Revolute => {
                return Turning::About(body.axis);
            }
            Turning::About(e) => returned(&body.rotation, e),
            other => return other,
        };
        let parallel = cross(turned, body.axis).iter().all(|x| x.is_zero());
        match body.joint == JointKind::Revolute && !parallel {
            true => Turning::Freely,
            false => Turning::About(turned),
        }
    }

    /// Adds a vector: moments of link j, those of its antecedent, and Ia of link j.
    fn add(&mut self, origin: Origin, j: usize, own: &Moments<Fp<'m>>) {
        let mut vector = self.zeros();
        self.put(&mut vector, j, own);
        self.found.push((origin, vector));
    }

    fn zeros(&self) -> Vec<Fp<'m>> {
        vec![self.tree.constants.zero; self.space.len()]
    }

    fn put(&self, vector: &mut [Fp<'m>], j: usize, moments: &Moments<Fp<'m>>) {
        let first = self.space.first_column(j);
        for (x, value) in vector[first..].iter_mut().zip(moments.parameters()) {
            *x = *x + value;
        }
    }

    fn nothing(&self) -> Moments<Fp<'m>> {
        Moments::zero(self.tree.constants.zero)
    }

    fn never_turns(&mut self, j: usize) {
        let one = self.tree.constants.one;
        for k in 0..9 {
            let mut vector = self.zeros();
            vector[self.space.first_column(j) + k] = one;
            self.found.push((Origin::NeverTurns, vector));
        }
    }

    /// Only e' J e acts, and no first moment along e.
    fn one_direction(&mut self, j: usize, e: Vec3<Fp<'m>>) {
        let (zero, one) = (self.tree.constants.zero, self.tree.constants.one);
        let acts: Vec<Fp<'m>> = (0..6).map(|k| unit_inertia(k, e, zero)).collect();
        let reference = acts.iter().position(|x| !x.is_zero());
        for k in (0..6).filter(|k| Some(*k) != reference) {
            let mut vector = self.zeros();
            let first = self.space.first_column(j);
            vector[first + k] = one;
            if let Some(r) = reference {
                let inverse = acts[r].inverse().expect("not zero");
                vector[first + r] = -(acts[k] * inverse);
            }
            self.found.push((Origin::OneDirection, vector));
        }
        let along = Moments {
            first: e,
            ..self.nothing()
        };
        self.add(Origin::OneDirection, j, &along);
    }

    /// The first revolute joint's link, if its axis and all slides before are along gravity
    /// (or gravity is zero and there is no slide).
    fn axis_along_gravity(&mut self, j: usize) {
        let tree = self.tree;
        let mut direction = tree.bodies[j].axis;
        let mut at = j;
        loop {
            let body = &tree.bodies[at];
            let slides = body.joint == JointKind::Prismatic;
            if slides && cross(body.axis, direction).iter().any(|x| !x.is_zero()) {
                return;
            }
            direction = moments::turned(&body.rotation, direction);
            match body.antecedent {
                Some(antecedent) => at = antecedent,
                None => break,
            }
        }
        if cross(tree.gravity, direction).iter().any(|x| !x.is_zero()) {
            return;
        }
        for k in 6..9 {
            let mut vector = self.zeros();
            vector[self.space.first_column(j) + k] = tree.constants.one;
            self.found.push((Origin::AxisAlongGravity, vector));
        }
    }

    /// Ia of the first revolute joint is an inertia of its link; so is that of a revolute
    /// joint at right angles to the only direction before; that of a first prismatic joint
    /// across gravity is a mass.
    fn rotor(&mut self, j: usize, parent: Turning<'m>) {
        let body = &self.tree.bodies[j];
        let Some(column) = self.space.rotor_column(j) else {
            return;
        };
        let mut vector = self.zeros();
        vector[column] = self.tree.constants.one;
        let a = body.axis;
        let inverse = body.axis_squared.inverse().expect("an axis has a length");
        match (body.joint, parent) {
            (JointKind::Revolute, Turning::Never) => {}
            (JointKind::Revolute, Turning::About(e)) => {
                if !dot(returned(&body.rotation, e), a).is_zero() {
                    return;
                }
            }
            (JointKind::Prismatic, Turning::Never) if self.slides_first(j) => {
                vector[self.space.first_column(j) + 9] = -self.tree.constants.one;
                self.found.push((Origin::Rotor, vector));
                return;
            }
            _ => return,
        }
        // T = (a.w)^2/2 is that of the inertia J = a a'.
        let first = self.space.first_column(j);
        for (k, (row, column)) in [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)]
            .into_iter()
            .enumerate()
        {
            vector[first + k] = -(a[row] * a[column] * inverse);
        }
        self.found.push((Origin::Rotor, vector));
    }

    /// Whether a prismatic joint is the first moving one and across gravity.
    fn slides_first(&self, j: usize) -> bool {
        let mut direction = self.tree.bodies[j].axis;
        let mut at = j;
        loop {
            let body = &self.tree.bodies[at];
            if at != j && body.joint != JointKind::Fixed {
                return false;
            }
            direction = moments::turned(&body.rotation, direction);
            match body.antecedent {
                Some(antecedent) => at = antecedent,
                None => return dot(self.tree.gravity, direction).is_zero(),
            }
        }
    }

    /// What can be the link's or its antecedent's.
    fn across_the_joint(&mut self, j: usize) {
        let body = &self.tree.bodies[j];
        let (zero, one) = (self.tree.constants.zero, self.tree.constants.one);
        let a = body.axis;
        let outer = a.map(|x| a.map(|y| x * y));
        let unit = |row: usize, column: usize| {
            let mut second = [[zero; 3]; 3];
            second[row][column] = one;
            second[column][row] = one;
            second
        };
        let second = |second| Moments {
            second,
            ..self.nothing()
        };
        let sides = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];
        let seconds = sides.map(|(row, column)| second(unit(row, column)));
        let mass = Moments {
            mass: one,
            ..self.nothing()
        };
        let along = |first| Moments {
            first,
            ..self.nothing()
        };
        let (origin, all) = match body.joint {
            JointKind::Revolute => (Origin::RevoluteAxis, vec![second(outer), along(a), mass]),
            JointKind::Prismatic => (Origin::PrismaticJoint, seconds.to_vec()),
            JointKind::Fixed => {
                let axes = [[one, zero, zero], [zero, one, zero], [zero, zero, one]];
                let mut all = seconds.to_vec();
                all.extend(axes.map(along));
                all.push(mass);
                (Origin::FixedJoint, all)
            }
            JointKind::Floating => return,
        };
        all.iter().for_each(|own| self.share(origin, j, own));
    }

    /// Moments that can be link j's or its antecedent's, if that has a body.
    fn share(&mut self, origin: Origin, j: usize, own: &Moments<Fp<'m>>) {
        let body = &self.tree.bodies[j];
        if body
            .antecedent
            .is_some_and(|a| self.tree.bodies[a].massless)
        {
            return;
        }
        let mut vector = self.zeros();
        self.put(&mut vector, j, own);
        if let Some(antecedent) = body.antecedent {
            let moved = own.moved(&body.rotation, body.origin).negative();
            self.put(&mut vector, antecedent, &moved);
        }
        self.found.push((origin, vector));
    }

    /// Where first moments stand along the only direction of turning means nothing.
    fn parallel_slide(&mut self, j: usize, parent: Turning<'m>) {
        let body = &self.tree.bodies[j];
        let (JointKind::Prismatic, Turning::About(e)) = (body.joint, parent) else {
            return;
        };
        let across = cross(returned(&body.rotation, e), body.axis);
        if across.iter().any(|x| !x.is_zero()) {
            return;
        }
        let (zero, one) = (self.tree.constants.zero, self.tree.constants.one);
        for first in [[one, zero, zero], [zero, one, zero], [zero, zero, one]] {
            let own = Moments {
                first,
                ..self.nothing()
            };
            self.share(Origin::ParallelSlide, j, &own);
        }
    }
}
