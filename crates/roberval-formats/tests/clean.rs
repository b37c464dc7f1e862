//! Cleaned files: only the changed numbers differ, and they read as the cleaned robot.

use std::fmt::Write;

use roberval_formats::{
    RobotDescription, UrdfOptions, catalogue, clean_toml, clean_urdf, parse_toml, parse_urdf,
    to_toml,
};
use roberval_mechanism::{Change, CleanPolicy, Geometry, JointKind, Origin, SourceFormat, clean};
use roberval_scalar::Quantity;
use roberval_testkit::{Angles, Family, dusty, literal_style};

/// Generated robots for each format.
const ROBOTS: u64 = 100;

/// Decimals of the angles, cycled through.
const STYLES: [usize; 6] = [16, 11, 9, 6, 5, 4];

fn policy() -> CleanPolicy {
    CleanPolicy::default()
}

fn read(text: &str) -> RobotDescription {
    parse_urdf(text, "r.urdf", UrdfOptions::default()).unwrap_or_else(|e| panic!("{e}"))
}

fn careless(seed: u64, format: SourceFormat) -> RobotDescription {
    let family = Family {
        angles: Angles::Fifteens,
        fixed: 0.3,
        format,
        ..Family::default()
    };
    let decimals = STYLES[(seed % 6) as usize];
    dusty(&literal_style(&family.robot(seed), decimals), seed)
}

const URDF: &str = "\u{feff}<?xml version='1.0'?>\r
<!-- rpy=\"1.5708 0 0\" in a comment -->
<robot name=\"r\" xmlns:x=\"u\">
  <link name='a'/> <link   name = 'b' ><visual><origin rpy='1.5708 0 0'/></visual></link>
  <joint name='j' type=\"revolute\"><!-- 1.5708 -->
    <x:origin rpy=\"3.1416 0 0\"/>
    <origin\txyz = ' 1e-17\t0.30
       -0 '   rpy='1.5708  1.57 -3.14159'  />
    <axis xyz=\"-1.0 1e-12 &#48;.0\"/><parent link='a'/><child link='b'/>
    <limit lower='1.5708' upper='3.1416' effort='1' velocity='1'/>
  </joint>
  <link name='tool'/>
  <joint name='tip' type='fixed'><parent link='b'/><child link='tool'/>
    <origin rpy='1.5708 0 0'/></joint>
  <gazebo><joint name='j'><origin rpy='1.5708 0 0'/></joint></gazebo>
</robot> <!-- \u{e9} -->
";

#[test]
fn offsets_at_which_joints_follow_others_are_set_right() {
    let chain = |angle: &str, offset: &str| {
        format!(
            "<robot name='g'><link name='b'/><link name='k'/><link name='t'/>
            <joint name='knuckle' type='revolute'><parent link='b'/><child link='k'/>
              <origin rpy='{angle} 0 0'/><axis xyz='0 0 1'/><limit effort='1' velocity='1'/></joint>
            <joint name='tip' type='revolute'><parent link='k'/><child link='t'/>
              <origin xyz='0.1 0 0'/><axis xyz='0 0 1'/><limit effort='1' velocity='1'/>
              <mimic joint='knuckle' multiplier='-1' offset='{offset}'/></joint></robot>"
        )
    };
    let (text, changes, near) = clean_urdf(&chain("0", "1.5708"), "g.urdf", &policy()).unwrap();
    assert_eq!(text, chain("0", "1.5707963267948966"));
    assert_eq!(changes.len(), 1);
    assert!(
        changes[0]
            .to_string()
            .starts_with("tip offset = 1.5708 is 3.7e-6 rad from pi/2")
    );
    assert!(near.is_empty());
    let (_, _, near) = clean_urdf(&chain("0", "3.14"), "g.urdf", &policy()).unwrap();
    assert_eq!(near.len(), 1);
    let toml = "[[link]]\nname = \"1\"\nalpha = 0\nd = 0\nr = 0\n[[link]]\nname = \"2\"\nalpha = 0\nd = 1\nr = 0\n\
                [[couple]]\njoint = \"2\"\nequals = { 1 = 2 }\noffset = 3.1416 # half a turn\n";
    let (text, changes, _) = clean_toml(toml, "g.toml", &policy()).unwrap();
    assert_eq!(changes.len(), 1);
    assert_eq!(text, toml.replace("3.1416", "\"pi\""));
}

