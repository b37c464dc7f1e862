use roberval_mechanism::ParameterSpace;
use roberval_scalar::{Lift, Scalar};

/// Where the recursion's columns go. Rows are added to what is there: hand in zeros.
pub trait Sink<T> {
    /// The ten inertial columns XX..M of a link, on the row of one joint of its path.
    fn link(&mut self, link: usize, row: usize, columns: [T; 10]);
    /// The Ia column of a link, on its own joint's row.
    fn rotor(&mut self, link: usize, row: usize, value: T);
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
    fn link(&mut self, link: usize, row: usize, columns: [T; 10]) {
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
    fn link(&mut self, link: usize, row: usize, columns: [T; 10]) {
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
    fn link(&mut self, link: usize, row: usize, columns: [T; 10]) {
        let x = &self.x[self.space.first_column(link)..][..10];
        let mut torque = self.torques[row];
        for (column, x) in columns.iter().zip(x) {
            torque = column.mul_add(T::lift(*x), torque);
        }
        self.torques[row] = torque;
    }

    #[inline(always)]
    fn rotor(&mut self, link: usize, row: usize, value: T) {
        let x = T::lift(self.x[self.space.first_column(link) + 10]);
        self.torques[row] = value.mul_add(x, self.torques[row]);
    }
}
