use roberval_mechanism::{JointKind, Mechanism};
use roberval_scalar::Magnitude;

use crate::layout::Layout;
use crate::vector::{Mat3, Vec3};

/// The constants a scalar cannot make by itself.
#[derive(Debug, Clone, Copy)]
pub struct Constants<T> {
    /// 0
    pub zero: T,
    /// 1
    pub one: T,
    /// 1/2
    pub half: T,
}

/// The robot's constants in the recursion's scalar: bodies, antecedents first.
#[derive(Debug, Clone)]
pub struct Tree<T> {
    /// The bodies in parameter order.
    pub bodies: Vec<Body<T>>,
    /// Acceleration of gravity in the base frame.
    pub gravity: Vec3<T>,
    /// 0, 1 and 1/2.
    pub constants: Constants<T>,
    /// Number of degrees of freedom n: rows of d.
    pub dof: usize,
}

/// One link's constants.
#[derive(Debug, Clone)]
pub struct Body<T> {
    /// Index of the antecedent body; `None` is the base.
    pub antecedent: Option<usize>,
    /// What the joint allows.
    pub joint: JointKind,
    /// Index of the joint's velocity; `None` for a fixed joint. The six of a floating base
    /// are the first.
    pub variable: Option<usize>,
    /// Whether there is an Ia column.
    pub rotor: bool,
    /// Whether there are no columns at all.
    pub massless: bool,
    /// Rotation from this frame to the antecedent's at joint variable 0.
    pub rotation: Mat3<T>,
    /// Origin of this frame in the antecedent's at joint variable 0.
    pub origin: Vec3<T>,
    /// Joint axis in this frame. Its length is 1 for floats; a prime field may leave it
    /// as written and measure the joint's motion in units of it.
    pub axis: Vec3<T>,
    /// Squared length of the axis vector.
    pub axis_squared: T,
    /// What is known of the placement beyond these numbers.
    pub layout: Layout,
}

impl<T> Tree<T> {
    /// Whether the first body is a base that floats.
    #[must_use]
    pub fn is_floating(&self) -> bool {
        let first = self.bodies.first();
        first.is_some_and(|b| b.joint == JointKind::Floating)
    }

    /// Of the coordinates of a position, the one of each variable. A floating base has seven
    /// coordinates and six variables: all joints stand one place further, and what stands
    /// in its own six places means nothing.
    pub(crate) fn variables<'q, S>(&self, q: &'q [S]) -> &'q [S] {
        &q[usize::from(self.is_floating())..]
    }
}

impl<T: Copy> Tree<T> {
    /// The same tree over another scalar.
    pub fn map<S>(&self, convert: impl Fn(T) -> S) -> Tree<S> {
        let vector = |v: &Vec3<T>| v.map(&convert);
        Tree {
            bodies: self
                .bodies
                .iter()
                .map(|b| Body {
                    antecedent: b.antecedent,
                    joint: b.joint,
                    variable: b.variable,
                    rotor: b.rotor,
                    massless: b.massless,
                    rotation: b.rotation.map(|row| vector(&row)),
                    origin: vector(&b.origin),
                    axis: vector(&b.axis),
                    axis_squared: convert(b.axis_squared),
                    layout: b.layout,
                })
                .collect(),
            gravity: vector(&self.gravity),
            constants: Constants {
                zero: convert(self.constants.zero),
                one: convert(self.constants.one),
                half: convert(self.constants.half),
            },
            dof: self.dof,
        }
    }
}

impl Tree<f64> {
    /// The float constants of a mechanism.
    #[must_use]
    pub fn of(mechanism: &Mechanism) -> Self {
        let mut dof = 0;
        let bodies = mechanism
            .links
            .iter()
            .map(|link| {
                let rotation: Mat3<f64> =
                    std::array::from_fn(|i| std::array::from_fn(|j| link.rotation[(i, j)]));
                let (origin, axis) = (link.origin.into(), link.axis.into());
                Body {
                    antecedent: link.antecedent,
                    joint: link.joint,
                    variable: next_variable(link.joint, &mut dof),
                    rotor: link.rotor,
                    massless: link.massless,
                    layout: Layout::of(link.joint, &rotation, &origin, &axis),
                    rotation,
                    origin,
                    axis,
                    axis_squared: 1.0,
                }
            })
            .collect();
        Self {
            bodies,
            gravity: mechanism.gravity.into(),
            constants: Constants {
                zero: 0.0,
                one: 1.0,
                half: 0.5,
            },
            dof,
        }
    }

    /// The magnitudes of the constants, for error bounds.
    #[must_use]
    pub fn magnitude(&self) -> Tree<Magnitude> {
        self.map(Magnitude::of)
    }
}

/// The first coordinate of a joint, `dof` being the number of those before it.
pub(crate) fn next_variable(joint: JointKind, dof: &mut usize) -> Option<usize> {
    let first = *dof;
    *dof += joint.dof();
    (joint != JointKind::Fixed).then_some(first)
}
