//! Robot TOML and the catalogue.

use proptest::prelude::*;
use roberval_formats::{RobotDescription, catalogue, load, parse_toml, to_toml};
use roberval_mechanism::{
    Couple, Geometry, JointKind, LinkDescription, MdhGeometry, SourceFormat, Term,
};
use roberval_scalar::{Decimal, Expr, Quantity};

fn read(text: &str) -> RobotDescription {
    parse_toml(text, "r.toml").unwrap_or_else(|e| panic!("{e}"))
}

fn mdh(link: &LinkDescription) -> &MdhGeometry {
    match &link.geometry {
        Geometry::Mdh(geometry) => geometry,
        Geometry::Placed { .. } => panic!("no MDH geometry"),
    }
}

const ZEROS: &str = "alpha=0\nd=0\nr=0\n";

#[test]
fn every_built_in_robot_loads_and_round_trips() {
    for entry in catalogue() {
        let robot = load(entry.name).unwrap_or_else(|e| panic!("{e}"));
        assert!(!entry.source.is_empty() && !entry.title.is_empty());
        assert!(entry.toml.starts_with("# "), "{}: no source", entry.name);
        assert_eq!(robot.warnings, Vec::<String>::new(), "{}", entry.name);
        let text = to_toml(&robot).unwrap();
        assert_eq!(read(&text), robot, "{text}");
    }
}

#[test]
fn the_catalogue_has_the_robots_that_the_documentation_names() {
    let joints = |name: &str| {
        let robot = load(name).unwrap_or_else(|e| panic!("{e}"));
        let moving = |l: &&LinkDescription| l.joint != JointKind::Fixed;
        robot.links.iter().filter(moving).count()
    };
    for (name, count) in [
        ("puma560", 6),
        ("two_link", 2),
        ("scara", 4),
        ("stanford", 6),
        ("iiwa14", 7),
        ("panda", 7),
        ("ur5", 6),
        ("ur10", 6),
        ("torso", 9),
        ("four_bar", 3),
        ("delta", 11),
    ] {
        assert_eq!(joints(name), count, "{name}");
    }
}

#[test]
fn the_puma_has_the_papers_geometry_and_values() {
    let puma = load("puma560").unwrap();
    let quarter = std::f64::consts::FRAC_PI_2;
    let table_1 = [
        (0.0, 0.0, 0.0),
        (-quarter, 0.0, 0.0),
        (0.0, 0.5, 0.2),
        (-quarter, 0.02, 0.6),
        (quarter, 0.0, 0.0),
        (-quarter, 0.0, 0.0),
    ];
    for (link, (alpha, d, r)) in puma.links.iter().zip(table_1) {
        let g = mdh(link);
        assert_eq!((g.alpha.value, g.d.value, g.r.value), (alpha, d, r));
        assert_eq!((g.gamma.value, g.b.value, g.theta.value), (0.0, 0.0, 0.0));
        assert!(link.active && link.rotor);
    }
    let known = |l: &LinkDescription| l.inertia.iter().flatten().count();
    // 66 parameters, 11 of them without effect: link 1 keeps ZZ and Ia, link 2 lacks MZ, M.
    let counts: Vec<usize> = puma.links.iter().map(known).collect();
    assert_eq!(counts, [2, 9, 11, 11, 11, 11]);
    assert_eq!(puma.links[1].inertia[10].as_ref().unwrap().text, "4.5");
}

