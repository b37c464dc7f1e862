//! URDF: links and joints in an XML file, frames of their own.

mod assemble;
mod clean;
mod inertia;
mod joint;
mod link;
mod node;
mod planar;
mod prescan;
mod tree;
mod write;

use std::borrow::Cow;
use std::collections::HashMap;

use roberval_mechanism::RobotDescription;
use roxmltree::{Document, Error, Node, ParsingOptions};

use crate::error::{Code, FormatError};
use crate::source::{Source, name_fault, stem};
use crate::words::quoted;
pub(crate) use assemble::{is_unit, of_joints};
pub use clean::clean_urdf;
pub(crate) use joint::Joint;
pub(crate) use link::Link;
pub(crate) use node::Element;
pub use write::to_urdf;

/// The most namespace prefixes that nobody declared.
const MAX_PREFIXES: usize = 8;

/// The most XML nodes that are read.
const MAX_NODES: u32 = 2_000_000;

/// How to read a URDF.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct UrdfOptions {
    /// Keep fixed joints as links of their own; the default is to lump a link on a fixed
    /// joint into its parent.
    pub keep_fixed: bool,
    /// Let the root link move freely, unless the file has a floating joint; the default is
    /// that it stands still.
    pub floating: bool,
}

/// Reads a URDF. `source_name` names the text in messages, and the robot where the text
/// gives no name. Meshes and everything that is no link and no joint are ignored, no
/// other file is opened.
///
/// The root link and what is fixed to it are the base, unless it floats. The others are
/// numbered depth first, joints in file order. Inertial parameters are about the origin of the link's
/// frame and in that frame; they include the links lumped into it.
///
/// # Errors
/// The first fault of the text with its line: encoding, XML, other formats, malformed or
/// non-finite numbers, names, joint types, links that are no tree, mimic joints.
pub fn parse_urdf(
    text: &str,
    source_name: &str,
    options: UrdfOptions,
) -> Result<RobotDescription, FormatError> {
    let source = Source::new(source_name, text)?;
    with_robot(&source, |root| {
        let name = match root.attribute("name")? {
            None => stem(source_name),
            Some(name) if name_fault(name).is_some() => stem(source_name),
            Some(name) => name.to_owned(),
        };
        let links = elements(root, "link", Link::read)?;
        let joints = elements(root, "joint", Joint::read)?;
        let tree = tree::Tree::new(&source, &links, &joints)?;
        assemble::description(&source, name, &links, &joints, &tree, options)
    })
}

/// Hands on the `<robot>` of a text, once it is sure that there is one.
pub(crate) fn with_robot<T>(
    source: &Source,
    read: impl FnOnce(&Element) -> Result<T, FormatError>,
) -> Result<T, FormatError> {
    prescan::check(source)?;
    let mut text = Cow::Borrowed(source.text);
    for _ in 0..=MAX_PREFIXES {
        let limits = ParsingOptions {
            nodes_limit: MAX_NODES,
            ..ParsingOptions::default()
        };
        let prefix = match Document::parse_with_options(&text, limits) {
            Ok(document) => {
                let root = Element::new(source, document.root_element(), "robot");
                check_format(&root)?;
                return read(&root);
            }
            Err(Error::UnknownNamespace(prefix, _)) if prefix != "xacro" => prefix,
            Err(error) => return Err(malformed(source, &error)),
        };
        text = Cow::Owned(without_prefix(source, &text, &prefix));
    }
    let what = format!("more than {MAX_PREFIXES} namespace prefixes are not declared");
    Err(source.error(Code::TooMany, 0, what))
}

/// The text with `_` for the colon of an undeclared namespace prefix, which ROS reads over:
/// everything stays where it is.
fn without_prefix(source: &Source, text: &str, prefix: &str) -> String {
    let name = format!("{prefix}:");
    let mut changed = String::with_capacity(text.len());
    let mut rest = 0;
    for (at, _) in text.match_indices(&name) {
        if text[..at].ends_with(|c: char| c == '<' || c == '/' || c.is_whitespace()) {
            if rest == 0 {
                let what = format!("the namespace prefix {} is not declared", quoted(prefix));
                source.warn(at, "robot", &what);
            }
            changed.push_str(&text[rest..at]);
            changed.push_str(prefix);
            changed.push('_');
            rest = at + name.len();
        }
    }
    changed + &text[rest..]
}

