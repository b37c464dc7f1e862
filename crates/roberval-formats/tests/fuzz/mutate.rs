//! Mutations that keep some of a text's structure: they act on words, numbers, lines and
//! blocks, so that a good part of the texts gets past the first check.

use roberval_scalar::SplitMix64;

/// The longest text that is made, bytes.
const LONGEST: usize = 1 << 16;

const NUMBERS: &[&str] = &[
    "nan",
    "inf",
    "-inf",
    "1e999",
    "1e-999",
    "-1e308",
    "4.9e-324",
    "0x10",
    "1,5",
    "1e",
    "--1",
    "+",
    ".",
    "-0.0",
    "0",
    "1.5708",
    "3.14",
    "1e-17",
    "9007199254740993",
    "1_000",
    "\u{663}",
    "${x}",
    "1e9999",
    "1e-9999",
    "0.1e99999999999",
    "pi/2",
    "90 deg",
    "true",
    "1.7e308",
];

const PIECES: &[&str] = &[
    "<",
    ">",
    "/>",
    "</",
    "&",
    "&amp;",
    "&#48;",
    "&#x0;",
    "&lt;",
    "'",
    "\"",
    "\"\"\"",
    "=",
    "[",
    "]",
    "[[",
    "]]",
    "{",
    "}",
    ",",
    "#",
    "\n",
    "\r\n",
    "\r",
    "\t",
    " ",
    "\0",
    "\u{feff}",
    "\u{e9}",
    "\u{202e}",
    "\u{1f916}",
    "\u{2212}",
    "<!--",
    "-->",
    "<![CDATA[",
    "]]>",
    "<?x ?>",
    "<!DOCTYPE r [<!ENTITY a 'b'>]>",
    "xmlns='u'",
    "xmlns:x='u'",
    "<x:link name='a'/>",
    "[[link]]",
    "[constants]",
    "[link.inertia]",
    "inertia = { M = 1 }",
    "a.b = 1",
    "(",
    ")",
    "*",
    "/",
    "+",
    "-",
    "sqrt(",
    "pi",
    "deg",
    "1e",
    "<mimic joint='j'/>",
    "<link name='z'/>",
    "<origin/>",
    "<axis xyz='0 0 0'/>",
    "type='fixed'",
    "joint = \"fixed\"",
    "\\",
    "\\u0000",
    "\\uD800",
];

/// A text made from one of the corpus by one to five mutations.
pub fn mutated(corpus: &[String], random: &mut SplitMix64) -> String {
    let mut text = corpus[random.below(corpus.len())].clone();
    for _ in 0..1 + random.below(5) {
        text = mutate(&text, corpus, random);
        let mut end = text.len().min(LONGEST);
        while !text.is_char_boundary(end) {
            end -= 1;
        }
        text.truncate(end);
    }
    text
}

fn mutate(text: &str, corpus: &[String], random: &mut SplitMix64) -> String {
    let mut words = words(text);
    if words.is_empty() {
        return pick(PIECES, random).to_owned();
    }
    let at = random.below(words.len());
    let end = (at + 1 + random.below(40)).min(words.len());
    match random.below(12) {
        0 => words[at] = pick(PIECES, random),
        1 => words.insert(at, pick(PIECES, random)),
        2 => drop(words.drain(at..end)),
        3 => drop(words.remove(at)),
        4 => {
            let other = random.below(words.len());
            words.swap(at, other);
        }
        // A name becomes another one of the same text: circles, duplicates, wrong ends.
        5 | 6 => replace(
            &mut words,
            random,
            |w| w.starts_with(char::is_alphabetic),
            None,
        ),
        7 | 8 => {
            let number = pick(NUMBERS, random);
            replace(&mut words, random, is_number, Some(number));
        }
        9 => return repeated(text, random),
        10 => {
            let block = words[at..end].to_vec();
            let to = random.below(words.len());
            drop(words.splice(to..to, block));
        }
        _ => {
            let other = self::words(&corpus[random.below(corpus.len())]);
            let from = random.below(other.len() + 1);
            words.truncate(at);
            words.extend(&other[from..]);
        }
    }
    words.concat()
}

fn is_number(word: &str) -> bool {
    word.contains(|c: char| c.is_ascii_digit())
}

/// Replaces a word of a kind by `new` or by another word of the kind.
fn replace<'t>(
    words: &mut [&'t str],
    random: &mut SplitMix64,
    kind: impl Fn(&str) -> bool,
    new: Option<&'t str>,
) {
    let places: Vec<usize> = (0..words.len()).filter(|w| kind(words[*w])).collect();
    if places.is_empty() {
        return;
    }
    let other = words[pick(&places, random)];
    words[pick(&places, random)] = new.unwrap_or(other);
}

/// A line, or a few characters, many times.
fn repeated(text: &str, random: &mut SplitMix64) -> String {
    let lines: Vec<&str> = text.split_inclusive('\n').collect();
    let at = random.below(lines.len());
    let times = [2, 3, 40, 300, 1100][random.below(5)];
    let piece = if random.below(2) == 0 {
        lines[at]
    } else {
        pick(PIECES, random)
    };
    let times = times.min(LONGEST / (piece.len() + 1));
    let (before, after) = lines.split_at(at);
    before.concat() + &piece.repeat(times) + &after.concat()
}

fn pick<T: Copy>(from: &[T], random: &mut SplitMix64) -> T {
    from[random.below(from.len())]
}

/// The text cut into words, numbers, spaces and single other characters.
fn words(text: &str) -> Vec<&str> {
    let class = |c: char| match c {
        _ if c.is_alphanumeric() || "_.+-".contains(c) => 'w',
        _ if c.is_whitespace() => ' ',
        other => other,
    };
    let mut words = Vec::new();
    let mut start = 0;
    let mut last = None;
    for (at, c) in text.char_indices() {
        if last.is_some_and(|l| l != class(c) || !"w ".contains(l)) {
            words.push(&text[start..at]);
            start = at;
        }
        last = Some(class(c));
    }
    if start < text.len() {
        words.push(&text[start..]);
    }
    words
}