#[test]
fn defaults_are_those_of_the_documentation() {
    let text =
        format!("[[link]]\n{ZEROS}[[link]]\n{ZEROS}[[link]]\njoint='fixed'\ntheta=0\n{ZEROS}");
    let robot = parse_toml(&text, "some/where/arm.toml").unwrap();
    assert_eq!(robot.name, "arm");
    assert_eq!(robot.gravity.clone().map(|g| g.value), [0.0, 0.0, -9.81]);
    assert_eq!(robot.gravity[2].text, "-9.81");
    let names: Vec<&str> = robot.links.iter().map(|l| l.name.as_str()).collect();
    assert_eq!(names, ["1", "2", "3"]);
    let antecedents: Vec<Option<&str>> = robot
        .links
        .iter()
        .map(|l| l.antecedent.as_deref())
        .collect();
    assert_eq!(antecedents, [None, Some("1"), Some("2")]);
    assert_eq!(robot.links[0].joint, JointKind::Revolute);
    assert!(robot.links[1].active && robot.links[1].rotor);
    assert!(!robot.links[2].active && !robot.links[2].rotor);
    assert_eq!(robot.format, SourceFormat::Mdh);
}

#[test]
fn a_passive_joint_has_no_rotor_unless_the_file_says_so() {
    let link = |flags: &str| read(&format!("[[link]]\n{flags}\n{ZEROS}")).links.remove(0);
    assert!(!link("active=false").rotor);
    assert!(link("active=false\nrotor=true").rotor);
    assert!(!link("rotor=false").rotor);
    assert!(link("rotor=false\ninertia={Ia=0}").inertia[10].is_some());
}

#[test]
fn numbers_stay_as_written() {
    let robot = read(
        "[constants]\nL = 0.290\nA = '30 deg'\n\
         [[link]]\nalpha = 1.570_796_3\nd = 29e-2\ntheta = 'A/2'\nr = +1\n\
         inertia = { M = 1.50, MX = '3*L' }\n",
    );
    let g = mdh(&robot.links[0]);
    assert_eq!(g.alpha.text, "1.5707963");
    assert_eq!((g.d.text.as_str(), g.d.value), ("29e-2", 0.29));
    assert_eq!(g.d.expr, Expr::Number(Decimal::parse("0.29").unwrap()));
    assert_eq!(g.r.expr, Expr::Number(Decimal::parse("1").unwrap()));
    assert!((g.theta.value - std::f64::consts::PI / 12.0).abs() < 1e-16);
    assert_eq!(robot.links[0].inertia[9].as_ref().unwrap().text, "1.50");
    assert_eq!(robot.links[0].inertia[6].as_ref().unwrap().text, "3*L");
    assert_eq!(robot.constants[0].1.text, "0.290");
}

#[test]
fn links_may_stand_in_any_order() {
    let link =
        |name: &str, on: &str| format!("[[link]]\nname='{name}'\nantecedent='{on}'\n{ZEROS}");
    let all = [
        link("a", "base"),
        link("b", "a"),
        link("c", "a"),
        link("d", "c"),
    ];
    let sorted = |mut robot: RobotDescription| {
        robot.links.sort_by(|x, y| x.name.cmp(&y.name));
        robot
    };
    let straight = sorted(read(&all.concat()));
    for order in [[3, 2, 1, 0], [1, 3, 0, 2], [2, 0, 3, 1]] {
        let text: String = order.map(|k| all[k].as_str()).concat();
        assert_eq!(sorted(read(&text)), straight);
    }
}

#[test]
fn links_may_be_inline_tables_and_inertias_tables_of_their_own() {
    let inline = read("link = [{ alpha = 0, d = 0, r = 0, inertia = { M = 1 } }]\n");
    let dotted = read(&format!("[[link]]\n{ZEROS}inertia.M = 1\n"));
    let table = read(&format!("[[link]]\n{ZEROS}[link.inertia]\nM = 1\n"));
    assert_eq!(inline, dotted);
    assert_eq!(inline, table);
}

#[test]
fn an_impossible_mass_is_a_warning() {
    let robot = read(&format!(
        "[[link]]\nname='x'\n{ZEROS}inertia = {{ M = -1, MX = -2 }}\n"
    ));
    assert_eq!(robot.warnings, ["link \"x\": M = -1 is negative"]);
}

#[test]
fn windows_line_ends_change_nothing() {
    let text = format!("name = 'r'\n[[link]]\n{ZEROS}inertia = {{ M = 1 }}\n");
    assert_eq!(read(&text.replace('\n', "\r\n")), read(&text));
}

