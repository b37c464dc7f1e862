//! Conditions that given values of symbols meet.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::Zero;
use roberval_scalar::{Fp, LinearInPi, Modulus};

use super::number;
use crate::field::Value;
use crate::naming::{Named, SymbolKind};

/// Sums of two lengths are looked for among so many at most.
const MOST_SUMMED: usize = 12;

/// A condition on symbols, given by their places.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Condition {
    /// A symbol has its given value.
    Value(usize),
    /// A length is a sum of one or two others, each with its sign.
    Lengths(usize, Vec<(bool, usize)>),
    /// An angle is another one, or minus it, and so many right angles.
    Angles(usize, (bool, usize), u8),
}

/// Makes a point meet conditions. Where they are too many to be met by values that are not
/// given, it meets a part of them.
pub(super) fn impose(conditions: &[Condition], point: &mut [Value], modulus: &Modulus) {
    let values = conditions.iter().filter(|c| c.symbols().len() == 1);
    values.for_each(|c| c.set(point, modulus));
    let mut reached: Vec<bool> = vec![false; point.len()];
    let (given, free): (Vec<usize>, Vec<usize>) =
        (0..point.len()).partition(|&k| point[k] == Value::Given);
    for start in given.into_iter().chain(free) {
        if reached[start] {
            continue;
        }
        let mut from = vec![start];
        reached[start] = true;
        while let Some(k) = from.pop() {
            for tie in conditions.iter().filter_map(|c| c.tie_from(k)) {
                if !std::mem::replace(&mut reached[tie.symbol()], true) {
                    tie.set(point, modulus);
                    from.push(tie.symbol());
                }
            }
        }
    }
    let paired = |k: usize| {
        let mut pairs = conditions.iter().filter(|c| c.symbols().len() == 2);
        pairs.any(|c| c.symbols().contains(&k))
    };
    let sums = conditions.iter().filter(|c| c.symbols().len() > 2);
    let free = sums.filter(|c| !paired(c.symbol()));
    free.for_each(|c| c.set(point, modulus));
}

impl Condition {
    /// Whether it gives a value.
    pub fn is_value(&self) -> bool {
        matches!(self, Self::Value(_))
    }

    /// The symbol that it determines.
    fn symbol(&self) -> usize {
        match self {
            Self::Value(symbol) | Self::Lengths(symbol, _) | Self::Angles(symbol, ..) => *symbol,
        }
    }

    /// The tie of two symbols, read so that it determines the other by this one.
    fn tie_from(&self, k: usize) -> Option<Self> {
        match self {
            Self::Lengths(symbol, sum) => match sum[..] {
                [(_, other)] if other == k => Some(self.clone()),
                [(minus, other)] if *symbol == k => Some(Self::Lengths(other, vec![(minus, k)])),
                _ => None,
            },
            Self::Angles(_, (_, other), _) if *other == k => Some(self.clone()),
            Self::Angles(symbol, (minus, other), quarters) if *symbol == k => {
                // a = b + q is b = a - q; a = q - b is b = q - a.
                let quarters = if *minus {
                    *quarters
                } else {
                    (4 - quarters) % 4
                };
                Some(Self::Angles(*other, (*minus, k), quarters))
            }
            Self::Value(_) | Self::Angles(..) => None,
        }
    }

    fn set(&self, point: &mut [Value], modulus: &Modulus) {
        match self {
            Self::Value(symbol) => point[*symbol] = Value::Given,
            Self::Lengths(symbol, _) | Self::Angles(symbol, ..) => {
                let others = self.symbols();
                let given = others[1..].iter().all(|&k| point[k] == Value::Given);
                match self.tied(point, modulus) {
                    Some(tied) => point[*symbol] = Value::Number(tied.residue()),
                    None if given => point[*symbol] = Value::Given,
                    None => {}
                }
            }
        }
    }

    /// Whether a point meets it.
    pub fn holds(&self, point: &[Value], modulus: &Modulus) -> bool {
        match self {
            Self::Value(symbol) => point[*symbol] == Value::Given,
            Self::Lengths(symbol, _) | Self::Angles(symbol, ..) => {
                let tied = self.tied(point, modulus).map(|x| x.residue());
                let given = self.symbols().iter().all(|&k| point[k] == Value::Given);
                given || (tied.is_some() && tied == number(point, *symbol))
            }
        }
    }

