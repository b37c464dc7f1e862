//! `roberval lint`: what is wrong or suspicious in robot files.

use std::io::Write;

use roberval_formats::{Finding, Rule, Severity, lint};
use roberval_tables::{self as tables, FindingRow};

use crate::arguments::LintArgs;
use crate::commands::answer;
use crate::error::CliError;
use crate::look::Look;
use crate::{BAD_INPUT, CLEAR, FOUND, say};

/// Lists the findings of all files; one that cannot be read does not stop the others.
pub(crate) fn run(
    args: &LintArgs,
    out: &mut dyn Write,
    err: &mut dyn Write,
    look: Look,
) -> Result<i32, CliError> {
    check_rules(&args.ignore)?;
    let (mut findings, mut unread) = (Vec::new(), 0);
    for file in &args.files {
        match lint(file) {
            Ok(found) => findings.extend(found),
            Err(error) => {
                say(err, "error", &error.to_string());
                unread += 1;
            }
        }
    }
    findings.retain(|f| !args.ignore.contains(&f.rule.name()));
    findings.retain(|f| !args.errors_only || f.severity == Severity::Error);
    let rows: Vec<FindingRow> = findings.iter().map(row).collect();
    answer(&args.output, out, look, |format| {
        Ok(tables::lint(&rows, format))
    })?;
    let errors = findings
        .iter()
        .filter(|f| f.severity == Severity::Error)
        .count();
    let warnings = findings.len() - errors;
    let files = args.files.len() - unread;
    let some = |count: usize, what: &str| match count {
        1 => format!("1 {what}"),
        _ => format!("{count} {what}s"),
    };
    let tally = format!(
        "{}, {} in {}",
        some(errors, "error"),
        some(warnings, "warning"),
        some(files, "file")
    );
    if files > 0 {
        say(err, "note", &tally);
    }
    let rounded = |f: &&Finding| matches!(f.rule, Rule::RoundedAngle | Rule::Dust);
    if let Some(first) = findings.iter().find(rounded) {
        // A text read instead of a file has a longer name.
        let asked = args.files.iter().find(|file| first.file.starts_with(*file));
        let advice = format!(
            "roberval clean {} -o FILE sets rounded numbers right and nothing else",
            asked.unwrap_or(&first.file)
        );
        say(err, "note", &advice);
    }
    Ok(match (unread, findings.len()) {
        (0, 0) => CLEAR,
        (0, _) => FOUND,
        _ => BAD_INPUT,
    })
}

/// Refuses names that no rule has; codes of errors are taken as they come.
fn check_rules(ignored: &[String]) -> Result<(), CliError> {
    let names = Rule::NAMED.map(Rule::name);
    let code = |name: &str| name.starts_with('E') && name.len() == 4;
    match ignored
        .iter()
        .find(|rule| !names.contains(rule) && !code(rule))
    {
        None => Ok(()),
        Some(rule) => Err(CliError::Usage(format!(
            "--ignore: there is no rule {rule:?}; rules are {} and codes such as E240",
            names.join(", ")
        ))),
    }
}

fn row(finding: &Finding) -> FindingRow {
    FindingRow {
        file: finding.file.clone(),
        line: finding.position.map(|p| p.line),
        column: finding.position.map(|p| p.column),
        severity: finding.severity.name(),
        rule: finding.rule.name(),
        what: finding.what.clone(),
        remedy: finding.remedy.clone(),
        line_of_text: finding.to_string(),
    }
}
