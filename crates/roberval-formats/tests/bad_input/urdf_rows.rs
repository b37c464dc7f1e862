use super::Row;

/// Whole files.
pub const FILES: &[Row] = &[
    ("xml: empty", "", "E101", &["r.urdf: [E101]", "empty"]),
    ("xml: blank", "\n\n  ", "E101", &["empty"]),
    ("xml: no XML", "hello", "E103", &["r.urdf:1:1", "<robot"]),
    (
        "xml: only a comment",
        "<!-- nothing -->",
        "E103",
        &["r.urdf:1:"],
    ),
    (
        "xml: truncated",
        "<robot name='r'>\n<link name='a'>",
        "E103",
        &["r.urdf:2:"],
    ),
    (
        "xml: mismatched tag",
        "<robot name='r'>\n<link name='a'></robot>",
        "E103",
        &["r.urdf:2:", "expected"],
    ),
    (
        "xml: duplicate attribute",
        "<robot name='r'>\n<link name='a' name='b'/></robot>",
        "E103",
        &["r.urdf:2:", "name"],
    ),
    (
        "xml: NUL",
        "<robot name='r'>\0</robot>",
        "E103",
        &["r.urdf:1:"],
    ),
    (
        "xml: unknown entity",
        "<robot name='r'>\n<link name='&who;'/></robot>",
        "E103",
        &["r.urdf:2:"],
    ),
    (
        "xml: two roots",
        "<robot name='r'/><robot name='s'/>",
        "E103",
        &["r.urdf:1:"],
    ),
    (
        "xml: attribute without quotes",
        "<robot name=r/>",
        "E103",
        &["r.urdf:1:"],
    ),
    (
        "xml: many undeclared prefixes",
        "<robot name='r'>\n<a:x/><b:x/><c:x/><d:x/><e:x/><f:x/><g:x/><h:x/><i:x/></robot>",
        "E604",
        &["r.urdf:", "namespace prefixes"],
    ),
    (
        "xml: document type",
        "<?xml version='1.0'?>\n<!DOCTYPE robot SYSTEM 'x.dtd'>\n<robot name='r'/>",
        "E110",
        &["r.urdf:2:1", "DOCTYPE"],
    ),
    (
        "xml: external entity",
        "<!DOCTYPE r [<!ENTITY x SYSTEM 'file:///etc/passwd'>]>\n<robot name='&x;'/>",
        "E110",
        &["refused"],
    ),
    (
        "xml: billion laughs",
        "<!DOCTYPE r [<!ENTITY a 'ha'><!ENTITY b '&a;&a;&a;&a;'>]>\n<robot name='&b;'/>",
        "E110",
        &["refused"],
    ),
    (
        "xml: web page",
        "<!DOCTYPE html>\n<html><body>robot</body></html>",
        "E116",
        &["web page", "download"],
    ),
    (
        "xml: web page without type",
        "<HTML lang='en'><head></head></HTML>",
        "E116",
        &["web page"],
    ),
    (
        "xml: SDF",
        "<sdf version='1.6'><model name='r'/></sdf>",
        "E116",
        &["r.urdf:1:1", "SDF"],
    ),
    (
        "xml: MJCF",
        "<mujoco model='r'><worldbody/></mujoco>",
        "E116",
        &["MJCF"],
    ),
    (
        "xml: COLLADA",
        "<COLLADA/>",
        "E116",
        &["<COLLADA>", "<robot>"],
    ),
    (
        "xml: xacro macro",
        "<robot name='r' xmlns:xacro='http://www.ros.org/wiki/xacro'>\n<xacro:arm/></robot>",
        "E115",
        &["r.urdf:2:1", "<xacro:arm>", "expand it first"],
    ),
    (
        "xml: xacro undeclared",
        "<robot name='r'>\n<xacro:arm/></robot>",
        "E115",
        &["r.urdf:2:", "expand it first"],
    ),
    ("xml: no link", "<robot name='r'/>", "E200", &["no link"]),
    (
        "xml: only joints",
        "<robot name='r'>\n<joint name='j' type='fixed'><parent link='a'/><child link='b'/></joint></robot>",
        "E200",
        &["no link"],
    ),
    (
        "xml: xacro name",
        "<robot name='${name}'><link name='a'/></robot>",
        "E115",
        &["${name}"],
    ),
    (
        "xml: two links without joint",
        "<robot name='r'>\n<link name='a'/>\n<link name='b'/></robot>",
        "E206",
        &["r.urdf:3:1", "link \"b\"", "\"a\", \"b\""],
    ),
    (
        "xml: only a cycle",
        "<robot name='r'>\n<link name='a'/><link name='b'/>\n\
        <joint name='j' type='fixed'><parent link='a'/><child link='b'/></joint>\n\
        <joint name='k' type='fixed'><parent link='b'/><child link='a'/></joint></robot>",
        "E204",
        &["joint", "circle", "\"a\"", "\"b\""],
    ),
    (
        "xml: a cycle beside the root",
        "<robot name='r'>\n<link name='r'/><link name='a'/><link name='b'/>\n\
        <joint name='j' type='fixed'><parent link='a'/><child link='b'/></joint>\n\
        <joint name='k' type='fixed'><parent link='b'/><child link='a'/></joint></robot>",
        "E204",
        &["circle", "\"a\"", "\"b\""],
    ),
];

