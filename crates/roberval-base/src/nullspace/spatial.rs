//! Spatial vectors: angular velocity, then velocity of the frame's origin (Featherstone).

use roberval_scalar::Scalar;

/// (w, v)
pub(super) type Vector6<T> = [T; 6];
pub(super) type Matrix6<T> = [[T; 6]; 6];

type Matrix3<T> = [[T; 3]; 3];

fn cross3<T: Scalar>(a: [T; 3], zero: T) -> Matrix3<T> {
    [
        [zero, -a[2], a[1]],
        [a[2], zero, -a[0]],
        [-a[1], a[0], zero],
    ]
}

/// The matrix with these blocks, the upper right one being zero.
fn lower_blocks<T: Scalar>(diagonal: &Matrix3<T>, lower_left: &Matrix3<T>, zero: T) -> Matrix6<T> {
    std::array::from_fn(|i| {
        std::array::from_fn(|j| match (i < 3, j < 3) {
            (true, true) => diagonal[i][j],
            (true, false) => zero,
            (false, true) => lower_left[i - 3][j],
            (false, false) => diagonal[i - 3][j - 3],
        })
    })
}

/// The matrix X of `X u`: a velocity u in a frame, seen in another one that has the
/// orientation `rotation` and the origin `origin` there: (R'w, R'(v + w x p)).
pub(super) fn transform<T: Scalar>(rotation: &Matrix3<T>, origin: [T; 3], zero: T) -> Matrix6<T> {
    let back = std::array::from_fn(|i| std::array::from_fn(|j| rotation[j][i]));
    let arm = cross3(origin, zero);
    let moment = std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let entry = |k: usize| rotation[k][i] * arm[k][j];
            -(entry(0) + entry(1) + entry(2))
        })
    });
    lower_blocks(&back, &moment, zero)
}

/// The matrix of `S x u`, the rate at which a joint's motion changes a velocity.
pub(super) fn cross_matrix<T: Scalar>(s: &Vector6<T>, zero: T) -> Matrix6<T> {
    let rotation = cross3([s[0], s[1], s[2]], zero);
    lower_blocks(&rotation, &cross3([s[3], s[4], s[5]], zero), zero)
}

/// u v'
pub(super) fn outer<T: Scalar>(u: &Vector6<T>, v: &Vector6<T>) -> Matrix6<T> {
    u.map(|x| v.map(|y| x * y))
}

pub(super) fn sum<T: Scalar>(a: &Matrix6<T>, b: &Matrix6<T>) -> Matrix6<T> {
    std::array::from_fn(|i| std::array::from_fn(|j| a[i][j] + b[i][j]))
}

pub(super) fn transposed<T: Scalar>(a: &Matrix6<T>) -> Matrix6<T> {
    std::array::from_fn(|i| std::array::from_fn(|j| a[j][i]))
}

pub(super) fn apply<T: Scalar>(a: &Matrix6<T>, u: &Vector6<T>) -> Vector6<T> {
    a.map(|row| {
        let terms = row.iter().zip(u).map(|(x, y)| *x * *y);
        terms.reduce(|s, x| s + x).unwrap_or(u[0])
    })
}

pub(super) fn product<T: Scalar>(a: &Matrix6<T>, b: &Matrix6<T>) -> Matrix6<T> {
    let columns = transposed(b);
    transposed(&columns.map(|column| apply(a, &column)))
}

