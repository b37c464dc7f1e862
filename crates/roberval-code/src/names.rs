//! Names from robot files in generated code.

/// Longest identifier made of a name.
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

/// A name as a comment may show it in any language: letters and digits of all scripts, blanks
/// and `_ . - / :` as they are, any other character by its number, as `<2A>`. Two names differ
/// as comments, too, and none ends its comment or turns the direction of the text.
#[must_use]
pub fn comment(name: &str) -> String {
    name.chars().fold(String::new(), |text, c| {
        match c.is_alphanumeric() || " _.-/:".contains(c) {
            true => text + c.encode_utf8(&mut [0; 4]),
            false => text + &format!("<{:X}>", u32::from(c)),
        }
    })
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
    fn comments_show_letters_and_no_character_that_could_end_them() {
        assert_eq!(
            comment("a*/b\n\"%{\\\u{202e}\u{2028}"),
            "a<2A>/b<A><22><25><7B><5C><202E><2028>"
        );
        for name in [
            "\u{8155}\u{95a2}\u{7bc0}",
            "\u{e9}paule 2",
            "robot1/base_link",
        ] {
            assert_eq!(comment(name), name);
        }
    }

    #[test]
    fn different_names_are_different_comments() {
        let long = "x".repeat(99);
        let names = [
            "\u{8155}", "\u{80a9}", "_", "*", "<2A>", "<", "e\u{301}", "\u{e9}",
        ];
        let mut comments: Vec<String> = names.map(comment).to_vec();
        comments.extend(["y", "z"].map(|end| comment(&(long.clone() + end))));
        let count = comments.len();
        comments.sort();
        comments.dedup();
        assert_eq!(comments.len(), count);
    }
}
