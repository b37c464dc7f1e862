//! Robot TOML: modified Denavit-Hartenberg frames of Khalil and Kleinfinger.

mod clean;
mod couple;
mod loops;
mod section;
mod write;

use roberval_mechanism::{
    Geometry, JointKind, LinkDescription, MdhGeometry, Origin, ParameterKind, RobotDescription,
    SourceFormat, TreeError,
};
use roberval_scalar::{Constants, Quantity, is_constant_name};
use toml_edit::{Document, Item, TableLike};

use crate::error::{Code, FormatError};
use crate::source::{Source, check_size, stem};
use crate::suspects;
use crate::words::{cut, nearest, quoted};
pub use clean::clean_toml;
pub(crate) use clean::with_places;
use section::{Section, one};
pub use write::to_toml;

/// The largest robot TOML: ten thousand links have about 2 MiB.
const MAX_TOML_BYTES: usize = 8 << 20;

/// The most named constants: each expression looks them up one by one.
const MAX_CONSTANTS: usize = 1000;

/// The name that stands for the base in `antecedent`.
pub(crate) const BASE: &str = "base";

const ROBOT_KEYS: &[&str] = &[
    "name",
    "gravity",
    "constants",
    "warnings",
    "link",
    "couple",
    "loop",
];
const LINK_KEYS: &[&str] = &[
    "name",
    "antecedent",
    "joint",
    "active",
    "rotor",
    "massless",
    "gamma",
    "b",
    "alpha",
    "d",
    "theta",
    "r",
    "joint_name",
    "xyz",
    "rpy",
    "axis",
    "inertia",
];

/// Keys of links that are placed as in URDF, and those of modified Denavit-Hartenberg ones.
const PLACED_KEYS: [&str; 3] = ["xyz", "rpy", "axis"];
const MDH_KEYS: [&str; 6] = ["gamma", "b", "alpha", "d", "theta", "r"];

/// Reads a robot TOML. `source_name` names the text in messages, and the robot where the
/// text gives no name.
///
/// # Errors
/// The first fault of the text with its line: syntax, unknown keys, wrong types, numbers
/// without a finite value, links that are no tree, contradicting flags.
pub fn parse_toml(text: &str, source_name: &str) -> Result<RobotDescription, FormatError> {
    read(&Source::new(source_name, text)?)
}

/// Reads the robot of a source, which may go on after faults.
pub(crate) fn read(source: &Source) -> Result<RobotDescription, FormatError> {
    check_size(source.name, source.text.len(), MAX_TOML_BYTES)?;
    let document = Document::parse(source.text).map_err(|error| syntax(source, &error))?;
    let robot = Section::new(source, document.as_table(), "robot", 0);
    robot.only(ROBOT_KEYS)?;

    let constants = constants(&robot)?;
    let mut description = RobotDescription {
        name: robot.name("name")?.unwrap_or_else(|| stem(source.name)),
        gravity: gravity(&robot, &constants)?,
        links: Vec::new(),
        couples: Vec::new(),
        loops: Vec::new(),
        constants,
        format: SourceFormat::Mdh,
        warnings: robot.strings("warnings")?,
    };
    let dependent = couple::dependent_joints(&robot)?;
    let tables = link_tables(&robot)?;
    for (number, (table, offset)) in (1..).zip(&tables) {
        let place = format!("link {number}");
        let section = Section::new(source, *table, &place, *offset);
        let previous = description.links.last().map(|link| link.name.as_str());
        let link = link(
            &section,
            number,
            previous,
            &dependent,
            &description.constants,
        );
        let link = source.or_go_on(link.map(Some), || None)?;
        description.links.extend(link);
    }
    let placed = |link: &LinkDescription| matches!(link.geometry, Geometry::Placed { .. });
    if description.links.iter().any(placed) {
        description.format = SourceFormat::Placed;
    }
    if !source.has_faults() {
        let tree = check_tree(source, &description, &tables);
        source.or_go_on(tree, || ())?;
    }
    couple::couples(&robot, &mut description)?;
    description.loops = loops::read(&robot, &description)?;
    let noticed = noticed(&description);
    description.warnings.extend(noticed);
    Ok(description)
}

