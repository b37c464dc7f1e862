//! Which constants of a robot are symbols.

mod expressions;
mod places;

use std::collections::HashSet;

use num_traits::Zero;
use roberval_mechanism::{Mechanism, RobotDescription};
use roberval_regressor::whole_multiple;
use roberval_scalar::{Expr, LinearInPi, Quantity};

use expressions::{degrees, is_right, names, stands_in, under_root};
use places::{Place, flat_couples, nameable, places};

/// Higher powers of a constant in one length are not looked for.
const MOST_DEGREE: usize = 8;

/// Which constants become symbols.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Naming {
    /// The named constants of the file, if it has any in its geometry; else all lengths.
    #[default]
    Auto,
    /// Named constants and, by names made for them, all other lengths that are not zero.
    All,
}

/// What a symbol stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SymbolKind {
    /// A length.
    Length,
    /// An angle, which relations know by its cosine and sine.
    Angle,
}

/// A constant that stays a symbol.
#[derive(Debug, Clone, PartialEq)]
pub struct Symbol {
    /// Its name, an identifier.
    pub name: String,
    /// The name in relations: another where that is a parameter's (`M_2`) or a function's.
    pub shown: String,
    /// What it stands for.
    pub kind: SymbolKind,
    /// The value that the robot's file gives.
    pub given: Quantity,
    /// How often it stands in the geometry: an angle `2*A` counts twice.
    pub uses: usize,
    /// The highest power in which it enters one of its places: 2 in a length `L^2`.
    pub degree: u8,
    /// Whether the name was made for it.
    pub made: bool,
}

/// A robot whose symbols are constants of its description.
#[derive(Debug, Clone)]
pub struct Named {
    /// The description, with names where there were only numbers.
    pub description: RobotDescription,
    /// The symbols, those of the file first.
    pub symbols: Vec<Symbol>,
    /// Named constants that are right angles: numbers in the relations, but whether their
    /// values are special is asked.
    pub right: Vec<Symbol>,
    /// Named constants that stay numbers, and why.
    pub notes: Vec<String>,
}

impl Named {
    /// The robot with its symbols. Right angles stay numbers; other constant angles, those
    /// of couples included, and lengths that are no fractions, are symbols in any case.
    #[must_use]
    pub fn new(robot: &Mechanism, naming: Naming) -> Self {
        let mut named = Self {
            description: (*robot.description).clone(),
            symbols: Vec::new(),
            right: Vec::new(),
            notes: Vec::new(),
        };
        if let Some(couples) = flat_couples(robot) {
            named.description.couples = couples;
        }
        named.take_constants();
        let all = naming == Naming::All || named.symbols.is_empty();
        named.make_names(all);
        named.tell_apart(robot.parameters().labels());
        named
    }

    /// Shows symbols by other names that have those of parameters or of functions.
    fn tell_apart(&mut self, labels: &[String]) {
        let regrouped = labels.iter().map(|label| label.replacen('_', "R_", 1));
        let functions = ["cos", "sin", "f"].map(str::to_owned).into_iter();
        let taken: HashSet<String> = labels
            .iter()
            .cloned()
            .chain(regrouped)
            .chain(functions)
            .collect();
        let constants = self.description.constants.iter();
        let names: Vec<String> = constants.map(|(name, _)| name.clone()).collect();
        let symbols = self.symbols.iter_mut().chain(&mut self.right);
        for symbol in symbols.filter(|s| taken.contains(&s.name)) {
            symbol.shown = free_name(&format!("const_{}", symbol.name), &names);
        }
    }

    /// The same with named right angles as symbols.
    #[must_use]
    pub(crate) fn with_right_angles(&self) -> Self {
        let mut named = self.clone();
        named.symbols.append(&mut named.right);
        named
    }

    /// The number of variables of the polynomials: one for a length, two for an angle.
    pub(crate) fn variables(&self) -> usize {
        2 * self.symbols.len() - self.lengths()
    }

    /// The place of a symbol's (first) variable: those of lengths come before those of angles.
    pub(crate) fn variable(&self, symbol: usize) -> usize {
        let kind = self.symbols[symbol].kind;
        let before = self.symbols[..symbol]
            .iter()
            .filter(|s| s.kind == kind)
            .count();
        match kind {
            SymbolKind::Length => before,
            SymbolKind::Angle => self.lengths() + 2 * before,
        }
    }

    /// The number of symbols that are lengths.
    pub(crate) fn lengths(&self) -> usize {
        let symbols = self.symbols.iter();
        symbols.filter(|s| s.kind == SymbolKind::Length).count()
    }

    /// A bound of the degree of the position of any frame in the symbols that are lengths,
    /// over one denominator, numerator and denominator.
    #[must_use]
    pub fn degree(&self) -> usize {
        let symbol = |name: &str| {
            let mut lengths = self.symbols.iter();
            lengths.any(|s| s.kind == SymbolKind::Length && s.name == name)
        };
        let constants = &self.description.constants;
        let places = places(&self.description).into_iter();
        let lengths = places.filter(|(place, _)| *place == Place::Length);
        let all = lengths.map(|(_, q)| degrees(&q.expr, constants, &symbol));
        let (highest, below) = all.fold((1, 0), |(highest, sum), (above, below)| {
            (above.max(highest), sum + below)
        });
        highest + below
    }

