//! What words on the command line mean, and what is said of those that mean nothing.

use clap::builder::{PossibleValuesParser, TypedValueParser};
use roberval_base::{Engine, Model};
use roberval_code::{Language, What};
use roberval_mechanism::{CleanMode, Convention};
use roberval_scalar::Quantity;
use roberval_tables::Format;

use super::{Gravity, Weights};

/// One of `values`, by its name.
fn named<T: Copy + Default + Send + Sync + 'static>(
    values: &'static [T],
    name: fn(T) -> &'static str,
) -> impl TypedValueParser<Value = T> {
    let names: Vec<&str> = values.iter().map(|v| name(*v)).collect();
    // The parser before has refused every other word.
    PossibleValuesParser::new(names).map(move |word| {
        let found = values.iter().find(|v| name(**v) == word);
        found.copied().unwrap_or_default()
    })
}

pub(super) fn model() -> impl TypedValueParser<Value = Model> {
    named(&Model::ALL, Model::name)
}

pub(super) fn convention() -> impl TypedValueParser<Value = Convention> {
    named(&Convention::ALL, Convention::name)
}

pub(super) fn engine() -> impl TypedValueParser<Value = Engine> {
    named(&Engine::ALL, Engine::name)
}

pub(super) fn snap() -> impl TypedValueParser<Value = CleanMode> {
    PossibleValuesParser::new(["default", "off", "aggressive"]).map(|word| match word.as_str() {
        "off" => CleanMode::Off,
        "aggressive" => CleanMode::Aggressive,
        _ => CleanMode::Default,
    })
}

pub(super) fn language() -> impl TypedValueParser<Value = Language> {
    named(&Language::ALL, Language::name)
}

pub(super) fn what() -> impl TypedValueParser<Value = What> {
    named(&What::ALL, What::name)
}

pub(super) fn format() -> impl TypedValueParser<Value = Format> {
    named(&Format::ALL, Format::name)
}

pub(super) fn rows(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(0) | Err(_) => Err("expected a whole number of rows, at least 1".to_owned()),
        Ok(rows) => Ok(rows),
    }
}

pub(super) fn threads(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(0) | Err(_) => Err("expected a whole number of threads, at least 1".to_owned()),
        Ok(threads) => Ok(threads),
    }
}

pub(super) fn weights(text: &str) -> Result<Weights, String> {
    if text == "columns" {
        return Ok(Weights::Columns);
    }
    let numbers = text.split(',').map(|word| word.trim().parse::<f64>());
    let numbers: Vec<f64> = numbers
        .collect::<Result<_, _>>()
        .map_err(|_| "expected numbers such as 1,1,4 or the word columns".to_owned())?;
    match numbers.iter().all(|w| w.is_finite() && *w >= 0.0) {
        true => Ok(Weights::Rows(numbers)),
        false => Err("a weight is a finite number, 0 or above".to_owned()),
    }
}

pub(super) fn seed(text: &str) -> Result<u64, String> {
    let hint = |_| format!("expected a whole number from 0 to {}", u64::MAX);
    text.parse().map_err(hint)
}

/// What one rounding costs.
pub(super) fn eps(text: &str) -> Result<f64, String> {
    positive(text).map_err(|expected| format!("{expected}, such as 2.2e-16 for doubles"))
}

/// A number above zero.
pub(super) fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if x > 0.0 && x.is_finite() => Ok(x),
        _ => Err("expected a number above 0".to_owned()),
    }
}

pub(super) fn gravity(text: &str) -> Result<Gravity, String> {
    let numbers: Vec<Quantity> = text
        .split(',')
        .map(Quantity::parse_decimal)
        .collect::<Result<_, _>>()
        .map_err(|error| format!("{error}; expected three numbers such as 0,0,-9.81"))?;
    let found = numbers.len();
    let three = <[Quantity; 3]>::try_from(numbers);
    three
        .map(Gravity)
        .map_err(|_| format!("{found} numbers, expected three such as 0,0,-9.81"))
}
