//! The engine's answers at many values of the symbols, and what they say of beta.

use std::collections::BTreeMap;

use roberval_mechanism::{JointKind, ParameterKind};
use roberval_regressor::NotInField;
use roberval_scalar::{Fp, Modulus, SplitMix64};

use crate::field::{Answer, Oracle, Value};
use crate::interpolation::{CHECKS, Shape, coefficients, interpolate, total_degree};
use crate::lines::{Line, Local};
use crate::naming::{Symbol, SymbolKind};
use crate::polynomial::{Monomial, Polynomial, power};
use crate::relations::{Coefficient, Open, Route};
use crate::rules::Origin;
use crate::sparse::sparse;

/// An entry of beta: its row and column.
pub(crate) type Place = (usize, usize);

/// What an entry looks like, and the symbols it depends on.
type Looks = (Option<Shape>, Vec<usize>);

/// What removes each column that goes, and which ones elimination removes.
type Origins = (Vec<(usize, Origin)>, Vec<usize>);

/// A formula, or why there is none.
pub(crate) type Found = Result<Polynomial, Open>;

/// The engine's answers in one field.
pub(crate) struct Samples<'a, 'm> {
    oracle: &'a Oracle<'a>,
    modulus: &'m Modulus,
    pub first: Answer,
    first_point: Vec<Value>,
    points: Vec<Vec<Fp<'m>>>,
    runs: Vec<Answer>,
}

impl<'a, 'm> Samples<'a, 'm> {
    pub fn new(
        oracle: &'a Oracle<'a>,
        modulus: &'m Modulus,
        random: &mut SplitMix64,
    ) -> Result<Self, NotInField> {
        let first_point = oracle.point(modulus, random);
        Ok(Self {
            first: oracle.ask(modulus, &first_point, random.next_u64())?,
            first_point,
            oracle,
            modulus,
            points: Vec::new(),
            runs: Vec::new(),
        })
    }

    /// All entries of beta.
    pub fn beta(
        &mut self,
        random: &mut SplitMix64,
    ) -> Result<Vec<Vec<Option<Coefficient>>>, NotInField> {
        let rows = self.first.beta.iter();
        let mut beta: Vec<Vec<Option<Coefficient>>> =
            rows.map(|row| vec![None; row.len()]).collect();
        let mut groups: BTreeMap<Shape, Vec<Place>> = BTreeMap::new();
        for ((i, j), (shape, depends)) in self.shapes(random)? {
            // Those that are found take this one's place.
            let names = depends.iter().map(|&k| &self.oracle.named.symbols[k].shown);
            beta[i][j] = Some(Coefficient::Open {
                symbols: names.cloned().collect(),
                why: Open::NotPolynomial,
            });
            if let Some(shape) = shape {
                groups.entry(shape).or_default().push((i, j));
            }
        }
        let mut long = Vec::new();
        for (shape, places) in groups {
            match self.dense(&shape, &places, random)? {
                Some(found) => put(&mut beta, places.into_iter().map(|p| (p, &shape)), found),
                None => long.extend(places.into_iter().map(|place| (place, shape.clone()))),
            }
        }
        let held = (&self.first_point[..], &self.first);
        let found = sparse((self.oracle, self.modulus), held, &long, random)?;
        put(
            &mut beta,
            long.iter().map(|(place, shape)| (*place, shape)),
            found,
        );
        Ok(beta)
    }

