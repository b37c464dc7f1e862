//! All joint variables from the independent ones.

use std::collections::{BTreeMap, HashMap};
use std::convert::Infallible;

use num_traits::Zero;
use roberval_scalar::{Expr, Formula, LinearInPi, Quantity};

use crate::{CoupleError, RobotDescription};

/// q = F(qa): how the n joint variables of the tree follow from m independent ones.
#[derive(Debug, Clone, PartialEq)]
pub struct Closure {
    /// The variables (places in q) that are independent, ascending: qa in q.
    pub independent: Vec<usize>,
    /// The law of each of the n variables.
    pub laws: Vec<VariableLaw>,
    /// The variables that follow by expressions, each after those that it follows.
    pub formulas: Vec<usize>,
}

/// How one joint variable follows.
#[derive(Debug, Clone, PartialEq)]
pub enum VariableLaw {
    /// It is independent, at this place of qa.
    Independent(usize),
    /// It is a sum of multiples.
    Affine(AffineLaw),
    /// It follows by an expression of other variables, given by their places in q.
    Formula(Formula<usize>),
    /// It follows from loops, which have to be closed.
    Implicit,
}

/// q = sum of multiplier * qa\[place\] + offset, chains of couples resolved. A multiplier
/// is a fraction wherever those of the description are rational numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct AffineLaw {
    /// Places in qa, ascending, each with its multiplier.
    pub terms: Vec<(usize, Quantity)>,
    /// rad or m.
    pub offset: Quantity,
}

impl Closure {
    /// The closure of a description whose links stand in `order` (their places in the
    /// file); `None` where no joint depends on another.
    ///
    /// # Errors
    /// A [`CoupleError`] that names the joint: unknown or fixed joints, two couples for
    /// one joint, circles, couples that hold their joint still.
    pub fn of(robot: &RobotDescription, order: &[usize]) -> Result<Option<Self>, CoupleError> {
        if robot.couples.is_empty() {
            return Ok(None);
        }
        let couples = Couples::of(robot)?;
        let order_of_couples = couples.in_order()?;
        let mut resolved: HashMap<usize, Sum> = HashMap::new();
        let mut formulas: HashMap<usize, Formula<usize>> = HashMap::new();
        let mut in_turn = Vec::new();
        for couple in order_of_couples {
            let link = couples.dependent[couple];
            match couples.formula(couple, |source| formulas.contains_key(&source))? {
                Some(formula) => {
                    formulas.insert(link, formula);
                    in_turn.push(link);
                }
                None => {
                    let sum = couples.resolve(couple, &resolved)?;
                    resolved.insert(link, sum);
                }
            }
        }
        let variables = |&l: &usize| std::iter::repeat_n(l, robot.links[l].joint.dof());
        let moving: Vec<usize> = order.iter().flat_map(variables).collect();
        let variable: HashMap<usize, usize> = moving.iter().copied().zip(0..).collect();
        let mut place = HashMap::new();
        let mut independent = Vec::new();
        for (at, &link) in moving.iter().enumerate() {
            if !resolved.contains_key(&link) && !formulas.contains_key(&link) {
                place.insert(link, independent.len());
                independent.push(at);
            }
        }
        let mut places = 0..independent.len();
        let law = |link: &usize| match (resolved.get(link), formulas.get(link)) {
            (Some(sum), _) => Some(VariableLaw::Affine(sum.law(&place))),
            (None, Some(formula)) => {
                let mut name = |link: &usize| Ok::<_, Infallible>(variable[link]);
                let Ok(formula) = formula.rename(&mut name);
                Some(VariableLaw::Formula(formula))
            }
            (None, None) => places.next().map(VariableLaw::Independent),
        };
        Ok(Some(Self {
            laws: moving.iter().filter_map(law).collect(),
            independent,
            formulas: in_turn.iter().map(|link| variable[link]).collect(),
        }))
    }
}

/// A sum of multiples of independent joints (links in the file), and a constant.
struct Sum {
    terms: BTreeMap<usize, Quantity>,
    offset: Quantity,
}

impl Sum {
    fn law(&self, place: &HashMap<usize, usize>) -> AffineLaw {
        let term = |(link, multiplier): (&usize, &Quantity)| (place[link], multiplier.clone());
        let mut terms: Vec<_> = self.terms.iter().map(term).collect();
        terms.sort_by_key(|(place, _)| *place);
        AffineLaw {
            terms,
            offset: self.offset.clone(),
        }
    }
}

/// The couples with their joints found.
struct Couples<'d> {
    robot: &'d RobotDescription,
    /// The link of each couple's joint.
    dependent: Vec<usize>,
    /// The links of each couple's terms.
    sources: Vec<Vec<usize>>,
    /// The couple of a link's joint.
    couple_of: HashMap<usize, usize>,
    /// Links by name.
    links: HashMap<&'d str, usize>,
}

