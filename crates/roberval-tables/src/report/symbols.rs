//! The relations once more with the file's named constants, where it has some.

use roberval_base::{BaseParameters, Choice};
use roberval_symbolic::{Naming, SymbolicOptions, SymbolicRelations, symbolic_relations};

use super::html::text;
use crate::symbolic::{formulas, verified};

/// Of robots with more links the relations in symbols are too many for a page, and take long.
const MOST_LINKS: usize = 16;

pub(super) fn section(answer: &BaseParameters) -> String {
    if answer.regrouped_into.is_empty() {
        return String::new();
    }
    let body = match relations(answer) {
        Some(symbolic) => lines(&symbolic),
        None => {
            "<p class=\"soft\">The same with lengths and angles as symbols: <code>roberval base \
                 FILE --symbolic</code>, for chains, trees and couples by multipliers.</p>"
                .to_owned()
        }
    };
    format!("<section>{body}</section>")
}

/// The relations in the constants that the file names; `None` if it names none, or they are
/// not found.
fn relations(answer: &BaseParameters) -> Option<SymbolicRelations> {
    let mechanism = &answer.mechanism;
    if mechanism.description.constants.is_empty() || mechanism.links.len() > MOST_LINKS {
        return None;
    }
    let order = match answer.choice {
        Choice::Paper => None,
        _ => Some(answer.decision.as_ref()?.order.clone()),
    };
    let options = SymbolicOptions {
        model: answer.model,
        naming: Naming::Auto,
        order,
        seed: answer.seed,
        ..SymbolicOptions::default()
    };
    let symbolic = symbolic_relations(mechanism, &options).ok()?;
    // At special values they are not those above.
    let same = symbolic.base == answer.base && symbolic.special.is_empty();
    (same && symbolic.named.symbols.iter().any(|s| !s.made)).then_some(symbolic)
}

fn lines(symbolic: &SymbolicRelations) -> String {
    let formulas = formulas(symbolic);
    let lines = formulas
        .iter()
        .map(|f| format!("<p class=\"rel\">{}</p>", f.html()));
    let symbols = symbolic.named.symbols.iter();
    let given = symbols.map(|s| format!("{} = {}", s.shown, s.given));
    format!(
        "<details><summary>The same in symbols</summary><p class=\"soft\">{}. {}.</p>{}</details>",
        text(&given.collect::<Vec<_>>().join(", ")),
        text(&verified(symbolic)),
        lines.collect::<String>()
    )
}
