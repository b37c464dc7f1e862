//! Hostile texts: limits instead of crashes, hangs and floods.

use roberval_formats::{
    Code, FormatError, MAX_FILE_BYTES, RobotDescription, UrdfOptions, load, parse_toml, parse_urdf,
};

fn urdf(text: &str) -> Result<RobotDescription, FormatError> {
    parse_urdf(text, "r.urdf", UrdfOptions::default())
}

fn code<T: std::fmt::Debug>(result: Result<T, FormatError>) -> Code {
    let error = result.unwrap_err();
    assert!(error.to_string().len() < 1000);
    error.code
}

const URDF: &str = include_str!("../data/small.urdf");
const TOML: &str = include_str!("../../catalogue/puma560.toml");

#[test]
fn a_file_cut_at_any_byte_never_panics() {
    for (text, whole) in [(URDF, URDF.len()), (TOML, TOML.len())] {
        for end in (0..whole).filter(|end| text.is_char_boundary(*end)) {
            let _ = urdf(&text[..end]);
            let _ = parse_toml(&text[..end], "r.toml");
        }
    }
    assert!(urdf(URDF).is_ok() && parse_toml(TOML, "r.toml").is_ok());
}

#[test]
fn a_file_with_any_byte_changed_never_panics() {
    for text in [URDF, TOML] {
        for at in 0..text.len() {
            for byte in [b'<', b'"', b'9', b' ', b'-', 0] {
                let mut bytes = text.as_bytes().to_vec();
                bytes[at] = byte;
                if let Ok(changed) = std::str::from_utf8(&bytes) {
                    let _ = urdf(changed);
                    let _ = parse_toml(changed, "r.toml");
                }
            }
        }
    }
}

#[test]
fn deep_nesting_ends_in_a_limit() {
    let deep = |n: usize| format!("<robot name='r'>{}", "<a>".repeat(n));
    assert_eq!(code(urdf(&deep(300))), Code::TooDeep);
    assert_eq!(code(urdf(&deep(1_000_000))), Code::TooDeep);
    let quoted = "<a b='/>' c=\"<!--\">".repeat(1000);
    assert_eq!(code(urdf(&quoted)), Code::TooDeep);
    let hidden = "<!-- --><![CDATA[</a></a>]]><?x </a>?><a>".repeat(1000);
    assert_eq!(code(urdf(&format!("<robot>{hidden}"))), Code::TooDeep);
    let toml = format!("name = {}", "[".repeat(100_000));
    assert_eq!(code(parse_toml(&toml, "r.toml")), Code::TooDeep);
    let brackets = "(".repeat(900);
    let toml = format!("[[link]]\nalpha = '{brackets}'\n");
    assert_eq!(code(parse_toml(&toml, "r.toml")), Code::LiteralTooLarge);
}

#[test]
fn shallow_nesting_in_what_is_ignored_is_accepted() {
    let ignored = format!("{}{}", "<x>".repeat(250), "</x>".repeat(250));
    let text = format!("<robot name='r'><gazebo>{ignored}</gazebo><link name='a'/></robot>");
    assert!(urdf(&text).is_ok());
}

#[test]
fn floods_end_in_a_limit() {
    let large = " ".repeat(MAX_FILE_BYTES + 1);
    assert_eq!(code(urdf(&large)), Code::TooLarge);
    assert_eq!(code(parse_toml(&large, "r.toml")), Code::TooLarge);
    let key = format!("{} = 1", "k".repeat(1_000_000));
    assert_eq!(code(parse_toml(&key, "r.toml")), Code::UnknownKey);
    let nodes = format!("<robot name='r'>{}</robot>", "<a/>".repeat(2_000_001));
    assert_eq!(code(urdf(&nodes)), Code::TooMany);
    let attributes: String = (0..2000).map(|i| format!(" a{i}=''")).collect();
    assert_eq!(code(urdf(&format!("<robot{attributes}/>"))), Code::TooMany);
    let spaces: String = (0..1100)
        .map(|i| format!("<a xmlns:n{i}='u{i}'/>"))
        .collect();
    assert_eq!(
        code(urdf(&format!("<robot>{spaces}</robot>"))),
        Code::TooMany
    );
    let constants: String = (0..1001).map(|i| format!("c{i} = 1\n")).collect();
    let toml = format!("[constants]\n{constants}[[link]]\nalpha=0\nd=0\nr=0\n");
    assert_eq!(code(parse_toml(&toml, "r.toml")), Code::TooMany);
    let number = format!(
        "<link name='b'><inertial><mass value='{}'/><inertia/></inertial></link>",
        "1".repeat(2000)
    );
    assert_eq!(
        code(urdf(&format!("<robot name='r'>{number}</robot>"))),
        Code::LiteralTooLarge
    );
}

#[test]
fn a_message_does_not_repeat_a_flood_of_the_file() {
    // Found by fuzzing: the XML reader's and the expressions' messages quote whole names.
    let name = "\u{1f916}".repeat(1000);
    let error = urdf(&format!("<robot><{name}></robot>")).unwrap_err();
    assert!(error.to_string().chars().count() < 1000, "{error}");
    let constant = format!("constants.{} = 1\nconstants.b = 'W'\n", "deg".repeat(1000));
    let error = parse_toml(&constant, "r.toml").unwrap_err();
    assert_eq!(error.code, Code::UnknownConstant);
    assert!(error.to_string().chars().count() < 1000, "{error}");
}