fn syntax(source: &Source, error: &toml_edit::TomlError) -> FormatError {
    let what = error.message().trim().replace('\n', ", ");
    let code = if what.contains("recurs") {
        Code::TooDeep
    } else if what.contains("overflow") {
        Code::NotFinite
    } else {
        Code::Toml
    };
    let offset = error.span().map_or(0, |span| span.start);
    let mut error = source.error(code, offset, cut(&what));
    if let Some(place) = unread_place(&source.text[..offset]) {
        error = error.place(cut(&place));
    }
    if code == Code::NotFinite {
        error = error.hint("the largest number is 1.797e308");
    }
    if source.text.trim_start().starts_with('<') {
        return error.hint("this looks like XML, not TOML: name the file .urdf if it is a URDF");
    }
    error
}

/// The link and the key before a place that the TOML reader does not understand.
fn unread_place(before: &str) -> Option<String> {
    let (key, _) = before.lines().last()?.split_once('=')?;
    let header = |line: &str| line.trim().starts_with("[[link]]");
    let links = before.lines().filter(|line| header(line)).count();
    let last = before.lines().rfind(|line| line.trim().starts_with('['));
    Some(match last {
        Some(line) if header(line) => format!("link {links}, {}", key.trim()),
        _ => key.trim().to_owned(),
    })
}

fn constants(robot: &Section) -> Result<Vec<(String, Quantity)>, FormatError> {
    let mut known = Vec::new();
    let Some(section) = robot.table("constants", "constants")? else {
        return Ok(known);
    };
    for (name, _) in section.table.iter() {
        if !is_constant_name(name) {
            let what = format!("{} cannot name a constant", quoted(name));
            let fault = section.fault(Code::BadName, name, what).hint(
                "use letters, digits and _, no digit first, and not pi, sqrt, deg, nan or inf",
            );
            section.source.or_go_on(Err(fault), || ())?;
            continue;
        }
        if known.len() == MAX_CONSTANTS {
            let what = format!("there are more than {MAX_CONSTANTS} constants");
            return Err(section.fault(Code::TooMany, name, what));
        }
        // A constant may be a length or an angle: degrees are allowed.
        let value = section.quantity(name, Quantity::parse_angle, &known)?;
        known.extend(value.map(|value| (name.to_owned(), value)));
    }
    Ok(known)
}

fn gravity(robot: &Section, constants: &Constants) -> Result<[Quantity; 3], FormatError> {
    let default = || {
        let down = Quantity::parse_decimal("-9.81").unwrap_or_else(|_| Quantity::zero());
        [Quantity::zero(), Quantity::zero(), down]
    };
    Ok(robot
        .vector("gravity", Quantity::parse_number, constants)?
        .unwrap_or_else(default))
}

type Tables<'d> = Vec<(&'d dyn TableLike, usize)>;

/// The `[[link]]` tables: at least one.
fn link_tables<'d>(robot: &Section<'_, 'd>) -> Result<Tables<'d>, FormatError> {
    let tables = tables(robot, "link")?;
    if tables.is_empty() {
        return Err(
            FormatError::new(Code::NoLink, robot.source.name, "the robot has no link")
                .hint("describe each link in a [[link]] table"),
        );
    }
    Ok(tables)
}

/// The `[[key]]` tables (or the tables of an array `key = [...]`) and where they begin.
fn tables<'d>(robot: &Section<'_, 'd>, key: &str) -> Result<Tables<'d>, FormatError> {
    let start = |span: Option<std::ops::Range<usize>>| span.map_or(0, |s| s.start);
    let wrong = || {
        robot
            .fault(
                Code::WrongType,
                key,
                format!("{key} must be a list of tables"),
            )
            .hint(format!("begin each {key} with [[{key}]]"))
    };
    let tables: Tables = match robot.table.get(key) {
        None => Vec::new(),
        Some(Item::ArrayOfTables(tables)) => tables
            .iter()
            .map(|t| (t as &dyn TableLike, start(t.span())))
            .collect(),
        Some(item) => item
            .as_array()
            .ok_or_else(wrong)?
            .iter()
            .map(|value| {
                let table = value.as_inline_table().ok_or_else(wrong)?;
                Ok((table as &dyn TableLike, start(value.span())))
            })
            .collect::<Result<_, FormatError>>()?,
    };
    Ok(tables)
}

