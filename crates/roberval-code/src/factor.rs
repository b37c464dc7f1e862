//! Sums rearranged: common factors once, what is known before a state first.

use crate::graph::{Graph, Op, Signed};
use crate::program::Program;

/// Rounds of rearranging; most programs have nothing left after two.
const ROUNDS: usize = 4;

impl Program {
    /// The same with `a x + a y` as `a (x + y)` wherever that saves something.
    #[must_use]
    pub(crate) fn factored(self) -> Self {
        let mut best = self;
        for _ in 0..ROUNDS {
            let next = Rearranging::of(&best);
            if next.cost() >= best.cost() {
                break;
            }
            best = next;
        }
        best
    }
}

/// A term of a sum: a product that nothing else needs, or anything.
#[derive(Clone, Copy)]
struct Term {
    negative: bool,
    product: Product,
}

#[derive(Clone, Copy)]
enum Product {
    One(Signed),
    Of(u32, u32),
}

/// A program on its way to a new graph.
struct Rearranging<'a> {
    old: &'a Program,
    graph: Graph,
    /// Nodes that only a sum needs, and only once: they are written with it.
    inner: Vec<bool>,
    /// Where the old nodes are.
    new: Vec<Signed>,
    /// Of the new nodes, whether they are the same at all states.
    constant: Vec<bool>,
}

impl<'a> Rearranging<'a> {
    fn of(old: &'a Program) -> Program {
        let mut work = Self {
            old,
            graph: Graph::default(),
            inner: inner(old),
            new: Vec::with_capacity(old.nodes.len()),
            constant: Vec::new(),
        };
        for (at, op) in old.nodes.iter().enumerate() {
            work.graph.set_link(old.links[at] as usize);
            let new = match *op {
                _ if work.inner[at] => Signed::plus(0),
                Op::Add(..) | Op::Sub(..) => {
                    let mut terms = Vec::new();
                    work.collect(at as u32, false, &mut terms);
                    work.sum(terms)
                }
                op => work.copied(op),
            };
            work.new.push(new);
        }
        let outputs = old.outputs.iter();
        let outputs = outputs.map(|x| work.new[x.node as usize].times(x.negative));
        let outputs = outputs.collect();
        Program::new(work.graph, old.inputs.clone(), outputs)
    }

    fn copied(&self, op: Op) -> Signed {
        let (graph, at) = (&self.graph, |x: u32| self.new[x as usize]);
        match op {
            Op::Constant(bits) => graph.constant(f64::from_bits(bits)),
            Op::Input(k) if self.old.inputs[k as usize].is_constant() => {
                graph.parameter(k as usize)
            }
            Op::Input(_) => Signed::plus(graph.node(op)),
            Op::Cos(x) => graph.cos(at(x)),
            Op::Sin(x) => graph.sin(at(x)),
            Op::Sign(x) => graph.sign(at(x)),
            Op::Add(x, y) => graph.add(at(x), at(y)),
            Op::Sub(x, y) => graph.add(at(x), at(y).times(true)),
            Op::Mul(x, y) => graph.mul(at(x), at(y)),
            Op::Div(x, y) => graph.div(at(x), at(y)),
            Op::Sqrt(x) => graph.sqrt(at(x)),
            Op::Atan2(y, x) => graph.atan2(at(y), at(x)),
        }
    }

    /// The terms of a sum and of those in it.
    fn collect(&self, at: u32, negative: bool, terms: &mut Vec<Term>) {
        let mut operand = |x: u32, negative: bool| match self.old.nodes[x as usize] {
            Op::Mul(a, b) if self.inner[x as usize] => {
                let (a, b) = (self.new[a as usize], self.new[b as usize]);
                terms.push(Term {
                    negative: negative != (a.negative != b.negative),
                    product: Product::Of(a.node, b.node),
                });
            }
            _ if self.inner[x as usize] => self.collect(x, negative, terms),
            _ => terms.push(Term {
                negative,
                product: Product::One(self.new[x as usize]),
            }),
        };
        match self.old.nodes[at as usize] {
            Op::Add(x, y) => {
                operand(x, negative);
                operand(y, negative);
            }
            Op::Sub(x, y) => {
                operand(x, negative);
                operand(y, !negative);
            }
            _ => {}
        }
    }

