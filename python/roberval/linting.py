"""What is wrong or suspicious in robot files."""

from __future__ import annotations

import os
from typing import NamedTuple

from . import _core, importers


class Finding(NamedTuple):
    """Something wrong or suspicious in a robot file; ``str()`` is the command's line.

    Attributes
    ----------
    file : str
        The file.
    line, column : int or None
        Where in it, from 1.
    severity : {"error", "warning"}
        Errors are what readers refuse.
    rule : str
        ``inertia``, ``missing-inertial``, ``units``, ``rounded-angle``, ``dust``, ``degrees``,
        ``axis``, ``mimic``, ``limits``, ``remark``, or the code of an error such as ``E240``.
    what : str
        What is wrong, with the link, joint and field.
    remedy : str
        What to do.
    text : str
        All of it in a line.
    """

    file: str
    line: int | None
    column: int | None
    severity: str
    rule: str
    what: str
    remedy: str
    text: str

    def __str__(self) -> str:
        return self.text


def lint(path_or_name: str | os.PathLike[str]) -> list[Finding]:
    """List what is wrong or suspicious in a robot file, in the order of the file.

    Parameters
    ----------
    path_or_name : str or path
        What `load` takes. Findings of a MJCF have no lines; those of a xacro file are of its
        expansion to URDF, and its name says so.

    Returns
    -------
    list of Finding

    Raises
    ------
    RobotError
        The file cannot be read as a robot file at all.

    Examples
    --------
    >>> import roberval as rv
    >>> rv.lint("two_link")
    []
    """
    path = importers.stand_in(os.fspath(path_or_name))
    return [Finding(*row) for row in _core.lint(path)]