/// `u' I v` for the matrix `u v'` (or a sum of such), as a linear form in the parameters
/// XX XY XZ YY YZ ZZ MX MY MZ M of the inertia I.
pub(super) fn energy_rate<T: Scalar>(p: &Matrix6<T>) -> [T; 10] {
    // The moment of a first moment m at velocity (w, v) is m x v, its momentum w x m.
    let moment = |i: usize, j: usize| p[j][3 + i] + p[3 + i][j] - p[i][3 + j] - p[3 + j][i];
    [
        p[0][0],
        p[0][1] + p[1][0],
        p[0][2] + p[2][0],
        p[1][1],
        p[1][2] + p[2][1],
        p[2][2],
        moment(1, 2),
        moment(2, 0),
        moment(0, 1),
        p[3][3] + p[4][4] + p[5][5],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use roberval_scalar::{Fp, Modulus, SplitMix64};

    fn vector<'m>(field: &'m Modulus, random: &mut SplitMix64) -> Vector6<Fp<'m>> {
        std::array::from_fn(|_| field.random(random))
    }

    fn cross<'m>(a: &[Fp<'m>], b: &[Fp<'m>]) -> [Fp<'m>; 3] {
        std::array::from_fn(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            a[j] * b[k] - a[k] * b[j]
        })
    }

    fn dot<'m>(a: &[Fp<'m>], b: &[Fp<'m>]) -> Fp<'m> {
        let zero = a[0].modulus().integer(0);
        a.iter().zip(b).fold(zero, |s, (x, y)| s + *x * *y)
    }

    #[test]
    fn a_point_mass_has_the_energy_of_its_velocity() {
        // m at c: XX = m (y^2 + z^2), XY = -m x y, MX = m x, and u'Iu = m |v + w x c|^2.
        let field = Modulus::new((1 << 62) - 3545);
        let mut random = SplitMix64::new(1);
        for _ in 0..20 {
            let (u1, u2) = (vector(&field, &mut random), vector(&field, &mut random));
            let c: [Fp<'_>; 3] = std::array::from_fn(|_| field.random(&mut random));
            let [x, y, z] = c;
            let one = field.integer(1);
            let inertia = [
                y * y + z * z,
                -(x * y),
                -(x * z),
                x * x + z * z,
                -(y * z),
                x * x + y * y,
                x,
                y,
                z,
                one,
            ];
            let at_c = |u: &Vector6<Fp<'_>>| {
                let turn = cross(&u[..3], &c);
                [u[3] + turn[0], u[4] + turn[1], u[5] + turn[2]].map(Fp::residue)
            };
            let (v1, v2) = (at_c(&u1), at_c(&u2));
            let product = (0..3).fold(field.integer(0), |s, i| {
                s + field.big(&v1[i].into()) * field.big(&v2[i].into())
            });
            assert_eq!(dot(&energy_rate(&outer(&u1, &u2)), &inertia), product);
        }
    }

    #[test]
    fn a_translated_and_turned_frame_sees_the_velocity_of_its_origin() {
        let field = Modulus::new((1 << 62) - 3545);
        let mut random = SplitMix64::new(2);
        let (zero, one) = (field.integer(0), field.integer(1));
        // x -> y -> z -> x: the columns are the new frame's axes.
        let rotation = [[zero, zero, one], [one, zero, zero], [zero, one, zero]];
        let u = vector(&field, &mut random);
        let origin: [Fp<'_>; 3] = std::array::from_fn(|_| field.random(&mut random));
        let seen = apply(&transform(&rotation, origin, zero), &u);
        let turn = cross(&u[..3], &origin);
        assert_eq!(seen[..3], [u[1], u[2], u[0]]);
        assert_eq!(seen[3..], [u[4] + turn[1], u[5] + turn[2], u[3] + turn[0]]);
    }

    #[test]
    fn the_cross_product_of_screws_is_a_lie_bracket() {
        let field = Modulus::new((1 << 62) - 3545);
        let mut random = SplitMix64::new(3);
        let zero = field.integer(0);
        let [a, b, c] = [0; 3].map(|_| vector(&field, &mut random));
        let times = |x: &Vector6<_>, y: &Vector6<_>| apply(&cross_matrix(x, zero), y);
        let jacobi = [
            times(&a, &times(&b, &c)),
            times(&b, &times(&c, &a)),
            times(&c, &times(&a, &b)),
        ];
        for i in 0..6 {
            assert_eq!(jacobi[0][i] + jacobi[1][i] + jacobi[2][i], zero);
        }
        assert_eq!(times(&a, &a), [zero; 6]);
    }
}
