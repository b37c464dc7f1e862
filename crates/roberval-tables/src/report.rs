//! The answer as a page to look at: one HTML file that needs nothing else.
//!
//! The page may load nothing and run nothing but the one constant script below, which its
//! content security policy names by its hash. Texts from robot files are escaped by
//! [`html::text`] wherever they stand.

mod decision;
mod downloads;
mod grid;
mod heat;
pub(crate) mod html;
mod math;
mod skeleton;
mod spectrum;
mod symbols;
mod tree;
mod values;

use roberval_base::BaseParameters;

use crate::robot;
use html::text;

const STYLE: &str = include_str!("report/style.css");
const SCRIPT: &str = include_str!("report/script.js");

/// The page.
pub(crate) fn page(answer: &BaseParameters) -> String {
    let name = text(&answer.mechanism.name);
    let policy = format!(
        "default-src 'none'; style-src '{}'; script-src '{}'; base-uri 'none'; form-action 'none'",
        downloads::hash(STYLE),
        downloads::hash(SCRIPT)
    );
    let sections = [
        head(answer),
        skeleton::section(answer),
        grid::section(answer),
        math::section(answer),
        symbols::section(answer),
        heat::section(answer),
        values::section(answer),
        spectrum::section(answer),
        decision::section(answer),
    ];
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\">\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <meta name=\"referrer\" content=\"no-referrer\">\
         <title>Base parameters of {name}</title><style>{STYLE}</style></head>\n\
         <body><main>\n{}\n</main>{}<script>{SCRIPT}</script></body></html>\n",
        sections.join("\n"),
        footer(),
    )
}

/// The answer in a sentence, its counts, and the files.
fn head(answer: &BaseParameters) -> String {
    let tally = answer.tally();
    let tile = |class: &str, count: usize, what: &str| {
        format!("<li class=\"{class}\"><b>{count}</b>{what}</li>")
    };
    let tiles = [
        tile("", tally.standard, "standard parameters"),
        tile("main", tally.base, "base parameters: what motion tells"),
        tile("", tally.unchanged, "of them stay as they are"),
        tile("", tally.regrouped_into, "of them take up others"),
        tile("", tally.regrouped, "are regrouped away"),
        tile("", tally.no_effect, "have no effect at all"),
    ];
    format!(
        "<header><p class=\"kicker\">Base inertial parameters</p><h1>{}</h1>\
         <p class=\"lead\">{}</p>{}</header><ul class=\"tiles\">{}</ul>\
         <p class=\"soft\">{}</p>{}",
        text(&answer.mechanism.name),
        sentence(answer),
        verdict(answer),
        tiles.concat(),
        text(&robot::joints_and_gravity(&answer.mechanism)),
        downloads::links(answer),
    )
}

fn sentence(answer: &BaseParameters) -> String {
    let tally = answer.tally();
    let are = |n: usize| if n == 1 { "is" } else { "are" };
    let base = format!(
        "Of the {} standard inertial parameters, {} what the motion of this robot can tell",
        tally.standard,
        if tally.base == 1 {
            "one is".to_owned()
        } else {
            format!("{} combinations are", tally.base)
        },
    );
    let mut text = format!(
        "{base}: {} {} a parameter as it stands, {} {} a sum.",
        tally.unchanged,
        are(tally.unchanged),
        tally.regrouped_into,
        are(tally.regrouped_into)
    );
    if tally.regrouped > 0 {
        text.push_str(&format!(
            " {} others act only inside those sums.",
            tally.regrouped
        ));
    }
    text
}

/// Whether the count is sure, in a word.
fn verdict(answer: &BaseParameters) -> String {
    let diagnosis = &answer.diagnosis;
    if !diagnosis.clear {
        return "<p class=\"doubt\">The count is in doubt: see below</p>".to_owned();
    }
    match &diagnosis.structure {
        Some(_) => "<p class=\"sure\">Decided exactly, without a tolerance</p>".to_owned(),
        None => "<p class=\"sure\">The gap is clear</p>".to_owned(),
    }
}

fn footer() -> String {
    format!(
        "<footer>Written by roberval {} (schema {}). Method: M. Gautier, <i>Numerical calculation \
         of the base inertial parameters of robots</i>, Journal of Robotic Systems 8(4), 1991. \
         This page loads nothing from anywhere.</footer>",
        env!("CARGO_PKG_VERSION"),
        crate::SCHEMA
    )
}
