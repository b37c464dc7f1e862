//! Robots with values for their symbols.
#![allow(dead_code)]

use std::collections::HashMap;

use num_rational::BigRational;
use num_traits::{Pow, Zero};
use roberval_mechanism::{Mechanism, RobotDescription};
use roberval_scalar::{Expr, Quantity, SplitMix64};
use roberval_symbolic::{
    Coefficient, Factored, Notation, Polynomial, SymbolKind, SymbolicOptions, SymbolicRelations,
    symbolic_relations,
};
use roberval_testkit::{angles_mut, decimal, lengths_mut};

/// The relations of a description in symbols.
pub fn relations(robot: &RobotDescription, options: &SymbolicOptions) -> SymbolicRelations {
    let mechanism = Mechanism::new(robot).expect("a valid robot");
    symbolic_relations(&mechanism, options).expect("relations")
}

/// `XX_2 - YY_2 - D3^2 M_3 ...`, term by term.
pub fn texts(answer: &SymbolicRelations) -> Vec<String> {
    let labels = answer.parameters.labels();
    let rows = answer.base.iter().zip(&answer.beta);
    let rows = rows.filter(|(_, row)| row.iter().any(Option::is_some));
    rows.map(|(&base, row)| {
        let mut text = labels[base].clone();
        for (&column, coefficient) in answer.regrouped.iter().zip(row) {
            let Some(coefficient) = coefficient else {
                continue;
            };
            let factored = Factored::of(coefficient, &answer.variables).expect("a polynomial");
            text += if factored.negative { " - " } else { " + " };
            let factor = factored.text(Notation::Text);
            text += [factor.as_str(), &labels[column]].join(" ").trim_start();
        }
        text
    })
    .collect()
}

/// The robot whose length symbols have random three-digit values, in thousandths, and those
/// values in the order of the symbols.
pub fn with_random_lengths(
    answer: &SymbolicRelations,
    random: &mut SplitMix64,
) -> (RobotDescription, Vec<BigRational>) {
    let mut robot = answer.named.description.clone();
    let mut values = Vec::new();
    for symbol in &answer.named.symbols {
        assert_eq!(symbol.kind, SymbolKind::Length);
        let thousandths = 1 + random.below(999) as i64;
        let text = format!("{thousandths}e-3");
        let value = Quantity::parse_decimal(&text).expect("a number");
        values.push(BigRational::new(thousandths.into(), 1000.into()));
        let mut constants = robot.constants.iter_mut();
        let constant = constants.find(|(name, _)| *name == symbol.name);
        constant.expect("symbols are constants").1 = value;
    }
    // What the expressions are worth in doubles is not asked here.
    (robot, values)
}

/// The robot with random values for its symbols in place of their names, lengths in mm and
/// angles in mrad; and those values.
pub fn with_random_values(
    answer: &SymbolicRelations,
    random: &mut SplitMix64,
) -> (RobotDescription, HashMap<String, f64>) {
    let mut robot = answer.named.description.clone();
    let mut values = HashMap::new();
    for symbol in &answer.named.symbols {
        let value = decimal(1 + random.below(1500) as i64, -3);
        values.insert(symbol.name.clone(), value.value);
        let mut constants = robot.constants.iter_mut();
        let constant = constants.find(|(name, _)| *name == symbol.name);
        constant.expect("symbols are constants").1 = value;
    }
    let constants: HashMap<String, Quantity> = robot.constants.iter().cloned().collect();
    let put = |quantity: &mut Quantity| {
        if let Expr::Name(name) = &quantity.expr {
            *quantity = constants[name].clone();
        }
    };
    angles_mut(&mut robot).into_iter().for_each(put);
    lengths_mut(&mut robot).into_iter().for_each(put);
    robot
        .couples
        .iter_mut()
        .for_each(|couple| put(&mut couple.offset));
    (robot, values)
}

/// A coefficient's value.
pub fn exact(coefficient: &Coefficient, at: &[BigRational]) -> BigRational {
    let Coefficient::Quotient {
        numerator,
        denominator,
    } = coefficient
    else {
        panic!("{coefficient:?} is open");
    };
    value(numerator, at) / power(denominator, at)
}

fn value(polynomial: &Polynomial, at: &[BigRational]) -> BigRational {
    let terms = polynomial.terms.iter();
    let terms = terms.map(|(monomial, coefficient)| coefficient * power(monomial, at));
    terms.fold(BigRational::zero(), |sum, term| sum + term)
}

fn power(monomial: &[u8], at: &[BigRational]) -> BigRational {
    let powers = monomial
        .iter()
        .zip(at)
        .map(|(e, x)| x.clone().pow(u32::from(*e)));
    powers.fold(BigRational::from_integer(1.into()), |product, x| {
        product * x
    })
}
