//! Names from robot files are data: in no format do they become markup, formulas,
//! commands or too long a line.

mod common;

use common::{Folder, roberval};
use roberval_base::{Options, base_parameters};
use roberval_mechanism::{Mechanism, RobotDescription};
use roberval_tables::WIDTH;
use roberval_testkit::{Angles, Family};
use serde_json::Value;
use unicode_width::UnicodeWidthStr;

/// Names that mean something to some reader.
const HOSTILE: &[&str] = &[
    "=1+1",
    "@SUM(A1)",
    "-2+3",
    "+cmd|' /C calc'!A0",
    "<script>alert(1)</script>",
    "</td><img src=x onerror=alert(1)>",
    "[click](javascript:alert(1))",
    "![x](http://example.org/x.png)",
    "`code` ``more``",
    "**bold** _it_ ~~no~~",
    "a|b||c",
    "\\input{/etc/passwd}",
    "\\write18{ls}",
    "$x_1^2$ & 50% #1 {~}",
    "\\end{longtable}",
    "a\"b'c,d;e",
    "a + 2 (b - c) = d * e",
    "M_1",
    "XX_1 + YY_2",
    "null",
    "arm\u{202e}gnp",
    "zero\u{200b}width",
    "line\u{2028}separator",
    "\u{8155}\u{95a2}\u{7bc0}",
    "\u{e9}paule",
    "  two  blanks  ",
    "%s%n%x",
    "{{7*7}}",
    "../../etc",
    "#",
];

const FORMATS: [&str; 5] = ["table", "json", "csv", "markdown", "latex"];

/// A chain whose links have these names.
fn robot_with(names: &[String]) -> String {
    let family = Family {
        links: (names.len(), names.len()),
        branch: 0.1,
        angles: Angles::Right,
        ..Family::default()
    };
    let mut robot: RobotDescription = family.robot(7);
    robot.name = names[0].clone();
    let place = |name: &str| name.parse::<usize>().map_or(0, |j| j - 1);
    for link in &mut robot.links {
        link.name = names[place(&link.name)].clone();
        // A robot file gives Ia only where there is a rotor.
        link.inertia[10] = link.inertia[10].take().filter(|_| link.rotor);
        link.antecedent = link.antecedent.take().map(|a| names[place(&a)].clone());
    }
    roberval_formats::to_toml(&robot).expect("writable")
}

fn hostile_robot(folder: &Folder) -> String {
    let names: Vec<String> = HOSTILE.iter().map(|n| (*n).to_owned()).collect();
    folder.file("robot.toml", robot_with(&names))
}

fn output(args: &[&str]) -> String {
    let run = roberval(args);
    assert!(run.code <= 1, "{args:?}: {}", run.err);
    for c in run.out.chars().chain(run.err.chars()) {
        let harmless = c == '\n' || !c.is_control();
        assert!(
            harmless && !('\u{2028}'..='\u{202e}').contains(&c),
            "{args:?}: {c:?}"
        );
    }
    run.out
}

#[test]
fn no_line_of_a_table_is_wider_than_100_columns() {
    let folder = Folder::new("width");
    let numbers = |n: usize| (1..=n).map(|j| j.to_string()).collect::<Vec<_>>();
    let long = |n: usize| {
        let name = |j| {
            format!(
                "{}_{j}",
                "a_very_long_link_name_of_a_humanoid".repeat(1 + j % 9)
            )
        };
        (1..=n).map(name).collect::<Vec<_>>()
    };
    let wide = |n: usize| {
        (1..=n)
            .map(|j| format!("{}{j}", "\u{8155}".repeat(40)))
            .collect()
    };
    let hostile = HOSTILE.iter().map(|n| (*n).to_owned()).collect();
    for (names, commands) in [
        (numbers(60), &["show", "base"][..]),
        (long(12), &["show", "base", "compare"]),
        (long(30), &["show", "base"]),
        (wide(8), &["show", "base", "compare"]),
        (hostile, &["show", "base"]),
    ] {
        let robot = folder.file("robot.toml", robot_with(&names));
        for command in commands {
            for line in output(&[command, &robot]).lines() {
                assert!(
                    line.width() <= WIDTH,
                    "{command}: {} columns: {line}",
                    line.width()
                );
            }
        }
    }
    let robot = folder.file("robot.toml", robot_with(&long(9)));
    for line in output(&["base", &robot, "--engine", "svd"]).lines() {
        assert!(line.width() <= WIDTH, "{line}");
    }
}