impl<'d> Couples<'d> {
    fn of(robot: &'d RobotDescription) -> Result<Self, CoupleError> {
        let names = robot.links.iter().enumerate();
        let links: HashMap<&str, usize> = names.map(|(i, l)| (l.name.as_str(), i)).collect();
        let find = |couple: usize, name: &str| {
            let unknown = || CoupleError::Unknown {
                couple,
                name: name.to_owned(),
            };
            let link = *links.get(name).ok_or_else(unknown)?;
            let kind = robot.links[link].joint;
            if !kind.has_axis() {
                let name = robot.joint_label(link).to_owned();
                return Err(CoupleError::NoAxis { couple, name, kind });
            }
            Ok(link)
        };
        let mut all = Self {
            robot,
            dependent: Vec::new(),
            sources: Vec::new(),
            couple_of: HashMap::new(),
            links: HashMap::new(),
        };
        for (couple, written) in robot.couples.iter().enumerate() {
            let link = find(couple, &written.joint)?;
            if let Some(first) = all.couple_of.insert(link, couple) {
                let name = robot.joint_label(link).to_owned();
                return Err(CoupleError::Twice {
                    couple,
                    first,
                    name,
                });
            }
            let mut names: Vec<&String> = written.terms.iter().map(|t| &t.joint).collect();
            if let Some(expression) = &written.expression {
                names.extend(expression.formula.joints());
            }
            let sources = names.into_iter().map(|name| find(couple, name));
            all.dependent.push(link);
            all.sources.push(sources.collect::<Result<_, _>>()?);
        }
        all.links = links;
        Ok(all)
    }

    /// The couples, each after those that it follows from.
    fn in_order(&self) -> Result<Vec<usize>, CoupleError> {
        let count = self.dependent.len();
        let before = |c: usize| self.sources[c].iter().filter_map(|l| self.couple_of.get(l));
        let mut waits: Vec<usize> = (0..count).map(|c| before(c).count()).collect();
        let mut after = vec![Vec::new(); count];
        (0..count).for_each(|c| before(c).for_each(|&b| after[b].push(c)));
        let mut order: Vec<usize> = (0..count).filter(|&c| waits[c] == 0).collect();
        let mut next = 0;
        while next < order.len() {
            for &c in &after[order[next]] {
                waits[c] -= 1;
                if waits[c] == 0 {
                    order.push(c);
                }
            }
            next += 1;
        }
        if order.len() == count {
            return Ok(order);
        }
        Err(self.circle(&waits))
    }

    /// Walks among couples that wait for each other until one comes again.
    fn circle(&self, waits: &[usize]) -> CoupleError {
        let waiting = |c: &usize| waits[*c] > 0;
        let mut walk: Vec<usize> = (0..waits.len()).filter(waiting).take(1).collect();
        while let Some(&last) = walk.last() {
            let sources = self.sources[last]
                .iter()
                .filter_map(|l| self.couple_of.get(l));
            let Some(next) = sources.copied().find(|c| waiting(c)) else {
                break;
            };
            if let Some(at) = walk.iter().position(|&c| c == next) {
                walk.drain(..at);
                break;
            }
            walk.push(next);
        }
        let label = |&c: &usize| self.robot.joint_label(self.dependent[c]).to_owned();
        CoupleError::Cycle {
            couple: walk.first().copied().unwrap_or(0),
            names: walk.iter().map(label).collect(),
        }
    }

    /// The couple as an expression of links' joints: where it is written so, or follows a
    /// joint that does.
    fn formula(
        &self,
        couple: usize,
        by_formula: impl Fn(usize) -> bool,
    ) -> Result<Option<Formula<usize>>, CoupleError> {
        let written = &self.robot.couples[couple];
        if let Some(expression) = &written.expression {
            if self.sources[couple].is_empty() {
                return Err(self.still(couple, "names no joint to follow"));
            }
            if !self.robot.loops.is_empty() {
                let name = self.robot.joint_label(self.dependent[couple]).to_owned();
                return Err(CoupleError::Loops { couple, name });
            }
            let mut find = |name: &String| Ok::<_, Infallible>(self.links[name.as_str()]);
            let Ok(formula) = expression.formula.rename(&mut find);
            return Ok(Some(formula));
        }
        if !self.sources[couple].iter().any(|&link| by_formula(link)) {
            return Ok(None);
        }
        let start = Formula::Constant(written.offset.clone());
        let terms = written.terms.iter().zip(&self.sources[couple]);
        Ok(Some(terms.fold(start, |sum, (term, &link)| {
            let factor = Box::new(Formula::Constant(term.multiplier.clone()));
            let product = Formula::Mul(factor, Box::new(Formula::Joint(link)));
            Formula::Add(Box::new(sum), Box::new(product))
        })))
    }

