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
        raise missing("expanding xacro", "xacrodoc") from None
    try:
        text = xacrodoc.XacroDoc.from_file(str(path)).to_urdf_string()
    except Exception as error:  # xacro raises whatever its macros meet
        raise RobotError(f"{path}: xacro cannot expand it: {error}") from error
    return Text("urdf", text)
