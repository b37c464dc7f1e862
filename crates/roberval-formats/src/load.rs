use std::collections::HashMap;
use std::io::Read;
use std::path::Path;
use std::sync::{LazyLock, Mutex, PoisonError};

use roberval_mechanism::{Change, CleanPolicy, NearMiss, RobotDescription};

use crate::catalogue::{catalogue, entry};
use crate::error::{Code, FormatError};
use crate::source::{MAX_FILE_BYTES, check_size, decode};
use crate::toml::{clean_toml, parse_toml};
use crate::urdf::{UrdfOptions, clean_urdf, parse_urdf};
use crate::words::{list, nearest};

/// Loads a robot: a built-in one by its name in the catalogue, or a file, robot TOML or
/// URDF by its extension (`.toml`, `.urdf`, `.xml`) or else by its content.
///
/// # Errors
/// When there is neither, or the file cannot be read or is no valid robot.
pub fn load(path_or_name: &str) -> Result<RobotDescription, FormatError> {
    load_with(path_or_name, UrdfOptions::default())
}

/// Loads a robot as [`load`] does, URDF files with options.
///
/// # Errors
/// As [`load`].
pub fn load_with(path_or_name: &str, urdf: UrdfOptions) -> Result<RobotDescription, FormatError> {
    with_text(path_or_name, |text, name, kind| match kind {
        Kind::Toml => parse_toml(text, name),
        Kind::Urdf => parse_urdf(text, name, urdf),
    })
}

/// The text of a robot file (or built-in robot) with its rounded angles and dust set
/// right and everything else as it is; what was changed; and what was left alone.
///
/// # Errors
/// Those of [`load`].
pub fn clean_file(
    path_or_name: &str,
    policy: &CleanPolicy,
) -> Result<(String, Vec<Change>, Vec<NearMiss>), FormatError> {
    with_text(path_or_name, |text, name, kind| match kind {
        Kind::Toml => clean_toml(text, name, policy),
        Kind::Urdf => clean_urdf(text, name, policy),
    })
}

/// What a robot file holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Robot TOML.
    Toml,
    /// URDF.
    Urdf,
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Self::Toml => "robot TOML",
            Self::Urdf => "URDF",
        }
    }
}

/// Texts that stand for files that other programs read.
static STAND_INS: LazyLock<Mutex<HashMap<String, (Kind, String)>>> = LazyLock::new(Mutex::default);

/// From now on reads this text where the file of this path is asked for. For files in formats
/// of other programs (MJCF, xacro), which have translated them.
pub fn read_instead(path: &str, kind: Kind, text: String) {
    let mut all = STAND_INS.lock().unwrap_or_else(PoisonError::into_inner);
    all.insert(path.to_owned(), (kind, text));
}

/// What is read where this path is asked for, if not the file.
pub(crate) fn stand_in(path: &str) -> Option<(Kind, String)> {
    let all = STAND_INS.lock().unwrap_or_else(PoisonError::into_inner);
    all.get(path).cloned()
}

/// Reads a robot file or built-in robot and hands on its text, its name and its kind.
pub(crate) fn with_text<T>(
    path_or_name: &str,
    read_text: impl FnOnce(&str, &str, Kind) -> Result<T, FormatError>,
) -> Result<T, FormatError> {
    if let Some(entry) = entry(path_or_name) {
        return read_text(entry.toml, entry.name, Kind::Toml);
    }
    if let Some((kind, text)) = stand_in(path_or_name) {
        let name = format!("{path_or_name} (as {})", kind.name());
        return read_text(&text, &name, kind);
    }
    let bytes = read(path_or_name)?;
    let text = decode(path_or_name, &bytes)?;
    let extension = Path::new(path_or_name)
        .extension()
        .map(|e| e.to_string_lossy().to_ascii_lowercase());
    let kind = match extension.as_deref() {
        Some("toml") => Kind::Toml,
        Some("urdf" | "xml") => Kind::Urdf,
        _ if text
            .trim_start_matches(['\u{feff}', ' ', '\t', '\r', '\n'])
            .starts_with('<') =>
        {
            Kind::Urdf
        }
        _ => Kind::Toml,
    };
    read_text(text, path_or_name, kind)
}

fn read(path: &str) -> Result<Vec<u8>, FormatError> {
    let refuse = |error: std::io::Error| not_found(path, &error);
    if Path::new(path).is_dir() {
        return Err(FormatError::new(Code::NotFound, path, "this is a folder")
            .hint("name the robot file in it"));
    }
    let file = std::fs::File::open(path).map_err(refuse)?;
    let mut bytes = Vec::new();
    file.take(MAX_FILE_BYTES as u64 + 1)
        .read_to_end(&mut bytes)
        .map_err(refuse)?;
    check_size(path, bytes.len(), MAX_FILE_BYTES)?;
    Ok(bytes)
}

fn not_found(path: &str, error: &std::io::Error) -> FormatError {
    let names = || catalogue().iter().map(|entry| entry.name);
    if error.kind() != std::io::ErrorKind::NotFound {
        return FormatError::new(Code::NotFound, path, format!("cannot be read: {error}"));
    }
    let result = FormatError::new(
        Code::NotFound,
        path,
        "there is no such file and no built-in robot of this name",
    );
    match nearest(path, names()) {
        Some(near) => result.hint(format!("did you mean the built-in {near:?}?")),
        None => result.hint(format!("built-in robots: {}", list(names()))),
    }
}
