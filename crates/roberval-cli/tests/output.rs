//! Where results go, and exit codes.

mod common;

use std::ffi::OsString;
use std::io::{self, Write};

use common::{Folder, roberval};

#[test]
fn output_files_get_the_result_and_stdout_nothing() {
    let folder = Folder::new("output");
    let file = folder.path("answer.json");
    let run = roberval(&["base", "puma560", "--format", "json", "-o", &file]);
    assert_eq!((run.code, run.out.as_str()), (0, ""), "{}", run.err);
    let direct = roberval(&["base", "puma560", "--format", "json"]);
    assert_eq!(std::fs::read_to_string(&file).expect("written"), direct.out);
    assert_eq!(folder.names(), ["answer.json"]);
}

#[test]
fn output_files_are_replaced_as_a_whole_or_not_at_all() {
    let folder = Folder::new("replace");
    let file = folder.file("out", "old");
    let states = folder.file("bad.csv", "q_1,q_2\n1,nan\n");
    let bad: [&[&str]; 3] = [
        &["base", "puma560", "--keep", "MX_9", "-o", &file],
        &["base", "nobody", "-o", &file],
        &[
            "regressor",
            "two_link",
            &states,
            "--model",
            "d",
            "-o",
            &file,
        ],
    ];
    for args in bad {
        assert_eq!(roberval(args).code, 2, "{args:?}");
        assert_eq!(std::fs::read_to_string(&file).expect("still there"), "old");
    }
    assert_eq!(folder.names(), ["bad.csv", "out"]);
    assert_eq!(roberval(&["show", "-o", &file]).code, 0);
    assert!(
        std::fs::read_to_string(&file)
            .expect("replaced")
            .contains("puma560")
    );
    assert_eq!(folder.names(), ["bad.csv", "out"]);
}

#[test]
#[cfg(unix)]
fn links_stay_links_and_devices_devices() {
    let folder = Folder::new("links");
    let (file, link) = (folder.file("file", "old"), folder.path("link"));
    std::os::unix::fs::symlink(&file, &link).expect("a link");
    assert_eq!(roberval(&["show", "-o", &link]).code, 0);
    assert!(
        std::fs::symlink_metadata(&link)
            .expect("there")
            .is_symlink()
    );
    assert!(
        std::fs::read_to_string(&file)
            .expect("there")
            .contains("puma560")
    );
    assert_eq!(roberval(&["show", "-o", "/dev/null"]).code, 0);
    let full = roberval(&["show", "-o", "/dev/full"]);
    assert_eq!(full.code, 2);
    assert!(
        full.err.contains("/dev/full: cannot be written"),
        "{}",
        full.err
    );
}

/// A reader that goes away after some bytes.
struct Closing(usize, io::ErrorKind);

impl Write for Closing {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.0 == 0 {
            return Err(self.1.into());
        }
        let count = bytes.len().min(self.0);
        self.0 -= count;
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_closed_pipe_is_quiet_and_a_full_disk_is_an_error() {
    let run = |kind| {
        let args = ["roberval", "base", "puma560"].map(OsString::from);
        let mut err = Vec::new();
        let code = roberval_cli::run(
            args,
            &mut Closing(100, kind),
            &mut err,
            roberval_cli::Look::default(),
        );
        (code, String::from_utf8(err).expect("UTF-8"))
    };
    assert_eq!(run(io::ErrorKind::BrokenPipe), (0, String::new()));
    let (code, err) = run(io::ErrorKind::StorageFull);
    assert_eq!(code, 2);
    assert!(
        err.contains("the standard output cannot be written"),
        "{err}"
    );
}

/// The second joint axis is a hundred-thousandth of a radian off the first: the engines can tell
/// them apart, but not beyond doubt.
const DOUBTFUL: &str = "\
link = [
  { alpha = 0, d = 0, theta = 0, r = 0 },
  { alpha = 0.00001, d = 0.4, theta = 0, r = 0 },
  { alpha = 0, d = 0.3, theta = 0, r = 0 },
]
";

