//! URDF: numbering, literals, lumping of fixed joints.

use nalgebra::{Matrix3, Vector3};
use proptest::prelude::*;
use roberval_formats::{RobotDescription, UrdfOptions, parse_urdf};
use roberval_mechanism::{Geometry, JointKind, LinkDescription, Origin, SourceFormat};

const LUMPED: UrdfOptions = UrdfOptions {
    keep_fixed: false,
    floating: false,
};
const KEPT: UrdfOptions = UrdfOptions {
    keep_fixed: true,
    floating: false,
};
const SMALL: &str = include_str!("data/small.urdf");

fn read(text: &str, options: UrdfOptions) -> RobotDescription {
    parse_urdf(text, "r.urdf", options).unwrap_or_else(|e| panic!("{e}"))
}

fn names(robot: &RobotDescription) -> Vec<&str> {
    robot.links.iter().map(|l| l.name.as_str()).collect()
}

fn link<'a>(robot: &'a RobotDescription, name: &str) -> &'a LinkDescription {
    robot.links.iter().find(|l| l.name == name).unwrap()
}

fn placed(link: &LinkDescription) -> (&[Origin], [&str; 3]) {
    match &link.geometry {
        Geometry::Placed { origins, axis } => (origins, axis.each_ref().map(|x| x.text.as_str())),
        Geometry::Mdh(_) => panic!("no URDF geometry"),
    }
}

#[test]
fn fixed_joints_are_lumped_unless_they_are_kept() {
    let lumped = read(SMALL, LUMPED);
    assert_eq!(names(&lumped), ["upper", "lower", "finger"]);
    let kept = read(SMALL, KEPT);
    assert_eq!(
        names(&kept),
        ["base", "upper", "lower", "bracket", "camera", "finger"]
    );
    assert_eq!(link(&lumped, "finger").antecedent.as_deref(), Some("upper"));
    assert_eq!(link(&kept, "finger").antecedent.as_deref(), Some("camera"));
    assert_eq!(link(&lumped, "upper").antecedent, None);
    assert_eq!(link(&kept, "upper").antecedent.as_deref(), Some("base"));
    assert_eq!(link(&kept, "base").antecedent, None);
    assert_eq!(link(&kept, "bracket").joint, JointKind::Fixed);
    assert_eq!(
        (lumped.name.as_str(), lumped.format),
        ("small", SourceFormat::Urdf)
    );
}

#[test]
fn origins_of_lumped_joints_stay_as_written() {
    let robot = read(SMALL, LUMPED);
    let (origins, axis) = placed(link(&robot, "upper"));
    let joints: Vec<&str> = origins.iter().map(|o| o.joint.as_str()).collect();
    assert_eq!(joints, ["fix", "shoulder"]);
    assert_eq!(origins[0].xyz[2].text, "0.29");
    assert_eq!(origins[0].rpy[2].text, "1.5707963267948966");
    assert_eq!(axis, ["0", "0", "-1"]);
    let (origins, axis) = placed(link(&robot, "finger"));
    let joints: Vec<&str> = origins.iter().map(|o| o.joint.as_str()).collect();
    assert_eq!(joints, ["mount", "screw", "finger"]);
    assert_eq!(origins[2].xyz.each_ref().map(|x| x.value), [0.0; 3]);
    assert_eq!(axis, ["1", "0", "0"], "the default axis");
    let (origins, _) = placed(link(&robot, "lower"));
    assert_eq!(
        origins[0].xyz.each_ref().map(|x| x.text.as_str()),
        [".1", "-5e-1", "3."]
    );
}

#[test]
fn joints_keep_their_kind_limits_and_mimic() {
    let robot = read(SMALL, LUMPED);
    let upper = link(&robot, "upper");
    assert_eq!((upper.joint, upper.limits), (JointKind::Revolute, None));
    assert!(upper.active && upper.rotor);
    let lower = link(&robot, "lower");
    assert_eq!(
        (lower.joint, lower.limits),
        (JointKind::Prismatic, Some((-0.1, 0.2)))
    );
    let finger = link(&robot, "finger");
    let [couple] = &robot.couples[..] else {
        panic!("one couple")
    };
    assert_eq!(couple.joint, "finger");
    let terms = couple.terms.iter();
    let terms: Vec<_> = terms
        .map(|t| (t.joint.as_str(), t.multiplier.text.as_str()))
        .collect();
    assert_eq!(terms, [("upper", "-0.5")], "links' names, not joints'");
    assert_eq!(couple.offset.text, "0.1");
    assert!(
        !finger.active && !finger.rotor,
        "a mimic joint has no motor of its own"
    );
    assert_eq!(finger.joint_name.as_deref(), Some("finger"));
}