#[test]
fn what_the_form_cannot_hold_is_not_written() {
    let mut robot = load("two_link").unwrap();
    robot.links[0].limits = Some((0.0, 1.0));
    assert_eq!(to_toml(&robot).unwrap_err().code.to_string(), "E270");
    let mut robot = load("two_link").unwrap();
    robot.format = SourceFormat::Urdf;
    let error = to_toml(&robot).unwrap_err().to_string();
    assert!(error.contains("cannot be written as robot TOML"), "{error}");
}

/// Texts of numbers in every style of the grammar; L and K are constants.
fn literal() -> impl Strategy<Value = String> {
    prop_oneof![
        prop::sample::select(vec![
            "0",
            "-0.0",
            "0.29",
            ".5",
            "5.",
            "+3",
            "1e-3",
            "-2.50E+2",
            "L",
            "2*L - K/3",
            "sqrt(L)",
            "-(1 + K)",
            "1.5707963267948966",
            "007",
        ])
        .prop_map(str::to_owned),
        any::<i32>().prop_map(|n| n.to_string()),
        (-10.0..10.0f64).prop_map(|x| format!("{x:?}")),
    ]
}

fn angle() -> impl Strategy<Value = String> {
    prop_oneof![
        literal(),
        prop::sample::select(vec!["-90 deg", "90deg", "(45/2) deg", "3*pi/4", "-pi/2"])
            .prop_map(str::to_owned),
    ]
}

fn constants() -> Vec<(String, Quantity)> {
    let l = ("L".to_owned(), Quantity::parse_number("0.5", &[]).unwrap());
    let k = Quantity::parse_angle("(7/L) deg", std::slice::from_ref(&l)).unwrap();
    vec![l, ("K".to_owned(), k)]
}

fn link(number: usize) -> impl Strategy<Value = LinkDescription> {
    let numbers = |text: &str| Quantity::parse_angle(text, &constants()).unwrap();
    let geometry = (angle(), literal(), angle(), literal(), angle(), literal()).prop_map(
        move |(gamma, b, alpha, d, theta, r)| MdhGeometry {
            gamma: numbers(&gamma),
            b: numbers(&b),
            alpha: numbers(&alpha),
            d: numbers(&d),
            theta: numbers(&theta),
            r: numbers(&r),
        },
    );
    let inertia = prop::collection::vec(prop::option::of(0.0..9.0f64), 11);
    let name = prop::sample::select(vec!["", " a b", "\u{e9}\"q\"", "'\\", "=[#"]);
    let flags = (0..3usize, any::<bool>(), any::<bool>());
    (geometry, inertia, name, any::<prop::sample::Index>(), flags).prop_map(
        move |(geometry, inertia, name, on, (kind, active, rotor))| {
            let joint = [JointKind::Revolute, JointKind::Prismatic, JointKind::Fixed][kind];
            let moving = joint != JointKind::Fixed;
            let rotor = rotor && moving;
            let mut values = inertia
                .iter()
                .map(|x| x.map(|x| Quantity::from_f64(x).unwrap()));
            let mut inertia: [_; 11] = std::array::from_fn(|_| values.next().unwrap());
            if !rotor {
                inertia[10] = None;
            }
            // Zero stands for the base, else an earlier link.
            let on = on.index(number + 1);
            LinkDescription {
                name: format!("{number}{name}"),
                joint_name: None,
                antecedent: (on > 0).then(|| (on - 1).to_string()),
                joint,
                active: active && moving,
                rotor,
                geometry: Geometry::Mdh(Box::new(geometry)),
                inertia,
                limits: None,
                massless: false,
            }
        },
    )
}

