//! Arithmetic of nodes: what is known beforehand is not computed.

use crate::graph::{Graph, Op, Signed};

impl Graph {
    /// x + y, folded.
    pub fn add(&self, x: Signed, y: Signed) -> Signed {
        match (self.value(x), self.value(y)) {
            (Some(a), Some(b)) => return self.constant(a + b),
            (Some(0.0), _) => return y,
            (_, Some(0.0)) => return x,
            _ => {}
        }
        let ((a, p), (b, q)) = (self.multiple(x), self.multiple(y));
        if p == q {
            return self.mul(self.constant(a + b), Signed::plus(p));
        }
        if let Some(rest) = self.cancelled(x, y).or_else(|| self.cancelled(y, x)) {
            return rest;
        }
        self.linear_sum(x, y)
    }

    /// x as a number times a node.
    fn multiple(&self, x: Signed) -> (f64, u32) {
        let sign = if x.negative { -1.0 } else { 1.0 };
        if let Op::Mul(p, q) = self.op(x.node) {
            for (p, q) in [(p, q), (q, p)] {
                if let Some(factor) = self.value(Signed::plus(p)) {
                    return (sign * factor, q);
                }
            }
        }
        (sign, x.node)
    }

    /// x + y as it stands.
    fn plain_sum(&self, x: Signed, y: Signed) -> Signed {
        let (x, y) = if x.node <= y.node { (x, y) } else { (y, x) };
        let op = match x.negative == y.negative {
            true => Op::Add(x.node, y.node),
            false => Op::Sub(x.node, y.node),
        };
        Signed::plus(self.node(op)).times(x.negative)
    }

    /// x + y; where parameters alone determine both, what they have in common is gathered.
    fn linear_sum(&self, x: Signed, y: Signed) -> Signed {
        let Some(sum) = self.forms.borrow().sum(x, y) else {
            return self.plain_sum(x, y);
        };
        let known = self.forms.borrow().known(&sum.form);
        if let Some((factor, node)) = known {
            return self.mul(self.constant(factor), Signed::plus(node));
        }
        let result = match sum.cancelled {
            false => self.plain_sum(x, y),
            true => self.sum_of(&sum.form),
        };
        self.forms.borrow_mut().set(result, sum.form);
        result
    }

    /// The terms of a form, one after the other.
    fn sum_of(&self, form: &[(u32, f64)]) -> Signed {
        let term =
            |&(node, factor): &(u32, f64)| self.mul(self.constant(factor), Signed::plus(node));
        let terms = form.iter().map(term);
        terms
            .reduce(|sum, term| self.linear_sum(sum, term))
            .unwrap_or_else(|| self.constant(0.0))
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
        let product = self.node(Op::Mul(low, high));
        self.forms
            .borrow_mut()
            .set_multiple(product, a.abs(), x.node);
        Signed::plus(product).times(factor.negative != x.negative)
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