    /// Takes the file's constants that are plain numbers and stand in the geometry.
    fn take_constants(&mut self) {
        let constants = self.description.constants.clone();
        for (name, given) in &constants {
            if constants.iter().any(|(other, _)| names(&given.expr, other)) {
                continue;
            }
            let places: Vec<(Place, Quantity)> = places(&self.description)
                .into_iter()
                .filter(|(_, quantity)| stands_in(&quantity.expr, &constants, name))
                .collect();
            match kind(&places, given, &constants, name) {
                None => {}
                Some(Err(why)) => self.notes.push(format!("{name} stays a number: it {why}")),
                Some(Ok(kind)) => {
                    let symbol = symbol(name, kind, given, &places, &constants);
                    if kind == SymbolKind::Angle && is_right(given, &constants) {
                        let note = "stays a number in the relations: it is a right angle";
                        self.notes.push(format!("{name} {note}"));
                        self.right.push(symbol);
                    } else {
                        self.symbols.push(symbol);
                    }
                }
            }
        }
    }

    /// Gives names to angles that are not right, to lengths that are no fractions and, if
    /// `all`, to all lengths but zero.
    fn make_names(&mut self, all: bool) {
        let constants = self.description.constants.clone();
        let symbols: Vec<String> = self.symbols.iter().map(|s| s.name.clone()).collect();
        let mut taken: Vec<String> = constants.iter().map(|(name, _)| name.clone()).collect();
        let mut made: Vec<Symbol> = Vec::new();
        for (letters, place, quantity) in nameable(&mut self.description) {
            let symbolic = |s: &String| stands_in(&quantity.expr, &constants, s);
            let kind = match place {
                Place::Angle => SymbolKind::Angle,
                Place::Length => SymbolKind::Length,
                Place::Other => continue,
            };
            let wanted = match kind {
                SymbolKind::Angle => !is_right(quantity, &constants),
                SymbolKind::Length => match LinearInPi::of(&quantity.expr, &constants) {
                    Some(x) if x.half_turns.is_zero() => all && !x.rational.is_zero(),
                    _ => true,
                },
            };
            if !wanted || symbols.iter().any(symbolic) {
                continue;
            }
            let name = free_name(&letters, &taken);
            taken.push(name.clone());
            made.push(Symbol {
                shown: name.clone(),
                name: name.clone(),
                kind,
                given: quantity.clone(),
                uses: 1,
                degree: 1,
                made: true,
            });
            *quantity = Quantity {
                text: name.clone(),
                expr: Expr::Name(name),
                value: quantity.value,
            };
        }
        let constants = made.iter().map(|s| (s.name.clone(), s.given.clone()));
        self.description.constants.extend(constants);
        self.symbols.extend(made);
    }
}

/// What a constant that stands in these places can be a symbol for; `None` if in none.
fn kind(
    places: &[(Place, Quantity)],
    given: &Quantity,
    constants: &[(String, Quantity)],
    name: &str,
) -> Option<Result<SymbolKind, &'static str>> {
    let all = |wanted: Place| places.iter().all(|(place, _)| *place == wanted);
    let rooted = |(_, q): &(Place, Quantity)| under_root(&q.expr, constants, name);
    let whole = |(_, q): &(Place, Quantity)| whole_multiple(&q.expr, constants, name).is_some();
    if places.is_empty() {
        return None;
    }
    Some(if all(Place::Length) {
        match places.iter().any(rooted) {
            true => Err("stands under a square root"),
            false => Ok(SymbolKind::Length),
        }
    } else if all(Place::Angle) {
        match (is_right(given, constants), places.iter().all(whole)) {
            (_, true) => Ok(SymbolKind::Angle),
            (true, false) => Err("is a right angle; other values of it are not asked"),
            (false, false) => Err("is not taken a whole number of times"),
        }
    } else {
        Err("is more than a length or an angle")
    })
}

/// A named constant as a symbol, with the places where it stands.
fn symbol(
    name: &str,
    kind: SymbolKind,
    given: &Quantity,
    places: &[(Place, Quantity)],
    constants: &[(String, Quantity)],
) -> Symbol {
    let own = |other: &str| other == name;
    let degrees = places.iter().map(|(_, q)| {
        let (above, below) = degrees(&q.expr, constants, &own);
        above.max(below)
    });
    let times = |(_, q): &(Place, Quantity)| match kind {
        SymbolKind::Length => 1,
        SymbolKind::Angle => {
            let times = whole_multiple(&q.expr, constants, name).unwrap_or(1);
            usize::try_from(times.unsigned_abs()).unwrap_or(usize::MAX)
        }
    };
    Symbol {
        name: name.to_owned(),
        shown: name.to_owned(),
        kind,
        given: given.clone(),
        uses: places.iter().map(times).fold(0, usize::saturating_add),
        degree: degrees.max().unwrap_or(1).min(MOST_DEGREE) as u8,
        made: false,
    }
}

/// `d3`, or the first of `d3b`, `d3c`, ... that is free.
fn free_name(name: &str, taken: &[String]) -> String {
    let free = |candidate: &String| !taken.contains(candidate);
    let more = ('b'..='z').map(|letter| format!("{name}{letter}"));
    let mut candidates = std::iter::once(name.to_owned()).chain(more);
    candidates.find(free).unwrap_or_else(|| {
        (2..)
            .map(|k| format!("{name}_{k}"))
            .find(free)
            .expect("names do not end")
    })
}
