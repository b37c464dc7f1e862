"""Robots by name or by file."""

from __future__ import annotations

import os
from typing import NamedTuple

from . import _core
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


def load(path_or_name: str | os.PathLike[str], *, keep_fixed: bool = False) -> Robot:
    """Load a robot: a built-in one by its name, or a robot TOML or URDF file.

    Parameters
    ----------
    path_or_name : str or path
        A name of `catalogue`, or the path of a file.
    keep_fixed : bool
        For URDF: keep links on fixed joints as links of their own. By default they are
        lumped into their parents.

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
    return Robot._of(_core.Robot.load(os.fspath(path_or_name), keep_fixed))


def catalogue() -> tuple[CatalogueEntry, ...]:
    """List the built-in robots.

    Examples
    --------
    >>> import roberval as rv
    >>> "puma560" in [entry.name for entry in rv.catalogue()]
    True
    """
    return tuple(CatalogueEntry(*entry) for entry in _core.catalogue())
