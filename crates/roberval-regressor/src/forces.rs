//! The inertia forces of a body and their power along the joints of its path: the columns.

use roberval_scalar::{Lift, Scalar};

use crate::dynamics::BodyState;
use crate::layout::{ordered, usual};
use crate::vector::{Mat3, Vec3, add, apply, dot, lift3, scale};
use crate::workspace::Screw;

/// All three components of a vector.
const ALL: u8 = 0b111;

/// The first two.
const NOT_LAST: u8 = 0b011;

/// The inertia forces of a body, parameter by parameter: the force of a unit first moment
/// m is `U m` and its moment `m x a`; that of a unit mass is `a`; a unit inertia J gives
/// the moment `J dw + w x J w`.
///
/// The axes x, y, z may be the body's y, z, x or z, x, y as well: see [`Columns::in_order`].
pub(crate) struct Forces<T> {
    dw: Vec3<T>,
    a: Vec3<T>,
    u: Mat3<T>,
    /// Entry k is w_i w_j.
    products: Vec3<T>,
    /// Entry k is w_i^2 - w_j^2.
    differences: Vec3<T>,
}

/// The products of the components of w.
struct Spin<T> {
    /// Entry k is w_k^2.
    squares: Vec3<T>,
    /// Entry k is w_i w_j.
    products: Vec3<T>,
}

impl<T: Scalar> Spin<T> {
    #[inline(always)]
    fn of([x, y, z]: Vec3<T>) -> Self {
        Self {
            squares: [x * x, y * y, z * z],
            products: [y * z, x * z, x * y],
        }
    }

    /// U = `[dw]x + [w]x [w]x`: a point fixed at p in the body's frame accelerates by a + U p.
    #[inline(always)]
    fn u(&self, dw: Vec3<T>) -> Mat3<T> {
        let ([x2, y2, z2], [yz, xz, xy]) = (self.squares, self.products);
        [
            [-(y2 + z2), xy - dw[2], xz + dw[1]],
            [xy + dw[2], -(x2 + z2), yz - dw[0]],
            [xz - dw[1], yz + dw[0], -(x2 + y2)],
        ]
    }
}

/// U of a body.
#[inline(always)]
pub(crate) fn acceleration_field<T: Scalar>(w: Vec3<T>, dw: Vec3<T>) -> Mat3<T> {
    Spin::of(w).u(dw)
}

impl<T: Scalar> Forces<T> {
    #[inline(always)]
    pub(crate) fn of(state: &BodyState<T>) -> Self {
        let (spin, dw) = (Spin::of(state.w), state.dw);
        let [x2, y2, z2] = spin.squares;
        Self {
            dw,
            a: state.a,
            u: spin.u(dw),
            products: spin.products,
            differences: [y2 - z2, z2 - x2, x2 - y2],
        }
    }

    /// Those of a body that turns about its last axis and about nothing else.
    #[inline(always)]
    pub(crate) fn spinning(zero: T, state: &BodyState<T>) -> Self {
        let (w, dw) = (state.w[2], state.dw[2]);
        let w2 = w * w;
        Self {
            dw: [zero, zero, dw],
            a: state.a,
            u: [[-w2, -dw, zero], [dw, -w2, zero], [zero; 3]],
            products: [zero; 3],
            differences: [-w2, w2, zero],
        }
    }

    /// Their power along a screw.
    #[inline(always)]
    pub(crate) fn on_screw(&self, screw: &Screw<T>) -> Columns<T> {
        self.on::<ALL>(screw)
    }

    /// The same where e has no other components than those whose bits are set in E, of which
    /// there are at least two.
    #[inline(always)]
    fn on<const E: u8>(&self, screw: &Screw<T>) -> Columns<T> {
        let (e, v) = (&screw.e, &screw.v);
        let [mx, my, mz] = self.first_moments::<E>(e);
        Columns {
            squares: self.squares::<E>(e),
            mixed: self.mixed::<E>(e),
            first: [
                self.along(0, v, mx),
                self.along(1, v, my),
                self.along(2, v, mz),
            ],
            mass: dot(*v, self.a),
        }
    }

