//! Expressions as a graph in which equal ones are one node.

use std::cell::{Cell, RefCell};
use std::collections::HashMap;

use crate::linear::Forms;

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
    /// What is known of nodes that parameters alone determine.
    pub(crate) forms: RefCell<Forms>,
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

    /// The node of an input that is a parameter: sums of such are known to be equal however
    /// they came about.
    pub fn parameter(&self, k: usize) -> Signed {
        let node = self.node(Op::Input(k as u32));
        self.forms.borrow_mut().set_parameter(node);
        Signed::plus(node)
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
}
