//! Loops in robot TOML: what is read, written, cleaned and refused.

use roberval_formats::{clean_toml, parse_toml, to_toml};
use roberval_mechanism::{CleanPolicy, Cut, LoopClosure};

/// Two arms on the base and the text of a loop, which begins in line 11.
fn robot(closure: &str) -> String {
    format!(
        "constants = {{ L = 0.9 }}\n\
         [[link]]\nname = \"a\"\nalpha = 0\nd = 0\nr = 0\n\
         [[link]]\nname = \"b c\"\nantecedent = \"base\"\nalpha = 0\nd = 1\nr = 0\n{closure}"
    )
}

fn only_loop(closure: &str) -> LoopClosure {
    let text = robot(closure);
    let mut read = parse_toml(&text, "r.toml").unwrap_or_else(|e| panic!("{e}\n{text}"));
    assert_eq!(read.loops.len(), 1);
    read.loops.remove(0)
}

const GOOD: &str =
    "[[loop]]\nbetween = [\"a\", \"b c\"]\nat = [[\"L\", 0, 0], [0.7, 0, 0]]\ncut = \"revolute\"\n";

#[test]
fn points_have_the_axes_of_their_links() {
    let closure = only_loop(&format!(
        "{GOOD}near = {{ a = \"30 deg\", \"b c\" = -1.50 }}\n"
    ));
    assert_eq!(
        closure.between,
        [Some("a".to_owned()), Some("b c".to_owned())]
    );
    assert_eq!(closure.cut, Cut::Revolute);
    let [a, b] = &closure.frames;
    assert_eq!((a.xyz[0].text.as_str(), a.xyz[0].value), ("L", 0.9));
    assert!(b.rpy.iter().all(|x| x.value == 0.0));
    assert_eq!(closure.near[1].0, "b c");
    assert_eq!(closure.near[1].1.text, "-1.50");
    assert!((closure.near[0].1.value - 30_f64.to_radians()).abs() < 1e-15);
}

#[test]
fn frames_have_their_own_axes_and_the_base_may_be_a_side() {
    for cut in Cut::ALL {
        let closure = only_loop(&format!(
            "[[loop]]\nbetween = [\"a\", \"base\"]\ncut = \"{cut}\"\n\
             frames = [{{ rpy = [\"90 deg\", 0, 0] }}, {{ xyz = [1, 2, 3] }}]\n"
        ));
        assert_eq!(closure.between, [Some("a".to_owned()), None]);
        assert_eq!(closure.cut, cut);
        assert_eq!(closure.frames[0].rpy[0].text, "90 deg");
        assert_eq!(closure.frames[0].xyz[0].value, 0.0);
        assert_eq!(closure.frames[1].xyz[2].value, 3.0);
    }
}

#[test]
fn loops_written_and_read_are_the_same() {
    let framed = "[[loop]]\nbetween = [\"base\", \"b c\"]\ncut = \"universal\"\n\
                  frames = [{ rpy = [\"pi/2\", 0, 0] }, { xyz = [1.0, \"L/2\", 3e-1] }]\n";
    let near = format!("{GOOD}near = {{ \"b c\" = \"-L\", a = 1 }}\n");
    for text in [
        robot(GOOD),
        robot(framed),
        robot(&format!("{near}{framed}")),
    ] {
        let read = parse_toml(&text, "r.toml").expect("a robot");
        let written = to_toml(&read).expect("robot TOML");
        let again = parse_toml(&written, "r.toml").unwrap_or_else(|e| panic!("{e}\n{written}"));
        assert_eq!(again, read, "{written}");
    }
}

#[test]
fn roundings_in_the_frames_of_loops_are_set_right_in_the_text() {
    let text = robot(
        "[[loop]] # kept\nbetween = [\"a\", \"b c\"]\ncut = \"revolute\"\n\
         frames = [{ rpy = [1.5708, 0, 0] }, { xyz = [1e-17, 0, 0.2], rpy = [0, 0, 1.57] }]\n",
    );
    let (cleaned, changes, near_misses) =
        clean_toml(&text, "r.toml", &CleanPolicy::default()).expect("a robot");
    assert_eq!(
        cleaned,
        text.replace("1.5708", "\"pi/2\"").replace("1e-17", "0")
    );
    let listed: Vec<String> = changes.iter().map(ToString::to_string).collect();
    assert_eq!(
        listed[0],
        "loop 1, frame 1 rpy[0] = 1.5708 is 3.7e-6 rad from pi/2"
    );
    assert_eq!((listed.len(), near_misses.len()), (2, 1));
}

