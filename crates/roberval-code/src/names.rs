//! Names from robot files in generated code.

/// Longest piece of a name that code or a comment repeats.
const LONGEST: usize = 40;

/// An identifier in all languages made of a robot's name: lower case letters, digits and
/// `_`, a letter first. It is never used without a suffix, so that it is no keyword.
#[must_use]
pub fn identifier(name: &str) -> String {
    let mut identifier = String::new();
    for c in name.chars().take(4 * LONGEST) {
        match c.to_ascii_lowercase() {
            c if c.is_ascii_alphanumeric() => identifier.push(c),
            _ if !identifier.is_empty() && !identifier.ends_with('_') => identifier.push('_'),
            _ => {}
        }
        if identifier.len() == LONGEST {
            break;
        }
    }
    let identifier = identifier.trim_end_matches('_');
    match identifier.starts_with(|c: char| c.is_ascii_alphabetic()) {
        true => identifier.to_owned(),
        false if identifier.is_empty() => "robot".to_owned(),
        false => format!("robot_{identifier}"),
    }
}

/// A name as a comment may show it in any language: letters, digits, blanks and `_ . -`
/// of ASCII as they are, anything else as `_`, not too long.
#[must_use]
pub fn plain(name: &str) -> String {
    let allowed = |c: char| c.is_ascii_alphanumeric() || " _.-".contains(c);
    let clean = |c: char| if allowed(c) { c } else { '_' };
    let cut: String = name.chars().take(LONGEST).map(clean).collect();
    match name.chars().nth(LONGEST) {
        Some(_) => cut + "..",
        None => cut,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hostile_names_become_plain_identifiers() {
        for (name, expected) in [
            ("PUMA 560", "puma_560"),
            ("2-link", "robot_2_link"),
            ("*/ int main(){}", "int_main"),
            ("\u{202e}\u{feff}", "robot"),
            ("\\u0022'''\"\"\"??/", "u0022"),
            ("", "robot"),
        ] {
            assert_eq!(identifier(name), expected);
        }
        assert!(identifier(&"a b".repeat(10_000)).len() <= LONGEST);
    }

    #[test]
    fn comments_show_no_character_that_could_end_them() {
        assert_eq!(plain("a*/b\n\"\"\"%{??/\\"), "a__b__________");
        assert_eq!(plain(&"x".repeat(99)).len(), LONGEST + 2);
    }
}
