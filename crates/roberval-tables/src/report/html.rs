//! What the parts of the page have in common.

use roberval_base::BaseParameters;
use roberval_mechanism::ParameterKind;

use crate::escape::plain;

/// Text from anywhere, as HTML: in elements and in quoted attributes.
pub(crate) fn text(text: &str) -> String {
    plain(text).chars().fold(String::new(), |mut out, c| {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            _ => out.push(c),
        }
        out
    })
}

/// A figure whose marks (class `m`, with a title or a number `data-v`) are read out below it.
pub(super) fn figure(label: &str, plot: &str, caption: &str) -> String {
    format!(
        "<figure><div class=\"plot\" tabindex=\"0\" role=\"group\" aria-label=\"{}\">{plot}</div>\
         <output aria-live=\"polite\"></output><figcaption>{caption}</figcaption></figure>",
        text(label)
    )
}

/// A list of sentences; nothing where there is none.
pub(super) fn list(sentences: &[String]) -> String {
    if sentences.is_empty() {
        return String::new();
    }
    let items: Vec<String> = sentences
        .iter()
        .map(|s| format!("<li>{}</li>", text(s)))
        .collect();
    format!("<ul class=\"list\">{}</ul>", items.concat())
}

/// A name of at most `most` characters for a place where there is no room for more.
pub(super) fn short(name: &str, most: usize) -> String {
    let count = name.chars().count();
    if count <= most {
        return name.to_owned();
    }
    let head: String = name.chars().take(most / 2).collect();
    let tail: String = name.chars().skip(count - (most - most / 2 - 1)).collect();
    format!("{head}\u{2026}{tail}")
}

/// How many parameters of each link are kept, and of how many.
pub(super) fn kept(answer: &BaseParameters) -> Vec<(usize, usize)> {
    let mut counts: Vec<(usize, usize)> = answer
        .mechanism
        .links
        .iter()
        .map(|link| (0, ParameterKind::ALL.len() - usize::from(!link.rotor)))
        .collect();
    for &column in &answer.base {
        counts[answer.parameters.ids()[column].link].0 += 1;
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_text_is_markup() {
        assert_eq!(
            text("<b a=\"x\" b='y'>&\u{202e}"),
            "&lt;b a=&quot;x&quot; b=&#39;y&#39;&gt;&amp;\\u{202e}"
        );
    }

    #[test]
    fn short_names_keep_head_and_tail() {
        assert_eq!(short("abcdef", 6), "abcdef");
        assert_eq!(short("left_wrist_roll_link", 9), "left\u{2026}link");
    }
}
