//! Constraints as prime fields hold them.
//!
//! Couples by multipliers are powers of circle points. A loop whose branch is that of such
//! couples, a parallelogram, is decided by them: the couples are guessed from G, which is
//! constant, and proved by closing the loops identically in a field. As the loops' equations
//! have full rank at the start, what closes them near there is m-dimensional, and so is what
//! the couples give: they are the branch. Other loops are decided at random points of their
//! variety, where these are easy to find and it is irreducible ([`NotClosed`] tells where
//! not).
//!
//! [`NotClosed`]: roberval_regressor::LoopsNotInField

use std::borrow::Cow;
use std::sync::Arc;

use roberval_mechanism::{Assembly, Couple, JointKind, Mechanism, Term, Walk};
use roberval_regressor::{AngleOrder, couples_close_loops};
use roberval_scalar::Quantity;

use super::ExactError;
use super::field::{in_some_field, try_fields};

/// Configurations at which G is looked at beside the start.
const CONFIGURATIONS: usize = 6;

/// The seed of their walk.
const SEED: u64 = 0xc0_91e;

/// Guesses are off by no more than this; those that are wrong close no loop in a field.
const GUESS: f64 = 1e-9;

/// Denominators of multipliers and of parts of a half turn.
const LARGEST_DENOMINATOR: i32 = 12;

/// How prime fields hold loops.
#[derive(Debug, Clone, PartialEq)]
pub enum LoopForm {
    /// On this branch they are these couples.
    Couples(Vec<Couple>),
    /// By random points of their irreducible variety.
    Points,
}

/// The mechanism as prime fields hold it, with couples in place of loops that are such on
/// their branch; and its loops' form.
///
/// # Errors
/// [`ExactError::Constraints`] if they do not.
pub fn held(
    mechanism: &Mechanism,
    seed: u64,
) -> Result<(Cow<'_, Mechanism>, Option<LoopForm>), ExactError> {
    if mechanism.is_affine() {
        return Ok((Cow::Borrowed(mechanism), None));
    }
    if mechanism.assembly.is_none() {
        return Err(ExactError::Constraints {
            reason: "joints follow by expressions".to_owned(),
        });
    }
    if let Some(coupled) = as_couples(mechanism, seed)? {
        let couples = coupled.description.couples.clone();
        return Ok((Cow::Owned(coupled), Some(LoopForm::Couples(couples))));
    }
    let angles = AngleOrder::of(mechanism);
    let holds = |exact: &roberval_regressor::ExactModel<'_>, _: &mut _| exact.holds_constraints();
    match in_some_field(mechanism, angles, seed, 1, holds)? {
        Ok(()) => Ok((Cow::Borrowed(mechanism), Some(LoopForm::Points))),
        Err(reason) => Err(ExactError::Constraints {
            reason: reason.to_string(),
        }),
    }
}

/// The mechanism with couples in place of its loops, if these are such on their branch.
fn as_couples(mechanism: &Mechanism, seed: u64) -> Result<Option<Mechanism>, ExactError> {
    let Some(assembly) = &mechanism.assembly else {
        return Ok(None);
    };
    let closed = mechanism.description.couples.is_empty();
    let Some(couples) = closed.then(|| guess(mechanism, assembly)).flatten() else {
        return Ok(None);
    };
    let Some(coupled) = with_couples(mechanism, &couples) else {
        return Ok(None);
    };
    // Couples for its joints, and its loops, to see whether the ones close the others.
    let mut description = (*coupled.description).clone();
    description.loops.clone_from(&mechanism.description.loops);
    let both = Mechanism {
        description: Arc::new(description),
        ..coupled.clone()
    };
    let angles = AngleOrder::of(&both);
    let proved = try_fields(angles, seed, |modulus, seed, _| {
        couples_close_loops(&both, modulus, angles, seed)
    });
    let proved = proved? && coupled.independent() == mechanism.independent();
    Ok(proved.then_some(coupled))
}

/// The mechanism with these couples in place of its loops; `None` if it is none.
pub(crate) fn with_couples(mechanism: &Mechanism, couples: &[Couple]) -> Option<Mechanism> {
    let mut description = (*mechanism.description).clone();
    description.couples = couples.to_vec();
    description.loops.clear();
    let coupled = Mechanism::new(&description).ok()?;
    Some(Mechanism {
        cleaning: mechanism.cleaning.clone(),
        ..coupled
    })
}

/// Couples that hold at the start if G is the same everywhere.
fn guess(mechanism: &Mechanism, assembly: &Assembly) -> Option<Vec<Couple>> {
    let m = assembly.independent.len();
    let zeros = vec![0.0; m];
    let transmission = |q: &[f64]| {
        let qa: Vec<f64> = assembly.independent.iter().map(|&k| q[k]).collect();
        let motion = assembly.linkage.motion(assembly, q, [&qa, &zeros, &zeros]);
        motion.ok().map(|motion| motion.g)
    };
    let g = transmission(&assembly.start)?;
    let mut walk = Walk::new(assembly, SEED);
    for _ in 0..CONFIGURATIONS {
        let other = transmission(&walk.next_configuration()?)?;
        let pairs = g.iter().flatten().zip(other.iter().flatten());
        if pairs.into_iter().any(|(a, b)| (a - b).abs() > GUESS) {
            return None;
        }
    }
    let joints = mechanism.moving().skip(mechanism.base_variables());
    let links: Vec<_> = joints.collect();
    let couple = |&k: &usize| {
        let mut offset = assembly.start[k];
        let mut terms = Vec::new();
        for (&x, &source) in g[k].iter().zip(&assembly.independent) {
            if x.abs() > GUESS {
                let (text, value) = fraction(x)?;
                offset -= value * assembly.start[source];
                terms.push(Term {
                    joint: links[source].name.clone(),
                    multiplier: Quantity::parse_number(&text, &[]).ok()?,
                });
            }
        }
        let offset = match links[k].joint {
            JointKind::Revolute => angle(offset)?,
            _ => Quantity::parse_length(&decimal(offset), &[]).ok()?,
        };
        Some(Couple {
            joint: links[k].name.clone(),
            terms,
            offset,
            expression: None,
        })
    };
    assembly.dependent().iter().map(couple).collect()
}

/// `-3/2` and its value, if x is such.
fn fraction(x: f64) -> Option<(String, f64)> {
    let near = |d: &i32| (x * f64::from(*d) - (x * f64::from(*d)).round()).abs() < GUESS;
    let d = (1..=LARGEST_DENOMINATOR).find(near)?;
    let numerator = (x * f64::from(d)).round();
    let text = match d {
        1 => format!("{numerator}"),
        _ => format!("{numerator}/{d}"),
    };
    Some((text, numerator / f64::from(d)))
}

/// A part of a half turn, else a decimal.
fn angle(x: f64) -> Option<Quantity> {
    let text = match fraction(x / std::f64::consts::PI) {
        Some((text, _)) if text == "0" || text == "-0" => "0".to_owned(),
        Some((text, _)) => format!("{text}*pi"),
        None => decimal(x),
    };
    Quantity::parse_angle(&text, &[]).ok()
}

/// Without what rounding has left.
fn decimal(x: f64) -> String {
    let text = format!("{x:.9}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0" } else { text }.to_owned()
}