    /// The sum of terms, common factors drawn out.
    fn sum(&mut self, mut terms: Vec<Term>) -> Signed {
        while let Some(factor) = self.best_factor(&terms) {
            let (mut rest, mut others) = (Vec::new(), Vec::new());
            let mut first = None;
            for (at, term) in terms.into_iter().enumerate() {
                match term.product.over(factor) {
                    Some(over) => {
                        first = first.or(Some(at));
                        rest.push(Term {
                            product: Product::One(Signed::plus(over)),
                            ..term
                        });
                    }
                    None => others.push(term),
                }
            }
            let rest = self.sum(rest);
            let place = first.unwrap_or(0).min(others.len());
            let product = match self.graph.value(rest) {
                Some(_) => Product::One(self.graph.mul(Signed::plus(factor), rest)),
                None => Product::Of(factor, rest.node),
            };
            let negative = rest.negative && matches!(product, Product::Of(..));
            others.insert(place, Term { negative, product });
            terms = others;
        }
        // What is the same at all states comes first.
        let terms: Vec<Signed> = terms.into_iter().map(|term| self.written(term)).collect();
        let (constant, others): (Vec<_>, Vec<_>) = terms
            .into_iter()
            .partition(|term| self.is_constant(term.node));
        let all = constant.into_iter().chain(others);
        all.reduce(|sum, term| self.graph.add(sum, term))
            .unwrap_or_else(|| self.graph.constant(0.0))
    }

    fn written(&self, term: Term) -> Signed {
        let value = match term.product {
            Product::One(x) => x,
            Product::Of(a, b) => self.graph.mul(Signed::plus(a), Signed::plus(b)),
        };
        value.times(term.negative)
    }

    /// The factor of most terms, of two at least; best where what is left is the same at all
    /// states.
    fn best_factor(&mut self, terms: &[Term]) -> Option<u32> {
        let mut gains: Vec<(u32, usize, usize)> = Vec::new();
        for term in terms {
            let Product::Of(a, b) = term.product else {
                continue;
            };
            let both = [(a, b), (b, a)];
            for (factor, rest) in both.into_iter().take(if a == b { 1 } else { 2 }) {
                let constant = usize::from(self.is_constant(rest));
                match gains.iter_mut().find(|g| g.0 == factor) {
                    Some(gain) => (gain.1, gain.2) = (gain.1 + 1, gain.2 + constant),
                    None => gains.push((factor, 1, constant)),
                }
            }
        }
        let several = gains.into_iter().filter(|g| g.1 > 1);
        let gain = |g: &(u32, usize, usize)| (g.1 - 1) + g.2.saturating_sub(1);
        several.rev().max_by_key(gain).map(|g| g.0)
    }

    fn is_constant(&mut self, node: u32) -> bool {
        for at in self.constant.len()..=node as usize {
            let constant = match self.graph.op(at as u32) {
                Op::Input(k) => self.old.inputs[k as usize].is_constant(),
                op => op.operands().all(|x| self.constant[x as usize]),
            };
            self.constant.push(constant);
        }
        self.constant[node as usize]
    }
}

impl Product {
    /// What is left without a factor.
    fn over(self, factor: u32) -> Option<u32> {
        match self {
            Self::Of(a, b) if a == factor => Some(b),
            Self::Of(a, b) if b == factor => Some(a),
            _ => None,
        }
    }
}

/// Sums and products that a sum needs and nothing else.
fn inner(program: &Program) -> Vec<bool> {
    let uses = program.uses();
    let mut inner = vec![false; program.nodes.len()];
    for op in &program.nodes {
        if let Op::Add(x, y) | Op::Sub(x, y) = *op {
            for x in [x, y].map(|x| x as usize) {
                let kind = matches!(program.nodes[x], Op::Add(..) | Op::Sub(..) | Op::Mul(..));
                inner[x] = kind && uses[x] == 1;
            }
        }
    }
    inner
}