    /// XX, YY and ZZ.
    #[inline(always)]
    fn squares<const E: u8>(&self, e: &Vec3<T>) -> [T; 3] {
        let (dw, p) = (&self.dw, &self.products);
        [
            turning::<E, T>(e, [(0, dw[0]), (1, p[1])], (2, p[2])),
            turning::<E, T>(e, [(1, dw[1]), (2, p[2])], (0, p[0])),
            turning::<E, T>(e, [(2, dw[2]), (0, p[0])], (1, p[1])),
        ]
    }

    /// YZ, XZ and XY.
    #[inline(always)]
    fn mixed<const E: u8>(&self, e: &Vec3<T>) -> [T; 3] {
        let (u, d) = (&self.u, &self.differences);
        [
            turning::<E, T>(e, [(2, u[0][2]), (0, d[0])], (1, u[0][1])),
            turning::<E, T>(e, [(0, u[1][0]), (1, d[1])], (2, u[1][2])),
            turning::<E, T>(e, [(1, u[2][1]), (2, d[2])], (0, u[2][0])),
        ]
    }

    /// `a x e`: of MX, MY and MZ what rotation takes.
    #[inline(always)]
    fn first_moments<const E: u8>(&self, e: &Vec3<T>) -> [T; 3] {
        let a = &self.a;
        [
            crossed::<E, T>(e, (2, a[1]), (1, a[2])),
            crossed::<E, T>(e, (0, a[2]), (2, a[0])),
            crossed::<E, T>(e, (1, a[0]), (0, a[1])),
        ]
    }

    /// `U' v` along axis k, added to what the rotation gives.
    #[inline(always)]
    fn along(&self, k: usize, v: &Vec3<T>, turning: T) -> T {
        let u = &self.u;
        let sum = u[0][k].mul_add(v[0], turning);
        u[2][k].mul_add(v[2], u[1][k].mul_add(v[1], sum))
    }

    /// Their power along a translation.
    #[inline(always)]
    pub(crate) fn on_translation(&self, zero: T, v: Vec3<T>) -> Columns<T> {
        let Self { a, u, .. } = self;
        let column = |k: usize| [u[0][k], u[1][k], u[2][k]];
        Columns {
            squares: [zero; 3],
            mixed: [zero; 3],
            first: [dot(column(0), v), dot(column(1), v), dot(column(2), v)],
            mass: dot(v, *a),
        }
    }

    /// Their power along a screw at a right angle to the last axis.
    #[inline(always)]
    pub(crate) fn on_crossed(&self, screw: &Screw<T>) -> Columns<T> {
        self.on::<NOT_LAST>(screw)
    }

    /// Their power along a screw parallel to the last axis, of unit length: v is at a right
    /// angle to it.
    #[inline(always)]
    pub(crate) fn on_parallel(&self, opposite: bool, zero: T, screw: &Screw<T>) -> Columns<T> {
        let mut columns = self.on_last_axis(opposite, zero);
        let (u, [x, y, _]) = (&self.u, screw.v);
        let [mx, my, _] = columns.first;
        columns.first = [
            u[1][0].mul_add(y, u[0][0].mul_add(x, mx)),
            u[1][1].mul_add(y, u[0][1].mul_add(x, my)),
            u[1][2].mul_add(y, u[0][2] * x),
        ];
        columns.mass = self.a[1].mul_add(y, self.a[0] * x);
        columns
    }

    /// Their power about the last axis, or against it: mostly a copy.
    #[inline(always)]
    pub(crate) fn on_last_axis(&self, opposite: bool, zero: T) -> Columns<T> {
        let Self { dw, a, u, .. } = self;
        let (xy, x2_y2) = (self.products[2], self.differences[2]);
        let (squares, mixed, first) = match opposite {
            false => (
                [-xy, xy, dw[2]],
                [u[0][2], -u[1][2], x2_y2],
                [a[1], -a[0], zero],
            ),
            true => (
                [xy, -xy, -dw[2]],
                [-u[0][2], u[1][2], -x2_y2],
                [-a[1], a[0], zero],
            ),
        };
        Columns {
            squares,
            mixed,
            first,
            mass: zero,
        }
    }
}

/// The parameters of a body with its axes in another order: see [`Columns::in_order`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Inertia {
    /// XX, YY and ZZ.
    squares: Vec3<f64>,
    /// ZZ - YY, XX - ZZ and YY - XX.
    differences: Vec3<f64>,
    /// YZ, XZ and XY.
    mixed: Vec3<f64>,
    /// MX, MY and MZ.
    first: Vec3<f64>,
    mass: f64,
    /// Ia.
    pub rotor: f64,
}