#[test]
fn json_keeps_every_name_and_number_as_it_is() {
    let folder = Folder::new("json-names");
    let robot = hostile_robot(&folder);
    let text = output(&["base", &robot, "--format", "json"]);
    let json: Value = serde_json::from_str(&text).expect("JSON");
    let names = json["robot"]["links"].as_array().expect("a list");
    let names: Vec<&str> = names.iter().filter_map(|l| l["name"].as_str()).collect();
    let mut expected = HOSTILE.to_vec();
    expected.sort_unstable();
    let mut found = names.clone();
    found.sort_unstable();
    assert_eq!(found, expected);
    for parameter in json["parameters"].as_array().expect("a list") {
        let label = format!(
            "{}_{}",
            parameter["kind"].as_str().expect("text"),
            parameter["link"].as_str().expect("text")
        );
        assert_eq!(parameter["label"], label.as_str());
    }
    let mechanism = Mechanism::new(&roberval_formats::load(&robot).expect("valid"));
    let answer = base_parameters(&mechanism.expect("valid"), &Options::default()).expect("valid");
    let labels = answer.parameters.labels();
    for relation in answer.relations() {
        for (column, coefficient) in relation.terms {
            let read = &json["beta"][&labels[relation.base]][&labels[column]];
            assert_eq!(
                read.as_f64(),
                Some(coefficient),
                "numbers read back exactly"
            );
        }
    }
}

#[test]
fn csv_cells_are_no_formulas_and_every_row_is_complete() {
    let folder = Folder::new("csv-names");
    let robot = hostile_robot(&folder);
    for command in ["show", "base", "compare"] {
        let text = output(&[command, &robot, "--format", "csv"]);
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .from_reader(text.as_bytes());
        for record in reader.records() {
            for cell in &record.expect("all rows have the same length") {
                let formula = cell.trim_start().starts_with(['=', '+', '-', '@', '\t']);
                assert!(
                    !formula || cell.parse::<f64>().is_ok(),
                    "{command}: {cell:?}"
                );
            }
        }
    }
}

#[test]
fn markdown_has_no_tags_links_or_broken_tables() {
    let folder = Folder::new("md-names");
    let robot = hostile_robot(&folder);
    for command in ["show", "base", "compare"] {
        let text = output(&[command, &robot, "--format", "markdown"]);
        for line in text.lines() {
            let prose = without_escapes(&without_code(line));
            for markup in ["<", "](", "**bold", "_it", "~~", "`"] {
                assert!(!prose.contains(markup), "{command}, {markup}: {line}");
            }
        }
        let rows: Vec<&str> = text.lines().filter(|l| l.starts_with('|')).collect();
        let bars = |row: &str| without_escapes(row).matches('|').count();
        for pair in rows.windows(2).filter(|p| p[1].contains("---")) {
            assert_eq!(bars(pair[0]), bars(pair[1]), "{command}: {}", pair[0]);
        }
    }
}

/// The line without its escaped characters.
fn without_escapes(line: &str) -> String {
    let mut out = String::new();
    let mut characters = line.chars();
    while let Some(c) = characters.next() {
        match c {
            '\\' => _ = characters.next(),
            c => out.push(c),
        }
    }
    out
}

