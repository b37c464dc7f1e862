//! What a new user meets: demo, report, lint, orders, completions, colours.

mod common;

use std::ffi::OsString;

use common::{Folder, roberval};
use roberval_cli::Look;
use serde_json::Value;

const ROUNDED: &str = r#"<robot name="r"><link name="a"/>
<link name="b"><inertial><mass value="2"/><origin xyz="0 0 3"/>
<inertia ixx="0.5" ixy="0" ixz="0" iyy="0.5" iyz="0" izz="0.5"/></inertial></link>
<joint name="j" type="continuous"><parent link="a"/><child link="b"/>
<origin rpy="1.5708 0 0"/><axis xyz="0 0 1"/></joint></robot>
"#;

const MOST_BYTES: usize = 1_000_000;

#[test]
fn the_demo_writes_a_report_and_says_what_to_try_next() {
    let folder = Folder::new("demo");
    let path = folder.path("demo.html");
    let run = roberval(&["demo", "-o", &path]);
    assert_eq!((run.code, run.err.as_str()), (0, ""));
    for piece in [
        "66",
        "40 combinations",
        "XXR_6 = XX_6 - YY_6",
        "roberval lint",
        &path,
    ] {
        assert!(run.out.contains(piece), "{piece}: {}", run.out);
    }
    let page = std::fs::read_to_string(&path).expect("written");
    assert!(page.starts_with("<!DOCTYPE html>") && page.ends_with("</html>\n"));
}

#[test]
fn a_report_comes_beside_the_table_and_never_on_stdout() {
    let folder = Folder::new("report");
    let path = folder.path("report.html");
    let run = roberval(&["base", "two_link", "--report", &path]);
    assert_eq!(run.out, roberval(&["base", "two_link"]).out);
    assert!(
        run.err.contains(&format!("note: wrote {path}")),
        "{}",
        run.err
    );
    let page = std::fs::read_to_string(&path).expect("written");
    assert!(
        page.contains("<h1>Planar") || page.contains("<h1>"),
        "{page}"
    );
    assert_eq!(roberval(&["base", "two_link", "--report", "-"]).code, 2);
    let nowhere = folder.path("nowhere/report.html");
    assert_eq!(
        roberval(&["base", "two_link", "--report", &nowhere]).code,
        2
    );
}

#[test]
fn the_report_of_sixty_joints_with_long_names_stays_below_a_megabyte() {
    let folder = Folder::new("sixty");
    // Two legs, two arms and a head on a torso; shoulders, hips and wrists of three axes.
    let mut toml = String::from("name = \"sixty\"\n");
    for (limb, from) in [
        ("left_leg", 12),
        ("right_leg", 12),
        ("torso", 3),
        ("left_arm", 15),
        ("right_arm", 15),
        ("head", 3),
    ] {
        for j in 0..from {
            let antecedent = match (limb, j) {
                ("left_leg" | "right_leg" | "torso", 0) => "base".to_owned(),
                (_, 0) => "torso_actuated_segment_2".to_owned(),
                _ => format!("{limb}_actuated_segment_{}", j - 1),
            };
            let (alpha, d, r) = (
                [90, -90, 0][j % 3],
                [0.0, 0.0, 0.2][j % 3],
                [0.0, 0.1, 0.0][j % 3],
            );
            toml += &format!(
                "[[link]]\nname = \"{limb}_actuated_segment_{j}\"\nantecedent = \"{antecedent}\"\n\
                 alpha = \"{alpha} deg\"\nd = {d}\ntheta = 0\nr = {r}\n"
            );
        }
    }
    let robot = folder.file("sixty.toml", &toml);
    let path = folder.path("sixty.html");
    let run = roberval(&["base", &robot, "--report", &path]);
    assert_eq!(run.code, 0, "{}", run.err);
    let bytes = std::fs::metadata(&path).expect("written").len();
    assert!(bytes < MOST_BYTES as u64, "{bytes} bytes");
}

