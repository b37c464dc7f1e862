//! beta in symbols.

use std::fmt;

use roberval_base::{LoopForm, Model, constraints_held};
use roberval_mechanism::{Couple, Mechanism, MechanismError, ParameterSpace};
use roberval_regressor::{AngleOrder, NotInField};
use roberval_scalar::{Modulus, SplitMix64};

use crate::field::Oracle;
use crate::naming::{Named, Naming, SymbolKind};
use crate::polynomial::{Monomial, Polynomial, Variable};
use crate::rules::Origin;
use crate::samples::Samples;
use crate::special::{Special, special};
use crate::verification::Verification;

/// How far relations are looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Route {
    /// The closed-form rules, then elimination on what they leave.
    #[default]
    Whole,
    /// The rules alone: they may leave more than the base parameters.
    RulesAlone,
}

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
    /// Joints follow by expressions.
    #[error(
        "the joint {joint:?} follows by an expression, so that relations have no known form in symbols (couples by multipliers have: equals = {{ ... }}); base without --symbolic gives them in numbers"
    )]
    Expression {
        /// The first of them.
        joint: String,
    },
    /// Loops that are no couples on their branch.
    #[error(
        "relations in symbols are known of loops only where these are couples, as in a parallelogram, which this robot's are not; base without --symbolic gives them in numbers"
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
    /// No such form was found.
    Open {
        /// The symbols it depends on.
        symbols: Vec<String>,
        /// Why.
        why: Open,
    },
}

/// Why an entry of beta has no formula.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Open {
    /// It is a quotient by a sum, or a power is too high.
    NotPolynomial,
    /// It has more terms than anyone reads.
    TooLong,
    /// Its numbers are no fractions (the length of an axis is a root, say).
    NotRational,
}

impl fmt::Display for Open {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotPolynomial => "no polynomial over a product of powers",
            Self::TooLong => "a polynomial of too many terms",
            Self::NotRational => "no polynomial with rational numbers",
        })
    }
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
    /// The linear model.
    pub model: Model,
    /// How far they were looked for.
    pub route: Route,
    /// What elimination removes of what the rules leave.
    pub left_over: Vec<usize>,
    /// The couples that the robot's loops are on their branch, as which they are taken.
    pub loops: Vec<Couple>,
    /// What is special about the given values.
    pub special: Vec<Special>,
    /// How sure the relations are.
    pub verification: Verification,
}

/// The relations of a mechanism in symbols.
///
/// # Errors
/// [`SymbolicError`] if it has constraints that are no couples by multipliers, or a number has
/// no place in a prime field.
pub fn symbolic_relations(
    mechanism: &Mechanism,
    options: &SymbolicOptions,
) -> Result<SymbolicRelations, SymbolicError> {
    let (coupled, loops) = by_couples(mechanism, options.seed)?;
    let named = Named::new(&coupled, options.naming);
    let columns = mechanism.parameters().len();
    let order = options.order.clone();
    let oracle = Oracle {
        route: options.route,
        named: &named,
        mechanism: Mechanism::new(&named.description)?,
        model: options.model,
        order: order.unwrap_or_else(|| (0..columns).collect()),
        angles: AngleOrder::of(&coupled),
    };
    let mut random = SplitMix64::new(options.seed);
    let modulus = oracle.modulus(&mut random)?;
    let mut samples = Samples::new(&oracle, &modulus, &mut random)?;
    let beta = samples.beta(&mut random)?;
    let (origins, left_over) = samples.origins(&mut random)?;
    let run = samples.first;
    let special = match options.route {
        Route::Whole => special_values(&oracle, &modulus, &mut random)?,
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
        model: options.model,
        route: options.route,
        left_over,
        loops,
        special,
        verification: Verification::default(),
        mechanism: oracle.mechanism.clone(),
        named: named.clone(),
    };
    relations.verification = Verification::of(&relations, &oracle, &mut random)?;
    Ok(relations)
}

/// The mechanism with couples by multipliers as its only constraints, and those that stand
/// for loops.
fn by_couples(mechanism: &Mechanism, seed: u64) -> Result<(Mechanism, Vec<Couple>), SymbolicError> {
    if mechanism.is_affine() {
        return Ok((mechanism.clone(), Vec::new()));
    }
    let formulas = mechanism.closure.iter().flat_map(|c| &c.formulas);
    if let Some(variable) = formulas.copied().next() {
        let link = mechanism.moving().nth(variable);
        let joint = link.map_or_else(String::new, |l| l.label().to_owned());
        return Err(SymbolicError::Expression { joint });
    }
    match constraints_held(mechanism, seed) {
        Ok((coupled, Some(LoopForm::Couples(couples)))) => Ok((coupled.into_owned(), couples)),
        _ => Err(SymbolicError::Loops),
    }
}

/// What is special about the given values of all named constants, right angles included.
fn special_values(
    oracle: &Oracle<'_>,
    modulus: &Modulus,
    random: &mut SplitMix64,
) -> Result<Vec<Special>, NotInField> {
    let named = oracle.named.with_right_angles();
    let oracle = Oracle {
        named: &named,
        mechanism: oracle.mechanism.clone(),
        order: oracle.order.clone(),
        ..*oracle
    };
    let point = oracle.point(modulus, random);
    let generic = oracle.ask(modulus, &point, random.next_u64())?;
    special(&oracle, modulus, &generic, random)
}

fn variables(named: &Named) -> Vec<Variable> {
    let of = |kind: SymbolKind| named.symbols.iter().filter(move |s| s.kind == kind);
    let lengths = of(SymbolKind::Length).map(|s| Variable::Length(s.shown.clone()));
    let angles = of(SymbolKind::Angle).flat_map(|s| {
        [
            Variable::Cos(s.shown.clone()),
            Variable::Sin(s.shown.clone()),
        ]
    });
    lengths.chain(angles).collect()
}
