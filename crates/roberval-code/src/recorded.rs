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

    /// Another value of the same graph.
    fn with(self, at: Signed) -> Self {
        Self { at, ..self }
    }

    /// Its cosine.
    pub fn cos(self) -> Self {
        self.with(self.graph.cos(self.at))
    }

    /// Its sine.
    pub fn sin(self) -> Self {
        self.with(self.graph.sin(self.at))
    }

    /// -1, 0 or 1, as its sign is.
    pub fn sign(self) -> Self {
        self.with(self.graph.sign(self.at))
    }
}

impl Add for Recorded<'_> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.with(self.graph.add(self.at, other.at))
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
        self.with(self.graph.mul(self.at, other.at))
    }
}

impl Div for Recorded<'_> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        self.with(self.graph.div(self.at, other.at))
    }
}

impl Neg for Recorded<'_> {
    type Output = Self;
    fn neg(self) -> Self {
        self.with(self.at.times(true))
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
        self.with(self.graph.sqrt(self.at))
    }

    fn atan2(self, x: Self) -> Self {
        self.with(self.graph.atan2(self.at, x.at))
    }
}
