//! `roberval regressor`: states in, W out.

mod common;

use std::io::Write;

use common::{Folder, roberval, roberval_bytes};
use roberval_base::{Options, base_parameters};
use roberval_mechanism::Mechanism;
use roberval_regressor::{Model, Regressor, States};
use zip::write::{SimpleFileOptions, ZipWriter};

/// The states of the tests: N = 3, n = 2, exact in float32.
const Q: [f64; 6] = [0.5, -1.25, 2.0, 0.0, -3.0, 1.0];
const QD: [f64; 6] = [1.0, 2.0, -0.5, 0.25, 4.0, -1.0];
const QDD: [f64; 6] = [-1.0, 0.0, 3.0, 7.5, 0.125, 2.0];

fn two_link() -> Mechanism {
    let robot = roberval_formats::load("two_link").expect("built in");
    Mechanism::new(&robot).expect("valid")
}

/// The shape and the numbers of an NPY file of float64 in C order.
fn npy(bytes: &[u8]) -> (String, Vec<f64>) {
    assert_eq!(bytes[..8], *b"\x93NUMPY\x01\x00");
    let size = usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    assert_eq!((10 + size) % 64, 0, "numbers are aligned");
    let header = std::str::from_utf8(&bytes[10..10 + size]).expect("ASCII");
    let shape = header
        .strip_prefix("{'descr': '<f8', 'fortran_order': False, 'shape': (")
        .and_then(|rest| rest.trim_end().strip_suffix("), }"))
        .expect(header);
    let numbers = bytes[10 + size..].chunks_exact(8);
    let numbers = numbers.map(|b| f64::from_le_bytes(b.try_into().expect("8 bytes")));
    (shape.to_owned(), numbers.collect())
}

fn csv() -> String {
    let mut text = "time,qdd_2,q_1,q_2,qd_1,qd_2,qdd_1\n".to_owned();
    for k in 0..3 {
        let (i, j) = (2 * k, 2 * k + 1);
        text += &format!(
            "{k},{}, {},{},{},{},{}\r\n",
            QDD[j], Q[i], Q[j], QD[i], QD[j], QDD[i]
        );
    }
    text
}

/// W from the library, with all columns or the base parameters'.
fn expected(model: Model, reduced: bool) -> Vec<f64> {
    let robot = two_link();
    let states = States {
        q: &Q,
        qd: &QD,
        qdd: &QDD,
    };
    let options = Options {
        model,
        ..Options::default()
    };
    let base = base_parameters(&robot, &options).expect("valid").base;
    let regressor = Regressor::new(&robot);
    let width = if reduced {
        base.len()
    } else {
        regressor.parameters().len()
    };
    let mut out = vec![0.0; 3 * model.rows(2) * width];
    if reduced {
        regressor
            .fill_columns(model, &base, states, &mut out)
            .expect("valid");
    } else {
        regressor.fill(model, states, &mut out).expect("valid");
    }
    out
}

#[test]
fn csv_states_give_the_librarys_rows_in_every_model() {
    let folder = Folder::new("csv");
    let states = folder.file("states.csv", csv());
    for (model, full, reduced) in [
        (Model::D, "3, 2, 22", "3, 2, 7"),
        (Model::D0, "3, 2, 22", "3, 2, 7"),
        (Model::H, "3, 22", "3, 7"),
    ] {
        let args = [
            "regressor",
            "two_link",
            &states,
            "--model",
            model.name(),
            "-o",
            "-",
        ];
        let (code, out, err) = roberval_bytes(&args);
        assert_eq!(code, 0, "{err}");
        assert_eq!(npy(&out), (full.to_owned(), expected(model, false)));
        let (code, out, err) = roberval_bytes(&[&args[..], &["--base"]].concat());
        assert_eq!(code, 0, "{err}");
        assert_eq!(npy(&out), (reduced.to_owned(), expected(model, true)));
        assert!(err.contains("not used: time"), "{err}");
    }
}

