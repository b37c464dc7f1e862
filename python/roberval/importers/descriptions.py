"""Robots of the package robot_descriptions, by name."""

from __future__ import annotations

import importlib
from pathlib import Path

from ..errors import RobotError
from . import missing


def file(name: str) -> Path:
    """Find the file of a robot; the package may fetch it once."""
    try:
        import robot_descriptions  # noqa: F401
    except ImportError:
        raise missing(f"the robot {name}", "robot_descriptions") from None
    try:
        module = importlib.import_module(f"robot_descriptions.{name}")
    except ModuleNotFoundError:
        raise RobotError(f"{name}: robot_descriptions has no robot of this name") from None
    except Exception as error:  # what fetching meets: git, the net, the disk
        raise RobotError(f"{name}: robot_descriptions cannot fetch it: {error}") from error
    for attribute in ("URDF_PATH", "MJCF_PATH", "XACRO_PATH"):
        path = getattr(module, attribute, None)
        if path is not None:
            return Path(path)
    raise RobotError(f"{name}: robot_descriptions gives no file of it")
