//! The answer of the method: the paper's Tables II to V.

mod csv;
mod document;
mod json;

pub(crate) use csv::csv;
pub(crate) use document::document;
pub(crate) use json::{diagnosis, json};

use roberval_base::BaseParameters;

use crate::number::without_dust;
use crate::relation::Label;

/// What became of a standard parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Class {
    NoEffect,
    Unchanged,
    RegroupedInto,
    Regrouped,
}

impl Class {
    /// The classes, column by column.
    pub fn all(answer: &BaseParameters) -> Vec<Self> {
        let mut classes = vec![Self::NoEffect; answer.parameters.len()];
        let lists = [
            (&answer.unchanged, Self::Unchanged),
            (&answer.regrouped_into, Self::RegroupedInto),
            (&answer.regrouped, Self::Regrouped),
        ];
        for (columns, class) in lists {
            for &column in columns {
                classes[column] = class;
            }
        }
        classes
    }

    /// The name that CSV uses.
    pub fn name(self) -> &'static str {
        match self {
            Self::NoEffect => "no_effect",
            Self::Unchanged => "unchanged",
            Self::RegroupedInto => "regrouped_into",
            Self::Regrouped => "regrouped",
        }
    }

    /// The mark in the grid of links and kinds.
    pub fn mark(self) -> &'static str {
        match self {
            Self::NoEffect => ".",
            Self::Unchanged => "=",
            Self::RegroupedInto => "+",
            Self::Regrouped => "o",
        }
    }
}

/// X and XB, where the robot file gives any inertial parameter.
pub(crate) fn values(answer: &BaseParameters) -> Option<(Vec<f64>, Vec<f64>)> {
    let x = answer.mechanism.standard_parameters()?;
    let xb = answer.values(&x).ok()?;
    Some((x, xb))
}

/// For each base parameter its label, X and XB, rounding that stands for zero taken off.
pub(crate) fn rounded_values(answer: &BaseParameters) -> Option<Vec<(Label, f64, f64)>> {
    let (x, xb) = values(answer)?;
    let relations = answer.relations();
    let rows = relations.iter().zip(&xb).map(|(relation, value)| {
        let column = relation.base;
        let terms = relation.terms.iter();
        let terms = terms.map(|&(c, coefficient)| (coefficient * x[c]).abs());
        let largest = terms.fold(x[column].abs(), f64::max);
        let label = Label::of_base(answer, column);
        (label, x[column], without_dust(*value, largest))
    });
    Some(rows.collect())
}