/// The line without its code spans.
fn without_code(line: &str) -> String {
    let mut out = String::new();
    let mut rest = line.to_owned();
    while let Some(start) = rest
        .find('`')
        .filter(|&at| at == 0 || &rest[at - 1..at] != "\\")
    {
        let fence: String = rest[start..].chars().take_while(|c| *c == '`').collect();
        let inner = start + fence.len();
        let run = |at: usize| rest[at..].chars().take_while(|c| *c == '`').count();
        let mut end = inner;
        while !(rest[end..].starts_with('`') && run(end) == fence.len()) {
            let step = rest[end..]
                .chars()
                .next()
                .expect("the span ends")
                .len_utf8();
            end += step.max(run(end));
        }
        out += &rest[..start];
        rest = rest[end + fence.len()..].to_owned();
    }
    out + &rest
}

/// The commands of our LaTeX.
const COMMANDS: &str = "\
    usepackage subsection subsubsection raggedright small tabcolsep setlength parindent hangindent \
    par noindent textbf begin end toprule midrule bottomrule endhead endfoot text \
    times textbackslash textasciicircum textasciitilde textless textgreater textbar textquotedbl";

#[test]
fn latex_has_no_command_from_a_name_and_balanced_braces() {
    let folder = Folder::new("latex-names");
    let robot = hostile_robot(&folder);
    for command in ["show", "base", "compare"] {
        let text = output(&[command, &robot, "--format", "latex"]);
        let (mut depth, mut dollars) = (0_i64, 0);
        let mut rest = text.as_str();
        while let Some(c) = rest.chars().next() {
            rest = &rest[c.len_utf8()..];
            match c {
                '\\' => {
                    let word: &str = rest
                        .split(|c: char| !c.is_ascii_alphabetic())
                        .next()
                        .unwrap_or("");
                    let known = COMMANDS.split_whitespace().any(|known| known == word);
                    assert!(word.is_empty() || known, "{command}: \\{word}");
                    let next = rest.chars().next().map_or(0, char::len_utf8);
                    rest = &rest[word.len().max(next)..];
                }
                '{' => depth += 1,
                '}' => depth -= 1,
                '$' => dollars += 1,
                '%' => rest = rest.split_once('\n').map_or("", |(_, after)| after),
                '#' | '~' | '^' if depth == 0 && dollars % 2 == 0 => panic!("{command}: {c}"),
                _ => {}
            }
            assert!(depth >= 0, "{command}");
        }
        assert_eq!((depth, dollars % 2), (0, 0), "{command}");
        assert_eq!(
            text.matches("\\begin{longtable}").count(),
            text.matches("\\end{longtable}").count()
        );
    }
}

#[test]
fn every_format_of_every_command_is_written() {
    for format in FORMATS {
        for args in [
            &["show"][..],
            &["show", "torso"],
            &["base", "scara"],
            &["compare", "ur5"],
            &["scale", "two_link"],
        ] {
            let text = output(&[args, &["--format", format]].concat());
            assert!(
                text.ends_with('\n') && text.len() > 100,
                "{args:?} {format}"
            );
        }
    }
}

#[test]
fn code_tells_names_apart_in_its_comments_and_none_ends_them() {
    let folder = Folder::new("code-names");
    let robot = hostile_robot(&folder);
    let standard = ["--parameters", "standard", "--what", "regressor"];
    for (lang, prefix) in [
        ("c", " *"),
        ("rust", "//"),
        ("python", "#"),
        ("matlab", "%"),
    ] {
        let text = output(&[&["code", &robot, "--lang", lang], &standard[..]].concat());
        let notes = text.lines().filter_map(|line| line.strip_prefix(prefix));
        let words = notes.filter_map(|note| note.trim_start().split_once(' '));
        let labels = words.map(|(_, label)| label.to_owned());
        let labels = labels.filter(|label| label.starts_with("ZZ_"));
        let mut labels: Vec<String> = labels.collect();
        assert_eq!(labels.len(), HOSTILE.len(), "{lang}: {labels:?}");
        assert!(labels.contains(&"ZZ_\u{8155}\u{95a2}\u{7bc0} [kg m^2]".to_owned()));
        labels.sort();
        labels.dedup();
        assert_eq!(labels.len(), HOSTILE.len(), "{lang}");
    }
}
