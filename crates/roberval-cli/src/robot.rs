//! From the robot argument to the mechanism.

use roberval_formats::{UrdfOptions, load_with};
use roberval_mechanism::{CleanMode, CleanPolicy, Mechanism};

use crate::arguments::ReadingArgs;
use crate::error::CliError;

/// Loads a robot.
pub(crate) fn load(robot: &str, reading: &ReadingArgs) -> Result<Mechanism, CliError> {
    let options = UrdfOptions {
        keep_fixed: reading.keep_fixed,
        floating: reading.floating,
    };
    let mut description = load_with(robot, options)?;
    if reading.floating {
        description = description.with_floating_base();
    }
    if reading.no_rotors {
        description = description.without_rotors();
    }
    if let Some(gravity) = &reading.gravity {
        description.gravity = gravity.0.clone();
    }
    Mechanism::cleaned(&description, &policy(reading.snap)).map_err(|error| CliError::Mechanism {
        robot: robot.to_owned(),
        error,
    })
}

/// The policy of a mode.
pub(crate) fn policy(mode: CleanMode) -> CleanPolicy {
    CleanPolicy {
        mode,
        ..CleanPolicy::default()
    }
}