#[test]
fn lint_says_where_and_what_and_its_exit_codes_are_for_machines() {
    let folder = Folder::new("lint");
    let file = folder.file("r.urdf", ROUNDED);
    let run = roberval(&["lint", &file]);
    assert_eq!(run.code, 1);
    assert!(run.err.contains("roberval clean"), "{}", run.err);
    assert!(
        run.out
            .starts_with(&format!("{file}:5:9: warning: j rpy[0] = 1.5708")),
        "{}",
        run.out
    );
    assert!(
        run.out
            .ends_with("[rounded-angle]; write 1.5707963267948966 (pi/2)\n")
    );
    let json = roberval(&["lint", &file, "two_link", "--format", "json"]);
    let found: Value = serde_json::from_str(&json.out).expect("JSON");
    assert_eq!(found["findings"][0]["line"], 5);
    assert_eq!(found["findings"][0]["rule"], "rounded-angle");
    let ignored = roberval(&["lint", &file, "--ignore", "rounded-angle"]);
    assert_eq!((ignored.code, ignored.out.as_str()), (0, ""));
    assert_eq!(roberval(&["lint", &file, "--ignore", "rounded"]).code, 2);
    let errors = roberval(&["lint", &file, "--errors-only"]);
    assert_eq!((errors.code, errors.out.as_str()), (0, ""));
    let nothing = roberval(&["lint", "no_such_file"]);
    assert_eq!(nothing.code, 2);
    assert!(!nothing.err.contains("0 errors"), "{}", nothing.err);
    let missing = roberval(&["lint", &file, "no_such_file"]);
    assert_eq!(missing.code, 2);
    assert!(
        missing.out.contains("rounded-angle"),
        "the others are linted"
    );
}

#[test]
fn the_orders_are_those_of_pinocchio_urdf_and_mujoco() {
    let folder = Folder::new("orders");
    let file = folder.file("r.urdf", ROUNDED);
    let row = |order: &str| {
        let run = roberval(&["show", &file, "--order", order, "--format", "csv"]);
        assert_eq!(run.code, 0, "{}", run.err);
        let line = run.out.lines().nth(1).expect("a link").to_owned();
        let numbers = line.split(',').skip(1).filter_map(|x| x.parse().ok());
        numbers.collect::<Vec<f64>>()
    };
    let ball = 18.5;
    assert_eq!(row("paper"), [ball, 0., 0., ball, 0., 0.5, 0., 0., 6., 2.]);
    assert_eq!(
        row("pinocchio"),
        [2., 0., 0., 6., ball, 0., ball, 0., 0., 0.5]
    );
    assert_eq!(row("urdf"), [2., 0., 0., 3., 0.5, 0., 0., 0.5, 0., 0.5]);
    assert_eq!(
        row("mujoco"),
        [2., 0., 0., 3., 1., 0., 0., 0., 0.5, 0.5, 0.5]
    );
    assert_eq!(roberval(&["show", "--order", "paper"]).code, 2);
}

#[test]
fn colours_are_for_terminals_only_and_change_no_word() {
    let coloured = |args: &[&str]| {
        let args = std::iter::once(&"roberval").chain(args).map(OsString::from);
        let (mut out, mut err) = (Vec::new(), Vec::new());
        let look = Look {
            colour: true,
            progress: false,
        };
        roberval_cli::run(args, &mut out, &mut err, look);
        String::from_utf8(out).expect("UTF-8")
    };
    let plain = roberval(&["base", "puma560"]).out;
    assert!(!plain.contains('\x1b'));
    let painted = coloured(&["base", "puma560"]);
    assert!(painted.contains("\x1b[32m=\x1b[0m"));
    let mut bare = String::new();
    for (i, piece) in painted.split('\x1b').enumerate() {
        bare += match i {
            0 => piece,
            _ => piece.split_once('m').expect("a colour").1,
        };
    }
    let trimmed = |text: &str| {
        text.lines()
            .map(str::trim_end)
            .collect::<Vec<_>>()
            .join("\n")
    };
    assert_eq!(trimmed(&bare), trimmed(&plain));
    let json = coloured(&["base", "puma560", "--format", "json"]);
    assert!(!json.contains('\x1b'));
}

#[test]
fn completions_come_for_every_shell() {
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let run = roberval(&["completions", shell]);
        assert_eq!(run.code, 0, "{}", run.err);
        assert!(
            run.out.contains("lint") && run.out.contains("certificate"),
            "{shell}"
        );
    }
}
