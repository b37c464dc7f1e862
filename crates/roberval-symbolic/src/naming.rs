//! Which constants of a robot are symbols.

use num_traits::Zero;
use roberval_mechanism::{Geometry, RobotDescription};
use roberval_regressor::whole_multiple;
use roberval_scalar::{Expr, LinearInPi, Quantity};

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
    /// What it stands for.
    pub kind: SymbolKind,
    /// The value that the robot's file gives.
    pub given: Quantity,
    /// How often it stands in the geometry.
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
    /// Named constants that stay numbers, and why.
    pub notes: Vec<String>,
}

/// Where a quantity of the geometry stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Place {
    Length,
    Angle,
    Other,
}

impl Named {
    /// The robot with its symbols. Right angles stay numbers; other constant angles, and
    /// lengths that are no fractions, are symbols in any case.
    #[must_use]
    pub fn new(robot: &RobotDescription, naming: Naming) -> Self {
        let mut named = Self {
            description: robot.clone(),
            symbols: Vec::new(),
            notes: Vec::new(),
        };
        named.take_constants();
        let all = naming == Naming::All || named.symbols.is_empty();
        named.make_names(all);
        named
    }

    /// A bound of the degree of the position of any frame in the symbols that are lengths,
    /// over one denominator, numerator and denominator.
    #[must_use]
    pub fn degree(&self) -> usize {
        let symbol = |name: &str| {
            let mut lengths = self.symbols.iter();
            lengths.any(|s| s.kind == SymbolKind::Length && s.name == name)
        };
        let mut description = self.description.clone();
        let constants = description.constants.clone();
        let places = places(&mut description).into_iter();
        let lengths = places.filter(|(place, _)| *place == Place::Length);
        let all = lengths.map(|(_, q)| degrees(&q.expr, &constants, &symbol));
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
            let places: Vec<(Place, Quantity)> = places(&mut self.description)
                .into_iter()
                .filter(|(_, quantity)| stands_in(&quantity.expr, &constants, name))
                .map(|(place, quantity)| (place, quantity.clone()))
                .collect();
            let right = is_right(given, &constants);
            let kind = match &places[..] {
                [] => continue,
                _ if places.iter().all(|(place, _)| *place == Place::Length) => {
                    let rooted = |(_, q): &(Place, Quantity)| under_root(&q.expr, &constants, name);
                    match places.iter().any(rooted) {
                        true => Err("stands under a square root"),
                        false => Ok(SymbolKind::Length),
                    }
                }
                _ if places.iter().all(|(place, _)| *place == Place::Angle) => {
                    let whole = |(_, q): &(Place, Quantity)| {
                        whole_multiple(&q.expr, &constants, name).is_some()
                    };
                    match (right, places.iter().all(whole)) {
                        (true, _) => Err("is a right angle; other values of it are not asked"),
                        (_, false) => Err("is not taken a whole number of times"),
                        _ => Ok(SymbolKind::Angle),
                    }
                }
                _ => Err("is more than a length or an angle"),
            };
            match kind {
                Ok(kind) => self.symbols.push(Symbol {
                    name: name.clone(),
                    kind,
                    given: given.clone(),
                    uses: places.len(),
                    degree: {
                        let own = |other: &str| other == name;
                        let degrees = places.iter().map(|(_, q)| {
                            let (above, below) = degrees(&q.expr, &constants, &own);
                            above.max(below)
                        });
                        degrees.max().unwrap_or(1).min(MOST_DEGREE) as u8
                    },
                    made: false,
                }),
                Err(why) => self.notes.push(format!("{name} stays a number: it {why}")),
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
        for (link, description) in self.description.links.iter_mut().enumerate() {
            for (letter, place, quantity) in geometry(&mut description.geometry) {
                let symbolic = |s: &String| stands_in(&quantity.expr, &constants, s);
                let wanted = !symbols.iter().any(symbolic)
                    && match place {
                        Place::Angle => !is_right(quantity, &constants),
                        Place::Length => match LinearInPi::of(&quantity.expr, &constants) {
                            Some(x) if x.half_turns.is_zero() => all && !x.rational.is_zero(),
                            _ => true,
                        },
                        Place::Other => false,
                    };
                if !wanted {
                    continue;
                }
                let name = free_name(&format!("{letter}{}", link + 1), &taken);
                taken.push(name.clone());
                made.push(Symbol {
                    name: name.clone(),
                    kind: match place {
                        Place::Angle => SymbolKind::Angle,
                        _ => SymbolKind::Length,
                    },
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
        }
        let constants = made.iter().map(|s| (s.name.clone(), s.given.clone()));
        self.description.constants.extend(constants);
        self.symbols.extend(made);
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

/// The quantities of a link's geometry with the letters that name them.
fn geometry(geometry: &mut Geometry) -> Vec<(&'static str, Place, &mut Quantity)> {
    match geometry {
        Geometry::Mdh(g) => vec![
            ("gamma", Place::Angle, &mut g.gamma),
            ("b", Place::Length, &mut g.b),
            ("alpha", Place::Angle, &mut g.alpha),
            ("d", Place::Length, &mut g.d),
            ("theta", Place::Angle, &mut g.theta),
            ("r", Place::Length, &mut g.r),
        ],
        Geometry::Placed { origins, axis } => {
            let mut all = Vec::new();
            for origin in origins {
                let letters = ["x", "y", "z"].into_iter();
                all.extend(
                    letters
                        .zip(&mut origin.xyz)
                        .map(|(l, q)| (l, Place::Length, q)),
                );
                let letters = ["roll", "pitch", "yaw"].into_iter();
                all.extend(
                    letters
                        .zip(&mut origin.rpy)
                        .map(|(l, q)| (l, Place::Angle, q)),
                );
            }
            all.extend(axis.iter_mut().map(|q| ("axis", Place::Other, q)));
            all
        }
    }
}

/// All quantities that the analysis depends on.
fn places(robot: &mut RobotDescription) -> Vec<(Place, &mut Quantity)> {
    let gravity = robot.gravity.iter_mut().map(|q| (Place::Other, q));
    let links = robot.links.iter_mut();
    let of_links = links.flat_map(|link| geometry(&mut link.geometry));
    let couples = robot.couples.iter_mut().flat_map(|couple| {
        let multipliers = couple.terms.iter_mut().map(|term| &mut term.multiplier);
        multipliers.chain([&mut couple.offset])
    });
    gravity
        .chain(of_links.map(|(_, place, quantity)| (place, quantity)))
        .chain(couples.map(|quantity| (Place::Other, quantity)))
        .collect()
}

/// Whether an angle is a multiple of 90 degrees.
fn is_right(angle: &Quantity, constants: &[(String, Quantity)]) -> bool {
    LinearInPi::of(&angle.expr, constants).is_some_and(|x| {
        let quarters = x.half_turns * num_bigint::BigInt::from(2);
        x.rational.is_zero() && quarters.is_integer()
    })
}

/// Whether an expression uses a name itself.
fn names(expr: &Expr, name: &str) -> bool {
    find(expr, &mut |e| matches!(e, Expr::Name(own) if own == name))
}

/// Whether an expression depends on a constant, be it through others.
fn stands_in(expr: &Expr, constants: &[(String, Quantity)], name: &str) -> bool {
    find(expr, &mut |e| match e {
        Expr::Name(own) if own == name => true,
        Expr::Name(other) => {
            let at = constants.iter().position(|(n, _)| n == other);
            at.is_some_and(|at| stands_in(&constants[at].1.expr, &constants[..at], name))
        }
        _ => false,
    })
}

/// Whether an expression takes a square root of something that depends on a constant.
fn under_root(expr: &Expr, constants: &[(String, Quantity)], name: &str) -> bool {
    find(expr, &mut |e| match e {
        Expr::Sqrt(inner) => stands_in(inner, constants, name),
        Expr::Name(other) => {
            let at = constants.iter().position(|(n, _)| n == other);
            at.is_some_and(|at| under_root(&constants[at].1.expr, &constants[..at], name))
        }
        _ => false,
    })
}

/// Degrees of an expression, above and below, in the constants that are symbols.
fn degrees(
    expr: &Expr,
    constants: &[(String, Quantity)],
    symbol: &dyn Fn(&str) -> bool,
) -> (usize, usize) {
    let of = |inner: &Expr| degrees(inner, constants, symbol);
    match expr {
        Expr::Number(_) | Expr::Pi => (0, 0),
        Expr::Name(name) if symbol(name) => (1, 0),
        Expr::Name(name) => match constants.iter().position(|(n, _)| n == name) {
            Some(at) => degrees(&constants[at].1.expr, &constants[..at], symbol),
            None => (0, 0),
        },
        Expr::Neg(a) | Expr::Sqrt(a) => of(a),
        Expr::Add(a, b) | Expr::Sub(a, b) => {
            let ((a, below_a), (b, below_b)) = (of(a), of(b));
            ((a + below_b).max(b + below_a), below_a + below_b)
        }
        Expr::Mul(a, b) => {
            let ((a, below_a), (b, below_b)) = (of(a), of(b));
            (a + b, below_a + below_b)
        }
        Expr::Div(a, b) => {
            let ((a, below_a), (b, below_b)) = (of(a), of(b));
            (a + below_b, below_a + b)
        }
    }
}

/// Whether a part of an expression is such.
fn find(expr: &Expr, such: &mut impl FnMut(&Expr) -> bool) -> bool {
    such(expr)
        || match expr {
            Expr::Number(_) | Expr::Name(_) | Expr::Pi => false,
            Expr::Neg(a) | Expr::Sqrt(a) => find(a, such),
            Expr::Add(a, b) | Expr::Sub(a, b) | Expr::Mul(a, b) | Expr::Div(a, b) => {
                find(a, such) || find(b, such)
            }
        }
}