fn malformed(source: &Source, error: &Error) -> FormatError {
    let text = error.to_string();
    // The position is said once, before the message.
    let what = text.rfind(" at ").map_or(text.as_str(), |at| &text[..at]);
    let code = match error {
        Error::NodesLimitReached | Error::AttributesLimitReached => Code::TooMany,
        Error::NamespacesLimitReached => Code::TooMany,
        Error::DtdDetected => Code::Dtd,
        Error::UnknownNamespace(prefix, _) if prefix == "xacro" => return xacro(source, error),
        _ => Code::Xml,
    };
    let mut result = FormatError::new(code, source.name, what);
    result.position = Some(match error {
        // The text ends before the robot does.
        Error::UnclosedRootNode | Error::NoRootNode => source.position(source.text.len()),
        _ => position(error),
    });
    if source.text.trim_start().starts_with('<') {
        return result;
    }
    result.hint("a URDF begins with <?xml or <robot: is this one?")
}

fn position(error: &Error) -> crate::error::Position {
    let at = error.pos();
    crate::error::Position {
        line: at.row,
        column: at.col,
    }
}

const XACRO_HINT: &str = "expand it first: xacro robot.urdf.xacro > robot.urdf";

fn xacro(source: &Source, error: &Error) -> FormatError {
    let what = "this is xacro, not URDF";
    let mut result = FormatError::new(Code::Xacro, source.name, what).hint(XACRO_HINT);
    result.position = Some(position(error));
    result
}

/// Refuses other formats by the name of their root element, and xacro.
fn check_format(root: &Element) -> Result<(), FormatError> {
    let name = root.node.tag_name().name();
    let (what, hint) = match name.to_ascii_lowercase().as_str() {
        "robot" => return check_expanded(root),
        "sdf" | "gazebo" => ("this is SDF, not URDF", "convert the model to URDF"),
        "mujoco" => (
            "this is MJCF (MuJoCo), not URDF",
            "the Python package reads it where mujoco is installed: pip install mujoco",
        ),
        "mujocoinclude" => (
            "this is a part that MJCF (MuJoCo) files include, not a whole model",
            "name the MJCF file that includes it",
        ),
        "html" => (
            "this is a web page, not a robot file",
            "download the raw file",
        ),
        _ => {
            let what = format!("the root element is <{name}>, not <robot>");
            return Err(root.fault(Code::WrongFormat, what).hint("is this a URDF?"));
        }
    };
    Err(root.fault(Code::WrongFormat, what).hint(hint))
}

fn check_expanded(root: &Element) -> Result<(), FormatError> {
    let is_xacro = |node: &Node| {
        let space = node.tag_name().namespace();
        space.is_some_and(|uri| uri.contains("xacro"))
    };
    match root.node.children().find(is_xacro) {
        None => Ok(()),
        Some(node) => {
            let name = node.tag_name().name();
            let what = format!("<xacro:{name}>: this is xacro, not URDF");
            Err(Element::new(root.source, node, "robot")
                .fault(Code::Xacro, what)
                .hint(XACRO_HINT))
        }
    }
}

/// All children of a kind, with unique names.
fn elements<T: Named>(
    root: &Element,
    tag: &str,
    read: fn(&Element, &str) -> Result<T, FormatError>,
) -> Result<Vec<T>, FormatError> {
    let mut all: Vec<T> = Vec::new();
    let mut first: HashMap<String, usize> = HashMap::new();
    for (number, node) in (1..).zip(root.children(tag)) {
        let unnamed = format!("{tag} {number}");
        let element = Element::new(root.source, node, &unnamed);
        let name = element.required("name")?;
        if let Some(what) = name_fault(name) {
            return Err(element.attribute_fault("name", Code::BadName, what));
        }
        let place = format!("{tag} {}", quoted(name));
        let element = Element::new(root.source, node, &place);
        let item = read(&element, name)?;
        if let Some(at) = first.insert(name.to_owned(), item.offset()) {
            let line = root.source.position(at).line;
            let what = format!("two {tag}s have this name");
            return Err(element
                .fault(Code::DuplicateName, what)
                .hint(format!("the other one is in line {line}")));
        }
        all.push(item);
    }
    Ok(all)
}

/// What [`elements`] needs of a link or a joint.
trait Named {
    /// Where the element begins.
    fn offset(&self) -> usize;
}
