//! Links by kinds of parameters: the tree and what becomes of each link's parameters.

use roberval_base::BaseParameters;
use roberval_mechanism::ParameterKind;

use super::html::{figure, kept, short, text};
use super::tree;
use crate::base::Class;
use crate::number::shortest;
use crate::relation::Label;

pub(super) fn section(answer: &BaseParameters) -> String {
    let key = [
        Class::Unchanged,
        Class::RegroupedInto,
        Class::Regrouped,
        Class::NoEffect,
    ];
    let key: Vec<String> = key
        .iter()
        .map(|c| {
            format!(
                "<li><span class=\"c {}\">{}</span>{}</li>",
                style(*c),
                c.mark(),
                words(*c)
            )
        })
        .collect();
    let caption = "Each row is a link with its joint, in the tree it hangs in: a disc turns, a \
                   square slides. XX to ZZ are moments and products of inertia about the origin \
                   of the link's frame, MX MY MZ the first moments, M the mass, Ia the rotor.";
    format!(
        "<section><h2>What each link keeps</h2><ul class=\"key\">{}</ul>{}</section>",
        key.concat(),
        figure(
            "Classification of the parameters, links by kinds",
            &table(answer),
            caption
        )
    )
}

fn table(answer: &BaseParameters) -> String {
    let mechanism = &answer.mechanism;
    let rows = tree::rows(mechanism);
    let widest = tree::widest(&rows);
    let (classes, kept, tips) = (Class::all(answer), kept(answer), tips(answer));
    let mut body = String::new();
    for row in &rows {
        let Some(j) = row.link else {
            let lanes = tree::lanes(mechanism, row, widest, "base");
            body.push_str(&format!(
                "<tr><td class=\"lane\">{lanes}</td><td class=\"name soft\">base</td><td colspan=\"12\"></td></tr>"
            ));
            continue;
        };
        let (link, (count, all)) = (&mechanism.links[j], kept[j]);
        let lanes = tree::lanes(mechanism, row, widest, &format!("n{count}"));
        body.push_str(&format!(
            "<tr><td class=\"lane\">{lanes}</td><th scope=\"row\" class=\"name m\" title=\"link {0}, {1}: {count} of {all} parameters kept\">{2}</th>",
            text(&link.name),
            tree::joint(mechanism, j),
            text(&short(&link.name, 28)),
        ));
        let first = answer.parameters.first_column(j);
        for k in 0..ParameterKind::ALL.len() {
            if k < all {
                let class = classes[first + k];
                body.push_str(&format!(
                    "<td class=\"c m {}\" title=\"{}\">{}</td>",
                    style(class),
                    text(&tips[first + k]),
                    class.mark()
                ));
            } else {
                body.push_str("<td class=\"c\"></td>");
            }
        }
        body.push_str(&format!("<td class=\"kept\">{count} of {all}</td></tr>"));
    }
    let kinds: Vec<String> = ParameterKind::ALL
        .iter()
        .map(|k| format!("<th scope=\"col\">{k}</th>"))
        .collect();
    format!(
        "<table class=\"grid\"><thead><tr><th></th><th class=\"name\">link</th>{}<th class=\"kept\">kept</th></tr></thead><tbody>{body}</tbody></table>",
        kinds.concat()
    )
}

/// What becomes of each parameter, in words.
fn tips(answer: &BaseParameters) -> Vec<String> {
    /// Sums that take up a parameter; a humanoid's masses go into dozens.
    const MOST: usize = 6;
    let mut into: Vec<Vec<String>> = vec![Vec::new(); answer.parameters.len()];
    let mut from = vec![0; answer.parameters.len()];
    for relation in answer.relations() {
        from[relation.base] = relation.terms.len();
        let sum = Label::of_base(answer, relation.base).text();
        for (column, coefficient) in relation.terms {
            into[column].push(format!("{sum} ({})", shortest(coefficient)));
        }
    }
    let classes = Class::all(answer);
    (0..classes.len())
        .map(|column| {
            let label = Label::of(answer, column).text();
            match classes[column] {
                Class::NoEffect => format!("{label} has no effect on the motion"),
                Class::Unchanged => format!("{label} is a base parameter as it stands"),
                Class::RegroupedInto => {
                    let s = if from[column] == 1 { "" } else { "s" };
                    format!("{label} takes up {} other parameter{s}", from[column])
                }
                Class::Regrouped => {
                    let sums = &into[column];
                    let more = match sums.len().saturating_sub(MOST) {
                        0 => String::new(),
                        n => format!(" and {n} more"),
                    };
                    let shown = &sums[..sums.len().min(MOST)];
                    format!("{label} acts only inside {}{more}", shown.join(", "))
                }
            }
        })
        .collect()
}

fn style(class: Class) -> &'static str {
    match class {
        Class::NoEffect => "none",
        Class::Unchanged => "keep",
        Class::RegroupedInto => "into",
        Class::Regrouped => "away",
    }
}

fn words(class: Class) -> &'static str {
    match class {
        Class::NoEffect => "no effect",
        Class::Unchanged => "kept, unchanged",
        Class::RegroupedInto => "kept, others regroup into it",
        Class::Regrouped => "regrouped away",
    }
}
