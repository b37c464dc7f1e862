//! The recursions' arithmetic, written down.

use std::ops::{Add, Div, Mul, Neg, Sub};

use roberval_scalar::{Analytic, Scalar};

use crate::graph::{Graph, Op, Signed};

/// A node in the recursion's arithmetic: what is computed with it is written down.
#[derive(Debug, Clone, Copy)]
pub struct Recorded<'g> {
    /// The graph that records.
    pub graph: &'g Graph,
    /// The expression.
    pub at: Signed,
}

impl<'g> Recorded<'g> {
    /// A number.
    pub fn constant(graph: &'g Graph, x: f64) -> Self {
        let at = graph.constant(x);
        Self { graph, at }
    }

    /// The k-th input.
    pub fn input(graph: &'g Graph, k: usize) -> Self {
        let at = Signed::plus(graph.node(Op::Input(k as u32)));
        Self { graph, at }
    }

    /// The k-th input, a parameter.
    pub fn parameter(graph: &'g Graph, k: usize) -> Self {
        let at = graph.parameter(k);
        Self { graph, at }
    }

    /// Its value if it is a number.
    pub fn value(self) -> Option<f64> {
        self.graph.value(self.at)
    }

    /// Its cosine.
    pub fn cos(self) -> Self {
        Self {
            at: self.graph.cos(self.at),
            ..self
        }
    }

    /// Its sine.
    pub fn sin(self) -> Self {
        Self {
            at: self.graph.sin(self.at),
            ..self
        }
    }

    /// -1, 0 or 1, as its sign is.
    pub fn sign(self) -> Self {
        Self {
            at: self.graph.sign(self.at),
            ..self
        }
    }
}

impl Add for Recorded<'_> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            at: self.graph.add(self.at, other.at),
            ..self
        }
    }
}

impl Sub for Recorded<'_> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Recorded<'_> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self {
            at: self.graph.mul(self.at, other.at),
            ..self
        }
    }
}

impl Div for Recorded<'_> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        Self {
            at: self.graph.div(self.at, other.at),
            ..self
        }
    }
}

impl Neg for Recorded<'_> {
    type Output = Self;
    fn neg(self) -> Self {
        Self {
            at: self.at.times(true),
            ..self
        }
    }
}

impl Scalar for Recorded<'_> {}

impl Analytic for Recorded<'_> {
    fn beside(self, x: f64) -> Self {
        Self::constant(self.graph, x)
    }

    fn cos_sin(self) -> (Self, Self) {
        (self.cos(), self.sin())
    }

    fn sqrt(self) -> Self {
        Self {
            at: self.graph.sqrt(self.at),
            ..self
        }
    }

    fn atan2(self, x: Self) -> Self {
        Self {
            at: self.graph.atan2(self.at, x.at),
            ..self
        }
    }
}