#[test]
fn bad_loops_are_refused_where_they_are_wrong() {
    let replaced = |from: &str, to: &str| GOOD.replace(from, to);
    let rows: &[(String, &str, &str)] = &[
        (
            replaced("[\"a\", \"b c\"]", "[\"a\", \"b d\"]"),
            "r.toml:14:1: [E203]",
            "did you mean \"b c\"?",
        ),
        (
            replaced("\"b c\"", "\"a\""),
            "r.toml:14:1: [E211]",
            "between \"a\" and itself",
        ),
        (
            replaced("[\"a\", \"b c\"]", "[\"base\", \"base\"]"),
            "[E211]",
            "between \"base\" and itself",
        ),
        (
            replaced("[\"a\", \"b c\"]", "[\"a\"]"),
            "r.toml:14:1: [E131]",
            "two elements, not 1",
        ),
        (
            replaced("[\"a\", \"b c\"]", "[1, 2]"),
            "[E131]",
            "names of two links",
        ),
        (
            replaced("[\"a\", \"b c\"]", "\"a\""),
            "[E131]",
            "an array of two",
        ),
        (
            replaced("between = [\"a\", \"b c\"]\n", ""),
            "r.toml:13:1: [E132]",
            "between is missing",
        ),
        (
            replaced("cut = \"revolute\"\n", ""),
            "r.toml:13:1: [E132]",
            "\"spherical\"",
        ),
        (
            replaced("revolute", "ball"),
            "r.toml:16:1: [E210]",
            "unknown kind of cut joint \"ball\"",
        ),
        (
            replaced("at = [[\"L\", 0, 0], [0.7, 0, 0]]\n", ""),
            "[E132]",
            "at is missing",
        ),
        (
            replaced("[0.7, 0, 0]]", "[0.7, 0]]"),
            "r.toml:15:1: [E131]",
            "three numbers, not 2",
        ),
        (
            replaced(", [0.7, 0, 0]]", "]"),
            "[E131]",
            "two elements, not 1",
        ),
        (replaced("0.7", "nan"), "r.toml:15", "[E"),
        (replaced("\"L\"", "\"K\""), "[E220]", "K"),
        (
            format!("{GOOD}frames = [{{}}, {{}}]\n"),
            "r.toml:17:1: [E211]",
            "leave one of them out",
        ),
        (
            replaced("at = [[\"L\", 0, 0], [0.7, 0, 0]]", "frames = [1, 2]"),
            "[E131]",
            "two tables",
        ),
        (
            replaced(
                "at = [[\"L\", 0, 0], [0.7, 0, 0]]",
                "frames = [{ zyx = 1 }, {}]",
            ),
            "[E130]",
            "known keys: xyz, rpy",
        ),
        (
            format!("{GOOD}nera = {{}}\n"),
            "r.toml:17:1: [E130]",
            "did you mean near?",
        ),
        (
            format!("{GOOD}near = {{ c = 1 }}\n"),
            "r.toml:17:1: [E203]",
            "which does not exist",
        ),
        (format!("{GOOD}near = 3\n"), "[E131]", "a table"),
        (
            format!("{GOOD}near = {{ a = 1 }}\n{GOOD}near = {{ a = 2 }}\n"),
            "[E211]",
            "another value than loop 1",
        ),
        ("loop = 3\n".to_owned(), "[E130]", "unknown key"),
    ];
    for (closure, place, what) in rows {
        let text = robot(closure);
        let error = parse_toml(&text, "r.toml").expect_err(&text).to_string();
        assert!(
            error.contains(place) && error.contains(what),
            "{error}\n{closure}"
        );
    }
}

#[test]
fn a_loop_without_a_joint_between_its_sides_is_refused() {
    let text = "[[link]]\nname = \"a\"\nalpha = 0\nd = 0\nr = 0\n\
                [[link]]\nname = \"b\"\njoint = \"fixed\"\nalpha = 0\nd = 0\ntheta = 0\nr = 0\n\
                [[loop]]\nbetween = [\"a\", \"b\"]\nat = [[0, 0, 0], [0, 0, 0]]\ncut = \"revolute\"\n";
    let error = parse_toml(text, "r.toml")
        .expect_err("no joint")
        .to_string();
    assert!(
        error.contains("[E211]") && error.contains("no moving joint between a and b"),
        "{error}"
    );
    let near = text.replace("\"a\", \"b\"", "\"base\", \"b\"") + "near = { b = 1 }\n";
    let error = parse_toml(&near, "r.toml").expect_err("fixed").to_string();
    assert!(error.contains("which is fixed"), "{error}");
}
