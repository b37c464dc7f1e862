//! What a link can meet: the spans of its velocities, of their squares and of gravity.

use roberval_linalg::Echelon;
use roberval_regressor::{Body, Constants, Tree};
use roberval_scalar::{Fp, Modulus};

use super::spatial::{Matrix6, Vector6, apply, outer, product, sum, transform, transposed};

/// A vector or a symmetric matrix.
trait Element<'m>: Clone {
    /// Dimension of the space of all of them.
    const DIMENSION: usize;
    fn coordinates(&self) -> Vec<Fp<'m>>;
}

impl<'m> Element<'m> for Vector6<Fp<'m>> {
    const DIMENSION: usize = 6;
    fn coordinates(&self) -> Vec<Fp<'m>> {
        self.to_vec()
    }
}

impl<'m> Element<'m> for Matrix6<Fp<'m>> {
    const DIMENSION: usize = 21;
    fn coordinates(&self) -> Vec<Fp<'m>> {
        (0..6).flat_map(|i| self[i][i..].iter().copied()).collect()
    }
}

/// A linear space, by a basis.
#[derive(Clone)]
struct Span<'m, E> {
    echelon: Echelon<'m>,
    basis: Vec<E>,
}

impl<'m, E: Element<'m>> Span<'m, E> {
    fn of(modulus: &'m Modulus, elements: impl IntoIterator<Item = E>) -> Self {
        let mut span = Self {
            echelon: Echelon::new(modulus, E::DIMENSION),
            basis: Vec::new(),
        };
        elements.into_iter().for_each(|e| span.add(e));
        span
    }

    fn is_full(&self) -> bool {
        self.basis.len() == E::DIMENSION
    }

    fn add(&mut self, element: E) {
        if !self.is_full() && self.echelon.insert(&element.coordinates()) {
            self.basis.push(element);
        }
    }

    /// The image under an invertible map.
    fn image(&self, modulus: &'m Modulus, map: impl Fn(&E) -> E) -> Self {
        if self.is_full() {
            return self.clone();
        }
        Self::of(modulus, self.basis.iter().map(map))
    }

    /// Adds the images of what is in it until nothing is new.
    ///
    /// With `rate` the rate of change along a one-parameter motion, whose finite motion
    /// is `exp(q rate)`, this is the span over all q: the derivatives at q = 0 span what
    /// the analytic function of q spans.
    fn close(&mut self, rate: impl Fn(&E) -> E) {
        let mut done = 0;
        while done < self.basis.len() && !self.is_full() {
            self.add(rate(&self.basis[done]));
            done += 1;
        }
    }
}

/// The spans of what a link can meet, in the link's frame.
pub(super) struct Attainable<'m> {
    modulus: &'m Modulus,
    /// Velocities u.
    velocities: Span<'m, Vector6<Fp<'m>>>,
    /// Their squares u u': more than the velocities' span tells, for a body on one joint
    /// knows only one direction and one square.
    squares: Span<'m, Matrix6<Fp<'m>>>,
    /// Gravity, as velocities (0, g).
    gravity: Span<'m, Vector6<Fp<'m>>>,
}

impl<'m> Attainable<'m> {
    /// The base stands still and feels gravity.
    pub fn base(tree: &Tree<Fp<'m>>) -> Self {
        let zero = tree.constants.zero;
        let modulus = zero.modulus();
        let [x, y, z] = tree.gravity;
        Self {
            modulus,
            velocities: Span::of(modulus, []),
            squares: Span::of(modulus, []),
            gravity: Span::of(modulus, [[zero, zero, zero, x, y, z]]),
        }
    }

    /// The base moves freely: whatever it meets, it meets in all directions.
    pub fn free(tree: &Tree<Fp<'m>>) -> Self {
        let Constants { zero, one, .. } = tree.constants;
        let modulus = zero.modulus();
        let unit = |k: usize| std::array::from_fn(|i| if i == k { one } else { zero });
        let pairs = (0..6).flat_map(|i| (0..=i).map(move |j| (unit(i), unit(j))));
        let falls = tree.gravity.iter().any(|g| !g.is_zero());
        Self {
            modulus,
            velocities: Span::of(modulus, (0..6).map(unit)),
            squares: Span::of(
                modulus,
                pairs.map(|(u, v)| sum(&outer(&u, &v), &outer(&v, &u))),
            ),
            gravity: Span::of(modulus, (3..6).filter(|_| falls).map(unit)),
        }
    }

    /// The same, in the frame of a body on this link, its joint at rest at 0.
    pub fn carried(&self, body: &Body<Fp<'m>>) -> Self {
        let x = transform(&body.rotation, body.origin, self.modulus.integer(0));
        let back = transposed(&x);
        Self {
            modulus: self.modulus,
            velocities: self.velocities.image(self.modulus, |u| apply(&x, u)),
            squares: self
                .squares
                .image(self.modulus, |s| product(&product(&x, s), &back)),
            gravity: self.gravity.image(self.modulus, |g| apply(&x, g)),
        }
    }

    /// The same at all joint positions, `cross` being the matrix of `S x`.
    pub fn moved_by(mut self, cross: &Matrix6<Fp<'m>>) -> Self {
        self.velocities.close(|u| apply(cross, u));
        self.gravity.close(|g| apply(cross, g));
        self.squares.close(|s| {
            let half = product(cross, s);
            sum(&half, &transposed(&half))
        });
        self
    }

    /// Adds the joint's own velocity: `(w + S qd)(w + S qd)'` for all qd.
    pub fn add_joint(&mut self, joint: &Vector6<Fp<'m>>) {
        for w in &self.velocities.basis {
            let mixed = outer(joint, w);
            self.squares.add(sum(&mixed, &transposed(&mixed)));
        }
        self.squares.add(outer(joint, joint));
        self.velocities.add(*joint);
    }

    pub fn velocities(&self) -> &[Vector6<Fp<'m>>] {
        &self.velocities.basis
    }

    pub fn squares(&self) -> &[Matrix6<Fp<'m>>] {
        &self.squares.basis
    }

    pub fn gravity(&self) -> &[Vector6<Fp<'m>>] {
        &self.gravity.basis
    }
    /// What these velocities span, without gravity.
    #[cfg(test)]
    pub fn of_velocities(velocities: &[Vector6<Fp<'m>>]) -> Self {
        let modulus = velocities[0][0].modulus();
        Self {
            modulus,
            velocities: Span::of(modulus, velocities.iter().copied()),
            squares: Span::of(modulus, velocities.iter().map(|u| outer(u, u))),
            gravity: Span::of(modulus, []),
        }
    }

    /// Dimensions of the spans of velocities and of squares with these velocities added.
    #[cfg(test)]
    pub fn dimensions_with(&self, velocities: &[Vector6<Fp<'m>>]) -> [usize; 2] {
        let (mut linear, mut squares) = (self.velocities.clone(), self.squares.clone());
        for u in velocities {
            linear.add(*u);
            squares.add(outer(u, u));
        }
        [linear.basis.len(), squares.basis.len()]
    }
}
