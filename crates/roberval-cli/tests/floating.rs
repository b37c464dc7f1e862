//! Robots that float, from the command line.

mod common;

use common::{Folder, roberval, roberval_bytes};
use serde_json::Value;

#[test]
fn base_counts_the_floating_ur5_of_the_catalogue() {
    let run = roberval(&[
        "base",
        "ur5",
        "--floating",
        "--no-rotors",
        "--format",
        "json",
    ]);
    assert_eq!(run.code, 0, "{}", run.err);
    let answer: Value = serde_json::from_str(&run.out).expect("JSON");
    assert_eq!(answer["rank"], 52);
    assert_eq!(answer["robot"]["links"][0]["type"], "floating");
    let still = roberval(&["base", "ur5", "--no-rotors", "--format", "json"]);
    let still: Value = serde_json::from_str(&still.out).expect("JSON");
    assert_eq!(still["rank"], 36);
}

#[test]
fn show_names_the_rows_of_the_base() {
    let run = roberval(&["show", "two_link", "--floating"]);
    let words = "2 joint variables and a base with 6; rows 0.fx .. 0.mz";
    assert!(run.out.contains(words), "{}", run.out);
    assert!(run.out.contains("q_1..q_7"), "{}", run.out);
}

const HEADER: &str = "q_0.x,q_0.y,q_0.z,q_0.qx,q_0.qy,q_0.qz,q_0.qw,q_1,q_2,\
    qd_0.vx,qd_0.vy,qd_0.vz,qd_0.wx,qd_0.wy,qd_0.wz,qd_1,qd_2,\
    qdd_0.vx,qdd_0.vy,qdd_0.vz,qdd_0.wx,qdd_0.wy,qdd_0.wz,qdd_1,qdd_2";

#[test]
fn regressor_reads_states_by_name() {
    let folder = Folder::new("floating-states");
    let header = HEADER;
    let states = format!(
        "{header}\n0,0,0,0,0,0.6,0.8,1,2,{}\n",
        ["0.5"; 16].join(",")
    );
    let states = folder.file("states.csv", states);
    let (code, out, err) =
        roberval_bytes(&["regressor", "two_link", &states, "--floating", "-o", "-"]);
    assert_eq!(code, 0, "{err}");
    assert!(err.contains("array of 1 x 8 x 32"), "{err}");
    assert!(out.starts_with(b"\x93NUMPY"));
    let named = folder.file(
        "bad.csv",
        format!(
            "{}\n{}\n",
            header.replace("q_0.qw,", ""),
            ["0.5"; 24].join(",")
        ),
    );
    let run = roberval(&["regressor", "two_link", &named, "--floating", "-o", "-"]);
    assert_eq!(run.code, 2);
    assert!(
        run.err.contains("every coordinate, and there is no q_0.qw"),
        "{}",
        run.err
    );
    let short = folder.file(
        "short.csv",
        format!(
            "{header}\n0,0,0,0,0,0.6,0.1,1,2,{}\n",
            ["0.5"; 16].join(",")
        ),
    );
    let run = roberval(&["regressor", "two_link", &short, "--floating", "-o", "-"]);
    assert_eq!(run.code, 2);
    assert!(run.err.contains("must be a quaternion"), "{}", run.err);
}

#[test]
fn scale_writes_states_that_regressor_reads() {
    let folder = Folder::new("floating-scale");
    let path = folder.path("samples.csv");
    let robot = ["two_link", "--floating"];
    let scale = [
        "scale", robot[0], robot[1], "--target", "1e9", "--format", "csv", "-o", &path,
    ];
    let run = roberval(&scale);
    assert_eq!(run.code, 0, "{}", run.err);
    let read = [
        "regressor",
        robot[0],
        &path,
        robot[1],
        "--model",
        "h",
        "-o",
        "-",
    ];
    let (code, _, err) = roberval_bytes(&read);
    assert_eq!(code, 0, "{err}");
}
