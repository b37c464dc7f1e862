//! A robot TOML.

use std::collections::HashSet;
use std::ops::Range;

use roberval_mechanism::{Mechanism, RobotDescription};

use super::{Finding, Rule, rounded};
use crate::error::{Code, FormatError};
use crate::source::Source;
use crate::suspects::in_degrees;
use crate::toml::{negatives, noticed, read, with_places};
use crate::words::quoted;

/// What to do about a remark that the program which wrote the file has left in it.
const NOT_READ: &str = "the parameters are those of the robot as it was read";

pub(super) fn findings(text: &str, name: &str) -> Result<Vec<Finding>, FormatError> {
    let source = Source::new(name, text)?.collecting();
    let description = match read(&source) {
        Ok(description) => description,
        Err(error) if error.code == Code::Toml => return Err(error),
        Err(error) => {
            let errors = source.take_faults().into_iter().chain([error]);
            return Ok(errors.map(Finding::refused).collect());
        }
    };
    let faults = source.take_faults().into_iter();
    let mut findings: Vec<Finding> = faults.map(Finding::refused).collect();
    let told = description.warnings.iter();
    let told = told.filter(|w| !noticed(&description).contains(w));
    findings.extend(told.map(|what| Finding::new(Rule::Remark, name, what.clone(), NOT_READ)));
    with_places(&source, |places| {
        let position = |range: Range<usize>| source.position(range.start);
        let roundings = rounded(name, &description, |change| {
            places.change(change).map(position)
        });
        findings.extend(roundings);
        for (link, key, mut finding) in suspicious(&description, name) {
            finding.position = places.value(Some(&link), key, None).map(position);
            findings.push(finding);
        }
    })?;
    Ok(findings)
}

/// Links whose inertia no body has and angles that look like degrees: the link, the key and
/// what is wrong.
fn suspicious(robot: &RobotDescription, file: &str) -> Vec<(String, &'static str, Finding)> {
    let mut found = Vec::new();
    let mut find = |link: &str, key, rule, what: String, remedy: String| {
        let what = format!("link {}: {what}", quoted(link));
        let finding = Finding::new(rule, file, what, remedy);
        found.push((link.to_owned(), key, finding));
    };
    let mut told = HashSet::new();
    let mechanism = Mechanism::new(robot);
    for link in mechanism.iter().flat_map(|m| &m.links) {
        if let Some(what) = link.unphysical() {
            let remedy = "no body is like this: parameters are about the origin of the link's \
                          frame, the products of inertia with the tensor's sign";
            find(
                &link.name,
                "inertia",
                Rule::Inertia,
                what.to_string(),
                remedy.to_owned(),
            );
            told.insert(link.name.clone());
        }
    }
    for link in &robot.links {
        for what in negatives(link).filter(|_| !told.contains(&link.name)) {
            let remedy = "no body is like this: look for a wrong sign".to_owned();
            let what = format!("{what} is negative");
            find(&link.name, "inertia", Rule::Inertia, what, remedy);
        }
        if let Some((key, angle)) = in_degrees(link) {
            let what = format!("the angle {} is more than a full turn", angle.text);
            let remedy = format!("is it in degrees? write \"{} deg\"", angle.text);
            find(&link.name, key, Rule::Degrees, what, remedy);
        }
    }
    found
}
