//! Relations against the engine at fresh random values.

use roberval_scalar::{Fp, Modulus, SplitMix64};

use crate::field::{Answer, Oracle};
use crate::naming::SymbolKind;
use crate::polynomial::power;
use crate::relations::{Coefficient, Route, SymbolicError, SymbolicRelations};

/// Fields at whose random values all relations are verified.
const FIELDS: usize = 2;

/// How relations were verified.
#[derive(Debug, Clone, PartialEq)]
pub struct Verification {
    /// The primes of the fields in which all of them hold at random values of the symbols.
    pub primes: Vec<u64>,
    /// An upper bound of the probability that one of them is wrong nevertheless.
    pub failure_probability: f64,
}

impl Default for Verification {
    /// Nothing is verified.
    fn default() -> Self {
        Self {
            primes: Vec::new(),
            failure_probability: 1.0,
        }
    }
}

impl Verification {
    /// Compares all entries with the engine's at fresh random values in fresh fields.
    ///
    /// # Errors
    /// [`SymbolicError::NotVerified`] with an entry that differs.
    pub(crate) fn of(
        relations: &SymbolicRelations,
        oracle: &Oracle<'_>,
        random: &mut SplitMix64,
    ) -> Result<Self, SymbolicError> {
        let mut verification = Self::default();
        for _ in 0..FIELDS {
            let modulus = oracle.modulus(random)?;
            let point = oracle.point(&modulus, random);
            let run = oracle.ask(&modulus, &point, random.next_u64())?;
            let at = oracle.variables(&modulus, &point);
            if let Some((i, j)) = relations.wrong(&run, &modulus, &at) {
                let labels = relations.parameters.labels();
                let (row, column) = (relations.base.get(i), relations.regrouped.get(j));
                let label = |c: Option<&usize>| c.map_or("none", |&c| labels[c].as_str());
                let entry = format!("{} in {}", label(column), label(row));
                return Err(SymbolicError::NotVerified { entry });
            }
            let failure = relations.degree(&run) / modulus.p() as f64;
            verification.failure_probability *= failure.min(1.0);
            verification.primes.push(modulus.p());
        }
        Ok(verification)
    }
}

impl SymbolicRelations {
    /// A place at which the engine says otherwise.
    fn wrong<'m>(
        &self,
        run: &Answer,
        modulus: &'m Modulus,
        at: &[Fp<'m>],
    ) -> Option<(usize, usize)> {
        if run.kept != self.base || run.deleted != self.regrouped {
            return Some((0, 0));
        }
        let rows = self.beta.iter().zip(&run.beta).enumerate();
        let mut places = rows.flat_map(|(i, (row, residues))| {
            let entries = row.iter().zip(residues).enumerate();
            entries.map(move |(j, (coefficient, residue))| ((i, j), coefficient, *residue))
        });
        let holds = |coefficient: &Option<Coefficient>, residue: u64| match coefficient {
            Some(c) => c.holds(modulus, at, residue),
            None => residue == 0,
        };
        let wrong = places.find(|(_, coefficient, residue)| !holds(coefficient, *residue));
        wrong.map(|(place, ..)| place)
    }

    /// The sum of the degrees, in all that is random, of the polynomials that vanish at the
    /// values drawn if something is wrong (J. T. Schwartz, Fast probabilistic algorithms for
    /// verification of polynomial identities, J. ACM 27(4), 1980: each does with probability
    /// degree / p at most). These are the differences between entries of beta, quotients of
    /// minors of W with b rows (or of the rules' vectors), and what is said of them; and one
    /// minor more, that of the rank.
    ///
    /// In an entry of W a position enters squared at most, a rotation three times with degree
    /// 2 in the tangent of its half angle.
    fn degree(&self, run: &Answer) -> f64 {
        let symbols = self.named.symbols.iter();
        let angles = symbols.filter(|s| s.kind == SymbolKind::Angle);
        let turns: f64 = angles.map(|s| 6.0 * s.uses as f64).sum();
        let row = run.degree as f64 + 2.0 * self.named.degree() as f64 + turns;
        let minor = row
            * match self.route {
                Route::Whole => self.base.len() as f64,
                Route::RulesAlone => self.origins.len() as f64,
            };
        let entries = self.beta.iter().flatten();
        let said = |c: &Option<Coefficient>| c.as_ref().map_or(0, Coefficient::degree);
        minor + entries.map(|c| minor + f64::from(said(c))).sum::<f64>()
    }
}

impl Coefficient {
    /// A bound of its degree: a cosine or sine has degree 2 in the tangent of half the angle.
    fn degree(&self) -> u32 {
        let Self::Quotient {
            numerator,
            denominator,
        } = self
        else {
            return 0;
        };
        let degree = |m: &crate::Monomial| m.iter().map(|&e| 2 * u32::from(e)).sum::<u32>();
        let above = numerator.terms.keys().map(degree).max().unwrap_or(0);
        above + degree(denominator)
    }

    /// Whether it has this value; what is open has any.
    fn holds<'m>(&self, modulus: &'m Modulus, at: &[Fp<'m>], residue: u64) -> bool {
        let Self::Quotient {
            numerator,
            denominator,
        } = self
        else {
            return true;
        };
        let below = power(modulus, denominator, at);
        numerator.value(modulus, at) == Some(modulus.element(residue) * below)
    }
}