    /// What each entry that is not zero looks like, if it is a polynomial over a monomial,
    /// and the symbols that it depends on.
    fn shapes(&self, random: &mut SplitMix64) -> Result<Vec<(Place, Looks)>, NotInField> {
        let entries: Vec<Place> = self
            .first
            .beta
            .iter()
            .enumerate()
            .flat_map(|(i, row)| row.iter().enumerate().map(move |(j, x)| (i, j, *x)))
            .filter_map(|(i, j, x)| (x != 0).then_some((i, j)))
            .collect();
        let homogeneous = self.homogeneous(&entries, random)?;
        let symbols = &self.oracle.named.symbols;
        let mut along: Vec<Vec<Option<Local>>> = Vec::new();
        for symbol in 0..symbols.len() {
            let held = (&self.first_point[..], &self.first);
            let mut line = Line::new((self.oracle, self.modulus), held, symbol);
            along.push(line.locals(&entries, random)?);
        }
        let named = self.oracle.named;
        let (lengths, variables) = (named.lengths(), named.variables());
        let looks = |(k, &(i, j)): (usize, &Place)| {
            let unit = homogeneous[k].then(|| self.degree(i, j));
            let locals = along.iter().map(|line| line[k].clone());
            let matters = |l: &Option<Local>| !l.as_ref().is_some_and(Local::is_constant);
            let (depends, locals): (Vec<usize>, Vec<Option<Local>>) =
                locals.enumerate().filter(|(_, l)| matters(l)).unzip();
            let shape = locals.into_iter().collect::<Option<Vec<_>>>();
            let shape = shape.map(|locals| Shape {
                degrees: unit.into_iter().collect(),
                locals,
                lengths,
                variables,
            });
            ((i, j), (shape, depends))
        };
        let mut all: Vec<(Place, Looks)> = entries.iter().enumerate().map(looks).collect();
        self.find_degrees(&mut all, random)?;
        Ok(all)
    }

    /// For each entry, whether it grows with all lengths together as its unit says.
    fn homogeneous(
        &self,
        entries: &[Place],
        random: &mut SplitMix64,
    ) -> Result<Vec<bool>, NotInField> {
        let modulus = self.modulus;
        let factor = modulus.random(random);
        let Some((factor, answer)) = self.grown(factor, random)? else {
            return Ok(vec![false; entries.len()]);
        };
        let as_unit = |&(i, j): &Place| {
            let [before, after] = [&self.first, &answer].map(|a| modulus.element(a.beta[i][j]));
            let power = factor.pow(self.degree(i, j).unsigned_abs().into());
            match self.degree(i, j) >= 0 {
                true => after == before * power,
                false => after * power == before,
            }
        };
        Ok(entries.iter().map(as_unit).collect())
    }

    /// The answer with all lengths of the first point times a factor, if it keeps the same
    /// columns.
    fn grown(
        &self,
        factor: Fp<'m>,
        random: &mut SplitMix64,
    ) -> Result<Option<(Fp<'m>, Answer)>, NotInField> {
        let (modulus, symbols) = (self.modulus, &self.oracle.named.symbols);
        let scaled = |(value, symbol): (&Value, &Symbol)| match (value, symbol.kind) {
            (Value::Number(x), SymbolKind::Length) => {
                Value::Number((modulus.element(*x) * factor).residue())
            }
            _ => *value,
        };
        let point: Vec<Value> = self.first_point.iter().zip(symbols).map(scaled).collect();
        let answer = self.oracle.ask(modulus, &point, random.next_u64())?;
        let same = answer.kept == self.first.kept && answer.deleted == self.first.deleted;
        Ok(same.then_some((factor, answer)))
    }

    /// Completes shapes by the degrees of the terms above: one where the entry grows as its
    /// unit says (that unit is what the shape has so far); else those along a line on which
    /// all lengths grow together. There are others where lengths are products of constants.
    fn find_degrees(
        &self,
        all: &mut [(Place, Looks)],
        random: &mut SplitMix64,
    ) -> Result<(), NotInField> {
        let modulus = self.modulus;
        let shapes = all.iter_mut();
        let shapes = shapes.filter_map(|(at, (shape, _))| Some((*at, shape.as_mut()?)));
        let mut grown = Vec::new();
        for ((i, j), shape) in shapes {
            let below = total_degree(&shape.below(), shape.lengths);
            if let [unit] = &mut shape.degrees[..] {
                *unit += below;
                continue;
            }
            let above = |m: &Monomial| total_degree(m, shape.lengths);
            let highest = |l: &Local| l.above.iter().map(above).max().unwrap_or(0);
            let highest: i16 = shape.locals.iter().map(highest).sum();
            let powers: Vec<Monomial> = (0..=highest as u8).map(|e| vec![e]).collect();
            while grown.len() < powers.len() + CHECKS {
                grown.extend(self.grown(modulus.random(random), random)?);
            }
            let grown = &grown[..powers.len() + CHECKS];
            let points: Vec<Vec<Fp<'m>>> = grown.iter().map(|(factor, _)| vec![*factor]).collect();
            let value = |(factor, answer): &(Fp<'m>, Answer)| {
                modulus.element(answer.beta[i][j]) * factor.pow(below as u64)
            };
            let values = vec![grown.iter().map(value).collect()];
            let fit = coefficients(modulus, &powers, &points, &values).remove(0);
            let terms = (0..).zip(fit.unwrap_or_default());
            shape.degrees = terms
                .filter(|(_, c)| !c.is_zero())
                .map(|(e, _)| e)
                .collect();
        }
        Ok(())
    }

