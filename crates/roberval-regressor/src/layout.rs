//! What is known of a body's placement before it moves: right angles, and the order in which
//! the recursion takes its axes.

use roberval_mechanism::JointKind;

use crate::vector::{Mat3, Vec3};

/// What is known of a body's placement beyond its numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Layout {
    /// Any rotation about any axis.
    #[default]
    General,
    /// Right angles.
    Aligned(Aligned),
}

/// A joint axis along an axis of either frame, the other axes then being quarter turns
/// apart: with the axes renamed in turn (x, y, z to y, z, x), the rotation is
/// `diag(1, +-1, +-1) Rot(z, q + quarters pi/2)`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Aligned {
    /// The axis of the body's frame along which the joint's axis lies.
    pub axis: usize,
    /// The axis of the antecedent's frame parallel to it.
    pub onto: usize,
    /// Whether these two are opposite.
    pub flip: bool,
    /// Whether the joint's axis points against the axis of the body's frame.
    pub reversed: bool,
    /// Quarter turns about the axis.
    pub quarters: u8,
    /// Bit k: whether the origin has a component along the antecedent's axis
    /// `onto + 1 + k`, at some joint position.
    pub offsets: u8,
}

impl Layout {
    /// The recursion takes a body's axes in turn so that the joint's comes last: x, y, z (2),
    /// y, z, x (0) or z, x, y (1).
    pub(crate) fn order(&self) -> usize {
        match self {
            Self::General => 2,
            Self::Aligned(aligned) => aligned.axis,
        }
    }

    /// The layout of a body given in floats.
    #[must_use]
    pub fn of(
        joint: JointKind,
        rotation: &Mat3<f64>,
        origin: &Vec3<f64>,
        axis: &Vec3<f64>,
    ) -> Self {
        let along = match joint {
            JointKind::Fixed | JointKind::Floating => Some(2),
            _ => (0..3).find(|&k| {
                axis[k].abs() == 1.0 && turned(k).iter().all(|&i| axis[i] == 0.0 || i == k)
            }),
        };
        let right = rotation
            .iter()
            .flatten()
            .all(|x| [0.0, 1.0, -1.0].contains(x));
        let (Some(along), true) = (along, right) else {
            return Self::General;
        };
        let Some(onto) = (0..3).find(|&i| rotation[i][along] != 0.0) else {
            return Self::General;
        };
        let ([i, j, _], [k, _, _]) = (turned(onto), turned(along));
        let flip = rotation[onto][along] < 0.0;
        let (cos, sin) = (
            rotation[i][k],
            if flip {
                -rotation[j][k]
            } else {
                rotation[j][k]
            },
        );
        let quarters = match (cos > 0.0, cos < 0.0, sin > 0.0) {
            (true, _, _) => 0,
            (_, true, _) => 2,
            (_, _, true) => 1,
            _ => 3,
        };
        let slides = joint == JointKind::Prismatic;
        let offsets = turned(onto)
            .into_iter()
            .enumerate()
            .filter(|&(bit, i)| origin[i] != 0.0 || (bit == 2 && slides))
            .fold(0, |bits, (bit, _)| bits | 1 << bit);
        Self::Aligned(Aligned {
            axis: along,
            onto,
            flip,
            reversed: axis[along] < 0.0,
            quarters,
            offsets,
        })
    }
}

/// A vector of three in another order: which axis comes first, second, third.
#[inline(always)]
pub(crate) fn ordered<T: Copy>(v: &Vec3<T>, order: usize) -> Vec3<T> {
    let [x, y, z] = turned(order);
    [v[x], v[y], v[z]]
}

/// Undoes [`ordered`].
#[inline(always)]
pub(crate) fn usual<T: Copy>(v: &Vec3<T>, order: usize) -> Vec3<T> {
    match order {
        0 => [v[2], v[0], v[1]],
        1 => [v[1], v[2], v[0]],
        _ => *v,
    }
}

/// The axes that follow axis k in turn, then k itself.
#[inline(always)]
fn turned(k: usize) -> [usize; 3] {
    match k {
        0 => [1, 2, 0],
        1 => [2, 0, 1],
        _ => [0, 1, 2],
    }
}
