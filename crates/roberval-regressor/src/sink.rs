use roberval_mechanism::ParameterSpace;
use roberval_scalar::{Lift, Scalar};

/// Where the recursion's columns go. Rows are added to what is there: hand in zeros.
pub trait Sink<T> {
    /// The ten inertial columns XX..M of a link, on the row of one joint of its path; all but
    /// those of `nonzero` are zero in every state.
    fn link(&mut self, link: usize, row: usize, columns: [T; 10], nonzero: Nonzero);
    /// The Ia column of a link, on its own joint's row.
    fn rotor(&mut self, link: usize, row: usize, value: T);
}

/// Which of a link's ten inertial columns can have entries on a row: bit k for column k. More
/// of them may be zero in every state of a robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Nonzero(u16);

impl Nonzero {
    /// All ten.
    pub const ALL: Self = Self((1 << 10) - 1);
    /// MX, MY, MZ and M, on the row of a joint that slides.
    pub const SLIDING: Self = Self(0b11_1100_0000);

    /// On the row of the link's own joint, which turns about its axis x, y or z (0, 1, 2):
    /// neither mass nor the first moment along the axis.
    #[inline(always)]
    pub(crate) fn turning(axis: usize) -> Self {
        Self(Self::ALL.0 & !(1 << 9) & !(1 << (6 + axis)))
    }

    /// On the same row where nothing else moves the link: of the inertias only the one about
    /// the axis.
    #[inline(always)]
    pub(crate) fn turning_alone(axis: usize) -> Self {
        let about = 1 << [0, 3, 5][axis];
        Self(Self::turning(axis).0 & Self::SLIDING.0 | about)
    }

    /// Whether column k is among them.
    #[inline(always)]
    #[must_use]
    pub fn has(self, k: usize) -> bool {
        self.0 >> k & 1 == 1
    }

    /// Calls `each` with them in order. Where they are known to the compiler, so are the calls.
    #[inline(always)]
    pub fn each(self, mut each: impl FnMut(usize)) {
        for k in 0..10 {
            if self.has(k) {
                each(k);
            }
        }
    }

    /// How many there are.
    #[inline(always)]
    #[must_use]
    pub fn count(self) -> usize {
        self.0.count_ones() as usize
    }
}

/// Dense rows (n x C, row-major) of all standard parameters.
///
/// Entries off a link's path are structural zeros and are not touched.
#[derive(Debug)]
pub struct DenseRows<'a, T> {
    /// Where each link's columns begin.
    pub space: &'a ParameterSpace,
    /// n * C numbers.
    pub rows: &'a mut [T],
}

impl<T: Scalar> Sink<T> for DenseRows<'_, T> {
    #[inline(always)]
    fn link(&mut self, link: usize, row: usize, columns: [T; 10], _: Nonzero) {
        let at = row * self.space.len() + self.space.first_column(link);
        for (entry, value) in self.rows[at..at + 10].iter_mut().zip(columns) {
            *entry = *entry + value;
        }
    }

    #[inline(always)]
    fn rotor(&mut self, link: usize, row: usize, value: T) {
        let at = row * self.space.len() + self.space.first_column(link) + 10;
        self.rows[at] = self.rows[at] + value;
    }
}

/// Dense rows (n x b, row-major) of a choice of columns: the reduced model d1.
#[derive(Debug)]
pub struct SelectedRows<'a, T> {
    /// Where each link's columns begin in the full space.
    pub space: &'a ParameterSpace,
    /// The place of each of the C columns among the chosen ones, if chosen.
    pub places: &'a [Option<u32>],
    /// Number of chosen columns b.
    pub width: usize,
    /// n * b numbers.
    pub rows: &'a mut [T],
}

impl<T: Scalar> Sink<T> for SelectedRows<'_, T> {
    #[inline(always)]
    fn link(&mut self, link: usize, row: usize, columns: [T; 10], _: Nonzero) {
        let first = self.space.first_column(link);
        let row = &mut self.rows[row * self.width..(row + 1) * self.width];
        for (place, value) in self.places[first..first + 10].iter().zip(columns) {
            if let Some(place) = place {
                row[*place as usize] = row[*place as usize] + value;
            }
        }
    }

    #[inline(always)]
    fn rotor(&mut self, link: usize, row: usize, value: T) {
        if let Some(place) = self.places[self.space.first_column(link) + 10] {
            let entry = &mut self.rows[row * self.width + place as usize];
            *entry = *entry + value;
        }
    }
}

/// The product d X, without ever storing d.
#[derive(Debug)]
pub struct Torques<'a, C, T> {
    /// Where each link's parameters begin in `x`.
    pub space: &'a ParameterSpace,
    /// The standard parameters X.
    pub x: &'a [C],
    /// n joint torques, added to.
    pub torques: &'a mut [T],
}

impl<C: Copy, T: Lift<C>> Sink<T> for Torques<'_, C, T> {
    #[inline(always)]
    fn link(&mut self, link: usize, row: usize, columns: [T; 10], nonzero: Nonzero) {
        let x = &self.x[self.space.first_column(link)..][..10];
        let mut torque = self.torques[row];
        nonzero.each(|k| torque = columns[k].mul_add(T::lift(x[k]), torque));
        self.torques[row] = torque;
    }

    #[inline(always)]
    fn rotor(&mut self, link: usize, row: usize, value: T) {
        let x = T::lift(self.x[self.space.first_column(link) + 10]);
        self.torques[row] = value.mul_add(x, self.torques[row]);
    }
}
