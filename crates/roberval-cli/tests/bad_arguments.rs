//! Every wrong command line ends in exit code 2, one clear message and no result.

mod common;

use common::{Folder, roberval};

/// Arguments and what the message must say.
const CASES: &[(&[&str], &[&str])] = &[
    (&[], &["Usage", "base"]),
    (&["bsae", "puma560"], &["bsae", "base"]),
    (&["base"], &["ROBOT"]),
    (&["base", "puma560", "extra"], &["extra"]),
    (&["base", "pumma560"], &["pumma560", "puma560"]),
    (&["base", "PUMA560"], &["puma560"]),
    (&["base", "no/such/arm.urdf"], &["no/such/arm.urdf"]),
    (&["base", ""], &["value is required", "ROBOT"]),
    (&["base", "/"], &["folder"]),
    (&["show", "pumma560"], &["puma560"]),
    (&["compare", "pumma560"], &["puma560"]),
    (&["base", "puma560", "--model", "D"], &["'D'", "d, d0, h"]),
    (&["base", "puma560", "--model", "e"], &["--model"]),
    (&["base", "puma560", "--model"], &["--model", "value"]),
    (&["base", "puma560", "--engine", "lu"], &["'lu'", "qrii"]),
    (&["base", "puma560", "--engine", "QR"], &["qr"]),
    (
        &["base", "puma560", "--format", "xml"],
        &["'xml'", "markdown"],
    ),
    (&["base", "puma560", "--format", "jsn"], &["json"]),
    (
        &["base", "puma560", "--choice", "best"],
        &["'best'", "pivoted"],
    ),
    (
        &["base", "puma560", "--choice", "prefer"],
        &["--keep", "--drop"],
    ),
    (
        &["base", "puma560", "--choice", "paper", "--keep", "MX_2"],
        &["contradict"],
    ),
    (
        &["base", "puma560", "--choice", "pivoted", "--drop", "MX_2"],
        &["contradict"],
    ),
    (
        &["base", "puma560", "--keep", "MX_9"],
        &["\"MX_9\"", "MX_1"],
    ),
    (
        &["base", "puma560", "--keep", "mx_2"],
        &["\"mx_2\"", "MX_2"],
    ),
    (&["base", "puma560", "--keep", "ZZR_1"], &["\"ZZR_1\""]),
    (&["base", "puma560", "--drop", "nothing"], &["\"nothing\""]),
    (&["base", "puma560", "--keep", "MX_2,"], &["\"\""]),
    (
        &["base", "puma560", "--keep", "YY_3", "--drop", "YY_3"],
        &["YY_3", "one list"],
    ),
    (&["base", "puma560", "--seed", "-1"], &["-1", "from 0 to"]),
    (
        &["base", "puma560", "--seed", "0.5"],
        &["0.5", "whole number"],
    ),
    (
        &["base", "puma560", "--seed", "18446744073709551616"],
        &["--seed"],
    ),
    (&["base", "puma560", "--rows", "0"], &["at least 1"]),
    (&["base", "puma560", "--rows", "-5"], &["-5"]),
    (&["base", "puma560", "--rows=-5"], &["whole number"]),
    (&["base", "puma560", "--rows", "many"], &["whole number"]),
    (&["base", "puma560", "--rows", "1e3"], &["whole number"]),
    (&["base", "puma560", "--rows", "54"], &["54", "55"]),
    (&["base", "puma560", "--rows", "3"], &["W has 3 rows"]),
    (&["base", "puma560", "--rows", "1000000000000"], &["memory"]),
    (
        &["base", "puma560", "--rows", "18446744073709551615"],
        &["memory"],
    ),
    (
        &[
            "base",
            "puma560",
            "--model",
            "h",
            "--rows",
            "18446744073709551615",
        ],
        &["memory"],
    ),
    (
        &["base", "puma560", "--paper-tolerance=-1"],
        &["above 0", "2.2e-16"],
    ),
    (
        &["base", "puma560", "--paper-tolerance=abc"],
        &["abc", "above 0"],
    ),
    (&["base", "puma560", "--paper-tolerance=nan"], &["above 0"]),
    (&["base", "puma560", "--paper-tolerance=inf"], &["above 0"]),
    (&["base", "puma560", "--paper-tolerance=small"], &["small"]),
    (
        &["base", "puma560", "--gravity", "0,0"],
        &["2 numbers", "three"],
    ),
    (
        &["base", "puma560", "--gravity", "0,0,-9.81,1"],
        &["4 numbers", "three"],
    ),
    (&["base", "puma560", "--gravity", "0,0,down"], &["down"]),
    (&["base", "puma560", "--gravity", "0,0,nan"], &["nan"]),
    (&["base", "puma560", "--gravity", "0,0,1e999"], &["1e999"]),
    (
        &["base", "puma560", "--gravity", "0 0 -9.81"],
        &["0 0 -9.81"],
    ),
    (&["base", "puma560", "--colour"], &["--colour"]),
    (&["base", "puma560", "-o", "/"], &["folder"]),
    (
        &["base", "puma560", "-o", ""],
        &["value is required", "--output"],
    ),
    (
        &["base", "puma560", "-o", "no/such/folder/out.txt"],
        &["folder does not exist"],
    ),
    (&["show", "puma560", "-o", "/"], &["folder"]),
    (&["compare", "puma560", "--model", "d"], &["--model"]),
    (&["compare", "puma560", "--keep", "MX_9"], &["MX_9"]),
    (&["regressor", "puma560"], &["STATES"]),
    (&["regressor", "puma560", "states.csv"], &["--output"]),
    (
        &["regressor", "puma560", "no-such.csv", "-o", "-"],
        &["no-such.csv"],
    ),
    (&["regressor", "puma560", "/", "-o", "-"], &["folder"]),
    (
        &["regressor", "pumma560", "no-such.csv", "-o", "-"],
        &["puma560"],
    ),
    (
        &["regressor", "puma560", "no-such.csv", "-o", "/"],
        &["folder"],
    ),
    (
        &[
            "regressor",
            "puma560",
            "no-such.csv",
            "-o",
            "-",
            "--keep=MX_2",
        ],
        &["--keep", "go with --base"],
    ),
    (
        &[
            "regressor",
            "puma560",
            "no-such.csv",
            "-o",
            "-",
            "--engine=svd",
        ],
        &["--engine", "go with --base"],
    ),
    (&["scale", "pumma560"], &["puma560"]),
    (&["scale", "puma560", "--target", "0"], &["above 0"]),
    (&["scale", "puma560", "--target", "nan"], &["above 0"]),
    (&["scale", "puma560", "--rows", "3"], &["55"]),
    (&["scale", "puma560", "--engine", "qr"], &["--engine"]),
];