impl Inertia {
    /// That of no mass.
    pub(crate) const NONE: Self = Self {
        squares: [0.0; 3],
        differences: [0.0; 3],
        mixed: [0.0; 3],
        first: [0.0; 3],
        mass: 0.0,
        rotor: 0.0,
    };

    /// From a body's columns XX to M, and Ia if it has one.
    pub(crate) fn new(x: &[f64], order: usize) -> Self {
        let squares = ordered(&[x[0], x[3], x[5]], order);
        let [xx, yy, zz] = squares;
        Self {
            squares,
            differences: [zz - yy, xx - zz, yy - xx],
            mixed: ordered(&[x[4], x[2], x[1]], order),
            first: ordered(&[x[6], x[7], x[8]], order),
            mass: x[9],
            rotor: x.get(10).copied().unwrap_or(0.0),
        }
    }
}

/// A force and its moment about the origin of the frame they are given in.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Wrench<T> {
    pub f: Vec3<T>,
    pub n: Vec3<T>,
}

impl<T: Lift<f64>> Forces<T> {
    /// What a body of this inertia takes: `f = M a + U ms`, `n = J dw + w x J w + ms x a`.
    #[inline(always)]
    pub(crate) fn wrench(&self, inertia: &Inertia) -> Wrench<T> {
        let (mass, ms) = (T::lift(inertia.mass), lift3(&inertia.first));
        Wrench {
            f: add(scale(self.a, mass), apply(&self.u, ms)),
            n: [
                self.moment(0, inertia),
                self.moment(1, inertia),
                self.moment(2, inertia),
            ],
        }
    }

    /// The moment about axis i, after which come j and k.
    #[inline(always)]
    pub(crate) fn moment(&self, i: usize, inertia: &Inertia) -> T {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        let Self { dw, a, u, .. } = self;
        let Inertia { mixed, first, .. } = inertia;
        let n = T::lift(inertia.squares[i]) * dw[i];
        let n = T::lift(inertia.differences[i]).mul_add(self.products[i], n);
        let n = T::lift(mixed[i]).mul_add(self.differences[i], n);
        let n = T::lift(mixed[j]).mul_add(u[j][i], n);
        let n = T::lift(mixed[k]).neg_mul_add(u[k][i], n);
        let n = T::lift(first[j]).mul_add(a[k], n);
        T::lift(first[k]).neg_mul_add(a[j], n)
    }
}

/// Entries of a body's ten inertial columns.
pub(crate) struct Columns<T> {
    /// XX, YY and ZZ.
    squares: [T; 3],
    /// YZ, XZ and XY.
    mixed: [T; 3],
    /// MX, MY and MZ.
    first: [T; 3],
    /// M.
    mass: T,
}

impl<T: Copy> Columns<T> {
    /// XX to M, where the axes are the body's in this order.
    #[inline(always)]
    pub(crate) fn in_order<const ORDER: usize>(&self) -> [T; 10] {
        let [xx, yy, zz] = usual(&self.squares, ORDER);
        let [yz, xz, xy] = usual(&self.mixed, ORDER);
        let [mx, my, mz] = usual(&self.first, ORDER);
        [xx, xy, xz, yy, yz, zz, mx, my, mz, self.mass]
    }
}

/// The sum of two products with components of e less a third one, e having only the
/// components of E.
#[inline(always)]
fn turning<const E: u8, T: Scalar>(
    e: &Vec3<T>,
    [(i, first), (j, second)]: [(usize, T); 2],
    (k, less): (usize, T),
) -> T {
    let sum = match (E >> i & 1, E >> j & 1) {
        (0, _) => e[j] * second,
        (_, 0) => e[i] * first,
        _ => e[j].mul_add(second, e[i] * first),
    };
    match E >> k & 1 {
        0 => sum,
        _ => e[k].neg_mul_add(less, sum),
    }
}

/// The difference of two products with components of e.
#[inline(always)]
fn crossed<const E: u8, T: Scalar>(e: &Vec3<T>, (i, more): (usize, T), (j, less): (usize, T)) -> T {
    match (E >> i & 1, E >> j & 1) {
        (0, _) => -(e[j] * less),
        (_, 0) => e[i] * more,
        _ => e[j].neg_mul_add(less, e[i] * more),
    }
}