#[test]
fn doubtful_ranks_have_exit_code_1_and_their_reason_on_stderr() {
    let folder = Folder::new("doubt");
    let robot = folder.file("robot.toml", DOUBTFUL);
    let base = ["base", &robot, "--engine", "qr", "--snap", "off"];
    let compare = ["compare", &robot, "--snap", "off"];
    for command in [base.as_slice(), &compare] {
        let run = roberval(command);
        assert_eq!(run.code, 1, "{command:?}: {}", run.err);
        assert!(
            run.err.contains("roberval: doubt:"),
            "{command:?}: {}",
            run.err
        );
        assert!(!run.out.is_empty());
    }
    let run = roberval(&base);
    assert!(run.out.contains("DOUBTFUL"), "{}", run.out);
}

#[test]
fn a_rounding_is_set_right_by_default_and_the_file_as_written_reported() {
    let folder = Folder::new("rounding");
    let robot = folder.file("robot.toml", DOUBTFUL);
    let run = roberval(&["base", &robot]);
    assert_eq!(run.code, 0, "{}", run.err);
    assert!(run.out.contains("Structural rank 9"), "{}", run.out);
    let literal = "as written the file has 17 base parameters instead of 9: link 2 alpha = 0.00001";
    assert!(run.err.contains(literal), "{}", run.err);
    let cleaned = folder.path("cleaned.toml");
    let run = roberval(&["clean", &robot, "-o", &cleaned]);
    assert_eq!(run.code, 0, "{}", run.err);
    assert!(run.err.contains("link 2 alpha = 0.00001"), "{}", run.err);
    let run = roberval(&["base", &cleaned, "--snap", "off"]);
    assert!(run.out.contains("Structural rank 9"), "{}", run.out);
}

/// An arm whose second axis is turned out of the vertical by fixed joints and its own origin.
fn tilted(rolls: [&str; 3]) -> String {
    let joint = |name: &str, kind: &str, [parent, child]: [&str; 2], xyz: &str, roll: &str| {
        format!(
            r#"<link name="{child}"/><joint name="{name}" type="{kind}"><parent link="{parent}"/>
            <child link="{child}"/><origin xyz="{xyz}" rpy="{roll} 0 0"/><axis xyz="0 0 1"/></joint>"#
        )
    };
    [
        r#"<robot name="tilted"><link name="base"/>"#.to_owned(),
        joint("j1", "continuous", ["base", "l1"], "0 0 0.3", "0"),
        joint("f1", "fixed", ["l1", "a"], "0.1 0.2 0", rolls[0]),
        joint("f2", "fixed", ["a", "b"], "0 0 0", rolls[1]),
        joint("j2", "continuous", ["b", "l2"], "0 0 0", rolls[2]),
        joint("j3", "continuous", ["l2", "l3"], "0.4 0 0", "0"),
        "</robot>".to_owned(),
    ]
    .concat()
}

#[test]
fn angles_that_add_up_to_a_right_one_but_for_the_last_digit_are_doubtful() {
    let folder = Folder::new("sum");
    let robot = folder.file("sum.urdf", tilted(["1.2", "0.7707963267948966", "-0.4"]));
    let run = roberval(&["base", &robot]);
    assert_eq!(run.code, 1, "{}", run.err);
    assert!(
        run.err.contains("doubt: all float engines count"),
        "{}",
        run.err
    );
    let robot = folder.file("clear.urdf", tilted(["1.2", "0.77", "-0.4"]));
    let run = roberval(&["base", &robot]);
    assert_eq!(run.code, 0, "{}", run.err);
}

#[test]
fn near_misses_are_warnings_that_say_what_they_would_change() {
    let folder = Folder::new("near");
    let robot = folder.file("near.urdf", tilted(["1.57", "0", "0"]));
    let run = roberval(&["base", &robot]);
    assert_eq!(run.code, 0, "{}", run.err);
    let near =
        "warning: f1 rpy[0] = 1.57 is 8.0e-4 rad from pi/2: left as written; set right, it would";
    assert!(run.err.contains(near), "{}", run.err);
    assert!(run.err.contains(" make "), "{}", run.err);
    let run = roberval(&["base", &robot, "--engine", "qr"]);
    assert!(run.err.contains("warning: f1 rpy[0] = 1.57"), "{}", run.err);
    let robot = folder.file(
        "same.urdf",
        tilted(["0", "0", "0"]).replacen("0 0 0\"", "0 0 1.57\"", 1),
    );
    let run = roberval(&["base", &robot]);
    assert!(run.err.contains("it would stay at"), "{}", run.err);
}

