//! Files inside the page.

use std::io::Write;

use flate2::{Compression, GzBuilder};
use roberval_base::BaseParameters;
use sha2::{Digest, Sha256};

use crate::Format;

/// Links that save what `--format csv`, `--format json` and `--certificate` write. Gzip in
/// the page; the script unpacks it, and without the script the reader's computer does.
pub(super) fn links(answer: &BaseParameters) -> String {
    let stem = stem(&answer.mechanism.name);
    let mut links = vec![
        link(&stem, "csv", "Save CSV", &crate::base(answer, Format::Csv)),
        link(
            &stem,
            "json",
            "Save JSON",
            &crate::base(answer, Format::Json),
        ),
    ];
    if let Ok(certificate) = answer.certificate() {
        let stem = format!("{stem}-certificate");
        links.push(link(&stem, "json", "Save certificate", &certificate));
    }
    format!("<p class=\"files\">{}</p>", links.concat())
}

fn link(stem: &str, extension: &str, label: &str, content: &str) -> String {
    let name = format!("{stem}.{extension}");
    format!(
        "<a download=\"{name}.gz\" data-name=\"{name}\" href=\"data:application/gzip;base64,{}\">{label}</a>",
        base64(&gzip(content.as_bytes()))
    )
}

/// A file name of harmless letters.
fn stem(name: &str) -> String {
    /// Longer names are no use to anyone.
    const LONGEST: usize = 40;
    let letters = name.chars().take(LONGEST);
    let stem: String = letters
        .map(|c| if c.is_ascii_alphanumeric() { c } else { '-' })
        .collect();
    match stem.trim_matches('-') {
        "" => "robot".to_owned(),
        stem => stem.to_owned(),
    }
}

/// Without a date: the same answer gives the same page.
fn gzip(content: &[u8]) -> Vec<u8> {
    let mut encoder = GzBuilder::new().write(Vec::new(), Compression::best());
    // Writing to memory does not fail.
    let written = encoder.write_all(content);
    debug_assert!(written.is_ok(), "{written:?}");
    encoder.finish().unwrap_or_default()
}

/// A source of a content security policy: `sha256-...`.
pub(super) fn hash(content: &str) -> String {
    format!("sha256-{}", base64(&Sha256::digest(content)))
}

/// RFC 4648, with padding.
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let byte = |i: usize| u32::from(group.get(i).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for i in 0..4 {
            let letter = LETTERS[(bits >> (18 - 6 * i) & 63) as usize];
            text.push(if i <= group.len() { letter.into() } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_is_that_of_the_rfc() {
        let pairs = [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foobar", "Zm9vYmFy"),
        ];
        for (plain, coded) in pairs {
            assert_eq!(base64(plain.as_bytes()), coded);
        }
    }

    #[test]
    fn file_names_are_harmless() {
        assert_eq!(stem("PUMA 560"), "PUMA-560");
        assert_eq!(stem("../../<b>"), "b");
        assert_eq!(stem("\u{8155}"), "robot");
    }
}
