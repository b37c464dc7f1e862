"""Robots from other programs' models, read by those programs' own libraries.

Nothing here is imported before it is used, and each library is optional.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Literal, NamedTuple

from .. import _core
from ..errors import MissingPackageError

Kind = Literal["mjcf", "xacro"]

HEAD = 1 << 16
"""Bytes of a file in which its root element is looked for."""

DESCRIPTION = re.compile(r"[a-z0-9_]+_description")
"""Names of the package robot_descriptions."""


class Text(NamedTuple):
    """A robot as text that the core reads.

    Attributes
    ----------
    kind : {"toml", "urdf"}
    text : str
        A robot TOML has among its ``warnings`` what was left out.
    """

    kind: str
    text: str


def kind_of(path: Path) -> Kind | None:
    """Tell MJCF and xacro from what the core reads itself, by their content."""
    try:
        with path.open("rb") as file:
            head = file.read(HEAD).decode("utf-8", "replace")
    except OSError:
        return None
    plain = re.sub(r"<!--.*?-->|<\?.*?\?>", "", head, flags=re.DOTALL)
    root = re.match(r"\s*\ufeff?\s*<([\w:.-]+)([^>]*)", plain)
    if root is None:
        return None
    if root[1] == "mujoco":
        return "mjcf"
    if root[1] == "robot" and (path.suffix == ".xacro" or is_xacro(plain)):
        return "xacro"
    return None


def is_xacro(text: str) -> bool:
    """Tell whether a robot file without its comments says itself that it is xacro.

    Expanding xacro evaluates what stands in the file, so that a stray ``${...}`` is not enough:
    the core refuses it. Nor is the namespace alone, which xacro leaves in what it has expanded.
    """
    declared = re.search(r"\sxmlns:xacro\s*=", text) is not None
    return "<xacro:" in text or (declared and re.search(r"\$[{(]", text) is not None)


def described(name: str) -> Path | None:
    """Find the file of a name of the package robot_descriptions, if it is installed."""
    if not DESCRIPTION.fullmatch(name):
        return None
    from . import descriptions

    return descriptions.file(name)


def read(path: Path, kind: Kind) -> Text:
    """Read a MJCF or xacro file."""
    if kind == "mjcf":
        from . import mujoco

        return mujoco.from_file(path)
    from . import xacro

    return xacro.from_file(path)


def stand_in(path_or_name: str) -> str:
    """Let the core read a translation where it is asked for a file that it cannot read itself.

    Returns
    -------
    str
        The path to ask the core for.
    """
    path = Path(path_or_name)
    if not path.exists():
        path = described(path_or_name) or path
        path_or_name = str(path)
    kind = kind_of(path)
    if kind is None:
        return path_or_name
    found = read(path, kind)
    _core.read_instead(path_or_name, found.kind == "urdf", found.text)
    return path_or_name


def missing(what: str, package: str) -> MissingPackageError:
    """Say what to install."""
    return MissingPackageError(f"{what} needs the package {package}: pip install {package}")
