//! A finished computation: nodes in order, each after its operands, and outputs.

use crate::graph::{Graph, Op, Signed};

/// Operations of a program or of a part of it. Changes of sign are not counted.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Count {
    /// Multiplications, and divisions where expressions of joints have them.
    pub mul: usize,
    /// Additions and subtractions.
    pub add: usize,
    /// Sines and cosines; roots and angles of points where expressions have them.
    pub trig: usize,
}

impl Count {
    fn take(&mut self, op: Op) {
        match op {
            Op::Mul(..) | Op::Div(..) => self.mul += 1,
            Op::Add(..) | Op::Sub(..) => self.add += 1,
            Op::Cos(_) | Op::Sin(_) | Op::Sqrt(_) | Op::Atan2(..) => self.trig += 1,
            Op::Constant(_) | Op::Input(_) | Op::Sign(_) => {}
        }
    }

    /// Multiplications and additions together.
    #[must_use]
    pub fn arithmetic(self) -> usize {
        self.mul + self.add
    }
}

/// What an input is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Input {
    /// Joint position, by joint variable.
    Q(usize),
    /// Joint velocity.
    Qd(usize),
    /// Joint acceleration.
    Qdd(usize),
    /// G: what coordinate k (second) does to joint variable i (first), where loops relate
    /// them.
    G(usize, usize),
    /// A parameter, by its place in the order of the code's parameters.
    Parameter(usize),
    /// A value that was computed from the parameters before, by its place.
    Prepared(usize),
}

impl Input {
    /// The name of the array that it stands in.
    pub(crate) fn array(self) -> &'static str {
        match self {
            Self::Q(_) => "q",
            Self::Qd(_) => "qd",
            Self::Qdd(_) => "qdd",
            Self::G(..) => "g",
            Self::Parameter(_) => "x",
            Self::Prepared(_) => "k",
        }
    }

    /// Whether this is the same at every state.
    #[must_use]
    pub fn is_constant(self) -> bool {
        matches!(self, Self::Parameter(_) | Self::Prepared(_))
    }
}

/// Straight-line code: every node after its operands, none that no output needs.
#[derive(Debug, Clone)]
pub struct Program {
    /// The nodes.
    pub nodes: Vec<Op>,
    /// The link in whose turn each node came up.
    pub links: Vec<u32>,
    /// The inputs that [`Op::Input`] numbers.
    pub inputs: Vec<Input>,
    /// The results.
    pub outputs: Vec<Signed>,
}

impl Program {
    /// What these outputs of a graph need, and nothing else.
    #[must_use]
    pub fn new(graph: Graph, inputs: Vec<Input>, outputs: Vec<Signed>) -> Self {
        let (nodes, links) = graph.into_nodes();
        Self {
            nodes,
            links,
            inputs,
            outputs,
        }
        .without_dead_nodes()
    }

    fn without_dead_nodes(self) -> Self {
        let mut needed = vec![false; self.nodes.len()];
        for output in &self.outputs {
            needed[output.node as usize] = true;
        }
        for (at, op) in self.nodes.iter().enumerate().rev() {
            if needed[at] {
                op.operands().for_each(|x| needed[x as usize] = true);
            }
        }
        let mut place = vec![0; self.nodes.len()];
        let mut kept = Self {
            nodes: Vec::new(),
            links: Vec::new(),
            ..self
        };
        for (at, op) in self.nodes.iter().enumerate().filter(|(at, _)| needed[*at]) {
            place[at] = kept.nodes.len() as u32;
            let new = |x: u32| place[x as usize];
            kept.nodes.push(op.with_operands(new));
            kept.links.push(self.links[at]);
        }
        for output in &mut kept.outputs {
            output.node = place[output.node as usize];
        }
        kept
    }

    /// For each node, whether it depends on the parameters and numbers alone: it need be
    /// computed only once for a robot.
    #[must_use]
    pub fn constant_nodes(&self) -> Vec<bool> {
        let mut constant = Vec::with_capacity(self.nodes.len());
        for op in &self.nodes {
            constant.push(match *op {
                Op::Input(k) => self.inputs[k as usize].is_constant(),
                op => op.operands().all(|x| constant[x as usize]),
            });
        }
        constant
    }

    /// The operations.
    #[must_use]
    pub fn count(&self) -> Count {
        let mut count = Count::default();
        self.nodes.iter().for_each(|op| count.take(*op));
        count
    }

