//! What comes from robot files, made harmless for each reader.

/// Control characters, line separators and characters that change the direction of text
/// become visible escapes such as `\u{1b}`: names reach terminals and logs.
pub(crate) fn plain(text: &str) -> String {
    text.chars().fold(String::new(), |mut out, c| {
        if is_hidden(c) {
            out.extend(c.escape_unicode());
        } else {
            out.push(c);
        }
        out
    })
}

/// Controls, line separators, and marks that are not seen or turn the direction of text.
pub(crate) fn is_hidden(c: char) -> bool {
    let mark = matches!(c, '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{feff}');
    c.is_control() || mark || ('\u{2060}'..='\u{206f}').contains(&c)
}

/// A link's name as part of a relation: in quotes if it would be read as something else.
pub(crate) fn in_relation(name: &str) -> String {
    let bare = |c: char| c.is_alphanumeric() || "_-.:/#".contains(c);
    let name = plain(name);
    if !name.is_empty() && name.chars().all(bare) {
        name
    } else {
        format!("\"{}\"", name.replace('"', "\\\""))
    }
}

/// Text in Markdown: every character that could mean something is escaped.
pub(crate) fn markdown(text: &str) -> String {
    plain(text).chars().fold(String::new(), |mut out, c| {
        match c {
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '&' => out.push_str("&amp;"),
            // Neither alone nor inside words do these mean anything.
            ' ' | ',' | '.' | '-' | '(' | ')' | ';' | '/' | '=' | '%' | '^' | '\'' => out.push(c),
            _ if c.is_ascii_punctuation() => out.extend(['\\', c]),
            _ => out.push(c),
        }
        out
    })
}

/// A code span in a table cell of Markdown.
pub(crate) fn markdown_code(text: &str) -> String {
    let text = plain(text).replace('|', "\\|");
    let runs = text.split(|c| c != '`').map(str::len);
    let fence = "`".repeat(runs.max().unwrap_or(0) + 1);
    let space = if text.contains('`') { " " } else { "" };
    format!("{fence}{space}{text}{space}{fence}")
}

/// Text in LaTeX, outside mathematics.
pub(crate) fn latex(text: &str) -> String {
    plain(text).chars().fold(String::new(), |mut out, c| {
        match c {
            '\\' => out.push_str("\\textbackslash{}"),
            '{' | '}' | '$' | '&' | '#' | '%' | '_' => out.extend(['\\', c]),
            '^' => out.push_str("\\textasciicircum{}"),
            '~' => out.push_str("\\textasciitilde{}"),
            '<' => out.push_str("\\textless{}"),
            '>' => out.push_str("\\textgreater{}"),
            '|' => out.push_str("\\textbar{}"),
            '"' => out.push_str("\\textquotedbl{}"),
            // An empty group between them: -- and `` and ?` would be ligatures, and a
            // bracket after \\ an argument.
            '-' | '`' | '\'' | '?' | '!' | '[' | ']' => out.extend([c, '{', '}']),
            _ => out.push(c),
        }
        out
    })
}

/// A cell of CSV that no spreadsheet takes for a formula.
pub(crate) fn csv_cell(text: &str) -> String {
    let text = plain(text);
    let formula = |c: char| "=+-@\t\r\u{ff1d}\u{ff0b}\u{ff0d}\u{ff20}".contains(c);
    if text.trim_start().starts_with(formula) {
        format!("'{text}")
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terminals_never_see_control_characters() {
        assert_eq!(
            plain("a\x1b[31mb\n\u{202e}c"),
            "a\\u{1b}[31mb\\u{a}\\u{202e}c"
        );
    }

    #[test]
    fn names_in_relations_are_quoted_when_they_look_like_operators() {
        assert_eq!(in_relation("left_arm-2.b"), "left_arm-2.b");
        assert_eq!(in_relation("left arm"), "\"left arm\"");
        assert_eq!(in_relation("a+b"), "\"a+b\"");
        assert_eq!(in_relation("a\"b"), "\"a\\\"b\"");
        assert_eq!(in_relation("\u{8155}"), "\u{8155}");
    }

    #[test]
    fn markdown_shows_markup_as_text() {
        assert_eq!(markdown("<b>|*x*_"), "&lt;b&gt;\\|\\*x\\*\\_");
        assert_eq!(markdown("[x](u)"), "\\[x\\](u)");
        assert_eq!(markdown_code("a`b|"), "`` a`b\\| ``");
        assert_eq!(markdown_code("XX_1"), "`XX_1`");
    }

    #[test]
    fn latex_shows_commands_as_text() {
        assert_eq!(latex("\\input{a}"), "\\textbackslash{}input\\{a\\}");
        assert_eq!(
            latex("50% & $x_1^2$ ~"),
            "50\\% \\& \\$x\\_1\\textasciicircum{}2\\$ \\textasciitilde{}"
        );
        assert_eq!(latex("--?`"), "-{}-{}?{}`{}");
    }

    #[test]
    fn cells_are_no_formulas() {
        assert_eq!(csv_cell("=1+1"), "'=1+1");
        assert_eq!(csv_cell(" @SUM(A1)"), "' @SUM(A1)");
        assert_eq!(csv_cell("\u{ff1d}1"), "'\u{ff1d}1");
        assert_eq!(csv_cell("a=b"), "a=b");
    }
}
