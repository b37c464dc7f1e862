//! What is wrong or suspicious in a robot file: all of it, with line and remedy.

mod finding;
mod inertial;
mod joints;
mod toml;
mod urdf;

use roberval_mechanism::{Change, CleanPolicy, Cleaned, RobotDescription, Unit, clean};

pub use finding::{Finding, Rule, Severity};

use crate::error::{FormatError, Position};
use crate::load::{Kind, stand_in, with_text};

/// Everything that is wrong or suspicious in a robot file, in the order of the file.
///
/// A file that can be read but is no valid robot has findings of [`Severity::Error`].
///
/// # Errors
/// The file cannot be read as text, XML or TOML at all, or it is of another format.
pub fn lint(path_or_name: &str) -> Result<Vec<Finding>, FormatError> {
    let mut findings = with_text(path_or_name, |text, name, kind| match kind {
        Kind::Toml => toml::findings(text, name),
        Kind::Urdf => urdf::findings(text, name),
    })?;
    if let Some((Kind::Toml, _)) = stand_in(path_or_name) {
        of_translation(&mut findings, path_or_name);
    }
    findings.sort_by_key(|f| f.position.map(|p| (p.line, p.column)));
    findings.dedup();
    Ok(findings)
}

/// Nobody wrote the numbers of a translation and nobody has its lines: what is left is what
/// concerns the file itself.
fn of_translation(findings: &mut Vec<Finding>, file: &str) {
    findings.retain(|f| !matches!(f.rule, Rule::RoundedAngle | Rule::Dust));
    for finding in findings {
        file.clone_into(&mut finding.file);
        finding.position = None;
    }
}

/// Numbers that look rounded, whatever became of them; `position` finds them in the file.
fn rounded(
    file: &str,
    description: &RobotDescription,
    position: impl Fn(&Change) -> Option<Position>,
) -> Vec<Finding> {
    let Cleaned {
        changes,
        near_misses,
        ..
    } = clean(description, &CleanPolicy::default());
    let near = near_misses.iter().map(|n| &n.change);
    let worth = changes.iter().filter(|c| !c.is_last_digit()).chain(near);
    worth
        .map(|change| {
            let (rule, remedy) = match change.field.unit() {
                Unit::Angle => (Rule::RoundedAngle, format!("write {}", exact(change))),
                Unit::Length | Unit::Direction => (Rule::Dust, "write 0".to_owned()),
            };
            let mut finding = Finding::new(rule, file, change.to_string(), remedy);
            finding.position = position(change);
            finding
        })
        .collect()
}

/// The number meant, with all its digits.
fn exact(change: &Change) -> String {
    match change.became.text.as_str() {
        text if text.parse::<f64>().is_ok() => text.to_owned(),
        text => format!("{:?} ({text})", change.became.value),
    }
}