#[test]
fn columns_may_carry_joint_and_link_names() {
    let folder = Folder::new("names");
    let urdf = "<robot name='r'><link name='b'/><link name='upper arm'/><link name='fore'/>\
        <joint name='shoulder' type='continuous'><parent link='b'/><child link='upper arm'/></joint>\
        <joint name='elbow' type='continuous'><parent link='upper arm'/><child link='fore'/>\
        <origin xyz='0.4 0 0'/></joint></robot>";
    let robot = folder.file("r.urdf", urdf);
    let run = |header: &str| {
        let states = folder.file("s.csv", format!("{header}\n1,2,3,4,5,6\n"));
        let (code, out, err) = roberval_bytes(&["regressor", &robot, &states, "-o", "-"]);
        assert_eq!(code, 0, "{header}: {err}");
        out
    };
    let by_number = run("q_1,q_2,qd_1,qd_2,qdd_1,qdd_2");
    assert_eq!(
        by_number,
        run("q_shoulder,q_elbow,qd_shoulder,qd_elbow,qdd_shoulder,qdd_elbow")
    );
    assert_eq!(
        by_number,
        run("\u{feff}q_upper arm,q_fore,qd_1,qd_elbow,qdd_1,qdd_2")
    );
    assert_ne!(by_number, run("q_2,q_1,qd_1,qd_2,qdd_1,qdd_2"));
}

