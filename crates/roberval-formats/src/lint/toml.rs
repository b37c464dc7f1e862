//! A robot TOML.

use roberval_mechanism::{Mechanism, RobotDescription};

use super::{Finding, Rule, rounded};
use crate::error::{Code, FormatError};
use crate::source::Source;
use crate::toml::{change_key, parse_toml, with_spans};

pub(super) fn findings(text: &str, name: &str) -> Result<Vec<Finding>, FormatError> {
    let source = Source::new(name, text)?;
    let description = match parse_toml(text, name) {
        Ok(description) => description,
        Err(error) if error.code == Code::Toml => return Err(error),
        Err(error) => return Ok(vec![Finding::refused(error)]),
    };
    let remark = |what: &String| Finding::new(Rule::Remark, name, what.clone(), "");
    let mut findings: Vec<Finding> = description.warnings.iter().map(remark).collect();
    with_spans(&source, &description, |span| {
        let position = |link: Option<&str>, key: &str, index: Option<usize>| {
            let range = span(link, key, index)?;
            Some(source.position(range.start))
        };
        findings.extend(rounded(name, &description, |change| {
            let (key, index) = change_key(change);
            position(change.link.as_deref(), &key, index)
        }));
        for (link, what) in impossible(&description) {
            let what = format!("link {link:?}: {what}");
            let remedy = "no body is like this: parameters are about the origin of the link's \
                          frame, the products of inertia with the tensor's sign";
            let mut finding = Finding::new(Rule::Inertia, name, what, remedy);
            finding.position = position(Some(&link), "inertia", None);
            findings.push(finding);
        }
    })?;
    Ok(findings)
}

/// Links whose inertia no body has, and why.
fn impossible(description: &RobotDescription) -> Vec<(String, String)> {
    let Ok(mechanism) = Mechanism::new(description) else {
        return Vec::new();
    };
    let links = mechanism.links.iter();
    links
        .filter_map(|link| Some((link.name.clone(), link.unphysical()?.to_string())))
        .collect()
}