#[test]
fn only_the_changed_numbers_of_a_urdf_are_replaced() {
    let (text, changes, near) = clean_urdf(URDF, "r.urdf", &policy()).unwrap();
    let expected = URDF
        .replace("' 1e-17\t", "' 0\t")
        .replace(
            "'1.5708  1.57 -3.14159'",
            "'1.5707963267948966  1.57 -3.141592653589793'",
        )
        .replace("\"-1.0 1e-12 &#48;.0\"", "\"-1.0 0 0.0\"");
    assert_eq!(text, expected);
    assert_eq!((changes.len(), near.len()), (4, 1));
    assert_eq!(near[0].change.written.text, "1.57");
}

#[test]
fn prefixes_that_nobody_declared_stay_as_written() {
    let text = URDF.replace("<x:origin", "<drake:origin");
    let (cleaned, changes, _) = clean_urdf(&text, "r.urdf", &policy()).unwrap();
    let declared = clean_urdf(URDF, "r.urdf", &policy()).unwrap();
    assert_eq!(cleaned, declared.0.replace("<x:origin", "<drake:origin"));
    assert_eq!(changes, declared.1);
}

#[test]
fn the_literal_policy_writes_the_text_as_it_was() {
    let literal = CleanPolicy::literal();
    let (text, changes, near) = clean_urdf(URDF, "r.urdf", &literal).unwrap();
    assert_eq!(text, URDF);
    assert!(changes.is_empty() && near.is_empty());
    for entry in catalogue() {
        let (text, changes, _) = clean_toml(entry.toml, entry.name, &literal).unwrap();
        assert_eq!(text, entry.toml);
        assert!(changes.is_empty());
    }
}

#[test]
fn the_built_in_robots_are_clean() {
    for entry in catalogue() {
        let (text, changes, near) = clean_toml(entry.toml, entry.name, &policy()).unwrap();
        let shown: Vec<String> = changes.iter().map(Change::to_string).collect();
        assert_eq!(shown, [""; 0], "{}", entry.name);
        assert!(near.is_empty(), "{}", entry.name);
        assert_eq!(text, entry.toml);
    }
}

/// A URDF of a generated robot; `number` writes its numbers, given the link's index.
fn urdf(robot: &RobotDescription, number: impl Fn(usize, &Quantity) -> String) -> String {
    let mut text = "<robot name='r'><link name='base'/>\n".to_owned();
    let kinds = ["revolute", "prismatic", "fixed"];
    for (index, link) in robot.links.iter().enumerate() {
        let three = |v: &[Quantity; 3]| v.each_ref().map(|x| number(index, x)).join("  ");
        let Geometry::Placed { origins, axis } = &link.geometry else {
            panic!("a URDF robot");
        };
        let [Origin { joint, xyz, rpy }] = &origins[..] else {
            panic!("one origin");
        };
        let parent = link.antecedent.as_deref().unwrap_or("base");
        writeln!(
            text,
            "<link name='{name}'/><joint name='{joint}' type='{kind}'><!-- {index} --><parent \
             link='{parent}'/><child link='{name}'/><origin rpy='{}' xyz=\"{}\"/><axis xyz='{}'/></joint>",
            three(rpy),
            three(xyz),
            three(axis),
            name = link.name,
            kind = kinds[link.joint as usize],
        )
        .unwrap();
    }
    text + "</robot>\n"
}

/// Whether a joint on a link, or on one that stands on it, moves.
fn places_something(robot: &RobotDescription, index: usize) -> bool {
    let antecedents = robot.antecedents().unwrap();
    (0..robot.links.len()).any(|l| {
        let mut at = Some(l);
        while at.is_some_and(|a| a != index) {
            at = antecedents[at.unwrap()];
        }
        at.is_some() && robot.links[l].joint != JointKind::Fixed
    })
}

/// What a cleaned URDF should have: decimals where something changed.
fn decimal(written: &Quantity, cleaned: &Quantity) -> String {
    if written == cleaned {
        written.text.clone()
    } else {
        Quantity::from_f64(cleaned.value).unwrap().text
    }
}