fn link(
    section: &Section,
    number: usize,
    previous: Option<&str>,
    dependent: &[String],
    constants: &Constants,
) -> Result<LinkDescription, FormatError> {
    section.only(LINK_KEYS)?;
    let name = section.name("name")?.unwrap_or_else(|| number.to_string());
    let place = format!("link {}", quoted(&name));
    let section = &section.renamed(&place);
    if name == BASE {
        let what = "\"base\" is the base and cannot name a link";
        return Err(section.fault(Code::BadName, "name", what));
    }
    let joint = joint_kind(section)?;
    let has_axis = joint.has_axis();
    let driven = has_axis && !dependent.contains(&name);
    let active = section.boolean("active")?.unwrap_or(driven);
    let massless = section.boolean("massless")?.unwrap_or(false);
    let rotor = section
        .boolean("rotor")?
        .unwrap_or(active && has_axis && !massless);
    for (key, value) in [("active", active), ("rotor", rotor), ("massless", massless)] {
        if value && !has_axis {
            let what = format!("a {} joint cannot have {key} = true", joint.name());
            return Err(section.fault(Code::Contradiction, key, what).hint(format!(
                "leave {key} out, or make the joint revolute or prismatic"
            )));
        }
    }
    for key in ["inertia", "rotor"] {
        if massless && (key == "inertia" || rotor) && section.table.contains_key(key) {
            let what = format!("a massless link has no {key}: it only stands between two motions");
            return Err(section.fault(Code::Contradiction, key, what));
        }
    }
    let joint_name = section.name("joint_name")?;
    let label = joint_name.as_deref().unwrap_or(&name);
    Ok(LinkDescription {
        antecedent: antecedent(section, previous)?,
        geometry: placement(section, joint, label, constants)?,
        inertia: inertia(section, rotor, constants)?,
        name,
        joint_name,
        joint,
        active,
        rotor,
        massless,
        limits: None,
    })
}

fn joint_kind(section: &Section) -> Result<JointKind, FormatError> {
    let Some(kind) = section.string("joint")? else {
        return Ok(JointKind::Revolute);
    };
    let known = JointKind::ALL.into_iter().find(|k| k.name() == kind);
    known.ok_or_else(|| {
        let what = format!("unknown joint type {}", quoted(kind));
        section
            .fault(Code::JointType, "joint", what)
            .hint("write \"revolute\", \"prismatic\", \"fixed\" or, for a base, \"floating\"")
    })
}

fn antecedent(section: &Section, previous: Option<&str>) -> Result<Option<String>, FormatError> {
    Ok(match section.name("antecedent")? {
        None => previous.map(str::to_owned),
        Some(name) if name == BASE => None,
        Some(name) => Some(name),
    })
}

/// Where the link is: by xyz, rpy and axis as in URDF, else by modified Denavit-Hartenberg
/// parameters.
fn placement(
    section: &Section,
    joint: JointKind,
    joint_name: &str,
    constants: &Constants,
) -> Result<Geometry, FormatError> {
    let has = |key: &&&str| section.table.contains_key(key);
    let Some(placed) = PLACED_KEYS.iter().find(has) else {
        let geometry = geometry(section, joint, constants)?;
        return Ok(Geometry::Mdh(Box::new(geometry)));
    };
    if let Some(key) = MDH_KEYS.iter().find(has) {
        let what = format!("{key} and {placed} exclude each other");
        return Err(section.fault(Code::Contradiction, key, what).hint(
            "place a link by xyz, rpy and axis, or by modified Denavit-Hartenberg parameters",
        ));
    }
    let vector = |key: &str, read| {
        let value = section.vector(key, read, constants)?;
        Ok::<_, FormatError>(value.unwrap_or_else(|| [(); 3].map(|()| Quantity::zero())))
    };
    let origin = Origin {
        joint: joint_name.to_owned(),
        xyz: vector("xyz", Quantity::parse_length)?,
        rpy: vector("rpy", Quantity::parse_angle)?,
    };
    let axis = match section.vector("axis", Quantity::parse_number, constants)? {
        Some(axis) if joint.has_axis() && axis.iter().all(|x| x.value == 0.0) => {
            let what = "the joint axis is zero";
            return Err(section
                .fault(Code::ZeroAxis, "axis", what)
                .hint("write a direction such as axis = [0, 0, 1]"));
        }
        Some(axis) => axis,
        None => [Quantity::zero(), Quantity::zero(), one()],
    };
    Ok(Geometry::Placed {
        origins: vec![origin],
        axis,
    })
}

