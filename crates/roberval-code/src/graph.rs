//! Expressions as a graph in which equal ones are one node.

use std::cell::{Cell, RefCell};
use std::collections::HashMap;
use std::ops::{Add, Div, Mul, Neg, Sub};

use roberval_scalar::{Analytic, Scalar};

/// What a node computes. Operands are earlier nodes; signs are kept beside the nodes
/// ([`Signed`]), so that x - y and y - x, (-x) y and x y are one node each.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Op {
    /// A positive number or 0, by its bits.
    Constant(u64),
    /// The k-th input.
    Input(u32),
    /// Cosine of a node.
    Cos(u32),
    /// Sine of a node.
    Sin(u32),
    /// -1, 0 or 1.
    Sign(u32),
    /// x + y
    Add(u32, u32),
    /// x - y
    Sub(u32, u32),
    /// x y
    Mul(u32, u32),
    /// x / y
    Div(u32, u32),
    /// The square root of a node.
    Sqrt(u32),
    /// The angle of the point (x, y), given as y, x.
    Atan2(u32, u32),
}

impl Op {
    /// The nodes it works on.
    pub fn operands(self) -> impl Iterator<Item = u32> {
        let (a, b) = match self {
            Self::Constant(_) | Self::Input(_) => (None, None),
            Self::Cos(x) | Self::Sin(x) | Self::Sign(x) | Self::Sqrt(x) => (Some(x), None),
            Self::Add(x, y)
            | Self::Sub(x, y)
            | Self::Mul(x, y)
            | Self::Div(x, y)
            | Self::Atan2(x, y) => (Some(x), Some(y)),
        };
        a.into_iter().chain(b)
    }

    /// The same on other nodes.
    #[must_use]
    pub fn with_operands(self, new: impl Fn(u32) -> u32) -> Self {
        match self {
            Self::Constant(_) | Self::Input(_) => self,
            Self::Cos(x) => Self::Cos(new(x)),
            Self::Sin(x) => Self::Sin(new(x)),
            Self::Sign(x) => Self::Sign(new(x)),
            Self::Sqrt(x) => Self::Sqrt(new(x)),
            Self::Add(x, y) => Self::Add(new(x), new(y)),
            Self::Sub(x, y) => Self::Sub(new(x), new(y)),
            Self::Mul(x, y) => Self::Mul(new(x), new(y)),
            Self::Div(x, y) => Self::Div(new(x), new(y)),
            Self::Atan2(x, y) => Self::Atan2(new(x), new(y)),
        }
    }
}

/// A node or its negative.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Signed {
    /// The node.
    pub node: u32,
    /// Whether its negative is meant.
    pub negative: bool,
}

impl Signed {
    /// The node itself.
    #[must_use]
    pub fn plus(node: u32) -> Self {
        Self {
            node,
            negative: false,
        }
    }

    /// The node, or its negative.
    #[must_use]
    pub fn times(self, negative: bool) -> Self {
        Self {
            negative: self.negative != negative,
            ..self
        }
    }
}

/// The graph under construction.
#[derive(Debug, Default)]
pub struct Graph {
    nodes: RefCell<Vec<Op>>,
    /// The link in whose turn each node came up.
    links: RefCell<Vec<u32>>,
    index: RefCell<HashMap<Op, u32>>,
    link: Cell<u32>,
}

impl Graph {
    /// Nodes from now on belong to this link.
    pub fn set_link(&self, link: usize) {
        self.link.set(link as u32);
    }

    /// The nodes, operands first, and their links.
    #[must_use]
    pub fn into_nodes(self) -> (Vec<Op>, Vec<u32>) {
        (self.nodes.into_inner(), self.links.into_inner())
    }

    /// What a node computes.
    #[must_use]
    pub fn op(&self, node: u32) -> Op {
        self.nodes.borrow()[node as usize]
    }

    /// The node of this operation.
    pub fn node(&self, op: Op) -> u32 {
        let mut nodes = self.nodes.borrow_mut();
        *self.index.borrow_mut().entry(op).or_insert_with(|| {
            nodes.push(op);
            self.links.borrow_mut().push(self.link.get());
            nodes.len() as u32 - 1
        })
    }

    /// A number.
    pub fn constant(&self, x: f64) -> Signed {
        // -0 is 0.
        Signed {
            node: self.node(Op::Constant(x.abs().to_bits())),
            negative: x < 0.0,
        }
    }

