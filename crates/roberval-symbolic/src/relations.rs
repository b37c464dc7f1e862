//! beta in symbols.

use std::collections::HashMap;

use roberval_base::Model;
use roberval_mechanism::{JointKind, Mechanism, MechanismError, ParameterKind, ParameterSpace};
use roberval_regressor::{AngleOrder, NotInField};
use roberval_scalar::{Fp, Modulus, SplitMix64};

use crate::field::{Answer, Oracle, Value};
use crate::interpolation::{CHECKS, Shape, coefficients, interpolate, total_degree};
use crate::lines::{Line, Local};
use crate::naming::{Named, Naming, Symbol, SymbolKind};
use crate::polynomial::{Monomial, Polynomial, Variable, power};
use crate::rules::Origin;
use crate::special::{Special, special};

/// Fields at whose random values all relations are verified.
const FIELDS: usize = 2;

/// An entry of beta: its row and column.
type Place = (usize, usize);

/// What an entry is.
type Entry = (Place, Polynomial);

/// What an entry looks like, and the symbols it depends on.
type Looks = (Option<Shape>, Vec<usize>);

/// How far relations are looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Route {
    /// The closed-form rules, then elimination on what they leave.
    #[default]
    Whole,
    /// The rules alone: they may leave more than the base parameters.
    RulesAlone,
}

/// What removes each column that goes, and which ones elimination removes.
type Origins = (Vec<(usize, Origin)>, Vec<usize>);

/// How relations are found in symbols.
#[derive(Debug, Clone, Default)]
pub struct SymbolicOptions {
    /// How far.
    pub route: Route,
    /// The linear model.
    pub model: Model,
    /// Which constants are symbols.
    pub naming: Naming,
    /// The columns in the order in which they are kept; `None` is their own, the paper's
    /// choice.
    pub order: Option<Vec<usize>>,
    /// Seed of all that is random.
    pub seed: u64,
}

/// Why there are no relations in symbols.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SymbolicError {
    /// The description is no mechanism.
    #[error(transparent)]
    Mechanism(#[from] MechanismError),
    /// A number has no place in a prime field.
    #[error("{0}; give it as a decimal number instead")]
    NotInField(#[from] NotInField),
    /// The robot's loops are not decided exactly.
    #[error(
        "relations in symbols are found for chains, trees and couples, not for loops given by cut joints"
    )]
    Loops,
    /// The found relations do not hold elsewhere.
    #[error(
        "the relation of {entry} fails at fresh values of the symbols: please report this robot"
    )]
    NotVerified {
        /// The entry of beta.
        entry: String,
    },
}

/// An entry of beta that is not zero.
#[derive(Debug, Clone, PartialEq)]
pub enum Coefficient {
    /// A polynomial over a monomial.
    Quotient {
        /// The polynomial.
        numerator: Polynomial,
        /// The monomial: all exponents 0 where the entry is a polynomial.
        denominator: Monomial,
    },
    /// No such form was found; the symbols it depends on.
    Open(Vec<String>),
}

/// How relations were verified.
#[derive(Debug, Clone, PartialEq)]
pub struct Verification {
    /// The primes of the fields in which all of them hold at random values of the symbols.
    pub primes: Vec<u64>,
    /// An upper bound of the probability that one of them is wrong nevertheless.
    pub failure_probability: f64,
}

/// The base parameters of a robot for generic values of its symbols.
#[derive(Debug, Clone)]
pub struct SymbolicRelations {
    /// The robot with its symbols.
    pub mechanism: Mechanism,
    /// Its symbols.
    pub named: Named,
    /// What the polynomials are in.
    pub variables: Vec<Variable>,
    /// The standard parameters.
    pub parameters: ParameterSpace,
    /// Parameters without effect.
    pub no_effect: Vec<usize>,
    /// The kept parameters X1; for [`Route::RulesAlone`] all that the rules leave.
    pub base: Vec<usize>,
    /// The regrouped parameters X2.
    pub regrouped: Vec<usize>,
    /// beta, base x regrouped; `None` is zero.
    pub beta: Vec<Vec<Option<Coefficient>>>,
    /// What removes each parameter that is not kept, in the order of the columns.
    pub origins: Vec<(usize, Origin)>,
    /// How far they were looked for.
    pub route: Route,
    /// What elimination removes of what the rules leave.
    pub left_over: Vec<usize>,
    /// What is special about the given values.
    pub special: Vec<Special>,
    /// How sure the relations are.
    pub verification: Verification,
}