#[test]
fn warnings_say_what_is_odd() {
    let robot = read(SMALL, LUMPED);
    assert_eq!(robot.warnings, [""; 0]);
    let none = read("<robot name='r'><link name='a'/></robot>", LUMPED);
    assert_eq!(none.warnings, ["no joint of the robot moves"]);
    let odd = read(
        "<robot name='r'><link name='a'/><link name='b'><inertial><mass value='1'/>\
         <inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='2.5'/></inertial></link>\
         <joint name='j' type='revolute'><parent link='a'/><child link='b'/>\
         <axis xyz='0 0 2'/><limit lower='1' upper='-1'/></joint></robot>",
        LUMPED,
    );
    assert_eq!(
        odd.warnings,
        [
            "links with an inertia that no body has (1): \"b\"",
            "joints whose axis is not of length 1, normalised (1): \"j\"",
            "joints whose lower limit is above the upper one (1): \"j\"",
        ]
    );
}

#[test]
fn commas_after_numbers_and_second_origins_are_read_over_with_a_warning() {
    let text = |origins: &str| {
        format!(
            "<robot name='r'><link name='a'/>\n<link name='b'/>\n<joint name='j' type='revolute'>\
             <parent link='a'/><child link='b'/>\n{origins}</joint></robot>"
        )
    };
    let plain = read(&text("<origin rpy='1.5 1.3 1' xyz='1 2 3'/>"), LUMPED);
    let commas = read(&text("<origin rpy='1.5, 1.3 1' xyz='1, 2,\t3,'/>"), LUMPED);
    assert_eq!(plain.links, commas.links);
    assert_eq!(
        commas.warnings,
        [
            "line 4, joint \"j\", origin xyz: commas in \"1, 2, 3,\" are taken for blanks",
            "line 4, joint \"j\", origin rpy: commas in \"1.5, 1.3 1\" are taken for blanks",
        ]
    );
    let twice = "<origin rpy='1.5 1.3 1' xyz='1 2 3'/>\n<origin xyz='9 9 9'/>\n<origin/>";
    let twice = read(&text(twice), LUMPED);
    assert_eq!(plain.links, twice.links);
    assert_eq!(
        twice.warnings,
        ["line 5, joint \"j\": a second <origin>: the first is taken"]
    );
}

#[test]
fn the_root_and_what_is_fixed_to_it_have_no_parameters() {
    let heavy = SMALL.replace("<mass value=\"5\"/>", "<mass value=\"500\"/>");
    assert_eq!(read(&heavy, LUMPED), read(SMALL, LUMPED));
}

#[test]
fn the_order_of_links_and_of_unrelated_joints_does_not_matter() {
    let joint = |name: &str, parent: &str, child: &str| {
        format!(
            "<joint name='{name}' type='revolute'><parent link='{parent}'/><child link='{child}'/></joint>"
        )
    };
    let links = ["a", "b", "c", "d", "e"].map(|n| format!("<link name='{n}'/>"));
    let (ab, bc, ad, de) = (
        joint("ab", "a", "b"),
        joint("bc", "b", "c"),
        joint("ad", "a", "d"),
        joint("de", "d", "e"),
    );
    let robot = |parts: &[&str]| {
        read(
            &format!("<robot name='r'>{}</robot>", parts.concat()),
            LUMPED,
        )
    };
    let [a, b, c, d, e] = links.each_ref().map(String::as_str);
    let straight = robot(&[a, b, c, d, e, &ab, &bc, &ad, &de]);
    assert_eq!(names(&straight), ["b", "c", "d", "e"]);
    assert_eq!(robot(&[&de, e, &ab, c, a, &ad, d, &bc, b]), straight);
    // Two joints on one link: the one that is written first is numbered first.
    assert_eq!(
        names(&robot(&[a, b, c, d, e, &ad, &ab, &bc, &de])),
        ["d", "e", "b", "c"]
    );
}

