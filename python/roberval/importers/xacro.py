"""xacro files."""

from __future__ import annotations

from pathlib import Path

from ..errors import RobotError
from . import Text, missing


def from_file(path: Path) -> Text:
    """Expand a xacro file to URDF."""
    try:
        import xacrodoc
    except ImportError:
        raise missing(f"{path}: expanding xacro", "xacrodoc") from None
    try:
        text = xacrodoc.XacroDoc.from_file(str(path)).to_urdf_string()
    except Exception as error:  # xacro raises whatever its macros meet
        raise RobotError(
            f"{path}: xacro cannot expand it: {error}; if it wants arguments, expand it with them:"
            f" xacrodoc {path.name} -o robot.urdf name:=value"
        ) from error
    return Text("urdf", text)
