//! What was decided about a robot, in a form that a small separate program can check:
//! `python/roberval/check_certificate.py` builds its own regressor from the geometry
//! written here and accepts or refuses every claim.
//!
//! The certificate is one line of canonical JSON (keys sorted, no spaces, whole numbers
//! and texts only), so that its SHA-256 fixes every byte of it.

mod couples;
mod numbers;

use num_bigint::BigUint;
use roberval_mechanism::{Geometry, JointKind, LinkDescription, Mechanism};
use roberval_regressor::{AngleOrder, AngleUnits, Model};
use roberval_scalar::Quantity;
use serde_json::{Map, Value, json};
use sha2::{Digest, Sha256};

use crate::{ExactDecision, Witness};
use couples::Couples;
use numbers::{Constants, coefficient, exact_text, unit_text};

/// The name of this form of certificate.
const FORMAT: &str = "roberval certificate 1";

/// Coefficients may have had this relative error before they were rounded: beyond it the
/// rounding, and the rank, are doubtful.
const LARGEST_ROUNDING_ERROR: f64 = 1.0 / (1_u64 << 60) as f64;

/// What a certificate records beside the decision; the checker cannot check it.
#[derive(Debug, Clone, Copy, Default)]
pub struct CertificateNotes<'a> {
    /// What cleaning changed in the robot's file, a line each.
    pub changes: &'a [String],
    /// What the float engines make of the robot.
    pub witnesses: &'a [Witness],
}

/// Why there is no certificate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CertificateError {
    /// A float engine decided.
    #[error("only the exact engine gives a certificate: leave the engine at exact")]
    NotExact,
    /// An expression is too long once its constants are written out.
    #[error(
        "{text:?} is longer than {limit} characters with its constants written out: give it as a decimal number"
    )]
    TooLong {
        /// The number as written in the robot's file.
        text: String,
        /// The limit.
        limit: usize,
    },
    /// A multiplier or an axis of coupled joints is no fraction, or its numbers are too large.
    #[error(
        "the joint {joint:?} follows others in a way that has no form in a certificate: its multiplier or axis must be fractions of small numbers"
    )]
    Couple {
        /// The joint.
        joint: String,
    },
    /// The coefficients are not known well enough.
    #[error(
        "coefficients without an exact form are known to {error:.1e} only, so that angles taken as generic may not be: give angles that are related as multiples of pi"
    )]
    Unsure {
        /// The relative error.
        error: f64,
    },
}

/// The certificate of a decision about this mechanism and model. See [`certificate_text`]
/// for the file's content.
///
/// # Errors
/// [`CertificateError`] if a number is too long to be written, or a coefficient not known
/// well enough.
pub fn certificate(
    mechanism: &Mechanism,
    model: Model,
    decision: &ExactDecision,
    notes: CertificateNotes<'_>,
) -> Result<Value, CertificateError> {
    let error = decision.rounding_error;
    // Not a number counts as too large.
    if !error.le(&LARGEST_ROUNDING_ERROR) {
        return Err(CertificateError::Unsure { error });
    }
    let robot = robot(mechanism)?;
    let space = mechanism.parameters();
    let labels = |columns: &[usize]| -> Vec<&str> {
        let label = |&column: &usize| space.labels()[column].as_str();
        columns.iter().map(label).collect()
    };
    let mut content = json!({
        "format": FORMAT,
        "version": env!("CARGO_PKG_VERSION"),
        "sha256": "", // hashed so
        "robot_sha256": sha256(&robot),
        "robot": robot,
        "model": model.name(),
        "order": labels(&decision.order),
        "no_effect": labels(&decision.no_effect),
        "base": labels(&decision.kept),
        "regrouped": labels(&decision.deleted),
        "rank": decision.kept.len(),
        "beta": beta(decision, space.labels()),
        "primes": decision.primes,
        "angle_order": decision.angle_order,
        "generic": decision.generic,
        "degree": decision.degree,
        "failure_log2": failure_log2(decision),
        "seeds": decision.seeds,
        "samples": decision.samples,
        "rounding_error": format!("{error:e}"),
        "changes": notes.changes,
        "witnesses": notes.witnesses.iter().map(witness).collect::<Vec<_>>(),
    });
    content["sha256"] = sha256(&content).into();
    Ok(sorted(content))
}

/// The content of a certificate's file: canonical JSON and a newline.
#[must_use]
pub fn certificate_text(certificate: &Value) -> String {
    format!("{}\n", sorted(certificate.clone()))
}

/// The geometry as decided on, every number exactly.
fn robot(mechanism: &Mechanism) -> Result<Value, CertificateError> {
    let description = &mechanism.description;
    let constants = description.constants.as_slice();
    let units = AngleUnits::of(mechanism, AngleOrder::of(mechanism));
    let couples = Couples::of(mechanism, &units)?;
    let mut variables = 0;
    let links: Vec<Value> = mechanism
        .links
        .iter()
        .map(|link| {
            let variable = (link.joint != JointKind::Fixed).then_some(variables);
            variables += link.joint.dof();
            let antecedent = link.antecedent.map(|a| mechanism.links[a].name.as_str());
            let written = &description.links[link.in_file];
            let (placement, axis) = geometry(written, constants, &units)?;
            Ok(json!({
                "name": link.name,
                "antecedent": antecedent,
                "joint": link.joint.name(),
                "columns": link.columns(),
                "placement": placement,
                "axis": couples.axis(variable, written, axis)?,
                "couple": couples.couple(variable)?,
            }))
        })
        .collect::<Result<_, _>>()?;
    Ok(json!({
        "name": mechanism.name,
        "gravity": vector(&description.gravity, constants)?,
        "links": links,
        "roots": couples.roots(),
    }))
}