#[test]
fn names_may_be_anything_visible() {
    let text = "<robot name='r'><link name='a/b \u{e9} \"q\"'/><link name='base'/>\
         <joint name='&lt;j&gt;' type='revolute'><parent link='a/b \u{e9} \"q\"'/>\
         <child link='base'/></joint></robot>";
    let robot = read(text, LUMPED);
    assert_eq!(names(&robot), ["base"]);
    assert_eq!(robot.links[0].joint_name.as_deref(), Some("<j>"));
}

#[test]
fn a_namespace_on_the_robot_changes_nothing() {
    let text = "<robot name='r' xmlns='http://www.ros.org' xmlns:xacro='http://www.ros.org/wiki/xacro'>\
         <link name='a'/><link name='b'/><joint name='j' type='revolute'><parent link='a'/>\
         <child link='b'/></joint></robot>";
    assert_eq!(names(&read(text, LUMPED)), ["b"]);
}

// Generated trees: lumping must change neither frames nor inertia.

/// A link on an earlier one: which, joint type, xyz, rpy, mass and the rest.
#[derive(Debug, Clone)]
struct Body {
    parent: prop::sample::Index,
    kind: &'static str,
    xyz: [f64; 3],
    rpy: [f64; 3],
    mass: Option<f64>,
    centre: [f64; 3],
    turn: [f64; 3],
    /// Second moments about the centre of mass along the axes of its frame, kg m^2.
    spread: [f64; 3],
}

fn body() -> impl Strategy<Value = Body> {
    let triple = |range: std::ops::Range<f64>| prop::array::uniform3(range);
    let kind = prop::sample::select(vec![
        "fixed",
        "fixed",
        "revolute",
        "prismatic",
        "continuous",
    ]);
    (
        (
            any::<prop::sample::Index>(),
            kind,
            prop::option::weighted(0.8, 0.1..5.0f64),
        ),
        (triple(-1.0..1.0), triple(-3.2..3.2), triple(-0.5..0.5)),
        (triple(-3.2..3.2), triple(0.01..0.1)),
    )
        .prop_map(
            |((parent, kind, mass), (xyz, rpy, centre), (turn, spread))| Body {
                parent,
                kind,
                xyz,
                rpy,
                mass,
                centre,
                turn,
                spread,
            },
        )
}

fn text([x, y, z]: [f64; 3]) -> String {
    format!("{x:?} {y:?} {z:?}")
}

fn urdf(bodies: &[Body]) -> String {
    let mut all = String::from("<robot name='r'><link name='l0'/>");
    for (k, body) in (1..).zip(bodies) {
        let [a, b, c] = body.spread;
        let inertial = body.mass.map_or(String::new(), |mass| {
            format!(
                "<inertial><origin xyz='{}' rpy='{}'/><mass value='{mass:?}'/><inertia \
                 ixx='{:?}' ixy='0' ixz='0' iyy='{:?}' iyz='0' izz='{:?}'/></inertial>",
                text(body.centre),
                text(body.turn),
                b + c,
                a + c,
                a + b
            )
        });
        all += &format!(
            "<link name='l{k}'>{inertial}</link><joint name='j{k}' type='{}'><parent link='l{}'/>\
             <child link='l{k}'/><origin xyz='{}' rpy='{}'/></joint>",
            body.kind,
            body.parent.index(k),
            text(body.xyz),
            text(body.rpy)
        );
    }
    all + "</robot>"
}

type Placement = (Matrix3<f64>, Vector3<f64>);

fn compose((r, p): Placement, (s, q): Placement) -> Placement {
    (r * s, r * q + p)
}

/// The placement of every link in the base at zero joint variables.
fn frames(robot: &RobotDescription) -> Vec<(String, Placement)> {
    let mut frames: Vec<(String, Placement)> = Vec::new();
    for link in &robot.links {
        let base = (Matrix3::identity(), Vector3::zeros());
        let start = link.antecedent.as_ref().map_or(base, |name| {
            frames.iter().find(|(known, _)| known == name).unwrap().1
        });
        let (origins, _) = placed(link);
        let frame = origins.iter().fold(start, |f, o| compose(f, o.placement()));
        frames.push((link.name.clone(), frame));
    }
    frames
}