#[test]
fn wrong_command_lines_are_refused_with_a_reason() {
    for (args, needles) in CASES {
        let run = roberval(args);
        assert_eq!(run.code, 2, "{args:?}: {}", run.err);
        assert_eq!(run.out, "", "{args:?}");
        for needle in *needles {
            assert!(
                run.err.contains(needle),
                "{args:?}: no {needle:?} in {}",
                run.err
            );
        }
        assert!(!run.err.contains("panicked"), "{args:?}: {}", run.err);
    }
}

/// Robot files and what the message must say.
const ROBOTS: &[(&str, &[&str])] = &[
    ("", &["empty"]),
    ("name = 3", &["name"]),
    ("[[link]]\njoint = \"spherical\"", &["spherical"]),
    (
        "[[link]]\nalpha = \"90 degrees\"\nd = 0\ntheta = 0\nr = 0",
        &["alpha"],
    ),
    ("[[link]]\nalpha = 0\nd = \"D3\"\ntheta = 0\nr = 0", &["D3"]),
    ("[[link]]\nmass = 3", &["mass"]),
    (
        "[[link]]\njoint = \"fixed\"\nalpha = 0\nd = 0\ntheta = 0\nr = 0",
        &["no moving joint"],
    ),
    ("name = \"x\"", &["link"]),
    ("<robot name=\"r\"><link name=\"a\"/>", &["robot"]),
    ("<robot name=\"r\"><link name=\"a\"/></robot>", &["no link"]),
];

#[test]
fn bad_robot_files_are_refused_with_a_reason_by_every_command() {
    let folder = Folder::new("bad-robots");
    for (text, needles) in ROBOTS {
        let file = folder.file("robot", text);
        for command in ["show", "base", "compare"] {
            let run = roberval(&[command, &file]);
            assert_eq!(run.code, 2, "{command} {text:?}: {}", run.err);
            assert_eq!(run.out, "", "{command} {text:?}");
            for needle in *needles {
                assert!(run.err.contains(needle), "{text:?}: {}", run.err);
            }
        }
    }
}

#[test]
fn help_and_version_are_results() {
    for args in [
        &["--help"][..],
        &["base", "--help"],
        &["regressor", "--help"],
    ] {
        let run = roberval(args);
        assert_eq!((run.code, run.err.as_str()), (0, ""), "{args:?}");
        assert!(run.out.contains("Usage"), "{args:?}");
    }
    let version = roberval(&["--version"]);
    assert_eq!(
        version.out,
        concat!("roberval ", env!("CARGO_PKG_VERSION"), "\n")
    );
}
