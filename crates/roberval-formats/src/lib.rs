//! Robot files and the catalogue of built-in robots.
//!
//! Every reader gives a [`RobotDescription`]: the robot as written, literals kept. No
//! reader opens any file but the one it is asked for (meshes never).

mod catalogue;
mod error;
mod lint;
mod load;
mod source;
mod splice;
mod suspects;
mod toml;
mod urdf;
mod words;

pub use catalogue::{CatalogueEntry, catalogue};
pub use error::{Code, FormatError, Position};
pub use lint::{Finding, Rule, Severity, lint};
pub use load::{Kind, clean_file, load, load_with, read_instead};
pub use roberval_mechanism::RobotDescription;
pub use source::MAX_FILE_BYTES;
pub use toml::{clean_toml, parse_toml, to_toml};
pub use urdf::{UrdfOptions, clean_urdf, parse_urdf, to_urdf};