/// gamma and b default to 0 (a chain has neither), and so does the constant to which the
/// joint variable is added; the others must be written. A floating base needs none.
fn geometry(
    section: &Section,
    joint: JointKind,
    constants: &Constants,
) -> Result<MdhGeometry, FormatError> {
    let optional = |key: &str, read| {
        let value = section.quantity(key, read, constants)?;
        Ok::<_, FormatError>(value.unwrap_or_else(Quantity::zero))
    };
    let required = |key: &str, read, default: bool| match section.quantity(key, read, constants)? {
        Some(value) => Ok(value),
        None if default || joint == JointKind::Floating => Ok(Quantity::zero()),
        None => {
            let what = format!("{key} is missing");
            let hint = format!("write {key} = 0 if it is zero");
            Err(section.here(Code::Missing, what).hint(hint))
        }
    };
    Ok(MdhGeometry {
        gamma: optional("gamma", Quantity::parse_angle)?,
        b: optional("b", Quantity::parse_length)?,
        alpha: required("alpha", Quantity::parse_angle, false)?,
        d: required("d", Quantity::parse_length, false)?,
        theta: required("theta", Quantity::parse_angle, joint == JointKind::Revolute)?,
        r: required("r", Quantity::parse_length, joint == JointKind::Prismatic)?,
    })
}

fn inertia(
    section: &Section,
    rotor: bool,
    constants: &Constants,
) -> Result<[Option<Quantity>; 11], FormatError> {
    let mut values: [Option<Quantity>; 11] = Default::default();
    let place = format!("{}, inertia", section.place);
    let Some(inertia) = section.table("inertia", &place)? else {
        return Ok(values);
    };
    inertia.only(&ParameterKind::ALL.map(ParameterKind::name))?;
    for (value, kind) in values.iter_mut().zip(ParameterKind::ALL) {
        *value = inertia.quantity(kind.name(), Quantity::parse_number, constants)?;
    }
    if !rotor && values[10].as_ref().is_some_and(|ia| ia.value != 0.0) {
        let what = "Ia is given, but the joint has no rotor";
        return Err(inertia
            .fault(Code::Contradiction, "Ia", what)
            .hint("write rotor = true, or leave Ia out"));
    }
    Ok(values)
}

fn check_tree(
    source: &Source,
    description: &RobotDescription,
    tables: &Tables,
) -> Result<(), FormatError> {
    let Err(fault) = description.antecedents() else {
        return Ok(());
    };
    let at = |link: usize, key: &str, code| {
        let (table, offset) = tables[link];
        let place = format!("link {}", quoted(&description.links[link].name));
        let section = Section::new(source, table, &place, offset);
        section.fault(code, key, fault.to_string())
    };
    Err(match &fault {
        TreeError::DuplicateName { first, link, .. } => {
            let line = source.position(tables[*first].1).line;
            at(*link, "name", Code::DuplicateName)
                .hint(format!("the other one begins in line {line}"))
        }
        TreeError::UnknownAntecedent {
            antecedent, link, ..
        } => {
            let names = description.links.iter().map(|l| l.name.as_str());
            let error = at(*link, "antecedent", Code::UnknownLink);
            match nearest(antecedent, names.chain([BASE])) {
                Some(name) => error.hint(format!("did you mean {}?", quoted(name))),
                None => error.hint("write the name of a link, or \"base\""),
            }
        }
        TreeError::Cycle { link, .. } => {
            at(*link, "antecedent", Code::Cycle).hint("one of them must stand on \"base\"")
        }
    })
}

/// Base parameters need no values, so that values that no body has are no errors.
pub(crate) fn noticed(description: &RobotDescription) -> Vec<String> {
    let links = description.links.iter();
    let told = links.flat_map(|link| {
        let name = quoted(&link.name);
        negatives(link).map(move |what| format!("link {name}: {what} is negative"))
    });
    told.chain(suspects::degrees(description)).collect()
}

/// Values of a link that are negative and cannot be: `XX = -1`.
pub(crate) fn negatives(link: &LinkDescription) -> impl Iterator<Item = String> {
    let positive = [
        ParameterKind::XX,
        ParameterKind::YY,
        ParameterKind::ZZ,
        ParameterKind::M,
        ParameterKind::Ia,
    ];
    positive.into_iter().filter_map(|kind| {
        let value = link.inertia[kind as usize].as_ref()?;
        (value.value < 0.0).then(|| format!("{kind} = {value}"))
    })
}