    /// The value of a node that is a number.
    #[must_use]
    pub fn value(&self, x: Signed) -> Option<f64> {
        match self.op(x.node) {
            Op::Constant(bits) if x.negative => Some(-f64::from_bits(bits)),
            Op::Constant(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }

    /// x + y, folded.
    pub fn add(&self, x: Signed, y: Signed) -> Signed {
        match (self.value(x), self.value(y)) {
            (Some(a), Some(b)) => return self.constant(a + b),
            (Some(0.0), _) => return y,
            (_, Some(0.0)) => return x,
            _ => {}
        }
        if x == y.times(true) {
            return self.constant(0.0);
        }
        if let Some(rest) = self.cancelled(x, y).or_else(|| self.cancelled(y, x)) {
            return rest;
        }
        let (x, y) = if x.node <= y.node { (x, y) } else { (y, x) };
        let op = match x.negative == y.negative {
            true => Op::Add(x.node, y.node),
            false => Op::Sub(x.node, y.node),
        };
        Signed::plus(self.node(op)).times(x.negative)
    }

    /// (a + b) - b = a
    fn cancelled(&self, sum: Signed, y: Signed) -> Option<Signed> {
        let (a, b) = match self.op(sum.node) {
            Op::Add(a, b) => (Signed::plus(a), Signed::plus(b)),
            Op::Sub(a, b) => (Signed::plus(a), Signed::plus(b).times(true)),
            _ => return None,
        };
        let (a, b, gone) = (a.times(sum.negative), b.times(sum.negative), y.times(true));
        match gone {
            _ if a == gone => Some(b),
            _ if b == gone => Some(a),
            _ => None,
        }
    }

    /// x y, folded.
    pub fn mul(&self, x: Signed, y: Signed) -> Signed {
        let negative = x.negative != y.negative;
        match (self.value(x), self.value(y)) {
            (Some(a), Some(b)) => return self.constant(a * b),
            (Some(0.0), _) | (_, Some(0.0)) => return self.constant(0.0),
            (Some(1.0 | -1.0), _) => return Signed::plus(y.node).times(negative),
            (_, Some(1.0 | -1.0)) => return Signed::plus(x.node).times(negative),
            (Some(a), None) => return self.scaled(a, y),
            (None, Some(b)) => return self.scaled(b, x),
            _ => {}
        }
        let (x, y) = (x.node.min(y.node), x.node.max(y.node));
        Signed::plus(self.node(Op::Mul(x, y))).times(negative)
    }

    /// a x, with numbers gathered: a (b x) = (a b) x.
    fn scaled(&self, a: f64, x: Signed) -> Signed {
        if let Op::Mul(p, q) = self.op(x.node) {
            for (p, q) in [(p, q), (q, p)] {
                if let Some(b) = self.value(Signed::plus(p)) {
                    return self.mul(self.constant(a * b), Signed::plus(q).times(x.negative));
                }
            }
        }
        let factor = self.constant(a);
        let (low, high) = (factor.node.min(x.node), factor.node.max(x.node));
        Signed::plus(self.node(Op::Mul(low, high))).times(factor.negative != x.negative)
    }

    /// cos x
    pub fn cos(&self, x: Signed) -> Signed {
        match self.value(x) {
            Some(value) => self.constant(value.cos()),
            None => Signed::plus(self.node(Op::Cos(x.node))),
        }
    }

    /// -1, 0 or 1
    pub fn sign(&self, x: Signed) -> Signed {
        Signed::plus(self.node(Op::Sign(x.node))).times(x.negative)
    }

    /// sin x
    pub fn sin(&self, x: Signed) -> Signed {
        match self.value(x) {
            Some(value) => self.constant(value.sin()),
            None => Signed::plus(self.node(Op::Sin(x.node))).times(x.negative),
        }
    }
}

impl Graph {
    /// x / y, folded.
    pub fn div(&self, x: Signed, y: Signed) -> Signed {
        match (self.value(x), self.value(y)) {
            (Some(0.0), _) => return x,
            (_, Some(b)) if b != 0.0 => return self.mul(self.constant(1.0 / b), x),
            _ => {}
        }
        Signed::plus(self.node(Op::Div(x.node, y.node))).times(x.negative != y.negative)
    }

    /// The square root of x.
    pub fn sqrt(&self, x: Signed) -> Signed {
        match self.value(x) {
            Some(value) if value >= 0.0 => self.constant(value.sqrt()),
            _ => Signed::plus(self.node(Op::Sqrt(self.unsigned(x)))),
        }
    }

    /// The angle of the point (x, y).
    pub fn atan2(&self, y: Signed, x: Signed) -> Signed {
        match (self.value(y), self.value(x)) {
            (Some(y), Some(x)) => self.constant(y.atan2(x)),
            _ => Signed::plus(self.node(Op::Atan2(y.node, self.unsigned(x)))).times(y.negative),
        }
    }

    /// A node that is x, its sign included.
    fn unsigned(&self, x: Signed) -> u32 {
        match x.negative {
            true => self.node(Op::Sub(self.constant(0.0).node, x.node)),
            false => x.node,
        }
    }
}

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
