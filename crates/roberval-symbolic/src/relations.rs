//! beta in symbols.

use std::collections::HashMap;

use roberval_base::{Model, Run};
use roberval_mechanism::{JointKind, Mechanism, MechanismError, ParameterKind, ParameterSpace};
use roberval_regressor::{AngleOrder, NotInField};
use roberval_scalar::{Fp, Modulus, SplitMix64};

use crate::field::{Oracle, Value};
use crate::interpolation::{Shape, interpolate};
use crate::naming::{Named, Naming, SymbolKind};
use crate::polynomial::{Monomial, Polynomial, Variable, power};
use crate::rules::Origin;
use crate::special::{Special, special};

/// Points beyond the unknown coefficients that check each interpolation.
const CHECKS: usize = 2;

/// Fields at whose random values all relations are verified.
const FIELDS: usize = 2;

/// An angle that stands in many places is taken to enter with this degree at most.
const HIGHEST_ANGLE_DEGREE: usize = 6;

/// An entry of beta: its row and column, and what it is.
type Entry = ((usize, usize), Polynomial);

/// How relations are found in symbols.
#[derive(Debug, Clone, Default)]
pub struct SymbolicOptions {
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
    /// The kept parameters X1.
    pub base: Vec<usize>,
    /// The regrouped parameters X2.
    pub regrouped: Vec<usize>,
    /// beta, base x regrouped; `None` is zero.
    pub beta: Vec<Vec<Option<Coefficient>>>,
    /// What removes each parameter that is not kept, in the order of the columns.
    pub origins: Vec<(usize, Origin)>,
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
    let origins = samples.origins(&mut random)?;
    let special = special(&oracle, &modulus, &run, &mut random)?;
    let mut relations = SymbolicRelations {
        variables: variables(&named),
        parameters: mechanism.parameters(),
        no_effect: run.no_effect,
        base: run.kept,
        regrouped: run.deleted,
        beta,
        origins,
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
    first: Run,
    first_point: Vec<Value>,
    points: Vec<Vec<Fp<'m>>>,
    runs: Vec<Run>,
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
        let depends = self.dependences(random)?;
        let mut beta: Vec<Vec<Option<Coefficient>>> = Vec::new();
        let mut open: Vec<(usize, usize)> = Vec::new();
        for (i, row) in self.first.beta.iter().enumerate() {
            beta.push(vec![None; row.len()]);
            let entries = row.iter().enumerate().filter(|(_, x)| **x != 0);
            open.extend(entries.map(|(j, _)| (i, j)));
        }
        for denominator in self.denominators() {
            let mut groups: HashMap<Shape, Vec<(usize, usize)>> = HashMap::new();
            for &(i, j) in &open {
                if let Some(shape) = self.shape(i, j, &depends[&(i, j)], &denominator) {
                    groups.entry(shape).or_default().push((i, j));
                }
            }
            for (shape, entries) in groups {
                let found = self.interpolate(&shape, &entries, &denominator, random)?;
                for ((i, j), numerator) in found {
                    let denominator = denominator.clone();
                    beta[i][j] = Some(Coefficient::Quotient {
                        numerator,
                        denominator,
                    });
                }
            }
            open.retain(|&(i, j)| beta[i][j].is_none());
            if open.is_empty() {
                break;
            }
        }
        for (i, j) in open {
            let symbols = &self.oracle.named.symbols;
            let names = depends[&(i, j)].iter().map(|&k| symbols[k].name.clone());
            beta[i][j] = Some(Coefficient::Open(names.collect()));
        }
        Ok(beta)
    }

    /// What removes each parameter that is not kept.
    fn origins(&self, random: &mut SplitMix64) -> Result<Vec<(usize, Origin)>, NotInField> {
        let rules = self
            .oracle
            .rules(self.modulus, &self.first_point, random.next_u64())?;
        let gone = self.first.no_effect.iter().chain(&self.first.deleted);
        let origin = |&column: &usize| {
            let rule = rules.iter().find(|(c, _)| *c == column);
            (
                column,
                rule.map_or(Origin::Elimination, |(_, origin)| *origin),
            )
        };
        let mut origins: Vec<_> = gone.map(origin).collect();
        origins.sort_unstable();
        Ok(origins)
    }