#[test]
fn a_file_taken_as_written_has_the_same_count_in_the_note_and_by_request() {
    let folder = Folder::new("written");
    let robot = folder.file("r.urdf", tilted(["1.5707963267948966", "0", "0"]));
    let literal = roberval(&["base", &robot, "--snap", "off"]);
    assert_eq!(literal.code, 1, "doubtful: {}", literal.err);
    let rank = literal
        .out
        .split("Structural rank ")
        .nth(1)
        .expect("a rank");
    let rank = rank.split(' ').next().expect("a number");
    let run = roberval(&["base", &robot]);
    assert_eq!(run.code, 0, "{}", run.err);
    let note = format!("as written the file has {rank} base parameters instead of");
    assert!(run.err.contains(&note), "{}", run.err);
    assert!(
        run.err.contains("for last digits of doubles only"),
        "{}",
        run.err
    );
}

#[test]
fn clear_ranks_have_exit_code_0_for_every_built_in_robot() {
    let list = roberval(&["show", "--format", "csv"]);
    let names = list.out.lines().skip(1).filter_map(|l| l.split(',').next());
    for name in names {
        let run = roberval(&["compare", name]);
        assert_eq!((run.code, run.err.as_str()), (0, ""), "{name}: {}", run.out);
    }
}

#[test]
fn options_change_the_answer_they_speak_of() {
    let json = |args: &[&str]| {
        let args = [&["base", "puma560", "--format", "json"], args].concat();
        let run = roberval(&args);
        assert_eq!(run.code, 0, "{args:?}: {}", run.err);
        serde_json::from_str::<serde_json::Value>(&run.out).expect("JSON")
    };
    let answer = json(&[
        "--model", "h", "--engine", "svd", "--seed", "7", "--rows", "80",
    ]);
    assert_eq!(answer["model"], "h");
    assert_eq!(answer["engine"], "svd");
    assert_eq!(answer["seed"], 7);
    assert_eq!(answer["rows"], 80);
    assert_eq!(answer["rank"], 40);
    let kept = json(&["--keep", "YY_3,MZ_4", "--drop", "XX_2"]);
    let has = |set: &str, label| {
        let set = kept[set].as_array().expect("a list");
        set.iter().any(|l| l == label)
    };
    assert!(has("base", "YY_3") && has("base", "MZ_4") && has("regrouped", "XX_2"));
    assert_eq!(kept["choice"]["rule"], "prefer");
    assert_eq!(kept["choice"]["keep"][1], "MZ_4");
    let weightless = json(&["--gravity", "0,0,0"]);
    assert_eq!(weightless["robot"]["gravity"][2], 0.0);
    assert_eq!(json(&["--choice", "pivoted"])["rank"], 40);
    let paper = json(&["--paper-tolerance", "--engine", "qrii"]);
    assert_eq!(paper["rank"], 40);
    let coarse = roberval(&[
        "base",
        "puma560",
        "--paper-tolerance=1e-2",
        "--engine",
        "qrii",
    ]);
    assert!(!coarse.out.contains("40 base parameters"), "{}", coarse.out);
}

#[test]
fn a_certificate_is_accepted_by_the_separate_checker_and_refused_when_changed() {
    let checker = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../python/roberval/check_certificate.py"
    );
    let folder = Folder::new("certificate");
    let path = folder.path("cert.json");
    let run = roberval(&["base", "puma560", "--certificate", &path]);
    assert_eq!(run.code, 0, "{}", run.err);
    let check = || {
        std::process::Command::new("python3")
            .arg(checker)
            .arg(&path)
            .output()
    };
    let Ok(accepted) = check() else {
        eprintln!("skipped: there is no python3 to run the checker");
        return;
    };
    assert!(accepted.status.success(), "{accepted:?}");
    let text = std::fs::read_to_string(&path).expect("written");
    std::fs::write(&path, text.replacen("363/1250", "364/1250", 1)).expect("a temporary file");
    let refused = check().expect("python3 ran before");
    assert_eq!(refused.status.code(), Some(1), "{refused:?}");
    let run = roberval(&["base", "puma560", "--certificate", &path, "--engine", "qr"]);
    assert_eq!(run.code, 2);
    assert!(run.err.contains("only the exact engine"), "{}", run.err);
}