    /// What a tied symbol is, by those that it is tied to; `None` if these are given.
    fn tied<'m>(&self, point: &[Value], modulus: &'m Modulus) -> Option<Fp<'m>> {
        let element = |k: usize| number(point, k).map(|x| modulus.element(x));
        let signed = |minus: bool, x: Fp<'m>| if minus { -x } else { x };
        match self {
            Self::Value(_) => None,
            Self::Lengths(_, sum) => sum
                .iter()
                .try_fold(modulus.integer(0), |total, (minus, k)| {
                    Some(total + signed(*minus, element(*k)?))
                }),
            Self::Angles(_, (minus, k), quarters) => {
                // The tangent of half the angle.
                let (t, one) = (signed(*minus, element(*k)?), modulus.integer(1));
                let quarter = |t: Fp<'m>| Some((one + t) * (one - t).inverse()?);
                (0..*quarters).try_fold(t, |t, _| quarter(t))
            }
        }
    }

    fn symbols(&self) -> Vec<usize> {
        match self {
            Self::Value(symbol) => vec![*symbol],
            Self::Lengths(symbol, sum) => std::iter::once(*symbol)
                .chain(sum.iter().map(|(_, k)| *k))
                .collect(),
            Self::Angles(symbol, (_, other), _) => vec![*symbol, *other],
        }
    }

    /// `D3 = 0`, `L2 = -L1`, `L3 = L1 + L2`, `B = 90 deg - A`.
    pub fn text(&self, named: &Named) -> String {
        let name = |k: usize| named.symbols[k].shown.as_str();
        let sign = |first: bool, minus: bool| match (first, minus) {
            (true, false) => "",
            (true, true) => "-",
            (false, false) => " + ",
            (false, true) => " - ",
        };
        match self {
            Self::Value(k) => format!("{} = {}", name(*k), named.symbols[*k].given),
            Self::Lengths(k, sum) => {
                let terms = sum.iter().enumerate();
                let terms =
                    terms.map(|(at, (minus, k))| sign(at == 0, *minus).to_owned() + name(*k));
                format!("{} = {}", name(*k), terms.collect::<String>())
            }
            Self::Angles(k, (minus, other), quarters) => {
                let right = ["", "90 deg", "180 deg", "-90 deg"][usize::from(*quarters)];
                let other = sign(right.is_empty(), *minus).to_owned() + name(*other);
                format!("{} = {right}{other}", name(*k))
            }
        }
    }
}

/// Exact values of the symbols that conditions give.
pub(super) struct Ties {
    lengths: Vec<(usize, LinearInPi)>,
    angles: Vec<(usize, LinearInPi)>,
}

impl Ties {
    /// Those of these conditions.
    pub fn of(named: &Named, conditions: &[Condition]) -> Self {
        let constants = &named.description.constants;
        let given = |kind: SymbolKind| {
            let symbols = conditions.iter().flat_map(Condition::symbols);
            let symbols = symbols.filter(|&k| named.symbols[k].kind == kind);
            let exact = symbols.filter_map(|k| {
                let value = LinearInPi::of(&named.symbols[k].given.expr, constants)?;
                Some((k, value))
            });
            exact.collect()
        };
        Self {
            lengths: given(SymbolKind::Length),
            angles: given(SymbolKind::Angle),
        }
    }

    /// The ties among them: equal ones, opposite lengths and angles that differ by right ones,
    /// angles of given sum, sums of lengths. Ties of one family can hold together, whatever
    /// the values.
    pub fn families(&self) -> Vec<Vec<Condition>> {
        let (mut equal, mut differing) = self
            .angles(false)
            .into_iter()
            .partition::<Vec<_>, _>(|tie| matches!(tie, Condition::Angles(_, _, 0)));
        equal.extend(self.lengths(false));
        differing.extend(self.lengths(true));
        vec![equal, differing, self.angles(true), self.sums()]
    }

    /// Lengths that are equal, or opposite.
    fn lengths(&self, minus: bool) -> Vec<Condition> {
        let mut ties = Vec::new();
        for (at, (k, x)) in self.lengths.iter().enumerate() {
            let tied = |(_, y): &&(usize, LinearInPi)| is_zero(&combined(x, y, minus));
            let others = self.lengths[..at].iter().filter(tied);
            ties.extend(others.map(|(j, _)| Condition::Lengths(*j, vec![(minus, *k)])));
        }
        ties
    }

    /// Angles whose difference, or sum, is a multiple of 90 degrees.
    fn angles(&self, minus: bool) -> Vec<Condition> {
        let mut ties = Vec::new();
        for (at, (k, x)) in self.angles.iter().enumerate() {
            let tie = |(j, y): &(usize, LinearInPi)| {
                let quarters = quarters(&combined(y, x, minus))?;
                Some(Condition::Angles(*j, (minus, *k), quarters))
            };
            ties.extend(self.angles[..at].iter().filter_map(tie));
        }
        ties
    }

    /// Lengths that are the sum or difference of two others.
    fn sums(&self) -> Vec<Condition> {
        let mut sums = Vec::new();
        if self.lengths.len() > MOST_SUMMED {
            return sums;
        }
        let signs = [(false, false), (false, true), (true, false), (true, true)];
        for (at, (k, z)) in self.lengths.iter().enumerate() {
            for (before, (j, y)) in self.lengths[..at].iter().enumerate() {
                for (i, x) in &self.lengths[..before] {
                    let is_sum =
                        |(a, b): &(bool, bool)| is_zero(&combined(&combined(x, y, *a), z, *b));
                    let fitting = signs.iter().filter(|s| is_sum(s));
                    sums.extend(
                        fitting.map(|(a, b)| Condition::Lengths(*i, vec![(*a, *j), (*b, *k)])),
                    );
                }
            }
        }
        sums
    }
}

/// `x - y`; with `minus`, `x + y`: what is zero where x is y, or minus y.
fn combined(x: &LinearInPi, y: &LinearInPi, minus: bool) -> LinearInPi {
    let of = |a: &BigRational, b: &BigRational| if minus { a + b } else { a - b };
    LinearInPi {
        rational: of(&x.rational, &y.rational),
        half_turns: of(&x.half_turns, &y.half_turns),
    }
}

fn is_zero(x: &LinearInPi) -> bool {
    x.rational.is_zero() && x.half_turns.is_zero()
}

/// How many right angles an angle is, 0 to 3.
fn quarters(angle: &LinearInPi) -> Option<u8> {
    let quarters = &angle.half_turns * BigInt::from(2);
    if !angle.rational.is_zero() || !quarters.is_integer() {
        return None;
    }
    let turn: BigInt = ((quarters.to_integer() % 4) + 4) % 4;
    u8::try_from(turn).ok()
}
