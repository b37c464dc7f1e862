//! Turns of symmetric matrices, with few operations.

use roberval_scalar::vector::{Mat3, apply, product};

use crate::recorded::Recorded;

/// A symmetric matrix from its entries of row i <= column k.
pub(crate) fn symmetric<'g>(entry: impl Fn(usize, usize) -> Recorded<'g>) -> Mat3<Recorded<'g>> {
    let [xx, xy, xz] = [0, 1, 2].map(|k| entry(0, k));
    let (yy, yz, zz) = (entry(1, 1), entry(1, 2), entry(2, 2));
    [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
}

/// R S R' of a symmetric S.
pub(crate) fn congruent<'g>(r: &Mat3<Recorded<'g>>, s: &Mat3<Recorded<'g>>) -> Mat3<Recorded<'g>> {
    let turned = product(r, s).map(|row| apply(r, row));
    symmetric(|i, k| turned[i][k])
}

/// The same for a turn about coordinate axis k, in 8 multiplications: with
/// `g = (S_ii - S_jj) sin + 2 S_ij cos`, S_ii loses `g sin`, S_jj gains it and S_ij becomes
/// `g cos - S_ij`.
pub(crate) fn turned_about<'g>(
    k: usize,
    cos: Recorded<'g>,
    sin: Recorded<'g>,
    s: &Mat3<Recorded<'g>>,
) -> Mat3<Recorded<'g>> {
    let (i, j) = ((k + 1) % 3, (k + 2) % 3);
    let g = (s[i][i] - s[j][j]) * sin + (s[i][j] + s[i][j]) * cos;
    let mut turned = *s;
    turned[i][i] = s[i][i] - g * sin;
    turned[j][j] = s[j][j] + g * sin;
    turned[i][j] = g * cos - s[i][j];
    turned[i][k] = s[i][k] * cos - s[j][k] * sin;
    turned[j][k] = s[i][k] * sin + s[j][k] * cos;
    (turned[j][i], turned[k][i], turned[k][j]) = (turned[i][j], turned[i][k], turned[j][k]);
    turned
}

/// A rotation as three turns about z, x and z: axes, cosines and sines, first factor first.
pub(crate) fn turns(r: &Mat3<f64>) -> [(usize, [f64; 2]); 3] {
    let sin = r[0][2].hypot(r[1][2]);
    let (first, last) = match sin > 0.0 {
        true => (
            [-r[1][2] / sin, r[0][2] / sin],
            [r[2][1] / sin, r[2][0] / sin],
        ),
        // About z alone, or turned upside down as well.
        false => ([r[0][0], r[1][0]], [1.0, 0.0]),
    };
    [(2, first), (0, [r[2][2], sin]), (2, last)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::Graph;
    use roberval_scalar::SplitMix64;
    use roberval_scalar::vector::rotation_about;

    /// A few roundings of numbers of size 1.
    const ROUNDING: f64 = 1e-14;

    fn about(k: usize, [cos, sin]: [f64; 2]) -> Mat3<f64> {
        let axis = [0, 1, 2].map(|i| if i == k { 1.0 } else { 0.0 });
        rotation_about(axis, cos, sin, 1.0 - cos)
    }

    /// Rotations about the axes and about any, quarter turns among them.
    fn rotations() -> Vec<Mat3<f64>> {
        let mut random = SplitMix64::new(1);
        let quarters = [
            [1.0, 0.0],
            [0.0, 1.0],
            [-1.0, 0.0],
            [0.0, -1.0],
            [0.8, -0.6],
        ];
        let simple = (0..3).flat_map(|k| quarters.map(|turn| about(k, turn)));
        let mut all: Vec<_> = simple.collect();
        for _ in 0..20 {
            let [a, b, c] = [0; 3].map(|_| {
                let (sin, cos) = random.uniform(-4.0, 4.0).sin_cos();
                [cos, sin]
            });
            all.push(product(&about(0, a), &product(&about(1, b), &about(2, c))));
        }
        all
    }

    #[test]
    fn three_turns_make_every_rotation() {
        for r in rotations() {
            let made = turns(&r).map(|(k, turn)| about(k, turn));
            let made = product(&made[0], &product(&made[1], &made[2]));
            for (a, b) in made.iter().flatten().zip(r.iter().flatten()) {
                assert!((a - b).abs() < ROUNDING, "{made:?} for {r:?}");
            }
        }
    }

    #[test]
    fn a_turn_about_an_axis_is_the_congruence() {
        let graph = Graph::default();
        let number = |x: f64| Recorded::constant(&graph, x);
        let s = [[3.0, 0.5, -1.0], [0.5, 2.0, 0.7], [-1.0, 0.7, 4.0]].map(|row| row.map(number));
        for k in 0..3 {
            let quick = turned_about(k, number(0.8), number(-0.6), &s);
            let r = about(k, [0.8, -0.6]).map(|row| row.map(number));
            let slow = congruent(&r, &s);
            for (a, b) in quick.iter().flatten().zip(slow.iter().flatten()) {
                let [a, b] = [a, b].map(|x| x.value().expect("a number"));
                assert!((a - b).abs() < ROUNDING, "{a} for {b}");
            }
        }
    }
}
