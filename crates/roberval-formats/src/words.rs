//! Words for messages.

use crate::error::visible;

/// A text for a message: quoted, control characters escaped, cut when long.
pub(crate) fn quoted(text: &str) -> String {
    let head: String = text.chars().take(60).collect();
    let dots = if head.len() < text.len() { "..." } else { "" };
    format!("{head:?}{dots}")
}

/// A text for a message without quotes: control characters escaped, cut when long.
pub(crate) fn cut(text: &str) -> String {
    const LONGEST: usize = 200;
    let shown = visible(text);
    let head: String = shown.chars().take(LONGEST).collect();
    let dots = if head.len() < shown.len() { "..." } else { "" };
    head + dots
}

/// Names in quotes with commas between them, at most eight of them.
pub(crate) fn list<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    let mut names = names.into_iter();
    let mut shown: Vec<String> = names.by_ref().take(8).map(quoted).collect();
    let more = names.count();
    if more > 0 {
        shown.push(format!("and {more} more"));
    }
    shown.join(", ")
}

/// The known word that is closest to a misspelt one, if one is close.
pub(crate) fn nearest<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    /// Longer words and lists are no spelling mistakes.
    const LONGEST: usize = 64;
    const MOST: usize = 10_000;
    if word.len() > LONGEST {
        return None;
    }
    let word = word.to_lowercase();
    known
        .into_iter()
        .take(MOST)
        .filter(|k| k.len() <= LONGEST)
        .map(|k| (distance(&word, &k.to_lowercase()), k))
        .filter(|(d, k)| *d <= 1 + word.len().max(k.len()) / 4)
        .min_by_key(|(d, _)| *d)
        .map(|(_, k)| k)
}

/// Levenshtein distance in characters.
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let changed = diagonal + usize::from(x != *y);
            diagonal = row[j + 1];
            row[j + 1] = changed.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_word_is_a_spelling_away() {
        let known = ["alpha", "gamma", "theta", "r", "d", "b"];
        assert_eq!(nearest("aplha", known), Some("alpha"));
        assert_eq!(nearest("Theta", known), Some("theta"));
        assert_eq!(nearest("friction", known), None);
        assert_eq!(distance("kitten", "sitting"), 3);
        assert_eq!(distance("", "abc"), 3);
    }
}