/// Links 0..=n in a chain; `joint` gives the type of the joint below link k.
fn chain(n: usize, joint: impl Fn(usize) -> &'static str) -> String {
    let mut text = String::from("<robot name='chain'><link name='l0'/>");
    for k in 0..n {
        let (kind, next) = (joint(k), k + 1);
        text += &format!(
            "<link name='l{next}'/><joint name='j{k}' type='{kind}'><parent link='l{k}'/>\
             <child link='l{next}'/><origin xyz='0 0 1'/></joint>\n"
        );
    }
    text + "</robot>"
}

#[test]
fn long_chains_need_neither_stack_nor_patience() {
    let fixed = urdf(&chain(10_000, |_| "fixed")).unwrap();
    assert!(fixed.links.is_empty());
    let last = urdf(&chain(
        10_000,
        |k| if k < 9_999 { "fixed" } else { "revolute" },
    ))
    .unwrap();
    assert_eq!(last.links.len(), 1);
    let kept = UrdfOptions {
        keep_fixed: true,
        floating: false,
    };
    assert_eq!(
        parse_urdf(&chain(10_000, |_| "fixed"), "r", kept)
            .unwrap()
            .links
            .len(),
        10_000
    );
    let moving = urdf(&chain(10_000, |_| "continuous")).unwrap();
    assert_eq!(moving.links.len(), 10_000);
    let mut mimics = chain(10_000, |_| "revolute");
    for k in (1..10_000).rev() {
        let joint = format!("<joint name='j{k}' type='revolute'>");
        let copies = format!("{joint}<mimic joint='j{}'/>", k - 1);
        if k % 100 == 0 {
            mimics = mimics.replace(&joint, &copies);
        }
    }
    assert_eq!(urdf(&mimics).unwrap().links.len(), 10_000);
    let toml = "[[link]]\nalpha=0\nd=0\nr=0\n".repeat(10_000);
    assert_eq!(parse_toml(&toml, "r").unwrap().links.len(), 10_000);
}

#[test]
fn a_comb_on_fixed_joints_ends_in_a_limit() {
    let mut text = chain(1000, |_| "fixed").replace("</robot>", "");
    for k in 0..1000 {
        text += &format!(
            "<link name='m{k}'/><joint name='m{k}' type='revolute'><parent link='l{k}'/>\
             <child link='m{k}'/></joint>"
        );
    }
    text += "</robot>";
    assert_eq!(code(urdf(&text)), Code::TooMany);
    let kept = UrdfOptions {
        keep_fixed: true,
        floating: false,
    };
    assert_eq!(parse_urdf(&text, "r", kept).unwrap().links.len(), 2000);
}

/// Writes bytes to a file of the test's own and loads it.
fn load_bytes(name: &str, bytes: &[u8]) -> Result<RobotDescription, FormatError> {
    let folder = std::env::temp_dir().join(format!("roberval-formats-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join(name);
    std::fs::write(&path, bytes).unwrap();
    let result = load(path.to_str().unwrap());
    std::fs::remove_file(&path).unwrap();
    result
}

#[test]
fn encodings_other_than_utf8_are_named() {
    let utf16 = |little: bool| -> Vec<u8> {
        let units = "\u{feff}<robot name='r'/>".encode_utf16();
        let bytes = units.map(|u| {
            if little {
                u.to_le_bytes()
            } else {
                u.to_be_bytes()
            }
        });
        bytes.flatten().collect()
    };
    for bytes in [utf16(true), utf16(false), b"<\0r\0o\0".to_vec()] {
        let error = load_bytes("utf16.urdf", &bytes).unwrap_err();
        assert_eq!(error.code, Code::Encoding);
        assert!(error.to_string().contains("UTF-16"), "{error}");
    }
    let error = load_bytes(
        "latin1.urdf",
        b"<robot name='r'>\n<link name='\xe9'/></robot>",
    )
    .unwrap_err();
    assert_eq!(error.code, Code::Encoding);
    assert!(
        error.to_string().contains(":2:13: [E102] the byte 0xe9"),
        "{error}"
    );
    assert_eq!(load_bytes("empty.toml", b"").unwrap_err().code, Code::Empty);
}

#[test]
fn a_byte_order_mark_is_no_fault() {
    let marked = |text: &str| [b"\xef\xbb\xbf", text.as_bytes()].concat();
    assert!(load_bytes("bom.urdf", &marked(URDF)).is_ok());
    assert!(load_bytes("bom.toml", &marked(TOML)).is_ok());
    assert!(load_bytes("bom_without_extension", &marked(URDF)).is_ok());
}

#[test]
fn a_missing_file_suggests_a_built_in_robot() {
    let error = load("puma56O").unwrap_err();
    assert_eq!(error.code, Code::NotFound);
    assert!(
        error
            .to_string()
            .contains("did you mean the built-in \"puma560\"?"),
        "{error}"
    );
    let error = load("no/such/file.urdf").unwrap_err();
    assert!(
        error.to_string().contains("built-in robots: \"puma560\""),
        "{error}"
    );
    assert_eq!(load(".").unwrap_err().code, Code::NotFound);
    assert_eq!(load("").unwrap_err().code, Code::NotFound);
    assert_eq!(load("a\0b").unwrap_err().code, Code::NotFound);
}