/// The relations of a mechanism in symbols.
///
/// # Errors
/// [`SymbolicError`] if a number has no place in a prime field.
pub fn symbolic_relations(
    mechanism: &Mechanism,
    options: &SymbolicOptions,
) -> Result<SymbolicRelations, SymbolicError> {
    if !mechanism.is_affine() {
        return Err(SymbolicError::Loops);
    }
    let named = Named::new(&mechanism.description, options.naming);
    let columns = mechanism.parameters().len();
    let order = options.order.clone();
    let oracle = Oracle {
        route: options.route,
        named: &named,
        mechanism: Mechanism::new(&named.description)?,
        model: options.model,
        order: order.unwrap_or_else(|| (0..columns).collect()),
        angles: AngleOrder::of(mechanism),
    };
    let mut random = SplitMix64::new(options.seed);
    let modulus = oracle.modulus(&mut random);
    let mut samples = Samples::new(&oracle, &modulus, &mut random)?;
    let beta = samples.beta(&mut random)?;
    let run = samples.first.clone();
    let (origins, left_over) = samples.origins(&mut random)?;
    let special = match options.route {
        Route::Whole => special(&oracle, &modulus, &run, &mut random)?,
        Route::RulesAlone => Vec::new(),
    };
    let mut relations = SymbolicRelations {
        variables: variables(&named),
        parameters: mechanism.parameters(),
        no_effect: run.no_effect,
        base: run.kept,
        regrouped: run.deleted,
        beta,
        origins,
        route: options.route,
        left_over,
        special,
        verification: Verification {
            primes: Vec::new(),
            failure_probability: 1.0,
        },
        mechanism: oracle.mechanism.clone(),
        named: named.clone(),
    };
    relations.verify(&oracle, &mut random)?;
    Ok(relations)
}

fn variables(named: &Named) -> Vec<Variable> {
    let of = |kind: SymbolKind| named.symbols.iter().filter(move |s| s.kind == kind);
    let lengths = of(SymbolKind::Length).map(|s| Variable::Length(s.name.clone()));
    let angles = of(SymbolKind::Angle)
        .flat_map(|s| [Variable::Cos(s.name.clone()), Variable::Sin(s.name.clone())]);
    lengths.chain(angles).collect()
}

/// The engine's answers in one field.
struct Samples<'a, 'm> {
    oracle: &'a Oracle<'a>,
    modulus: &'m Modulus,
    first: Answer,
    first_point: Vec<Value>,
    points: Vec<Vec<Fp<'m>>>,
    runs: Vec<Answer>,
}

