//! Sums of multiples of parameters, by which equal ones are known.

use std::collections::HashMap;

use crate::graph::Signed;

/// Parameters by their nodes, in order, with their factors.
pub(crate) type Form = Vec<(u32, f64)>;

/// A factor that is left of two this much larger is rounding: products of cosines and sines
/// have a few units in the last place.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// The nodes of a graph that are sums of multiples of parameters.
#[derive(Debug, Default)]
pub(crate) struct Forms {
    forms: HashMap<u32, Form>,
    /// Nodes by their form over its first factor.
    nodes: HashMap<Vec<(u32, u64)>, (f64, u32)>,
}

/// A sum of two forms.
pub(crate) struct Sum {
    pub form: Form,
    /// Whether parameters went that one of the two had.
    pub cancelled: bool,
}

impl Forms {
    /// A node is a parameter.
    pub fn set_parameter(&mut self, node: u32) {
        self.set(Signed::plus(node), vec![(node, 1.0)]);
    }

    /// A node is a multiple of another, whether that has a form or not.
    pub fn set_multiple(&mut self, node: u32, factor: f64, of: u32) {
        let Some(form) = self.forms.get(&of) else {
            return;
        };
        let form = form.iter().map(|&(x, f)| (x, factor * f)).collect();
        self.set(Signed::plus(node), form);
    }

    /// A node has this form.
    pub fn set(&mut self, node: Signed, form: Form) {
        let sign = if node.negative { -1.0 } else { 1.0 };
        if let Some(&(_, first)) = form.first() {
            let entry = self.nodes.entry(normal(&form));
            entry.or_insert((sign * first, node.node));
        }
        let form = form.into_iter().map(|(x, f)| (x, sign * f));
        self.forms
            .entry(node.node)
            .or_insert_with(|| form.collect());
    }

    /// The node whose multiple a form is, and the factor.
    pub fn known(&self, form: &Form) -> Option<(f64, u32)> {
        let &(_, first) = form.first()?;
        let (theirs, node) = self.nodes.get(&normal(form))?;
        Some((first / theirs, *node))
    }

    /// x + y, if both have forms.
    pub fn sum(&self, x: Signed, y: Signed) -> Option<Sum> {
        let signed = |x: Signed| {
            let sign = if x.negative { -1.0 } else { 1.0 };
            let form = self.forms.get(&x.node)?;
            Some(form.iter().map(move |&(x, f)| (x, sign * f)))
        };
        let (mut left, mut right) = (signed(x)?.peekable(), signed(y)?.peekable());
        let mut sum = Sum {
            form: Vec::new(),
            cancelled: false,
        };
        loop {
            let order = match (left.peek(), right.peek()) {
                (Some(a), Some(b)) => a.0.cmp(&b.0),
                (Some(_), None) => std::cmp::Ordering::Less,
                (None, Some(_)) => std::cmp::Ordering::Greater,
                (None, None) => return Some(sum),
            };
            match order {
                std::cmp::Ordering::Less => sum.form.extend(left.next()),
                std::cmp::Ordering::Greater => sum.form.extend(right.next()),
                std::cmp::Ordering::Equal => {
                    let (Some((node, a)), Some((_, b))) = (left.next(), right.next()) else {
                        continue;
                    };
                    match (a + b).abs() <= ROUNDING * a.abs().max(b.abs()) {
                        true => sum.cancelled = true,
                        false => sum.form.push((node, a + b)),
                    }
                }
            }
        }
    }
}

/// The same for all multiples of a form, but for roundings.
fn normal(form: &Form) -> Vec<(u32, u64)> {
    let first = form.first().map_or(1.0, |x| x.1);
    let entry = |&(node, factor): &(u32, f64)| (node, (factor / first).to_bits());
    form.iter().map(entry).collect()
}
