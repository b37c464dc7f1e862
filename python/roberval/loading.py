"""Robots by name or by file."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from . import _core, files, importers
from .options import Number, Snap, reading
from .robot import Robot


class CatalogueEntry(NamedTuple):
    """A built-in robot.

    Attributes
    ----------
    name : str
        The name under which `load` finds it.
    title : str
        What robot it is.
    source : str
        Where its numbers come from.
    """

    name: str
    title: str
    source: str


def load(
    path_or_name: str | os.PathLike[str],
    *,
    keep_fixed: bool = False,
    floating: bool = False,
    rotors: bool = True,
    snap: Snap = "default",
    gravity: Sequence[Number] | None = None,
) -> Robot:
    """Load a robot: a built-in one by its name, or a robot file.

    Robot TOML and URDF are read by roberval itself; MJCF needs the package mujoco, xacro the
    package xacrodoc, and names such as ``panda_description`` the package robot_descriptions.

    Parameters
    ----------
    path_or_name : str or path
        A name of `catalogue`, or the path of a file.
    keep_fixed : bool
        For URDF: keep links on fixed joints as links of their own. By default they are
        lumped into their parents.
    floating : bool
        Let the base move freely: the root link of a URDF, with the inertia it has there; for
        other robots a link ``"0"`` of unknown inertia. A robot that floats already stays as
        it is.
    rotors : bool
        Whether driven joints have a rotor inertia Ia of their own. Without, a link has the
        ten parameters of its rigid body.
    snap : {"default", "off", "aggressive"}
        Set right what the file rounded (1.5708 is pi/2) and take dust (1e-17 m) for zero;
        or take the file as written; or set right 1.57 and 3.14 too. See `Robot.changes`.
    gravity : 3 numbers
        Acceleration of gravity in the base frame, m/s^2, instead of the file's.

    Returns
    -------
    Robot

    Raises
    ------
    RobotError
        There is no such file or robot, or the file is not valid; the message names the
        file, the line and what would be right.

    Examples
    --------
    >>> import roberval as rv
    >>> rv.load("puma560")
    Robot('PUMA 560', 6 revolute joints, 66 parameters)
    """
    asked = reading(
        keep_fixed=keep_fixed, floating=floating, rotors=rotors, snap=snap, gravity=gravity
    )
    path = Path(_path("load", path_or_name))
    if not path.exists():
        path = importers.described(os.fspath(path_or_name)) or path
        path_or_name = path
    if kind := importers.kind_of(path):
        return Robot._imported(importers.read(path, kind), asked)
    return Robot._of(_core.Robot.load(os.fspath(path_or_name), asked), asked)


class Cleaned(NamedTuple):
    """What `clean_file` found in a robot file.

    Attributes
    ----------
    changes : tuple of str
        The numbers that were changed.
    near_misses : tuple of str
        Numbers that look rounded and were left alone.
    """

    changes: tuple[str, ...]
    near_misses: tuple[str, ...]


def clean_file(
    path_or_name: str | os.PathLike[str],
    output: str | os.PathLike[str],
    *,
    aggressive: bool = False,
) -> Cleaned:
    """Write a robot file with its rounded angles and dust set right.

    Comments, order and everything else stay byte for byte. The file is written as a whole or
    not at all; it may be the one that is read. What `load` has others read is written as robot
    TOML (MJCF) or URDF (xacro).

    Parameters
    ----------
    path_or_name : str or path
        A robot TOML or URDF file, or a name of `catalogue`.
    output : str or path
        The file to write.
    aggressive : bool
        Set right coarse roundings such as 1.57 too.

    Returns
    -------
    Cleaned

    Raises
    ------
    RobotError
        There is no such file or robot, or the file is not valid.
    OSError
        `output` cannot be written.
    """
    snap = "aggressive" if aggressive else "default"
    path = importers.stand_in(_path("clean_file", path_or_name))
    text, changes, near_misses = _core.clean_file(path, snap)
    files.write(output, text)
    return Cleaned(tuple(changes), tuple(near_misses))


def _path(function: str, path: Any) -> str:
    """Return a path as text, or refuse what is none."""
    try:
        text = os.fspath(path)
    except TypeError:
        text = None
    if not isinstance(text, str):
        raise TypeError(
            f"{function} takes a file's path or the name of a built-in robot, not {path!r}"
        )
    return text


def catalogue() -> tuple[CatalogueEntry, ...]:
    """List the built-in robots.

    Examples
    --------
    >>> import roberval as rv
    >>> "puma560" in [entry.name for entry in rv.catalogue()]
    True
    """
    return tuple(CatalogueEntry(*entry) for entry in _core.catalogue())