impl<'a, 'm> Samples<'a, 'm> {
    fn new(
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
    fn beta(
        &mut self,
        random: &mut SplitMix64,
    ) -> Result<Vec<Vec<Option<Coefficient>>>, NotInField> {
        let rows = self.first.beta.iter();
        let mut beta: Vec<Vec<Option<Coefficient>>> =
            rows.map(|row| vec![None; row.len()]).collect();
        let mut groups: HashMap<Shape, Vec<(usize, usize)>> = HashMap::new();
        for ((i, j), (shape, depends)) in self.shapes(random)? {
            // Those that are found take this one's place.
            let names = depends.iter().map(|&k| &self.oracle.named.symbols[k].name);
            beta[i][j] = Some(Coefficient::Open(names.cloned().collect()));
            if let Some(shape) = shape {
                groups.entry(shape).or_default().push((i, j));
            }
        }
        let count = variables(self.oracle.named).len();
        for (shape, entries) in groups {
            let denominator = shape.below(count);
            let found = self.interpolate(&shape, &entries, &denominator, random)?;
            for ((i, j), numerator) in found {
                let denominator = denominator.clone();
                beta[i][j] = Some(Coefficient::Quotient {
                    numerator,
                    denominator,
                });
            }
        }
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
        let lengths = symbols.iter().filter(|s| s.kind == SymbolKind::Length);
        let lengths = lengths.count();
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
        let (modulus, count) = (self.modulus, variables(self.oracle.named).len());
        let shapes = all.iter_mut();
        let shapes = shapes.filter_map(|(at, (shape, _))| Some((*at, shape.as_mut()?)));
        let mut grown = Vec::new();
        for ((i, j), shape) in shapes {
            let below = total_degree(&shape.below(count), shape.lengths);
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
    fn origins(&self, random: &mut SplitMix64) -> Result<Origins, NotInField> {
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

    /// The entries of one shape that have it.
    fn interpolate(
        &mut self,
        shape: &Shape,
        entries: &[(usize, usize)],
        denominator: &Monomial,
        random: &mut SplitMix64,
    ) -> Result<Vec<Entry>, NotInField> {
        let Some(monomials) = shape.above(denominator) else {
            return Ok(Vec::new());
        };
        let count = monomials.len() + CHECKS;
        self.sample(count, random)?;
        let points = &self.points[..count];
        let values: Vec<Vec<Fp<'m>>> = entries
            .iter()
            .map(|&(i, j)| {
                let value = |(run, point): (&Answer, &Vec<Fp<'m>>)| {
                    let below = power(self.modulus, denominator, point);
                    self.modulus.element(run.beta[i][j]) * below
                };
                self.runs[..count].iter().zip(points).map(value).collect()
            })
            .collect();
        let found = interpolate(self.modulus, &monomials, points, &values);
        let found = entries.iter().copied().zip(found);
        Ok(found.filter_map(|(at, p)| Some((at, p?))).collect())
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

impl SymbolicRelations {
    /// Compares all entries with the engine's at fresh random values in fresh fields.
    fn verify(
        &mut self,
        oracle: &Oracle<'_>,
        random: &mut SplitMix64,
    ) -> Result<(), SymbolicError> {
        let mut failure = 1.0;
        let mut primes = Vec::new();
        while primes.len() < FIELDS {
            let modulus = oracle.modulus(random);
            let point = oracle.point(&modulus, random);
            let run = oracle.ask(&modulus, &point, random.next_u64())?;
            let at = oracle.variables(&modulus, &point);
            let mut entries = 0;
            for (i, row) in self.beta.iter().enumerate() {
                for (j, coefficient) in row.iter().enumerate() {
                    entries += 1;
                    let residue = run.beta.get(i).and_then(|row| row.get(j));
                    let same_sets = run.kept == self.base && run.deleted == self.regrouped;
                    let holds = same_sets
                        && match coefficient {
                            Some(c) => c.holds(&modulus, &at, residue.copied()),
                            None => residue == Some(&0),
                        };
                    if !holds {
                        let labels = self.parameters.labels();
                        let (row, column) = (self.base[i], self.regrouped[j]);
                        let entry = format!("{} in {}", labels[column], labels[row]);
                        return Err(SymbolicError::NotVerified { entry });
                    }
                }
            }
            failure *= (entries as f64 * self.degree(&run) / modulus.p() as f64).min(1.0);
            primes.push(modulus.p());
        }
        self.verification = Verification {
            primes,
            failure_probability: failure,
        };
        Ok(())
    }

    /// A bound of the degree, in all that is random, of the numerator of the difference
    /// between an entry of beta (a quotient of minors of W with b rows, or of the rules'
    /// vectors) and a quotient of
    /// low degree. A position enters an entry of W at most squared, a rotation three times
    /// with degree 2 in the tangent of its half angle.
    fn degree(&self, run: &Answer) -> f64 {
        let angles = self
            .named
            .symbols
            .iter()
            .filter(|s| s.kind == SymbolKind::Angle);
        let turns: usize = angles.map(|s| 6 * s.uses).sum();
        let row = run.degree as f64 + 2.0 * self.named.degree() as f64 + turns as f64;
        let minor = match self.route {
            Route::Whole => self.base.len(),
            Route::RulesAlone => self.origins.len(),
        };
        (minor as f64 + 1.0) * row
    }
}

impl Coefficient {
    /// Whether it has this value.
    fn holds<'m>(&self, modulus: &'m Modulus, at: &[Fp<'m>], residue: Option<u64>) -> bool {
        let (
            Self::Quotient {
                numerator,
                denominator,
            },
            Some(residue),
        ) = (self, residue)
        else {
            return matches!(self, Self::Open(_));
        };
        let below = power(modulus, denominator, at);
        numerator.value(modulus, at) == Some(modulus.element(residue) * below)
    }
}