    /// The symbols that each entry of beta depends on, seen by changing one at a time.
    fn dependences(
        &self,
        random: &mut SplitMix64,
    ) -> Result<HashMap<(usize, usize), Vec<usize>>, NotInField> {
        let mut depends: HashMap<(usize, usize), Vec<usize>> = HashMap::new();
        for symbol in 0..=self.first_point.len() {
            let mut point = self.first_point.clone();
            // The last run changes nothing: every entry gets its list.
            if let Some(value) = point.get_mut(symbol) {
                *value = Value::Number(self.modulus.random(random).residue());
            }
            let run = self.oracle.ask(self.modulus, &point, random.next_u64())?;
            for (i, row) in run.beta.iter().enumerate() {
                for (j, value) in row.iter().enumerate() {
                    let list = depends.entry((i, j)).or_default();
                    if *value != self.first.beta[i][j] {
                        list.push(symbol);
                    }
                }
            }
        }
        Ok(depends)
    }

    /// Monomials that may stand under an entry, the number 1 first.
    fn denominators(&self) -> Vec<Monomial> {
        let count = variables(self.oracle.named).len();
        let mut all = vec![vec![0; count]];
        for exponent in [1, 2] {
            for at in 0..count {
                let mut monomial = vec![0; count];
                monomial[at] = exponent;
                all.push(monomial);
            }
        }
        all
    }

    /// What an entry times a denominator can look like; `None` if it cannot be.
    fn shape(&self, i: usize, j: usize, depends: &[usize], under: &[u8]) -> Option<Shape> {
        let symbols = &self.oracle.named.symbols;
        let lengths: Vec<usize> = (0..symbols.len())
            .filter(|&k| symbols[k].kind == SymbolKind::Length)
            .collect();
        let angles: Vec<usize> = (0..symbols.len())
            .filter(|&k| symbols[k].kind == SymbolKind::Angle)
            .collect();
        let own = |list: &[usize], k: &usize| list.iter().position(|x| x == k);
        let under_lengths: u8 = under[..lengths.len()].iter().sum();
        let degree = self.dimension(self.first.kept[i]) - self.dimension(self.first.deleted[j]);
        let degree = u8::try_from(degree + i8::try_from(under_lengths).ok()?).ok()?;
        let shape = Shape {
            lengths: depends.iter().filter_map(|k| own(&lengths, k)).collect(),
            angles: depends
                .iter()
                .filter_map(|k| {
                    let at = lengths.len() + 2 * own(&angles, k)?;
                    let uses = (2 * symbols[*k].uses).min(HIGHEST_ANGLE_DEGREE);
                    Some((at, uses as u8 + under[at] + under[at + 1]))
                })
                .collect(),
            degree,
        };
        // What stands below must matter.
        let known = |at: usize| {
            shape.lengths.contains(&at)
                || shape.angles.iter().any(|(a, _)| *a == at || *a + 1 == at)
        };
        let below = under.iter().enumerate().filter(|(_, e)| **e > 0);
        let sensible = below.into_iter().all(|(at, _)| known(at));
        sensible.then_some(shape)
    }

    /// The power of length in a parameter's unit.
    fn dimension(&self, column: usize) -> i8 {
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
        let Some(monomials) = shape.monomials(denominator.len()) else {
            return Ok(Vec::new());
        };
        let count = monomials.len() + CHECKS;
        self.sample(count, random)?;
        let points = &self.points[..count];
        let values: Vec<Vec<Fp<'m>>> = entries
            .iter()
            .map(|&(i, j)| {
                let value = |(run, point): (&Run, &Vec<Fp<'m>>)| {
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
    /// between an entry of beta (a quotient of minors of W with b rows) and a quotient of
    /// low degree. A length enters an entry of W at most squared, a rotation three times
    /// with degree 2 in the tangent of its half angle.
    fn degree(&self, run: &Run) -> f64 {
        let angles = self
            .named
            .symbols
            .iter()
            .filter(|s| s.kind == SymbolKind::Angle);
        let turns: usize = angles.map(|s| 6 * s.uses).sum();
        let row = run.degree as f64 + 2.0 + turns as f64;
        (self.base.len() as f64 + 1.0) * row
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