    /// What choosing among programs goes by: the operations at every state, then all.
    #[must_use]
    pub(crate) fn cost(&self) -> (usize, usize) {
        let main = self
            .divided()
            .map_or_else(|| self.count(), |(_, main)| main.count());
        (main.arithmetic(), self.nodes.len())
    }

    /// The operations in each link's turn.
    #[must_use]
    pub fn count_by_link(&self, links: usize) -> Vec<Count> {
        let mut counts = vec![Count::default(); links];
        for (op, link) in self.nodes.iter().zip(&self.links) {
            counts[*link as usize].take(*op);
        }
        counts
    }

    /// Divided in what need be done once for a set of parameters, and what is left for
    /// every state: the outputs of the first are the [`Input::Prepared`] of the second.
    /// `None` if nothing is to be done once.
    #[must_use]
    pub fn divided(&self) -> Option<(Self, Self)> {
        let constant = self.constant_nodes();
        let computed = |at: usize| constant[at] && self.nodes[at].operands().next().is_some();
        if !(0..self.nodes.len()).any(computed) {
            return None;
        }
        let mut prepare = self.clone();
        prepare.outputs.clear();
        let mut rest = self.clone();
        rest.inputs.clear();
        let boundary = self.boundary(&constant);
        for (at, op) in self.nodes.iter().enumerate() {
            let number = matches!(op, Op::Constant(_));
            let input = match *op {
                Op::Input(k) if !self.inputs[k as usize].is_constant() => self.inputs[k as usize],
                _ if constant[at] && !number && boundary[at] => {
                    prepare.outputs.push(Signed::plus(at as u32));
                    Input::Prepared(prepare.outputs.len() - 1)
                }
                _ => continue,
            };
            rest.nodes[at] = Op::Input(rest.inputs.len() as u32);
            rest.inputs.push(input);
        }
        Some((prepare.without_dead_nodes(), rest.without_dead_nodes()))
    }

    /// The nodes that something not constant, or an output, needs.
    fn boundary(&self, constant: &[bool]) -> Vec<bool> {
        let mut boundary = vec![false; self.nodes.len()];
        let users = self.nodes.iter().zip(constant).filter(|(_, c)| !**c);
        let operands = users.flat_map(|(op, _)| op.operands());
        let outputs = self.outputs.iter().map(|x| x.node);
        operands
            .chain(outputs)
            .for_each(|x| boundary[x as usize] = true);
        boundary
    }

    /// How often each node is used, as an operand or as an output.
    #[must_use]
    pub fn uses(&self) -> Vec<usize> {
        let mut uses = vec![0; self.nodes.len()];
        let operands = self.nodes.iter().flat_map(|op| op.operands());
        let outputs = self.outputs.iter().map(|x| x.node);
        operands.chain(outputs).for_each(|x| uses[x as usize] += 1);
        uses
    }

    /// The outputs in doubles; `input` gives the inputs' values.
    #[must_use]
    pub fn evaluate(&self, input: impl Fn(Input) -> f64) -> Vec<f64> {
        let mut values: Vec<f64> = Vec::with_capacity(self.nodes.len());
        for op in &self.nodes {
            let at = |x: u32| values[x as usize];
            values.push(match *op {
                Op::Constant(bits) => f64::from_bits(bits),
                Op::Input(k) => input(self.inputs[k as usize]),
                Op::Cos(x) => at(x).cos(),
                Op::Sin(x) => at(x).sin(),
                Op::Sign(x) => sign(at(x)),
                Op::Add(x, y) => at(x) + at(y),
                Op::Sub(x, y) => at(x) - at(y),
                Op::Mul(x, y) => at(x) * at(y),
                Op::Div(x, y) => at(x) / at(y),
                Op::Sqrt(x) => at(x).sqrt(),
                Op::Atan2(y, x) => at(y).atan2(at(x)),
            });
        }
        let value = |x: &Signed| match x.negative {
            true => -values[x.node as usize],
            false => values[x.node as usize],
        };
        self.outputs.iter().map(value).collect()
    }
}

fn sign(x: f64) -> f64 {
    match x {
        x if x > 0.0 => 1.0,
        x if x < 0.0 => -1.0,
        _ => 0.0,
    }
}
