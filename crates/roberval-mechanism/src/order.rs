//! Links in an order in which every antecedent comes first.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// The links, antecedents first, otherwise in file order. The antecedents must form a
/// tree ([`crate::RobotDescription::antecedents`]).
pub(crate) fn antecedents_first(antecedents: &[Option<usize>]) -> Vec<usize> {
    let mut successors = vec![Vec::new(); antecedents.len()];
    let mut ready = BinaryHeap::new();
    for (link, antecedent) in antecedents.iter().enumerate() {
        match antecedent {
            Some(a) => successors[*a].push(link),
            None => ready.push(Reverse(link)),
        }
    }
    let mut order = Vec::with_capacity(antecedents.len());
    while let Some(Reverse(link)) = ready.pop() {
        order.push(link);
        ready.extend(successors[link].iter().map(|&s| Reverse(s)));
    }
    order
}