#[test]
fn a_cleaned_urdf_is_the_text_of_the_cleaned_robot() {
    for seed in 0..ROBOTS {
        let robot = careless(seed, SourceFormat::Urdf);
        let text = urdf(&robot, |_, x| x.text.clone());
        let all_but_dead_ends = {
            let cleaned = clean(&robot, &policy()).description;
            let new = std::cell::RefCell::new(all_numbers(&cleaned).into_iter());
            urdf(&robot, |index, x| {
                let new = new.borrow_mut().next().unwrap();
                if places_something(&robot, index) {
                    decimal(x, &new)
                } else {
                    x.text.clone()
                }
            })
        };
        let (cleaned, changes, _) = clean_urdf(&text, "r.urdf", &policy()).unwrap();
        assert_eq!(cleaned, all_but_dead_ends, "seed {seed}");

        // Read again, only the last digits of its decimals are left to clean.
        let once = clean(&read(&text), &policy());
        let twice = clean(&read(&cleaned), &policy());
        assert!(once.description == twice.description, "seed {seed}");
        assert!(twice.changes.iter().all(Change::is_last_digit));
        assert_eq!(changes, once.changes);
        let (again, _, _) = clean_urdf(&cleaned, "r.urdf", &policy()).unwrap();
        assert_eq!(again, cleaned, "seed {seed}");
    }
}

/// The numbers of the joints in the order in which `urdf` writes them.
fn all_numbers(robot: &RobotDescription) -> Vec<Quantity> {
    let numbers = robot.links.iter().flat_map(|link| match &link.geometry {
        Geometry::Placed { origins, axis } => {
            [origins[0].rpy.clone(), origins[0].xyz.clone(), axis.clone()].concat()
        }
        Geometry::Mdh(_) => Vec::new(),
    });
    numbers.collect()
}

#[test]
fn a_cleaned_toml_reads_as_the_cleaned_robot() {
    for seed in 0..ROBOTS {
        let mut robot = careless(seed, SourceFormat::Mdh);
        for link in robot.links.iter_mut().filter(|link| !link.rotor) {
            link.inertia[10] = None;
        }
        robot.gravity = ["1e-8", "-9.81", "6e-16"].map(|x| Quantity::parse_decimal(x).unwrap());
        let commented = |robot: &RobotDescription| {
            let text = to_toml(robot).unwrap();
            format!("\u{feff}# 1.5708\n{}", text.replace('\n', "  # 1e-9 '\r\n"))
        };
        let (text, changes, _) = clean_toml(&commented(&robot), "r.toml", &policy()).unwrap();
        let cleaned = clean(&robot, &policy());
        assert_eq!(text, commented(&cleaned.description), "seed {seed}");
        assert_eq!(changes, cleaned.changes);
        let mut read = parse_toml(&text, "r.toml").unwrap();
        // The generated masses are no masses.
        read.warnings.clear();
        assert!(read == cleaned.description, "seed {seed}");
    }
}

#[test]
fn links_in_inline_tables_are_cleaned_where_they_stand() {
    let text = "constants = { A = 3.1416 }\n\
                link = [{ alpha = 'A/2', d=1e-9, r = 0.1 }, # 'A/2'\n \
                { d = 0, alpha=-1.570_796_3,r=0 }]\n";
    let (cleaned, changes, _) = clean_toml(text, "r.toml", &policy()).unwrap();
    let expected = text
        .replace("alpha = 'A/2'", "alpha = \"pi/2\"")
        .replace("d=1e-9", "d=0")
        .replace("=-1.570_796_3,", "=\"-pi/2\",");
    assert_eq!(cleaned, expected);
    assert_eq!(changes.len(), 3);
}

#[test]
fn a_faulty_file_is_refused_as_by_the_readers() {
    let code = |result: Result<_, roberval_formats::FormatError>| {
        result
            .map(|_: (String, _, _)| ())
            .unwrap_err()
            .code
            .to_string()
    };
    assert_eq!(code(clean_urdf("<robot", "r", &policy())), "E103");
    assert_eq!(code(clean_urdf("", "r", &policy())), "E101");
    assert_eq!(code(clean_toml("link = 1", "r", &policy())), "E131");
    assert_eq!(code(clean_toml("[", "r", &policy())), "E104");
}
