//! Bases that float and planar joints, as the readers take them.

use roberval_formats::{UrdfOptions, parse_toml, parse_urdf, to_toml};
use roberval_mechanism::{
    Geometry, JointKind, Mechanism, MechanismError, RobotDescription, SourceFormat,
};

const FLOATING: UrdfOptions = UrdfOptions {
    keep_fixed: false,
    floating: true,
};

/// A world, a body on it by a joint of some type, a plate fixed to the body and an arm.
fn urdf(kind: &str, more: &str) -> String {
    format!(
        "<robot name='r'><link name='world'/>
        <link name='body'><inertial><mass value='2'/>
          <inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>
        <link name='plate'><inertial><mass value='3'/>
          <inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>
        <link name='arm'/>
        <joint name='free' type='{kind}'><parent link='world'/><child link='body'/>
          <origin xyz='0 0 1'/>{more}</joint>
        <joint name='weld' type='fixed'><parent link='body'/><child link='plate'/></joint>
        <joint name='hinge' type='revolute'><parent link='plate'/><child link='arm'/></joint>
        </robot>"
    )
}

fn read(text: &str, options: UrdfOptions) -> RobotDescription {
    parse_urdf(text, "r.urdf", options).expect("valid")
}

fn names(robot: &RobotDescription) -> Vec<(&str, Option<&str>, JointKind)> {
    robot
        .links
        .iter()
        .map(|l| (l.name.as_str(), l.antecedent.as_deref(), l.joint))
        .collect()
}

#[test]
fn a_floating_joint_of_the_root_lets_its_child_float() {
    let text = urdf("floating", "");
    for options in [UrdfOptions::default(), FLOATING] {
        let robot = read(&text, options);
        let expected = [
            ("body", None, JointKind::Floating),
            ("arm", Some("body"), JointKind::Revolute),
        ];
        assert_eq!(names(&robot), expected);
        let mass = robot.links[0].inertia[9].as_ref().expect("a mass");
        assert_eq!(mass.value, 5.0, "with the plate");
        assert!(!robot.links[0].rotor && robot.links[1].rotor);
        let robot = Mechanism::new(&robot).expect("valid");
        assert_eq!((robot.dof(), robot.positions()), (7, 8));
        assert_eq!(robot.parameters().len(), 21);
        assert_eq!(robot.row_names()[5..], ["body.mz", "hinge"]);
        assert_eq!(robot.position_names()[6..], ["body.qw", "hinge"]);
    }
}

#[test]
fn the_root_floats_where_that_is_asked_for() {
    let text = urdf("fixed", "");
    let still = read(&text, UrdfOptions::default());
    assert_eq!(names(&still), [("arm", None, JointKind::Revolute)]);
    let robot = read(&text, FLOATING);
    let expected = [
        ("world", None, JointKind::Floating),
        ("arm", Some("world"), JointKind::Revolute),
    ];
    assert_eq!(names(&robot), expected);
    let first: Vec<f64> = robot.links[0].inertia[6..10]
        .iter()
        .map(|x| x.as_ref().expect("known").value)
        .collect();
    assert_eq!(first, [0.0, 0.0, 5.0, 5.0], "body and plate, 1 m above");
    assert_eq!(robot.clone().with_floating_base(), robot);
    let by_hand = still.with_floating_base();
    assert_eq!(names(&by_hand)[0], ("0", None, JointKind::Floating));
}

#[test]
fn a_planar_joint_is_three_joints_and_one_body() {
    let text = urdf("planar", "<axis xyz='0 0 1'/>");
    let text = text.replace("<parent link='plate'/>", "<parent link='body'/>");
    let robot = read(&text, UrdfOptions::default());
    let expected = [
        ("body.x", None, JointKind::Prismatic),
        ("body.y", Some("body.x"), JointKind::Prismatic),
        ("body", Some("body.y"), JointKind::Revolute),
        ("arm", Some("body"), JointKind::Revolute),
    ];
    assert_eq!(names(&robot), expected);
    let Geometry::Placed { origins, .. } = &robot.links[0].geometry else {
        panic!("a URDF")
    };
    assert_eq!(origins[0].xyz[2].value, 1.0);
    let placed = RobotDescription {
        format: SourceFormat::Placed,
        ..robot.clone()
    };
    let toml = to_toml(&placed).expect("written");
    let again = parse_toml(&toml, "r.toml").expect("valid");
    assert_eq!(names(&again), expected);
    let columns = |robot| Mechanism::new(robot).expect("valid").parameters().len();
    assert_eq!((columns(&robot), columns(&again)), (10 + 11, 10 + 11));
    let robot = Mechanism::new(&robot).expect("valid");
    assert_eq!(robot.row_names(), ["free.x", "free.y", "free", "hinge"]);
}

#[test]
fn a_floating_base_can_be_written_as_toml() {
    let text = "[[link]]\nname = \"hull\"\njoint = \"floating\"\ninertia = { M = 7 }\n\
                [[link]]\nalpha = \"pi/2\"\nd = 0\nr = 0.1\n";
    let robot = parse_toml(text, "r.toml").expect("valid");
    let expected = [
        ("hull", None, JointKind::Floating),
        ("2", Some("hull"), JointKind::Revolute),
    ];
    assert_eq!(names(&robot), expected);
    let again = parse_toml(&to_toml(&robot).expect("written"), "r.toml");
    assert_eq!(again.expect("valid"), robot);
}

#[test]
fn a_link_that_floats_must_carry_all_others() {
    let link = |name: &str, on: &str, joint: &str| {
        format!(
            "[[link]]\nname = \"{name}\"\nantecedent = \"{on}\"\njoint = \"{joint}\"\n\
             alpha = 0\nd = 0\nr = 0\ntheta = 0\n"
        )
    };
    let refused = |links: [String; 2]| {
        let robot = parse_toml(&links.concat(), "r.toml").expect("a tree");
        Mechanism::new(&robot).expect_err("refused")
    };
    let on_link = refused([link("a", "base", "revolute"), link("b", "a", "floating")]);
    assert!(matches!(on_link, MechanismError::FloatingOnLink { link, .. } if link == "b"));
    let beside = refused([link("a", "base", "floating"), link("b", "base", "revolute")]);
    assert!(matches!(beside, MechanismError::BesideFloating { link, .. } if link == "b"));
    for wrong in ["inertia = { M = 1 }", "rotor = true"] {
        let text = format!("[[link]]\nalpha = 0\nd = 0\nr = 0\nmassless = true\n{wrong}\n");
        let error = parse_toml(&text, "r.toml")
            .expect_err("refused")
            .to_string();
        assert!(error.contains("a massless link has no"), "{error}");
    }
    let rotor = "[[link]]\njoint = \"floating\"\nrotor = true\n";
    let error = parse_toml(rotor, "r.toml")
        .expect_err("refused")
        .to_string();
    assert!(
        error.contains("a floating joint cannot have rotor = true"),
        "{error}"
    );
}
