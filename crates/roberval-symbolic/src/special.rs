//! What is special about the given values of symbols.

use roberval_regressor::NotInField;
use roberval_scalar::{Modulus, SplitMix64};

use crate::field::{Answer, Oracle, Value};

/// Values of symbols at which the rank is lower than at generic ones.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Special {
    /// The symbols and their values as given, `D3 = 0`.
    pub values: Vec<String>,
    /// How many base parameters fewer there are.
    pub fewer: usize,
    /// How many of those have no effect any more, the others regrouping.
    pub without_effect: usize,
    /// Those that are base parameters otherwise.
    pub gone: Vec<usize>,
}

/// The symbols whose given values lower the rank, one by one; all of them together where
/// that lowers it further than each does.
pub(crate) fn special(
    oracle: &Oracle<'_>,
    modulus: &Modulus,
    generic: &Answer,
    random: &mut SplitMix64,
) -> Result<Vec<Special>, NotInField> {
    let symbols = &oracle.named.symbols;
    let mut at = |given: &dyn Fn(usize) -> bool| {
        let mut point = oracle.point(modulus, random);
        let mut values = Vec::new();
        for (k, symbol) in symbols.iter().enumerate().filter(|(k, _)| given(*k)) {
            point[k] = Value::Given;
            values.push(format!("{} = {}", symbol.name, symbol.given));
        }
        let run = oracle.ask(modulus, &point, random.next_u64())?;
        let gone = generic.kept.iter().filter(|c| !run.kept.contains(c));
        Ok(Special {
            values,
            gone: gone.copied().collect(),
            fewer: generic.kept.len().saturating_sub(run.kept.len()),
            without_effect: run.no_effect.len().saturating_sub(generic.no_effect.len()),
        })
    };
    let together = at(&|_| true)?;
    if together.fewer == 0 {
        return Ok(Vec::new());
    }
    let mut all = Vec::new();
    for k in 0..symbols.len() {
        let alone = at(&|other| other == k)?;
        if alone.fewer > 0 {
            all.push(alone);
        }
    }
    let explained = all.iter().any(|s: &Special| s.fewer == together.fewer);
    if !explained {
        all.push(together);
    }
    Ok(all)
}