/// Moves `["move", x, y, z]` and turns `["turn", axis, s, k, unit]` by s pi + k unit, left to
/// right, from the antecedent's frame to the link's; then the joint axis.
fn geometry(
    link: &LinkDescription,
    constants: &Constants,
    units: &AngleUnits<'_>,
) -> Result<(Vec<Value>, [String; 3]), CertificateError> {
    let length = |x: &Quantity| exact_text(x, constants);
    let zero = || "0".to_owned();
    let turn = |axis: &str, x: &Quantity| {
        let (half_turns, steps, unit) = angle(x, constants, units)?;
        Ok(json!(["turn", axis, half_turns, steps, unit]))
    };
    match &link.geometry {
        Geometry::Mdh(g) => {
            let steps = vec![
                turn("z", &g.gamma)?,
                json!(["move", zero(), zero(), length(&g.b)?]),
                turn("x", &g.alpha)?,
                json!(["move", length(&g.d)?, zero(), zero()]),
                turn("z", &g.theta)?,
                json!(["move", zero(), zero(), length(&g.r)?]),
            ];
            Ok((steps, [zero(), zero(), "1".to_owned()]))
        }
        Geometry::Placed { origins, axis } => {
            let mut steps = Vec::with_capacity(4 * origins.len());
            for origin in origins {
                let [x, y, z] = vector(&origin.xyz, constants)?;
                let [roll, pitch, yaw] = &origin.rpy;
                steps.push(json!(["move", x, y, z]));
                steps.extend([turn("z", yaw)?, turn("y", pitch)?, turn("x", roll)?]);
            }
            Ok((steps, vector(axis, constants)?))
        }
    }
}

/// (s, k, unit) of the angle s pi + k unit.
fn angle(
    x: &Quantity,
    constants: &Constants,
    units: &AngleUnits<'_>,
) -> Result<(String, i64, String), CertificateError> {
    let parts = units.parts(x);
    let (steps, unit) = match parts.multiple {
        Some((unit, steps)) => (steps, unit_text(&units.units()[unit], constants)?),
        None => (0, "0".to_owned()),
    };
    Ok((parts.half_turns.to_string(), steps, unit))
}

fn vector(v: &[Quantity; 3], constants: &Constants) -> Result<[String; 3], CertificateError> {
    let text = |k: usize| exact_text(&v[k], constants);
    Ok([text(0)?, text(1)?, text(2)?])
}

/// The entries that are not zero: base parameter, regrouped parameter, value.
fn beta(decision: &ExactDecision, labels: &[String]) -> Vec<Value> {
    let mut entries = Vec::new();
    for (&base, row) in decision.kept.iter().zip(&decision.beta) {
        for (&regrouped, x) in decision.deleted.iter().zip(row) {
            if !x.is_zero() {
                entries.push(json!([labels[base], labels[regrouped], coefficient(x)]));
            }
        }
    }
    entries
}

/// The least k such that `(b degree)^primes / product of primes < 2^k` is seen from the
/// bit lengths of both (Schwartz and Zippel: a field misses rank with at most this
/// probability).
fn failure_log2(decision: &ExactDecision) -> i64 {
    let one_field = BigUint::from(decision.kept.len()) * decision.degree;
    let numerator = one_field.pow(decision.primes.len() as u32);
    let denominator: BigUint = decision.primes.iter().product();
    numerator.bits() as i64 - denominator.bits() as i64 + 1
}

fn witness(witness: &Witness) -> Value {
    let gap = |gap: Option<f64>| gap.map(|x| format!("{x:e}"));
    json!({
        "engine": witness.engine.name(),
        "rank": witness.rank,
        "gap": gap(witness.gap),
        "gap_at_structural": gap(witness.gap_at_structural),
    })
}

/// The SHA-256 of what the analysis depends on in a robot: a certificate's `robot_sha256`.
///
/// # Errors
/// [`CertificateError::TooLong`] if a number is too long to be written.
pub fn robot_sha256(mechanism: &Mechanism) -> Result<String, CertificateError> {
    Ok(sha256(&robot(mechanism)?))
}

fn sha256(value: &Value) -> String {
    let digest = Sha256::digest(sorted(value.clone()).to_string());
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The same with the keys of every object in order.
fn sorted(value: Value) -> Value {
    match value {
        Value::Object(entries) => {
            let mut entries: Vec<_> = entries.into_iter().collect();
            entries.sort_by(|(a, _), (b, _)| a.cmp(b));
            let entries = entries.into_iter().map(|(key, v)| (key, sorted(v)));
            Value::Object(entries.collect::<Map<_, _>>())
        }
        Value::Array(items) => items.into_iter().map(sorted).collect(),
        other => other,
    }
}
