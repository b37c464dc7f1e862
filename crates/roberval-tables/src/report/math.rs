//! The relations, typeset by the browser itself (MathML).

use std::collections::HashMap;

use roberval_base::{BaseParameters, ExactNumber};

use super::html::text;
use crate::escape::plain;
use crate::number::shortest;
use crate::relation::{self, Label, Sum};

pub(super) fn section(answer: &BaseParameters) -> String {
    let sums = relation::of(answer);
    let exact = Coefficients::of(answer);
    let lines: Vec<String> = sums.iter().map(|sum| relation(&exact, sum)).collect();
    let tally = answer.tally();
    let lead = match (tally.regrouped_into, tally.unchanged) {
        (0, _) => "Nothing regroups: every base parameter is a standard parameter.".to_owned(),
        (into, unchanged) => format!(
            "Parameters with an R are sums, and nothing inside a sum can be told apart by any \
             motion. These are {into} of the {} base parameters; the other {unchanged} stay as \
             they are.",
            tally.base
        ),
    };
    format!(
        "<section><h2>How the parameters regroup</h2><p>{lead}</p>{}</section>",
        lines.concat()
    )
}

/// Between two terms: a line may break before the sign, not after it.
const PLUS: &str = " +\u{a0}";
const MINUS: &str = " \u{2212}\u{a0}";

/// Of a sum with more members than this, a humanoid's masses, those after the first are written
/// without MathML, which is five times as long and looks the same.
const MOST: usize = 8;

/// One relation; a line may break between its terms.
fn relation(exact: &Coefficients<'_>, sum: &Sum) -> String {
    let mut line = math(&format!(
        "{}<mo>=</mo>{}",
        label(&sum.left),
        label(&sum.first)
    ));
    for group in &sum.groups {
        let minus = group.coefficient < 0.0;
        let factor = match group.coefficient.abs() {
            1.0 => String::new(),
            x => {
                let number = coefficient(exact.get(sum, &group.members[0]), x);
                number + "<mspace width=\"0.17em\"/>"
            }
        };
        let last = group.members.len() - 1;
        for (i, member) in group.members.iter().enumerate() {
            line.push_str(if i == 0 && minus { MINUS } else { PLUS });
            if i > 0 && last > MOST {
                line.push_str(&light(member));
                line.push_str(if i == last { ")" } else { "" });
                continue;
            }
            let mut term = String::new();
            if i == 0 {
                term.push_str(&factor);
            }
            if i == 0 && last > 0 {
                term.push_str("<mo stretchy=\"false\">(</mo>");
            }
            term.push_str(&label(member));
            if i == last && last > 0 {
                term.push_str("<mo stretchy=\"false\">)</mo>");
            }
            line.push_str(&math(&term));
        }
    }
    format!("<p class=\"rel\">{line}</p>")
}

fn math(content: &str) -> String {
    format!("<math>{content}</math>")
}

/// ZZR with the link's name below.
fn label(label: &Label) -> String {
    let r = if label.regrouped { "R" } else { "" };
    format!(
        "<msub><mi>{}{r}</mi><mi>{}</mi></msub>",
        label.kind,
        text(&plain(&label.link))
    )
}

/// The same as plain text with a subscript.
fn light(label: &Label) -> String {
    let link = text(&plain(&label.link));
    format!("{}<sub>{link}</sub>", label.kind)
}

/// A factor: a decimal where it is short, else the exact fraction or root where known.
fn coefficient(exact: Option<&ExactNumber>, x: f64) -> String {
    /// Decimals of more characters are fractions or roots, most likely.
    const SHORT: usize = 9;
    let decimal = shortest(x);
    if decimal.len() <= SHORT {
        return format!("<mn>{decimal}</mn>");
    }
    let exact = exact.and_then(|number| typeset(&number.to_string()));
    exact.unwrap_or_else(|| format!("<mn>{decimal}</mn>"))
}

/// Where the exact coefficients stand.
struct Coefficients<'a> {
    beta: Option<&'a Vec<Vec<ExactNumber>>>,
    rows: HashMap<String, usize>,
    columns: HashMap<String, usize>,
}

impl<'a> Coefficients<'a> {
    fn of(answer: &'a BaseParameters) -> Self {
        let places = |columns: &[usize]| {
            let key = |(i, &column)| (Label::of(answer, column).text(), i);
            columns.iter().enumerate().map(key).collect()
        };
        Self {
            beta: answer.beta_exact.as_ref(),
            rows: places(&answer.base),
            columns: places(&answer.regrouped),
        }
    }

    /// The exact coefficient of a term, where there is one.
    fn get(&self, sum: &Sum, member: &Label) -> Option<&ExactNumber> {
        let row = self.beta?.get(*self.rows.get(&sum.first.text())?)?;
        let number = row.get(*self.columns.get(&member.text())?)?;
        number.is_exact().then_some(number)
    }
}

/// The size of `1/2`, `-3/4 sqrt(2)` and the like; sums and long fractions stay decimals.
fn typeset(number: &str) -> Option<String> {
    /// Longer fractions say less than their decimals.
    const LONGEST: usize = 12;
    let number = number.trim_start_matches('-');
    if number.len() > LONGEST + "sqrt()".len() || number.contains(" + ") || number.contains(" - ") {
        return None;
    }
    let (fraction, root) = match number.split_once(" sqrt(") {
        Some((fraction, root)) => (fraction, Some(root.trim_end_matches(')'))),
        None => (number, None),
    };
    if fraction.len() > LONGEST {
        return None;
    }
    let root = root.map_or(String::new(), |n| format!("<msqrt><mn>{n}</mn></msqrt>"));
    Some(match fraction.split_once('/') {
        Some(("1", below)) if !root.is_empty() => {
            format!("<mfrac>{root}<mn>{below}</mn></mfrac>")
        }
        Some((above, below)) => format!("<mfrac><mn>{above}</mn><mn>{below}</mn></mfrac>{root}"),
        None if fraction == "1" => root,
        None => format!("<mn>{fraction}</mn>{root}"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fractions_and_roots_are_typeset_and_long_numbers_left() {
        assert_eq!(
            typeset("-1/3").as_deref(),
            Some("<mfrac><mn>1</mn><mn>3</mn></mfrac>")
        );
        assert_eq!(
            typeset("1/2 sqrt(3)").as_deref(),
            Some("<mfrac><msqrt><mn>3</mn></msqrt><mn>2</mn></mfrac>")
        );
        assert_eq!(typeset("1/2 + 3/4 sqrt(2)"), None);
        assert_eq!(typeset("123456789/1234567890123"), None);
    }
}
