//! Bad robot files: each gets its code and a message that says what, where and what
//! would be right.

mod couple_rows;
mod hostile;
mod toml_rows;
mod urdf_rows;

use roberval_formats::{FormatError, Severity, UrdfOptions, lint, parse_toml, parse_urdf};

/// A bad text: its name, the text, the code, and words of the message (among them the
/// line or the link or joint).
pub type Row = (
    &'static str,
    &'static str,
    &'static str,
    &'static [&'static str],
);

fn check(row: &Row, result: Result<impl std::fmt::Debug, FormatError>) {
    let (name, _, code, words) = row;
    let error = match result {
        Ok(robot) => panic!("{name}: accepted as {robot:?}"),
        Err(error) => error,
    };
    let message = error.to_string();
    assert_eq!(error.code.to_string(), *code, "{name}: {message}");
    assert!(!message.contains(char::is_control), "{name}: {message:?}");
    assert!(message.len() < 1000, "{name}: {} bytes", message.len());
    for word in *words {
        assert!(message.contains(word), "{name}: {word:?} not in {message}");
    }
}

#[test]
fn bad_toml_is_refused_with_its_place() {
    for row in toml_rows::FILES {
        check(row, parse_toml(row.1, "r.toml"));
    }
}

#[test]
fn bad_toml_links_are_refused_with_their_place() {
    for row in toml_rows::LINKS {
        let text = format!(
            "[constants]\nL = 0.5\n[[link]]\nname = \"good\"\nalpha=0\nd=0\nr=0\n{}",
            row.1
        );
        check(row, parse_toml(&text, "r.toml"));
    }
}

#[test]
fn bad_couples_are_refused_with_their_place() {
    let link = |name: &str| format!("[[link]]\nname = \"{name}\"\nalpha = 0\nd = 0.5\nr = 0\n");
    let fixed = link("c") + "theta = 0\njoint = \"fixed\"\n";
    let links = ["name = \"r\"\n", &link("a"), &link("b"), &fixed].concat();
    for row in couple_rows::COUPLES {
        // Keys of the last link come before a new table begins.
        check(row, parse_toml(&(links.clone() + row.1), "r.toml"));
    }
}

#[test]
fn bad_xml_is_refused_with_its_place() {
    for row in urdf_rows::FILES {
        for keep_fixed in [false, true] {
            check(
                row,
                parse_urdf(
                    row.1,
                    "r.urdf",
                    UrdfOptions {
                        keep_fixed,
                        floating: false,
                    },
                ),
            );
        }
    }
}

/// Two links, and these elements.
fn urdf(elements: &str) -> String {
    let links = "<link name=\"a\"/>\n<link name=\"b\"/>";
    format!("<robot name=\"r\">\n{links}\n{elements}\n</robot>")
}

#[test]
fn bad_urdf_elements_are_refused_with_their_place() {
    for row in urdf_rows::ROBOTS {
        let text = urdf(row.1);
        for keep_fixed in [false, true] {
            check(
                row,
                parse_urdf(
                    &text,
                    "r.urdf",
                    UrdfOptions {
                        keep_fixed,
                        floating: false,
                    },
                ),
            );
        }
    }
}

#[test]
fn lint_tells_no_fault_of_bad_files_twice() {
    let path = std::env::temp_dir().join(format!("roberval-twice-{}.urdf", std::process::id()));
    let files = urdf_rows::FILES.iter().map(|row| row.1.to_owned());
    let robots = urdf_rows::ROBOTS.iter().map(|row| urdf(row.1));
    for text in files.chain(robots) {
        std::fs::write(&path, &text).expect("a file");
        // A file that is no XML has one error and no findings.
        let mut found = lint(&path.to_string_lossy()).unwrap_or_default();
        found.retain(|f| f.severity == Severity::Error);
        let what = |f: &roberval_formats::Finding| {
            let what = f.what.split_once(": ").map_or(&*f.what, |(_, what)| what);
            (f.position.map(|p| (p.line, p.column)), what.to_owned())
        };
        let mut faults: Vec<_> = found.iter().map(what).collect();
        faults.sort();
        let count = faults.len();
        faults.dedup();
        assert_eq!(faults.len(), count, "{text}\n{found:#?}");
    }
    std::fs::remove_file(&path).expect("still there");
}

#[test]
fn the_table_of_bad_files_is_long_and_its_names_are_unique() {
    let tables = [
        toml_rows::FILES,
        toml_rows::LINKS,
        urdf_rows::FILES,
        urdf_rows::ROBOTS,
    ];
    let mut names: Vec<&str> = tables.concat().iter().map(|row| row.0).collect();
    let count = names.len();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), count);
    assert!(count >= 120, "{count} rows");
}
