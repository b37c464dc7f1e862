//! From the robot argument to the mechanism.

use std::io::Write;

use roberval_formats::{UrdfOptions, load_with};
use roberval_mechanism::{Mechanism, RobotDescription};

use crate::arguments::ReadingArgs;
use crate::error::CliError;
use crate::say;

/// Loads a robot and tells the reader's warnings.
pub(crate) fn load(
    robot: &str,
    reading: &ReadingArgs,
    err: &mut dyn Write,
) -> Result<(RobotDescription, Mechanism), CliError> {
    let options = UrdfOptions {
        keep_fixed: reading.keep_fixed,
    };
    let mut description = load_with(robot, options)?;
    if let Some(gravity) = &reading.gravity {
        description.gravity = gravity.0.clone();
    }
    let mechanism = Mechanism::new(&description).map_err(|error| CliError::Mechanism {
        robot: robot.to_owned(),
        error,
    })?;
    for warning in &description.warnings {
        say(err, "warning", warning);
    }
    Ok((description, mechanism))
}
