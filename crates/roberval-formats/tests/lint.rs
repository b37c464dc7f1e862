//! Findings in robot files: all at once, each where it is, and none in a good file.

use std::path::PathBuf;

use roberval_formats::{Finding, Kind, Rule, catalogue, clean_toml, lint, read_instead};
use roberval_mechanism::CleanPolicy;

/// Lints a text as a file of this name.
fn findings(name: &str, text: &str) -> Vec<Finding> {
    let folder = std::env::temp_dir().join(format!("roberval-lint-{}-{name}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let path: PathBuf = folder.join(name);
    std::fs::write(&path, text).expect("a file");
    let found = lint(&path.to_string_lossy());
    std::fs::remove_dir_all(&folder).expect("still there");
    found.unwrap_or_else(|error| panic!("{error}"))
}

/// Line, rule and a piece of the text.
fn summary(findings: &[Finding]) -> Vec<(u32, String)> {
    let line = |f: &Finding| f.position.map_or(0, |p| p.line);
    findings.iter().map(|f| (line(f), f.rule.name())).collect()
}

const BAD: &str = r#"<robot name="bad">
  <link name="base"/>
  <link name="upper">
    <inertial>
      <mass value="1.0"/>
      <inertia ixx="3" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>
    </inertial>
  </link>
  <link name="lower"/>
  <link name="tool">
    <inertial>
      <origin xyz="0 0 120"/>
      <mass value="2.0"/>
      <inertia ixx="1500" ixy="0" ixz="0" iyy="1500" iyz="0" izz="1500"/>
    </inertial>
  </link>
  <link name="upper"/>
  <link name="light">
    <inertial><mass value="-1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
  </link>
  <joint name="a" type="revolute">
    <parent link="base"/><child link="upper"/>
    <origin xyz="0 0 1x" rpy="1.5708 0 0"/>
    <axis xyz="0 0 2"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/>
  </joint>
  <joint name="b" type="revolute">
    <parent link="upper"/><child link="lower"/>
    <origin xyz="0 0 1" rpy="0 1.57 0"/>
    <axis xyz="0 3 4"/>
    <limit lower="1" upper="-1" effort="1" velocity="1"/>
    <mimic joint="d" multiplier="0"/>
  </joint>
  <joint name="c" type="revolute">
    <parent link="lower"/><child link="tool"/>
    <origin rpy="90 0 0"/>
  </joint>
  <joint name="d" type="fixed">
    <parent link="tool"/><child link="light"/>
    <origin xyz="1e-9 0 0" rpy="0 0 3.1416"/>
  </joint>
</robot>
"#;

#[test]
fn one_run_finds_every_fault_of_a_file_each_in_its_line() {
    let found = findings("bad.urdf", BAD);
    let expected = [
        (6, "inertia"),
        (9, "missing-inertial"),
        (12, "units"),
        (14, "units"),
        (17, "E202"),
        (19, "inertia"),
        (23, "E105"),
        (29, "rounded-angle"),
        (30, "axis"),
        (31, "limits"),
        (32, "mimic"),
        (34, "limits"),
        (36, "degrees"),
        (40, "dust"),
        (40, "rounded-angle"),
    ];
    let expected: Vec<(u32, String)> = expected
        .iter()
        .map(|&(line, rule)| (line, rule.to_owned()))
        .collect();
    let text: Vec<String> = found.iter().map(ToString::to_string).collect();
    assert_eq!(summary(&found), expected, "{}", text.join("\n"));
    for (finding, text) in found.iter().zip(&text) {
        assert!(!finding.remedy.is_empty(), "{text}");
        assert!(text.contains("bad.urdf:"), "{text}");
    }
    assert!(text[8].ends_with("write 0 0.6 0.8"), "{}", text[8]);
    assert!(text[7].contains("write 1.5707963267948966"), "{}", text[7]);
}

#[test]
fn the_built_in_robots_and_a_good_file_have_no_findings_but_impossible_values() {
    for entry in catalogue() {
        let found = lint(entry.name).expect("built in");
        // The paper's own values of the PUMA are those of no body.
        let others: Vec<String> = found
            .iter()
            .filter(|f| f.rule.name() != "inertia")
            .map(ToString::to_string)
            .collect();
        assert!(others.is_empty(), "{others:?}");
    }
    let good = BAD
        .replace("ixx=\"3\"", "ixx=\"1\"")
        .replace("<link name=\"lower\"/>", "<link name=\"lower\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial></link>")
        .replace("0 0 120", "0 0 0.120")
        .replace("1500", "0.0015")
        .replace("  <link name=\"upper\"/>\n", "")
        .replace("value=\"-1\"", "value=\"1\"")
        .replace("1x\" rpy=\"1.5708", "1\" rpy=\"1.5707963267948966")
        .replace("0 0 2", "0 0 1")
        .replace("0 1.57 0", "0 1.5707963267948966 0")
        .replace("0 3 4", "0 0.6 0.8")
        .replace("lower=\"1\" upper=\"-1\"", "lower=\"-1\" upper=\"1\"")
        .replace("    <mimic joint=\"d\" multiplier=\"0\"/>\n", "")
        .replace("<origin rpy=\"90 0 0\"/>", "<limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/>")
        .replace("1e-9", "0")
        .replace("3.1416", "3.141592653589793");
    let found = findings("good.urdf", &good);
    assert!(found.is_empty(), "{found:?}");
}

#[test]
fn robot_toml_is_linted_with_lines_too() {
    let text = "\
gravity = [0, 1e-9, -9.81]
[[link]]
alpha = 1.5708
d = 0
theta = 0
r = 0
inertia = { XX = 3, XY = 0, XZ = 0, YY = 1, YZ = 0, ZZ = 1, MX = 0, MY = 0, MZ = 0, M = 1 }
";
    let found = findings("robot.toml", text);
    let expected = [(1, "dust"), (3, "rounded-angle"), (7, "inertia")];
    let expected = expected.map(|(line, rule)| (line, rule.to_owned()));
    assert_eq!(summary(&found), expected);
    let found = findings(
        "wrong.toml",
        "[[link]]\nalpha = 0\nd = 0\ntheta = 0\nr = 0\nq = 0\n",
    );
    assert_eq!(summary(&found), [(6, "E130".to_owned())]);
}

#[test]
fn what_is_no_robot_file_is_refused() {
    let folder = std::env::temp_dir().join(format!("roberval-lint-none-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    for (name, text, code) in [
        ("cut.urdf", "<robot name=\"r\"><link", "E103"),
        ("other.urdf", "<sdf/>", "E116"),
        ("cut.toml", "[[link", "E104"),
        ("empty.urdf", "", "E101"),
    ] {
        let path = folder.join(name);
        std::fs::write(&path, text).expect("a file");
        let error = lint(&path.to_string_lossy()).expect_err("no robot file");
        assert_eq!(error.code.to_string(), code, "{error}");
    }
    assert!(lint("no_such_robot").is_err());
    std::fs::remove_dir_all(&folder).expect("still there");
}

#[test]
fn one_run_finds_every_fault_of_a_robot_toml_each_in_its_line() {
    let text = "\
gravity = [0, 0]
colour = 1
[constants]
pi = 3
L = \"1 +\"
[[link]]
joint = \"revolut\"
alpha = 0
[[link]]
name = 5
alpha = \"x\"
d = \"L\"
theta = 1.5708
gamma = 90
r = [1]
active = \"yes\"
inertia = { XX = -1, QQ = 2, M = \"heavy\" }
[[link]]
antecedent = \"nowhere\"
alpha = 0
theta = 0
r = 0
[[couple]]
joint = \"2\"
equals = { \"1\" = \"a\" }
near = 0
[[loop]]
between = [\"1\"]
at = [[0, 0, 0], [0, 0, 0]]
cut = \"spherical\"
";
    let found = findings("bad.toml", text);
    let expected = [
        (1, "E131"),
        (2, "E130"),
        (4, "E201"),
        (5, "E105"),
        (7, "E210"),
        (10, "E131"),
        (11, "E220"),
        (13, "rounded-angle"),
        (14, "degrees"),
        (15, "E131"),
        (16, "E131"),
        (17, "inertia"),
        (17, "E130"),
        (17, "E220"),
        (18, "E132"),
        (25, "E220"),
        (26, "E130"),
        (28, "E131"),
    ];
    let expected = expected.map(|(line, rule)| (line, rule.to_owned()));
    let text: Vec<String> = found.iter().map(ToString::to_string).collect();
    assert_eq!(summary(&found), expected, "{}", text.join("\n"));
}

#[test]
fn a_translation_has_findings_of_the_file_and_none_of_its_own_digits() {
    let text = "warnings = [\"tendon 't' is not applied\"]\n\
                [[link]]\nxyz = [0, 0, 1e-17]\nrpy = [1.5708, 0, 0]\ninertia = { M = -1 }\n";
    read_instead("arm.xml", Kind::Toml, text.to_owned());
    let found = lint("arm.xml").expect("a robot");
    let text: Vec<String> = found.iter().map(ToString::to_string).collect();
    let mut rules: Vec<String> = found.iter().map(|f| f.rule.name()).collect();
    rules.sort();
    assert_eq!(rules, ["inertia", "remark"], "{text:?}");
    assert!(
        text.iter().all(|t| t.starts_with("arm.xml: warning: ")),
        "{text:?}"
    );
}

#[test]
fn a_text_in_urdf_read_instead_of_a_file_is_named_as_such() {
    let text = r#"<robot name="r"><link name="a"/><link name="b"/>
<joint name="j" type="continuous"><parent link="a"/><child link="b"/>
<origin rpy="1.5708 0 0"/></joint></robot>"#;
    read_instead("arm.xacro", Kind::Urdf, text.to_owned());
    let found = lint("arm.xacro").expect("a robot");
    let rounded = found.iter().find(|f| f.rule == Rule::RoundedAngle);
    let text = rounded.expect("an angle").to_string();
    assert!(
        text.starts_with("arm.xacro (as URDF):3:9: warning"),
        "{text}"
    );
}

#[test]
fn an_undeclared_namespace_prefix_is_read_over_with_a_remark() {
    let text = r#"<robot name="r"><link name="a"/><link name="b"/>
<joint name="j" type="continuous"><parent link="a"/><child link="b"/>
<drake:reflected value="drake:x"/><axis xyz="0 0 1" drake:soft="1"/></joint></robot>"#;
    let found = findings("prefix.urdf", text);
    let remarks: Vec<_> = summary(&found)
        .into_iter()
        .filter(|(_, rule)| rule == "remark")
        .collect();
    assert_eq!(remarks, [(3, "remark".to_owned())], "{found:?}");
}

#[test]
fn numbers_of_placed_links_and_of_loops_are_found_and_cleaned() {
    let text = "\
[[link]]
xyz = [0, 0, 1e-9]
rpy = [0, 1.5708, 0]
axis = [0, 1, 0.0000001]
[[link]]
antecedent = \"base\"
xyz = [1, 0, 0]
[[loop]]
between = [\"1\", \"2\"]
frames = [{ xyz = [1, 0, 0], rpy = [3.1416, 0, 0] }, { }]
cut = \"spherical\"
";
    let found = findings("placed.toml", text);
    let expected = [
        (2, "dust"),
        (3, "rounded-angle"),
        (4, "dust"),
        (10, "rounded-angle"),
    ];
    let expected = expected.map(|(line, rule)| (line, rule.to_owned()));
    assert_eq!(summary(&found), expected, "{found:?}");
    let policy = CleanPolicy::default();
    let (cleaned, changes, _) = clean_toml(text, "placed.toml", &policy).expect("a robot");
    assert_eq!(changes.len(), 4, "{changes:?}");
    let again = findings("placed.toml", &cleaned);
    assert!(again.is_empty(), "{cleaned}\n{again:?}");
}

#[test]
fn millimetres_and_weightless_ends_are_suspicious() {
    let text = r#"<robot name="r"><link name="a"/>
<link name="b"><inertial><mass value="0"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>
<joint name="j" type="continuous"><parent link="a"/><child link="b"/>
<origin xyz="0 0 333"/></joint></robot>"#;
    let found = findings("far.urdf", text);
    let expected = [(2, "missing-inertial"), (4, "units")];
    let expected = expected.map(|(line, rule)| (line, rule.to_owned()));
    assert_eq!(summary(&found), expected, "{found:?}");
    assert!(found[1].remedy.contains("millimetres"), "{found:?}");
}
