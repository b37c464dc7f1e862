//! Replacing pieces of a text and nothing else.

use std::ops::Range;

/// A piece of a text, in bytes, and what to write in its place.
pub(crate) type Edit = (Range<usize>, String);

/// The text with its pieces replaced; everything else stays byte for byte. Pieces must
/// not overlap; their order does not matter.
pub(crate) fn splice(text: &str, mut edits: Vec<Edit>) -> String {
    edits.sort_by_key(|(range, _)| range.start);
    let mut spliced = String::with_capacity(text.len() + 16 * edits.len());
    let mut done = 0;
    for (range, new) in &edits {
        spliced.push_str(text.get(done..range.start).unwrap_or_default());
        spliced.push_str(new);
        done = range.end;
    }
    spliced.push_str(text.get(done..).unwrap_or_default());
    spliced
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_pieces_change() {
        let edits = vec![(8..9, "three".to_owned()), (0..3, "1".to_owned())];
        assert_eq!(splice("one 2 = 3 \u{e9}", edits), "1 2 = three \u{e9}");
        assert_eq!(splice("same", Vec::new()), "same");
    }
}