/// Turns and shifts by some tens of placements of size 1: rounding of some hundred eps.
const FRAME_TOLERANCE: f64 = 1e-13;
/// The same for moments of some kg over distances of some m.
const INERTIA_TOLERANCE: f64 = 1e-11;

/// XX XY XZ YY YZ ZZ MX MY MZ M of point masses.
fn moments(points: &[(f64, Vector3<f64>)]) -> [f64; 10] {
    let sum = |f: &dyn Fn(&Vector3<f64>) -> f64| points.iter().map(|(m, x)| m * f(x)).sum();
    [
        sum(&|x| x.y * x.y + x.z * x.z),
        sum(&|x| -x.x * x.y),
        sum(&|x| -x.x * x.z),
        sum(&|x| x.x * x.x + x.z * x.z),
        sum(&|x| -x.y * x.z),
        sum(&|x| x.x * x.x + x.y * x.y),
        sum(&|x| x.x),
        sum(&|x| x.y),
        sum(&|x| x.z),
        sum(&|_| 1.0),
    ]
}

/// Six points that have a body's mass, centre and second moments, in the link's frame.
fn points(body: &Body) -> Vec<(f64, Vector3<f64>)> {
    let Some(mass) = body.mass else {
        return Vec::new();
    };
    let [roll, pitch, yaw] = body.turn;
    // The inertial's frame by nalgebra's own Euler angles.
    let turn = nalgebra::Rotation3::from_euler_angles(roll, pitch, yaw);
    let mut points = Vec::new();
    for (axis, spread) in body.spread.iter().enumerate() {
        for sign in [-1.0, 1.0] {
            let mut arm = Vector3::zeros();
            arm[axis] = sign * (3.0 * spread / mass).sqrt();
            points.push((mass / 6.0, turn * arm + Vector3::from(body.centre)));
        }
    }
    points
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn lumping_moves_no_frame(bodies in prop::collection::vec(body(), 1..12)) {
        let text = urdf(&bodies);
        let kept = frames(&read(&text, KEPT));
        prop_assert_eq!(kept.len(), bodies.len());
        for (name, (r, p)) in frames(&read(&text, LUMPED)) {
            let (s, q) = kept.iter().find(|(known, _)| *known == name).unwrap().1;
            prop_assert!((r - s).amax() < FRAME_TOLERANCE, "{}", name);
            prop_assert!((p - q).amax() < FRAME_TOLERANCE, "{}", name);
        }
    }

    #[test]
    fn lumped_inertia_is_that_of_all_points(bodies in prop::collection::vec(body(), 1..12)) {
        let text = urdf(&bodies);
        let robot = read(&text, LUMPED);
        let frames = frames(&read(&text, KEPT));
        let frame = |k: usize| frames.iter().find(|f| f.0 == format!("l{k}")).unwrap().1;
        // The moving link that carries each body; 0 is the base.
        let mut carrier = vec![0];
        for (k, body) in (1..).zip(&bodies) {
            let fixed = body.kind == "fixed";
            carrier.push(if fixed { carrier[body.parent.index(k)] } else { k });
        }
        for k in (1..carrier.len()).filter(|k| carrier[*k] == *k) {
            let (r, p) = frame(k);
            let mut all = Vec::new();
            for (other, body) in (1..).zip(&bodies).filter(|(o, _)| carrier[*o] == k) {
                let (s, q) = frame(other);
                let seen = |x: Vector3<f64>| r.transpose() * (s * x + q - p);
                all.extend(points(body).into_iter().map(|(m, x)| (m, seen(x))));
            }
            let inertia = &link(&robot, &format!("l{k}")).inertia;
            prop_assert!(inertia[10].is_none());
            if all.is_empty() {
                prop_assert!(inertia.iter().all(Option::is_none));
                continue;
            }
            for (found, expected) in inertia.iter().zip(moments(&all)) {
                let found = found.as_ref().unwrap().value;
                prop_assert!((found - expected).abs() < INERTIA_TOLERANCE, "{} {}", found, expected);
            }
        }
    }

    #[test]
    fn reading_is_deterministic(bodies in prop::collection::vec(body(), 1..12)) {
        let text = urdf(&bodies);
        prop_assert_eq!(read(&text, LUMPED), read(&text, LUMPED));
    }
}
