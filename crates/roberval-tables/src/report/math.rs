//! The relations, typeset by the browser itself (MathML).

use roberval_base::BaseParameters;

use super::html::text;
use crate::escape::plain;
use crate::number::shortest;
use crate::relation::{self, Label, Sum, Surd};

pub(super) fn section(answer: &BaseParameters) -> String {
    let sums = relation::of(answer);
    let lines: Vec<String> = sums.iter().map(relation).collect();
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

const SPACE: &str = "<mspace width=\"0.17em\"/>";

/// Of a sum with more members than this, a humanoid's masses, those after the first are written
/// without MathML, which is five times as long and looks the same.
const MOST: usize = 8;

/// One relation; a line may break between its terms.
fn relation(sum: &Sum) -> String {
    let mut line = math(&format!(
        "{}<mo>=</mo>{}",
        label(&sum.left),
        label(&sum.first)
    ));
    for group in &sum.groups {
        let minus = group.coefficient < 0.0;
        let factor = match (&group.exact, group.coefficient.abs()) {
            (Some(exact), _) => typeset(exact) + SPACE,
            (None, 1.0) => String::new(),
            (None, x) => format!("<mn>{}</mn>{SPACE}", shortest(x)),
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

fn typeset(exact: &Surd) -> String {
    let root = exact.root.as_ref();
    let root = root.map_or(String::new(), |n| format!("<msqrt><mn>{n}</mn></msqrt>"));
    let above = match exact.above.as_str() {
        "1" if !root.is_empty() => root,
        above => format!("<mn>{above}</mn>{root}"),
    };
    match &exact.below {
        Some(below) => format!("<mfrac><mrow>{above}</mrow><mn>{below}</mn></mfrac>"),
        None => above,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fractions_and_roots_are_typeset() {
        let typeset = |number| Surd::of(number, "0.333333333333").map(|s| typeset(&s));
        let fraction = "<mfrac><mrow><mn>1</mn></mrow><mn>3</mn></mfrac>";
        assert_eq!(typeset("-1/3").as_deref(), Some(fraction));
        let root = "<mfrac><mrow><msqrt><mn>3</mn></msqrt></mrow><mn>2</mn></mfrac>";
        assert_eq!(typeset("1/2 sqrt(3)").as_deref(), Some(root));
        assert_eq!(
            typeset("7 sqrt(2)").as_deref(),
            Some("<mn>7</mn><msqrt><mn>2</mn></msqrt>")
        );
    }
}
