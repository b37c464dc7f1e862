//! What is special about the given values of symbols.
//!
//! The rank at the given values may be lower than at generic ones. What makes it lower is a
//! set of conditions that the given values meet: a symbol has its value (`D3 = 0`), two are
//! equal or opposite, two angles differ by a right one, a length is the sum of two others.
//! Conditions are dropped one after the other as long as the rest still lowers the rank by
//! more than the causes that are known already; what is left is a cause of its own.

mod condition;

use std::collections::BTreeSet;

use roberval_regressor::NotInField;
use roberval_scalar::{Modulus, SplitMix64};

use crate::field::{Answer, Oracle, Value};
use condition::{Condition, Ties, impose};

/// More causes than these are not looked for: their number is part of the answer.
const MOST_CAUSES: usize = 24;

/// Conditions that the given values meet and that lower the rank below the generic one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Special {
    /// The conditions as written, `D3 = 0` or `L1 = L2`: all of them are needed.
    pub values: Vec<String>,
    /// How many base parameters fewer there are; beyond those that other causes explain
    /// which hold wherever this one does.
    pub fewer: usize,
    /// How many of those have no effect any more, the others regrouping.
    pub without_effect: usize,
    /// Those that are base parameters otherwise.
    pub gone: Vec<usize>,
    /// Those that are base parameters only here, in place of others.
    pub come: Vec<usize>,
    /// Whether a part of the conditions lowers the rank by itself, which is told there.
    pub beyond: bool,
}

/// A cause and what is gone by it and its parts.
type Cause = (Vec<Condition>, Special);

/// The causes by which the given values lower the rank, each as small as can be.
pub(crate) fn special(
    oracle: &Oracle<'_>,
    modulus: &Modulus,
    generic: &Answer,
    random: &mut SplitMix64,
) -> Result<Vec<Special>, NotInField> {
    let mut search = Search {
        oracle,
        modulus,
        generic,
        random,
        causes: Vec::new(),
    };
    search.all()?;
    Ok(search.causes.into_iter().map(|(_, cause)| cause).collect())
}

struct Search<'a> {
    oracle: &'a Oracle<'a>,
    modulus: &'a Modulus,
    generic: &'a Answer,
    random: &'a mut SplitMix64,
    causes: Vec<Cause>,
}

impl Search<'_> {
    fn all(&mut self) -> Result<(), NotInField> {
        let count = self.oracle.named.symbols.len();
        let all: Vec<Condition> = (0..count).map(Condition::Value).collect();
        if self.effect(&all)?.is_none() {
            return Ok(());
        }
        for one in &all {
            self.find(vec![one.clone()])?;
        }
        while self.causes.len() < MOST_CAUSES && self.find(all.clone())? {}
        Ok(())
    }

    /// Finds a cause that these conditions hold, if there is a new one.
    fn find(&mut self, conditions: Vec<Condition>) -> Result<bool, NotInField> {
        if self.effect(&conditions)?.is_none() {
            return Ok(false);
        }
        let most = conditions.len() / 2;
        let mut least = self.shrunk(conditions, most)?;
        if least.len() > 1 {
            // Values hold ties among them, which may be enough.
            for ties in Ties::of(self.oracle.named, &least).families() {
                let tied = [least.clone(), ties].concat();
                let tied = self.shrunk(tied, 1)?;
                let values = |all: &[Condition]| all.iter().filter(|c| c.is_value()).count();
                if values(&tied) < values(&least) {
                    least = tied;
                }
            }
        }
        let cause = self.effect(&least)?;
        self.causes.extend(cause.map(|cause| (least, cause)));
        Ok(true)
    }

    /// Leaves out conditions that are not needed, the first ones first: so many together, then
    /// half as many, at last one by one.
    fn shrunk(
        &mut self,
        mut conditions: Vec<Condition>,
        most: usize,
    ) -> Result<Vec<Condition>, NotInField> {
        let mut size = most.max(1);
        loop {
            let mut at = 0;
            while at < conditions.len() && conditions.len() > 1 {
                let mut fewer = conditions.clone();
                fewer.drain(at..(at + size).min(conditions.len()));
                match !fewer.is_empty() && self.effect(&fewer)?.is_some() {
                    true => conditions = fewer,
                    false => at += size,
                }
            }
            if size == 1 {
                return Ok(conditions);
            }
            size /= 2;
        }
    }

    /// What these conditions do, if it is more than the known causes that they hold explain.
    fn effect(&mut self, conditions: &[Condition]) -> Result<Option<Special>, NotInField> {
        let named = self.oracle.named;
        let mut point = self.oracle.point(self.modulus, self.random);
        impose(conditions, &mut point, self.modulus);
        let seed = self.random.next_u64();
        let run = self.oracle.ask(self.modulus, &point, seed)?;
        let holds =
            |(conditions, _): &&Cause| conditions.iter().all(|c| c.holds(&point, self.modulus));
        let known: Vec<&Cause> = self.causes.iter().filter(holds).collect();
        let explained: BTreeSet<usize> = known
            .iter()
            .flat_map(|(_, cause)| cause.gone.iter().copied())
            .collect();
        let fewer = self.generic.kept.len().saturating_sub(run.kept.len());
        if fewer <= explained.len() {
            return Ok(None);
        }
        let gone = self.generic.kept.iter().filter(|c| !run.kept.contains(c));
        let gone: Vec<usize> = gone.filter(|c| !explained.contains(c)).copied().collect();
        let come = run.kept.iter().filter(|c| !self.generic.kept.contains(c));
        Ok(Some(Special {
            values: conditions.iter().map(|c| c.text(named)).collect(),
            fewer: fewer - explained.len(),
            without_effect: gone.iter().filter(|c| run.no_effect.contains(c)).count(),
            gone,
            come: come.copied().collect(),
            beyond: !known.is_empty(),
        }))
    }
}

/// The value of a symbol at a point: `None` where it is given.
fn number(point: &[Value], symbol: usize) -> Option<u64> {
    match point[symbol] {
        Value::Number(x) => Some(x),
        Value::Given => None,
    }
}
