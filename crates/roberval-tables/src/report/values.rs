//! Values: what the robot file gives, and what motion can tell of it.

use roberval_base::BaseParameters;

use super::html::{list, text};
use crate::base::rounded_values;
use crate::number::shortest;
use crate::relation::Label;

pub(super) fn section(answer: &BaseParameters) -> String {
    let Some(rows) = rounded_values(answer) else {
        return "<section><h2>Values</h2><p>The robot file gives no inertial values. None are \
                needed: everything on this page follows from the geometry alone.</p></section>"
            .to_owned();
    };
    let rows: Vec<String> = rows
        .iter()
        .map(|(label, x, xb)| row(label, *x, *xb))
        .collect();
    format!(
        "<section><h2>Values</h2>{}<p>In SI units, about the origin of the link's frame and in that \
         frame. What the robot file does not give counts as 0.</p><div class=\"scroll\" tabindex=\"0\">\
         <table><thead><tr><th>parameter</th><th class=\"num\">in the file</th><th class=\"num\">base \
         parameter</th></tr></thead><tbody>{}</tbody></table></div></section>",
        impossible(answer),
        rows.concat()
    )
}

fn row(label: &Label, x: f64, xb: f64) -> String {
    format!(
        "<tr><td>{}</td><td class=\"num\">{}</td><td class=\"num\">{}</td></tr>",
        text(&label.text()),
        shortest(x),
        shortest(xb)
    )
}

/// Links whose inertia no body has.
fn impossible(answer: &BaseParameters) -> String {
    let links = answer.mechanism.links.iter();
    let faults: Vec<String> = links
        .filter_map(|link| Some(format!("link {}: {}", link.name, link.unphysical()?)))
        .collect();
    if faults.is_empty() {
        return String::new();
    }
    format!(
        "<p class=\"doubt\">{} with an inertia that no body has</p>{}",
        if faults.len() == 1 {
            "1 link".to_owned()
        } else {
            format!("{} links", faults.len())
        },
        list(&faults)
    )
}