/// An NPY file with this header text and these numbers.
fn array(descr: &str, fortran: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let header = format!("{{'descr': {descr}, 'fortran_order': {fortran}, 'shape': {shape}, }}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(data);
    bytes
}

fn float64(shape: &str, numbers: &[f64]) -> Vec<u8> {
    let data: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
    array("'<f8'", "False", shape, &data)
}

fn npz(arrays: &[(&str, Vec<u8>)], packed: bool) -> Vec<u8> {
    let method = match packed {
        true => zip::CompressionMethod::Deflated,
        false => zip::CompressionMethod::Stored,
    };
    let options = SimpleFileOptions::default().compression_method(method);
    let mut writer = ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for (name, bytes) in arrays {
        writer
            .start_file(format!("{name}.npy"), options)
            .expect("in memory");
        writer.write_all(bytes).expect("in memory");
    }
    writer.finish().expect("in memory").into_inner()
}

fn good() -> Vec<(&'static str, Vec<u8>)> {
    vec![
        ("q", float64("(3, 2)", &Q)),
        ("qd", float64("(3, 2)", &QD)),
        ("qdd", float64("(3, 2)", &QDD)),
    ]
}

#[test]
fn npz_states_of_every_type_and_order_give_the_librarys_rows() {
    let folder = Folder::new("npz");
    let q32: Vec<u8> = Q.iter().flat_map(|x| (*x as f32).to_be_bytes()).collect();
    let turned = [QD[0], QD[2], QD[4], QD[1], QD[3], QD[5]];
    let turned: Vec<u8> = turned.iter().flat_map(|x| x.to_le_bytes()).collect();
    let variants = [
        npz(&good(), false),
        npz(&good(), true),
        npz(
            &[
                ("labels", b"ignored".to_vec()),
                ("q", array("'>f4'", "False", "(3, 2)", &q32)),
                ("qd", array("'<f8'", "True", "(3, 2)", &turned)),
                ("qdd", float64("(3, 2)", &QDD)),
            ],
            true,
        ),
    ];
    for bytes in variants {
        let states = folder.file("s.npz", bytes);
        let file = folder.path("W.npy");
        let run = roberval(&["regressor", "two_link", &states, "-o", &file]);
        assert_eq!((run.code, run.out.as_str()), (0, ""), "{}", run.err);
        let written = std::fs::read(&file).expect("written");
        assert_eq!(
            npy(&written),
            ("3, 2, 22".to_owned(), expected(Model::D, false))
        );
    }
}

#[test]
fn whole_numbers_are_states_too() {
    let folder = Folder::new("ints");
    let ones: Vec<u8> = [1_i32; 6].iter().flat_map(|x| x.to_le_bytes()).collect();
    let ints = |d: &str| array(d, "False", "(3, 2)", &ones);
    let arrays = [
        ("q", ints("'<i4'")),
        ("qd", ints("'<u4'")),
        ("qdd", ints("'=i4'")),
    ];
    let whole = folder.file("i.npz", npz(&arrays, false));
    let float = float64("(3, 2)", &[1.0; 6]);
    let arrays = ["q", "qd", "qdd"].map(|name| (name, float.clone()));
    let float = folder.file("f.npz", npz(&arrays, false));
    let run = |file: &str| roberval_bytes(&["regressor", "two_link", file, "-o", "-"]);
    assert_eq!(run(&whole).0, 0);
    assert_eq!(run(&whole).1, run(&float).1);
}

#[test]
fn many_states_come_in_blocks_without_a_seam() {
    let folder = Folder::new("blocks");
    let count = 20_000; // 880 000 numbers: several blocks
    let q: Vec<f64> = (0..2 * count).map(|i| f64::from(i) * 1e-3).collect();
    let array = float64(&format!("({count}, 2)"), &q);
    let arrays = ["q", "qd", "qdd"].map(|name| (name, array.clone()));
    let states = folder.file("s.npz", npz(&arrays, true));
    let (code, out, _) = roberval_bytes(&["regressor", "two_link", &states, "-o", "-"]);
    assert_eq!(code, 0);
    let states = States {
        q: &q,
        qd: &q,
        qdd: &q,
    };
    let mut expected = vec![0.0; count as usize * 44];
    let regressor = Regressor::new(&two_link());
    regressor
        .fill(Model::D, states, &mut expected)
        .expect("valid");
    assert!(npy(&out).1 == expected);
}

const HEADER: &str = "q_1,q_2,qd_1,qd_2,qdd_1,qdd_2";

#[test]
fn bad_csv_states_are_refused_with_line_and_column() {
    let cases: &[(String, &[&str])] = &[
        (String::new(), &[":1:", "q_1"]),
        ("\n\n".to_owned(), &["q_1"]),
        (HEADER.to_owned(), &["no state"]),
        (
            format!("{HEADER}\n1,2,3,4,5\n"),
            &[":2:", "5 values under 6 columns"],
        ),
        (
            format!("{HEADER}\n1,2,3,4,5,6\n1,2,3,4,5,6,7\n"),
            &[":3:", "7 values"],
        ),
        (
            format!("{HEADER}\n1,2,3,4,5,6\n1,2,nan,4,5,6\n"),
            &[":3:", "column qd_1", "finite"],
        ),
        (
            format!("{HEADER}\n1,2,3,4,5,inf\n"),
            &[":2:", "column qdd_2", "finite"],
        ),
        (
            format!("{HEADER}\n1,2,3,4,1e999,6\n"),
            &["column qdd_1", "1e999", "finite"],
        ),
        (
            format!("{HEADER}\n1,2,3,,5,6\n"),
            &["column qd_2", "\"\"", "number"],
        ),
        (
            format!("{HEADER}\n1,2,3,four,5,6\n"),
            &["column qd_2", "four"],
        ),
        (format!("{HEADER}\n1,2,3,0x10,5,6\n"), &["0x10"]),
        (format!("{HEADER}\n1,2,3,4 5,5,6\n"), &["4 5"]),
        (format!("{HEADER}\n1,2,3,\u{ff11},5,6\n"), &["not a number"]),
        (
            format!("{HEADER}\n\"1,5\",2,3,4,5,6\n"),
            &["column q_1", "1,5"],
        ),
        (format!("{HEADER}\n\x1b[31m,2,3,4,5,6\n"), &["\\u{1b}"]),
        (
            "q_1,qd_1,qd_2,qdd_1,qdd_2\n1,2,3,4,5\n".to_owned(),
            &["no q_2"],
        ),
        ("q_1,q_2\n1,2\n".to_owned(), &["qd_1, qd_2, qdd_1, qdd_2"]),
        (
            "q1,q2,qd1,qd2,qdd1,qdd2\n1,2,3,4,5,6\n".to_owned(),
            &["no q_1", "q_1 .. q_2"],
        ),
        (
            "q_0,q_1,qd_1,qd_2,qdd_1,qdd_2\n1,2,3,4,5,6\n".to_owned(),
            &["no q_2"],
        ),
        (
            format!("{HEADER},q_1\n1,2,3,4,5,6,7\n"),
            &["1 (q_1)", "7 (q_1)", "both"],
        ),
        (
            "1,2,3,4,5,6\n1,2,3,4,5,6\n".to_owned(),
            &["first line must name"],
        ),
        (
            HEADER.replace(',', ";") + "\n1;2;3;4;5;6\n",
            &["separated by commas"],
        ),
        (
            HEADER.replace(',', "\t") + "\n1\t2\n",
            &["separated by commas"],
        ),
    ];
    let folder = Folder::new("bad-csv");
    for (text, needles) in cases {
        let states = folder.file("s.csv", text);
        refuse(&states, needles, text);
    }
    let bytes = [HEADER.as_bytes(), b"\n1,2,3,\xff,5,6\n"].concat();
    refuse(&folder.file("s.csv", bytes), &[":2:", "UTF-8"], "bad UTF-8");
    let endless = [HEADER.as_bytes(), b"\n", &vec![b'1'; 20 << 20]].concat();
    refuse(
        &folder.file("s.csv", endless),
        &["longer than 16 MiB"],
        "a long line",
    );
}

fn refuse(states: &str, needles: &[&str], what: &str) {
    let run = roberval(&["regressor", "two_link", states, "-o", "-"]);
    assert_eq!(run.code, 2, "{what:?}: {}", run.err);
    assert_eq!(run.out, "", "{what:?}");
    for needle in needles.iter().chain(&[states]) {
        assert!(
            run.err.contains(needle),
            "{what:?}: no {needle:?} in {}",
            run.err
        );
    }
    assert!(!run.err.contains('\x1b'), "{what:?}: {}", run.err);
}

#[test]
fn bad_npz_states_are_refused_by_array_and_reason() {
    let with = |name: &str, bytes: Vec<u8>| {
        let replace = |(n, good): (&'static str, Vec<u8>)| match n == name {
            true => (n, bytes.clone()),
            false => (n, good),
        };
        npz(&good().into_iter().map(replace).collect::<Vec<_>>(), false)
    };
    let plain = |descr: &str| with("qd", array(descr, "False", "(3, 2)", &[0; 96]));
    let huge = "(1099511627776, 2)";
    let mut nan = Q;
    nan[3] = f64::NAN;
    let cases: &[(&str, Vec<u8>, &[&str])] = &[
        ("no arrays", npz(&[], false), &["no array q", "no array"]),
        (
            "no qdd",
            npz(&good()[..2], false),
            &["no array qdd", "q, qd"],
        ),
        (
            "wrong width",
            with("q", float64("(2, 3)", &Q)),
            &["array q", "(2, 3)", "(N, 2)"],
        ),
        ("flat", with("q", float64("(6,)", &Q)), &["(6)", "(N, 2)"]),
        (
            "three axes",
            with("q", float64("(3, 2, 1)", &Q)),
            &["(3, 2, 1)"],
        ),
        (
            "scalar",
            with("q", float64("()", &Q[..1])),
            &["()", "(N, 2)"],
        ),
        (
            "no rows",
            with("q", float64("(0, 2)", &[])),
            &["array q has no state"],
        ),
        (
            "two counts",
            with("qd", float64("(2, 2)", &QD[..4])),
            &["qd has 2", "q has 3"],
        ),
        (
            "NaN",
            with("q", float64("(3, 2)", &nan)),
            &["array q", "[1, 1] is NaN"],
        ),
        (
            "cut off",
            with("qdd", float64("(3, 2)", &QDD[..5])),
            &["qdd", "cut off", "40 of 48"],
        ),
        (
            "too long",
            with("q", float64("(2, 2)", &Q)),
            &["more numbers than its shape"],
        ),
        (
            "8 TiB",
            with("q", float64(huge, &Q)),
            &["array q", "more numbers than the file"],
        ),
        (
            "overflow",
            with("q", float64("(4294967296, 4294967296, 2)", &Q)),
            &["expected (N, 2)"],
        ),
        (
            "beyond usize",
            with("q", float64("(99999999999999999999, 2)", &Q)),
            &["header"],
        ),
        ("negative", with("q", float64("(-3, 2)", &Q)), &["header"]),
        ("pickled", plain("'|O'"), &["array qd", "objects"]),
        ("complex", plain("'<c16'"), &["complex"]),
        ("text", plain("'<U4'"), &["texts"]),
        ("records", plain("[('a', '<f8')]"), &["records"]),
        ("half", plain("'<f2'"), &["<f2", "float64"]),
        ("long double", plain("'<f16'"), &["<f16"]),
        ("time", plain("'<M8[ns]'"), &["M8"]),
        ("no header", with("q", b"junk".to_vec()), &["array q"]),
        (
            "no magic",
            with("q", vec![b' '; 200]),
            &["not a NumPy array"],
        ),
        (
            "version 9",
            with("q", b"\x93NUMPY\x09\x00\x00\x00".to_vec()),
            &["version 9"],
        ),
        (
            "empty header",
            with("q", b"\x93NUMPY\x01\x00\x00\x00".to_vec()),
            &["header"],
        ),
        (
            "header cut off",
            with("q", b"\x93NUMPY\x01\x00\xff\x00{".to_vec()),
            &["within"],
        ),
        (
            "npy",
            float64("(3, 2)", &Q),
            &["one NumPy array", "np.savez"],
        ),
        (
            "zip magic only",
            b"PK\x03\x04".to_vec(),
            &["damaged or cut off"],
        ),
    ];
    let folder = Folder::new("bad-npz");
    for (what, bytes, needles) in cases {
        refuse(&folder.file("s.npz", bytes), needles, what);
    }
}

#[test]
fn damaged_archives_are_refused_at_every_cut_and_flip() {
    let folder = Folder::new("damaged");
    let whole = npz(&good(), true);
    let mut copy = Vec::new();
    for end in 0..whole.len() {
        let states = folder.file("s.npz", &whole[..end]);
        assert_eq!(
            roberval(&["regressor", "two_link", &states, "-o", "-"]).code,
            2,
            "{end}"
        );
    }
    let states = folder.file("s.npz", &whole);
    let expected = roberval_bytes(&["regressor", "two_link", &states, "-o", "-"]);
    for at in 0..whole.len() {
        copy.clone_from(&whole);
        copy[at] ^= 0x10;
        let states = folder.file("s.npz", &copy);
        let (code, out, _) = roberval_bytes(&["regressor", "two_link", &states, "-o", "-"]);
        // A flip in a time stamp changes nothing; one in the numbers never goes unseen.
        assert!(code == 2 || out == expected.1, "byte {at}");
    }
}

#[test]
fn a_model_needs_only_what_it_looks_at() {
    let folder = Folder::new("needs");
    let states = folder.file("s.csv", "q_1,q_2,qdd_1,qdd_2\n1,2,3,4\n");
    let run = |model| {
        roberval_bytes(&[
            "regressor",
            "two_link",
            &states,
            "--model",
            model,
            "-o",
            "-",
        ])
    };
    assert_eq!(run("d0").0, 0, "{}", run("d0").2);
    assert_eq!(run("d").0, 2);
    assert!(run("h").2.contains("no qd_1, qd_2"), "{}", run("h").2);
}

#[test]
fn samples_of_scale_are_states_of_regressor() {
    let folder = Folder::new("scale");
    let states = folder.path("states.csv");
    let run = roberval(&[
        "scale", "two_link", "--model", "d", "--format", "csv", "-o", &states,
    ]);
    assert_eq!((run.code, run.err.as_str()), (0, ""));
    let (code, out, err) = roberval_bytes(&["regressor", "two_link", &states, "-o", "-"]);
    assert_eq!(code, 0, "{err}");
    let json = roberval(&["scale", "two_link", "--model", "d", "--format", "json"]).out;
    let json: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    let count = json["samples"]["q"].as_array().map_or(0, Vec::len);
    assert_eq!(npy(&out).0, format!("{count}, 2, 22"));
    let s = |grade: &str| json[grade]["S"].as_f64().expect("a number");
    assert!(s("after") <= s("before"));
}

#[test]
fn states_of_robots_with_couples_or_loops_are_those_of_the_independent_joints() {
    let folder = Folder::new("independent");
    for robot in ["hitachi_hpr", "sr400", "four_bar"] {
        let states = folder.path("scaled.csv");
        let scale = [
            "scale", robot, "--target", "1e99", "--format", "csv", "-o", &states,
        ];
        if robot != "four_bar" {
            let run = roberval(&scale);
            assert_eq!(run.code, 0, "{robot}: {}", run.err);
        } else {
            folder.file("scaled.csv", "q_1,qd_1,qdd_1\n0.1,0.2,0.3\n");
        }
        let (code, out, err) = roberval_bytes(&["regressor", robot, &states, "-o", "-"]);
        assert_eq!(code, 0, "{robot}: {err}");
        assert!(out.starts_with(b"\x93NUMPY"), "{robot}");
    }
}

#[test]
fn numbers_that_are_the_names_of_other_joints_are_refused() {
    let folder = Folder::new("numerals");
    let titles: Vec<String> = ["q", "qd", "qdd"]
        .iter()
        .flat_map(|array| (1..=5).map(move |j| format!("{array}_{j}")))
        .collect();
    let text = format!("{}\n{}\n", titles.join(","), ["0.5"; 15].join(","));
    let states = folder.file("s.csv", text);
    let run = roberval(&["regressor", "hitachi_hpr", &states, "-o", "-"]);
    assert_eq!(run.code, 2);
    let words = "columns 2 (q_2) and 3 (q_3) both give q of joint 2";
    assert!(run.err.contains(words), "{}", run.err);
}

#[test]
fn lines_are_counted_as_editors_count_them() {
    let folder = Folder::new("lines");
    let good = "1,2,3,4,5,6";
    for end in ["\n", "\r\n", "\r"] {
        for (last, words) in [("1,2,x,4,5,6", ":6: column qd_1"), ("1,2", ":6: 2 values")] {
            for tail in ["", end] {
                let lines = ["", HEADER, good, good, "", last];
                let text = format!("{}{tail}", lines.join(end));
                let run = roberval(&[
                    "regressor",
                    "two_link",
                    &folder.file("s.csv", text),
                    "-o",
                    "-",
                ]);
                assert!(run.err.contains(words), "{end:?} {tail:?}: {}", run.err);
            }
        }
    }
}