/// A multiplier and an offset, or none.
fn factor() -> impl Strategy<Value = Option<(String, String)>> {
    let multiplier = prop::sample::select(vec!["1", "-1", "-3/2", "0.250", "L/3", "2*L"]);
    let offset = prop::sample::select(vec!["0", "3*pi", "-0.1", "K"]);
    let both = (multiplier, offset).prop_map(|(m, o)| (m.to_owned(), o.to_owned()));
    prop::option::of(both)
}

/// Some joints follow the first one that moves.
fn couples(links: &[LinkDescription], factors: Vec<Option<(String, String)>>) -> Vec<Couple> {
    let read = |text: &str| Quantity::parse_angle(text, &constants()).unwrap();
    let mut moving = links.iter().filter(|l| l.joint != JointKind::Fixed);
    let Some(first) = moving.next() else {
        return Vec::new();
    };
    let couple = |(link, factor): (&LinkDescription, Option<(String, String)>)| {
        let (multiplier, offset) = factor?;
        let term = Term {
            joint: first.name.clone(),
            multiplier: read(&multiplier),
        };
        Some(Couple {
            joint: link.name.clone(),
            terms: vec![term],
            offset: read(&offset),
            expression: None,
        })
    };
    moving.zip(factors).filter_map(couple).collect()
}

fn robot() -> impl Strategy<Value = RobotDescription> {
    let links = (1..8usize).prop_flat_map(|n| (0..n).map(link).collect::<Vec<_>>());
    (links, any::<bool>(), prop::collection::vec(factor(), 7)).prop_map(
        |(mut links, backwards, factors)| {
            let names: Vec<String> = links.iter().map(|l| l.name.clone()).collect();
            for link in &mut links {
                let on = link.antecedent.take();
                link.antecedent = on.map(|k| names[k.parse::<usize>().unwrap()].clone());
            }
            if backwards {
                links.reverse();
            }
            let couples = couples(&links, factors);
            RobotDescription {
                name: "a \"robot\"".to_owned(),
                gravity: ["0", "-L", "9.810"]
                    .map(|t| Quantity::parse_number(t, &constants()).unwrap()),
                constants: constants(),
                links,
                couples,
                loops: Vec::new(),
                format: SourceFormat::Mdh,
                warnings: Vec::new(),
            }
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn a_description_written_and_read_is_the_same(robot in robot()) {
        let text = to_toml(&robot).unwrap();
        let mut again = parse_toml(&text, "again").unwrap_or_else(|e| panic!("{e}\n{text}"));
        again.warnings.clear(); // what a reader notices is not part of the robot
        prop_assert_eq!(again, robot, "{}", text);
    }
}

#[test]
fn a_couple_by_an_expression_is_written_and_read_the_same() {
    let text = "[[link]]\nname = \"left arm\"\nalpha = 0\nd = 0\nr = 0\n\
                [[link]]\nname = \"b\"\nalpha = 0\nd = 1\nr = 0\n\
                [[couple]]\njoint = \"b\"\nexpression = 'atan2(sin(q[\"left arm\"]), 2)'\n";
    let robot = read(text);
    assert!(!robot.links[1].active && !robot.links[1].rotor);
    assert_eq!(read(&to_toml(&robot).unwrap()).couples, robot.couples);
}

#[test]
fn warnings_of_the_program_that_wrote_the_file_are_the_robots_and_round_trip() {
    let text = "warnings = [\"ball joint 'b' is taken as three hinges\"]\n\
                [[link]]\nxyz = [0, 0, 1]\ninertia = { M = -1 }\n";
    let robot = read(text);
    assert_eq!(robot.warnings.len(), 2, "{:?}", robot.warnings);
    assert!(robot.warnings[0].contains("three hinges"));
    let again = read(&to_toml(&robot).unwrap());
    assert_eq!(again.warnings, robot.warnings);
    let wrong = "warnings = [1]\n[[link]]\nxyz = [0, 0, 1]\n";
    let error = parse_toml(wrong, "wrong.toml").unwrap_err();
    assert!(error.to_string().contains("an array of strings"), "{error}");
}