/// Elements of a robot that has the links a and b in lines 2 and 3; the text begins in
/// line 4.
pub const ROBOTS: &[Row] = &[
    (
        "name: xacro link",
        "<link name='${p}c'/>",
        "E115",
        &["link 3", "name = \"${p}c\" is xacro", "expand it first"],
    ),
    (
        "name: xacro joint",
        "<joint name='$(arg p)j' type='fixed'><parent link='a'/><child link='b'/></joint>",
        "E115",
        &["joint 1", "\"$(arg p)j\" is xacro"],
    ),
    (
        "link without name",
        "<link/>",
        "E132",
        &["r.urdf:4:1", "link 3", "no attribute name"],
    ),
    (
        "link with empty name",
        "<link name=''/>",
        "E201",
        &["r.urdf:4:7", "empty or blank"],
    ),
    (
        "link with blank name",
        "<link name='  '/>",
        "E201",
        &["empty or blank"],
    ),
    (
        "link with a newline in its name",
        "<link name='a&#10;b'/>",
        "E201",
        &["control"],
    ),
    (
        "link twice",
        "<link name='a'/>",
        "E202",
        &["r.urdf:4:1", "link \"a\"", "line 2"],
    ),
    (
        "joint without name",
        "<joint type='fixed'><parent link='a'/><child link='b'/></joint>",
        "E132",
        &["joint 1", "no attribute name"],
    ),
    (
        "joint with empty name",
        "<joint name='' type='fixed'><parent link='a'/><child link='b'/></joint>",
        "E201",
        &["r.urdf:4:8"],
    ),
    (
        "joint twice",
        "<joint name='j' type='fixed'><parent link='a'/><child link='b'/></joint>\n\
        <joint name='j' type='fixed'><parent link='a'/><child link='b'/></joint>",
        "E202",
        &["r.urdf:5:1", "joint \"j\"", "line 4"],
    ),
    (
        "joint without type",
        "<joint name='j'><parent link='a'/><child link='b'/></joint>",
        "E132",
        &["joint \"j\"", "type"],
    ),
    (
        "floating joint on a link that moves",
        "<joint name='i' type='planar'><parent link='a'/><child link='b'/></joint>\
        <link name='c'/>\n\
        <joint name='j' type='floating'><parent link='b'/><child link='c'/></joint>",
        "E210",
        &["r.urdf:5:1", "joint \"j\"", "can only be the root link's"],
    ),
    (
        "ball joint",
        "<joint name='j' type='ball'><parent link='a'/><child link='b'/></joint>",
        "E210",
        &["\"ball\"", "floating or planar"],
    ),
    (
        "misspelt type",
        "<joint name='j' type='revolut'><parent link='a'/><child link='b'/></joint>",
        "E210",
        &["did you mean revolute?"],
    ),
    (
        "type in another case",
        "<joint name='j' type='Fixed'><parent link='a'/><child link='b'/></joint>",
        "E210",
        &["did you mean fixed?"],
    ),
    (
        "joint without parent",
        "<joint name='j' type='fixed'><child link='b'/></joint>",
        "E132",
        &["r.urdf:4:1", "no <parent>"],
    ),
    (
        "joint without child",
        "<joint name='j' type='fixed'><parent link='a'/></joint>",
        "E132",
        &["no <child>"],
    ),
    (
        "parent without link",
        "<joint name='j' type='fixed'><parent/><child link='b'/></joint>",
        "E132",
        &["joint \"j\"", "<parent> has no attribute link"],
    ),
    (
        "two parents in one joint",
        "<joint name='j' type='fixed'><parent link='a'/><parent link='a'/><child link='b'/></joint>",
        "E202",
        &["a second <parent>"],
    ),
    (
        "unknown parent",
        "<joint name='j' type='fixed'><parent link='aa'/><child link='b'/></joint>",
        "E203",
        &["joint \"j\"", "parent link \"aa\"", "did you mean \"a\"?"],
    ),
    (
        "unknown child",
        "<joint name='j' type='fixed'><parent link='a'/><child link='hand'/></joint>",
        "E203",
        &["child link \"hand\""],
    ),
    (
        "joint to itself",
        "<joint name='j' type='fixed'><parent link='b'/><child link='b'/></joint>",
        "E204",
        &["link \"b\" to itself"],
    ),
    (
        "two parents",
        "<joint name='j' type='fixed'><parent link='a'/><child link='b'/></joint>\n\
        <joint name='k' type='fixed'><parent link='a'/><child link='b'/></joint>",
        "E205",
        &[
            "r.urdf:5:1",
            "joint \"k\"",
            "link \"b\" is also the child of joint \"j\"",
        ],
    ),
    (
        "orphan",
        "<link name='c'/><joint name='j' type='fixed'><parent link='a'/><child link='b'/></joint>",
        "E206",
        &["r.urdf:4:1", "\"a\", \"c\""],
    ),
    (
        "xyz with NaN",
        "<joint name='j' type='fixed'><parent link='a'/><child link='b'/><origin xyz='0 nan 0'/></joint>",
        "E240",
        &["r.urdf:4:", "joint \"j\", origin xyz", "finite"],
    ),
    (
        "xyz infinite",
        "<joint name='j' type='fixed'><parent link='a'/><child link='b'/><origin xyz='0 -inf 0'/></joint>",
        "E240",
        &["finite"],
    ),
    (
        "xyz overflows",
        "<joint name='j' type='fixed'><parent link='a'/><child link='b'/><origin xyz='0 1e999 0'/></joint>",
        "E240",
        &["too large"],
    ),
    (
        "xyz hexadecimal",
        "<joint name='j' type='fixed'><parent link='a'/><child link='b'/><origin xyz='0 0x10 0'/></joint>",
        "E105",
        &["hexadecimal"],
    ),
    (
        "xyz with a decimal comma",
        "<joint name='j' type='fixed'><parent link='a'/><child link='b'/><origin xyz='0 1,5 0'/></joint>",
        "E105",
        &["decimal point"],
    ),
    (
        "xyz with commas alone",
        "<joint name='j' type='fixed'><parent link='a'/><child link='b'/><origin xyz='0,1,0'/></joint>",
        "E105",
        &["origin xyz"],
    ),
    (
        "mass with a comma",
        "<link name='c'><inertial><mass value='1,'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>",
        "E105",
        &["leave the comma out"],
    ),
    (
        "xyz with full-width digits",
        "<joint name='j' type='fixed'><parent link='a'/><child link='b'/><origin xyz='0 \u{ff11} 0'/></joint>",
        "E105",
        &["origin xyz"],
    ),
    (
        "xyz with a Unicode minus",
        "<joint name='j' type='fixed'><parent link='a'/><child link='b'/><origin xyz='0 \u{2212}1 0'/></joint>",
        "E105",
        &["write the minus sign as -"],
    ),
    (
        "xyz with two numbers",
        "<joint name='j' type='fixed'><parent link='a'/><child link='b'/><origin xyz='0 1'/></joint>",
        "E131",
        &["3 numbers wanted, 2 found"],
    ),
    (
        "xyz with four numbers",
        "<joint name='j' type='fixed'><parent link='a'/><child link='b'/><origin xyz='0 1 2 3'/></joint>",
        "E131",
        &["4 found"],
    ),
    (
        "xyz empty",
        "<joint name='j' type='fixed'><parent link='a'/><child link='b'/><origin xyz=''/></joint>",
        "E131",
        &["0 found"],
    ),
    (
        "xyz with a word",
        "<joint name='j' type='fixed'><parent link='a'/><child link='b'/><origin xyz='0 up 0'/></joint>",
        "E105",
        &["\"up\""],
    ),
    (
        "xyz with xacro",
        "<joint name='j' type='fixed'><parent link='a'/><child link='b'/><origin xyz='0 0 ${h}'/></joint>",
        "E115",
        &["${h}", "expand it first"],
    ),
    (
        "xyz with a substitution",
        "<joint name='j' type='fixed'><parent link='a'/><child link='b'/><origin xyz='$(arg x) 0 0'/></joint>",
        "E115",
        &["expand it first"],
    ),
    (
        "rpy with an expression",
        "<joint name='j' type='fixed'><parent link='a'/><child link='b'/><origin rpy='0 pi/2 0'/></joint>",
        "E105",
        &["origin rpy", "\"pi/2\""],
    ),
    (
        "rpy with two numbers",
        "<joint name='j' type='fixed'><parent link='a'/><child link='b'/><origin rpy='0 0'/></joint>",
        "E131",
        &["origin rpy", "2 found"],
    ),
    (
        "two axes",
        "<joint name='j' type='revolute'><parent link='a'/><child link='b'/><axis xyz='1 0 0'/><axis xyz='0 1 0'/></joint>",
        "E202",
        &["a second <axis>"],
    ),
    (
        "quaternion",
        "<joint name='j' type='fixed'><parent link='a'/><child link='b'/><origin quat_xyzw='0 0 0 1'/></joint>",
        "E130",
        &["quaternions", "rpy"],
    ),
    (
        "axis zero",
        "<joint name='j' type='revolute'><parent link='a'/><child link='b'/><axis xyz='0 0 0'/></joint>",
        "E241",
        &["joint \"j\"", "axis is zero", "0 0 1"],
    ),
    (
        "axis minus zero",
        "<joint name='j' type='prismatic'><parent link='a'/><child link='b'/><axis xyz='-0.0 0 0e5'/></joint>",
        "E241",
        &["axis is zero"],
    ),
    (
        "axis with two numbers",
        "<joint name='j' type='revolute'><parent link='a'/><child link='b'/><axis xyz='0 1'/></joint>",
        "E131",
        &["axis xyz", "2 found"],
    ),
    (
        "axis NaN",
        "<joint name='j' type='continuous'><parent link='a'/><child link='b'/><axis xyz='0 NaN 1'/></joint>",
        "E240",
        &["axis xyz"],
    ),
    (
        "limit with a word",
        "<joint name='j' type='revolute'><parent link='a'/><child link='b'/><limit lower='-pi' upper='3'/></joint>",
        "E105",
        &["limit lower", "\"-pi\""],
    ),
    (
        "limit NaN",
        "<joint name='j' type='revolute'><parent link='a'/><child link='b'/><limit lower='nan' upper='3'/></joint>",
        "E240",
        &["limit lower"],
    ),
    (
        "mimic without joint",
        "<joint name='j' type='revolute'><parent link='a'/><child link='b'/><mimic multiplier='2'/></joint>",
        "E132",
        &["<mimic> has no attribute joint"],
    ),
    (
        "mimic of nothing",
        "<joint name='j' type='revolute'><parent link='a'/><child link='b'/><mimic joint='k'/></joint>",
        "E231",
        &["joint \"j\"", "\"k\"", "does not exist"],
    ),
    (
        "mimic of itself",
        "<joint name='j' type='revolute'><parent link='a'/><child link='b'/><mimic joint='j'/></joint>",
        "E230",
        &["circle: \"j\""],
    ),
    (
        "mimic cycle",
        "<link name='c'/><joint name='j' type='revolute'><parent link='a'/><child link='b'/><mimic joint='k'/></joint>\n\
        <joint name='k' type='revolute'><parent link='b'/><child link='c'/><mimic joint='j'/></joint>",
        "E230",
        &["\"j\", \"k\""],
    ),
    (
        "mimic of a fixed joint",
        "<link name='c'/><joint name='j' type='revolute'><parent link='a'/><child link='b'/><mimic joint='k'/></joint>\n\
        <joint name='k' type='fixed'><parent link='b'/><child link='c'/></joint>",
        "E211",
        &[
            "joint \"j\"",
            "\"k\", which is fixed",
            "make it a fixed joint",
        ],
    ),
    (
        "mimic multiplier 0",
        "<link name='c'/><joint name='j' type='revolute'><parent link='a'/><child link='b'/><mimic joint='k' multiplier='0'/></joint>\n\
        <joint name='k' type='revolute'><parent link='b'/><child link='c'/></joint>",
        "E211",
        &["joint \"j\"", "multiplier 0"],
    ),
    (
        "mimic multiplier NaN",
        "<joint name='j' type='revolute'><parent link='a'/><child link='b'/><mimic joint='j' multiplier='nan'/></joint>",
        "E240",
        &["mimic multiplier"],
    ),
    (
        "inertial without mass",
        "<link name='c'>\n<inertial><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>",
        "E132",
        &["r.urdf:5:1", "link \"c\"", "no <mass>"],
    ),
    (
        "inertial without inertia",
        "<link name='c'><inertial><mass value='1'/></inertial></link>",
        "E132",
        &["no <inertia>"],
    ),
    (
        "mass without value",
        "<link name='c'><inertial><mass/><inertia/></inertial></link>",
        "E132",
        &["<mass> has no attribute value"],
    ),
    (
        "mass a word",
        "<link name='c'><inertial><mass value='heavy'/><inertia/></inertial></link>",
        "E105",
        &["mass value", "\"heavy\""],
    ),
    (
        "mass NaN",
        "<link name='c'><inertial><mass value='nan'/><inertia/></inertial></link>",
        "E240",
        &["link \"c\", mass value"],
    ),
    (
        "inertia without izz",
        "<link name='c'><inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0'/></inertial></link>",
        "E132",
        &["izz"],
    ),
    (
        "centre of mass with two numbers",
        "<link name='c'><inertial><origin xyz='0 0'/><mass value='1'/>\
        <inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>",
        "E131",
        &["link \"c\", origin xyz"],
    ),
    (
        "two inertials",
        "<link name='c'><inertial/><inertial/></link>",
        "E202",
        &["a second <inertial>"],
    ),
    (
        "inertia overflows",
        "<link name='c'><inertial><origin xyz='1e200 0 0'/><mass value='1e200'/>\
        <inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>\
        <joint name='j' type='revolute'><parent link='a'/><child link='c'/></joint>\
        <joint name='k' type='revolute'><parent link='a'/><child link='b'/></joint>",
        "E240",
        &["link \"c\"", "inertia is too large"],
    ),
];
