//! The exact engine at values of the symbols.

use std::sync::Arc;

use roberval_base::{Model, Run, eliminate};
use roberval_mechanism::Mechanism;
use roberval_regressor::{AngleOrder, ExactModel, NotInField, Turn};
use roberval_scalar::{Fp, Modulus, Quantity, SplitMix64, random_prime};

use crate::naming::{Named, SymbolKind};
use crate::relations::Route;
use crate::rules::{ByRules, by_rules};

/// Primes tried before a square root of the description counts as unobtainable: each prime
/// has a given one with probability 1/2.
const MOST_PRIMES: usize = 256;

/// What each symbol is: a random number of the field, or as given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Value {
    /// This length, or the angle whose half has this tangent.
    Number(u64),
    Given,
}

/// The answer at values of the symbols, in a prime field.
#[derive(Debug, Clone)]
pub(crate) struct Answer {
    pub no_effect: Vec<usize>,
    pub kept: Vec<usize>,
    pub deleted: Vec<usize>,
    /// Residues.
    pub beta: Vec<Vec<u64>>,
    /// Degree in all that is random of what a minor gives beta by.
    pub degree: u64,
}

impl From<Run> for Answer {
    fn from(run: Run) -> Self {
        Self {
            no_effect: run.no_effect,
            kept: run.kept,
            deleted: run.deleted,
            beta: run.beta,
            degree: run.degree,
        }
    }
}

/// A robot with symbols, ready to be asked.
pub(crate) struct Oracle<'a> {
    pub route: Route,
    pub named: &'a Named,
    pub mechanism: Mechanism,
    pub model: Model,
    /// Columns in the order in which they are kept.
    pub order: Vec<usize>,
    /// What the angles that are no symbols need.
    pub angles: AngleOrder,
}

impl Oracle<'_> {
    /// A random prime field that has this robot's numbers, those given for symbols included.
    pub fn modulus(&self, random: &mut SplitMix64) -> Result<Modulus, NotInField> {
        let mut last = NotInField::Root;
        for _ in 0..MOST_PRIMES {
            let modulus = Modulus::new(random_prime(self.angles.get(), random));
            let given = vec![Value::Given; self.named.symbols.len()];
            let mut has = |point: &[Value]| {
                let seed = random.next_u64();
                self.at(&modulus, point, seed, |_, _, _| ())
            };
            let others = vec![Value::Number(2); given.len()];
            match has(&given).and_then(|()| has(&others)) {
                Err(error @ (NotInField::Root | NotInField::Inverse)) => last = error,
                other => return other.map(|()| modulus),
            }
        }
        Err(last)
    }

    /// Random values of all symbols.
    pub fn point(&self, modulus: &Modulus, random: &mut SplitMix64) -> Vec<Value> {
        let symbols = self.named.symbols.iter();
        symbols
            .map(|_| Value::Number(modulus.random(random).residue()))
            .collect()
    }

    /// What the route says at these values.
    pub fn ask(&self, modulus: &Modulus, at: &[Value], seed: u64) -> Result<Answer, NotInField> {
        match self.route {
            Route::RulesAlone => Ok(self.rules(modulus, at, seed)?.answer),
            Route::Whole => self.eliminate(&self.order, modulus, at, seed),
        }
    }

    /// Elimination at these values, columns kept in this order.
    pub fn eliminate(
        &self,
        order: &[usize],
        modulus: &Modulus,
        at: &[Value],
        seed: u64,
    ) -> Result<Answer, NotInField> {
        self.at(modulus, at, seed, |mechanism, exact, random| {
            eliminate(mechanism, self.model, order, exact, seed, random).into()
        })
    }

    /// What the rules say at these values.
    pub fn rules(&self, modulus: &Modulus, at: &[Value], seed: u64) -> Result<ByRules, NotInField> {
        self.at(modulus, at, seed, |mechanism, exact, random| {
            by_rules(mechanism, exact, &self.order, random)
        })
    }

    /// What `f` makes of the robot with these values of its symbols.
    fn at<T>(
        &self,
        modulus: &Modulus,
        at: &[Value],
        seed: u64,
        f: impl FnOnce(&Mechanism, &ExactModel<'_>, &mut SplitMix64) -> T,
    ) -> Result<T, NotInField> {
        let mut description = self.named.description.clone();
        let mut turns = Vec::new();
        for (symbol, value) in self.named.symbols.iter().zip(at) {
            let Value::Number(value) = *value else {
                continue;
            };
            let constant = description
                .constants
                .iter_mut()
                .find(|(name, _)| *name == symbol.name)
                .map(|(_, quantity)| quantity)
                .expect("symbols are constants");
            match symbol.kind {
                SymbolKind::Length => *constant = integer(value),
                SymbolKind::Angle => {
                    *constant = Quantity::zero();
                    let rotation = circle_point(modulus, value).ok_or(NotInField::Inverse)?;
                    let name = symbol.name.clone();
                    turns.push(Turn { name, rotation });
                }
            }
        }
        let mechanism = Mechanism {
            description: Arc::new(description),
            ..self.mechanism.clone()
        };
        let mut random = SplitMix64::new(seed);
        let model_seed = random.next_u64();
        // What the description's angles need, symbols being zero.
        let exact =
            ExactModel::with_turns(&mechanism, modulus, self.angles, 1, model_seed, &turns)?;
        Ok(f(&mechanism, &exact, &mut random))
    }

    /// The values of the polynomials' variables at a point: lengths, then cosine and sine
    /// of each angle.
    pub fn variables<'m>(&self, modulus: &'m Modulus, at: &[Value]) -> Vec<Fp<'m>> {
        let (mut lengths, mut angles) = (Vec::new(), Vec::new());
        for (symbol, value) in self.named.symbols.iter().zip(at) {
            let Value::Number(value) = *value else {
                unreachable!("only random values are interpolated");
            };
            match symbol.kind {
                SymbolKind::Length => lengths.push(modulus.element(value)),
                SymbolKind::Angle => {
                    let (cos, sin) = circle_point(modulus, value).expect("asked before");
                    angles.extend([cos, sin]);
                }
            }
        }
        lengths.extend(angles);
        lengths
    }
}

fn integer(value: u64) -> Quantity {
    Quantity::parse_decimal(&value.to_string()).expect("a whole number")
}

/// The point of the circle with tangent t of half its angle.
fn circle_point(modulus: &Modulus, t: u64) -> Option<(Fp<'_>, Fp<'_>)> {
    let (t, one) = (modulus.element(t), modulus.integer(1));
    let inverse = (one + t * t).inverse()?;
    Some(((one - t * t) * inverse, (t + t) * inverse))
}
