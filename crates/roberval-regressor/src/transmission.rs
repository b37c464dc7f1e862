use crate::{Nonzero, Sink};
use roberval_scalar::Scalar;

/// G: what a unit velocity of each independent coordinate does to the n joint variables,
/// qd = G qad (n x m, row by row, zeros left out).
#[derive(Debug, Clone, PartialEq)]
pub struct Transmission<T> {
    /// Where each row begins in `places` and `values`, and where the last one ends.
    starts: Vec<usize>,
    /// Places in qa.
    places: Vec<usize>,
    values: Vec<T>,
}

impl<T: Copy> Transmission<T> {
    /// G from its rows: pairs of a place in qa and the value there.
    pub fn from_rows(rows: impl IntoIterator<Item = Vec<(usize, T)>>) -> Self {
        let mut g = Self {
            starts: vec![0],
            places: Vec::new(),
            values: Vec::new(),
        };
        for row in rows {
            g.places.extend(row.iter().map(|(place, _)| place));
            g.values.extend(row.iter().map(|(_, value)| value));
            g.starts.push(g.places.len());
        }
        g
    }

    /// Row i: places in qa and the values there.
    #[inline(always)]
    pub fn row(&self, i: usize) -> impl Iterator<Item = (usize, T)> + '_ {
        let span = self.starts[i]..self.starts[i + 1];
        let places = self.places[span.clone()].iter().copied();
        places.zip(self.values[span].iter().copied())
    }

    /// All values, row by row.
    pub fn values(&self) -> &[T] {
        &self.values
    }

    /// The values of row i, in the order of its places.
    pub fn row_mut(&mut self, i: usize) -> &mut [T] {
        &mut self.values[self.starts[i]..self.starts[i + 1]]
    }

    /// The same in another scalar.
    #[must_use]
    pub fn map<S>(&self, convert: impl Fn(T) -> S) -> Transmission<S> {
        Transmission {
            starts: self.starts.clone(),
            places: self.places.clone(),
            values: self.values.iter().map(|&x| convert(x)).collect(),
        }
    }
}

/// Rows for the independent coordinates: G' times the rows that the recursion emits for
/// all joints. The inner sink adds.
#[derive(Debug)]
pub struct Projected<'a, T, S> {
    /// G.
    pub transmission: &'a Transmission<T>,
    /// Where the m rows go.
    pub inner: &'a mut S,
}

impl<T: Scalar, S: Sink<T>> Sink<T> for Projected<'_, T, S> {
    #[inline(always)]
    fn link(&mut self, link: usize, row: usize, columns: [T; 10], nonzero: Nonzero) {
        for (place, g) in self.transmission.row(row) {
            self.inner
                .link(link, place, columns.map(|x| g * x), nonzero);
        }
    }

    #[inline(always)]
    fn rotor(&mut self, link: usize, row: usize, value: T) {
        for (place, g) in self.transmission.row(row) {
            self.inner.rotor(link, place, g * value);
        }
    }
}