    /// What removes each parameter that is not kept; and, of what the rules leave, what the
    /// elimination of these columns removes.
    pub fn origins(&self, random: &mut SplitMix64) -> Result<Origins, NotInField> {
        let (modulus, point) = (self.modulus, &self.first_point);
        let rules = self.oracle.rules(modulus, point, random.next_u64())?;
        let left = rules.answer.kept.iter().copied();
        let order: Vec<usize> = left.chain(rules.removed.iter().map(|(c, _)| *c)).collect();
        let seed = random.next_u64();
        let base = self.oracle.eliminate(&order, modulus, point, seed)?.kept;
        let mut left_over = rules.answer.kept;
        left_over.retain(|c| !base.contains(c));
        let mut origins = rules.removed;
        if self.oracle.route == Route::Whole {
            origins.extend(left_over.iter().map(|&c| (c, Origin::Elimination)));
        }
        origins.sort_unstable();
        Ok((origins, left_over))
    }

    /// The power of length in an entry's unit.
    fn degree(&self, i: usize, j: usize) -> i16 {
        self.dimension(self.first.kept[i]) - self.dimension(self.first.deleted[j])
    }

    /// The power of length in a parameter's unit.
    fn dimension(&self, column: usize) -> i16 {
        let id = self.oracle.mechanism.parameters().ids()[column];
        let prismatic = self.oracle.mechanism.links[id.link].joint == JointKind::Prismatic;
        match id.kind {
            ParameterKind::M => 0,
            ParameterKind::MX | ParameterKind::MY | ParameterKind::MZ => 1,
            ParameterKind::Ia if prismatic => 0,
            _ => 2,
        }
    }

    /// The formulas of entries of one shape, from as many samples as it may have terms; `None`
    /// if these are too many.
    fn dense(
        &mut self,
        shape: &Shape,
        entries: &[Place],
        random: &mut SplitMix64,
    ) -> Result<Option<Vec<Found>>, NotInField> {
        let denominator = shape.below();
        let Some(monomials) = shape.above(&denominator) else {
            return Ok(None);
        };
        let count = monomials.len() + CHECKS;
        self.sample(count, random)?;
        let points = &self.points[..count];
        let values = entries.iter().map(|&(i, j)| {
            let value = |(run, point): (&Answer, &Vec<Fp<'m>>)| {
                let below = power(self.modulus, &denominator, point);
                self.modulus.element(run.beta[i][j]) * below
            };
            self.runs[..count].iter().zip(points).map(value).collect()
        });
        let values: Vec<Vec<Fp<'m>>> = values.collect();
        Ok(Some(interpolate(self.modulus, &monomials, points, &values)))
    }

    /// Makes sure that there are so many samples.
    fn sample(&mut self, count: usize, random: &mut SplitMix64) -> Result<(), NotInField> {
        while self.points.len() < count {
            let point = self.oracle.point(self.modulus, random);
            let run = self.oracle.ask(self.modulus, &point, random.next_u64())?;
            if run.kept == self.first.kept && run.deleted == self.first.deleted {
                self.points
                    .push(self.oracle.variables(self.modulus, &point));
                self.runs.push(run);
            }
        }
        Ok(())
    }
}

/// Puts what was found in its place: formulas over what their shape has below, or why there
/// is none.
fn put<'s>(
    beta: &mut [Vec<Option<Coefficient>>],
    entries: impl Iterator<Item = (Place, &'s Shape)>,
    found: Vec<Found>,
) {
    for (((i, j), shape), found) in entries.zip(found) {
        match (found, &mut beta[i][j]) {
            (Ok(numerator), entry) => {
                *entry = Some(Coefficient::Quotient {
                    denominator: shape.below(),
                    numerator,
                });
            }
            (Err(reason), Some(Coefficient::Open { why, .. })) => *why = reason,
            (Err(_), _) => {}
        }
    }
}