    fn still(&self, couple: usize, what: &str) -> CoupleError {
        CoupleError::Still {
            couple,
            name: self.robot.joint_label(self.dependent[couple]).to_owned(),
            what: what.to_owned(),
        }
    }

    /// The couple's joint as a sum over independent joints, those before it being known.
    fn resolve(&self, couple: usize, known: &HashMap<usize, Sum>) -> Result<Sum, CoupleError> {
        let written = &self.robot.couples[couple];
        let name = || self.robot.joint_label(self.dependent[couple]).to_owned();
        let still = |what: &str| self.still(couple, what);
        if written.terms.is_empty() {
            return Err(still("names no joint to follow"));
        }
        let too_long = || CoupleError::TooLong {
            couple,
            name: name(),
        };
        let algebra = Algebra(&self.robot.constants);
        let mut sum = Sum {
            terms: BTreeMap::new(),
            offset: written.offset.clone(),
        };
        for (term, link) in written.terms.iter().zip(&self.sources[couple]) {
            if term.multiplier.value == 0.0 {
                return Err(still("has the multiplier 0"));
            }
            let part = match known.get(link) {
                None => BTreeMap::from([(*link, term.multiplier.clone())]),
                Some(source) => {
                    let scaled = |(l, m): (&usize, &Quantity)| {
                        Some((*l, algebra.product(&term.multiplier, m)?))
                    };
                    let offset = algebra.product(&term.multiplier, &source.offset);
                    sum.offset = offset
                        .and_then(|o| algebra.sum(&sum.offset, &o))
                        .ok_or_else(too_long)?;
                    let terms = source.terms.iter().map(scaled).collect::<Option<_>>();
                    terms.ok_or_else(too_long)?
                }
            };
            for (link, multiplier) in part {
                let multiplier = match sum.terms.get(&link) {
                    None => Some(multiplier),
                    Some(other) => algebra.sum(other, &multiplier),
                };
                sum.terms.insert(link, multiplier.ok_or_else(too_long)?);
            }
        }
        sum.terms.retain(|_, m| !algebra.is_zero(m));
        if sum.terms.is_empty() {
            return Err(still("has multipliers that cancel"));
        }
        let numbers = || sum.terms.values().chain([&sum.offset]);
        if numbers().all(|x| x.value.is_finite() && !algebra.is_too_long(x)) {
            Ok(sum)
        } else {
            Err(too_long())
        }
    }
}

/// Exact sums and products of quantities: numbers where both are r + s pi and the result
/// is, else expressions.
struct Algebra<'d>(&'d [(String, Quantity)]);

impl Algebra<'_> {
    fn linear(&self, x: &Quantity) -> Option<LinearInPi> {
        LinearInPi::of(&x.expr, self.0)
    }

    fn is_zero(&self, x: &Quantity) -> bool {
        match self.linear(x) {
            Some(x) => x.rational.is_zero() && x.half_turns.is_zero(),
            None => x.value == 0.0,
        }
    }

    fn is_too_long(&self, x: &Quantity) -> bool {
        LinearInPi::is_too_long(&x.expr, self.0)
    }

    /// `None` where it would be too long.
    fn product(&self, a: &Quantity, b: &Quantity) -> Option<Quantity> {
        if let (Some(x), Some(y)) = (self.linear(a), self.linear(b))
            && let (Some(x), Some(y)) = (x.as_rational(), y.as_rational())
        {
            return Some(Quantity::from_rational(&(x * y)));
        }
        self.composed(a, b, "*", a.value * b.value, Expr::Mul)
    }

    /// `None` where it would be too long.
    fn sum(&self, a: &Quantity, b: &Quantity) -> Option<Quantity> {
        if self.is_zero(a) {
            return Some(b.clone());
        }
        if self.is_zero(b) {
            return Some(a.clone());
        }
        if let (Some(x), Some(y)) = (self.linear(a), self.linear(b))
            && let (Some(x), Some(y)) = (x.as_rational(), y.as_rational())
        {
            return Some(Quantity::from_rational(&(x + y)));
        }
        self.composed(a, b, "+", a.value + b.value, Expr::Add)
    }

    fn composed(
        &self,
        a: &Quantity,
        b: &Quantity,
        sign: &str,
        value: f64,
        operation: impl Fn(Box<Expr>, Box<Expr>) -> Expr,
    ) -> Option<Quantity> {
        if self.is_too_long(a) || self.is_too_long(b) {
            return None;
        }
        Some(Quantity {
            text: format!("({}) {sign} ({})", a.text, b.text),
            expr: operation(Box::new(a.expr.clone()), Box::new(b.expr.clone())),
            value,
        })
    }
}
