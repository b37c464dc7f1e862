"""Rows of modified Denavit-Hartenberg parameters as the text of a robot TOML."""

from __future__ import annotations

import json
import numbers
from collections.abc import Iterable, Mapping, Sequence
from decimal import Decimal
from fractions import Fraction
from typing import Any, TypeAlias

from .errors import RobotError

Row: TypeAlias = Mapping[str, Any] | Sequence[Any]
"""A link: a mapping with the keys of the robot TOML, or (alpha, d, theta, r)."""

FIELDS = ("alpha", "d", "theta", "r")


def robot_toml(
    rows: Iterable[Row],
    name: str,
    gravity: Sequence[Any],
    constants: Mapping[str, Any] | None,
) -> str:
    """Return the robot TOML of these rows; the core checks it as it checks a file."""
    lines = [f"name = {_text(name)}", f"gravity = {_value('gravity', list(gravity))}"]
    if constants:
        lines.append("[constants]")
        lines += [f"{_text(key)} = {_value(key, value)}" for key, value in constants.items()]
    for number, row in enumerate(rows, start=1):
        lines.append("[[link]]")
        for key, value in _fields(number, row).items():
            lines.append(f"{_text(key)} = {_value(f'link {number}, {key}', value)}")
    return "\n".join(lines) + "\n"


def _fields(number: int, row: Row) -> dict[str, Any]:
    if isinstance(row, Mapping):
        return dict(row)
    if isinstance(row, str) or len(row) != len(FIELDS):
        raise RobotError(
            f"link {number} is {row!r}, expected a dict of robot TOML keys "
            f"or a tuple ({', '.join(FIELDS)})"
        )
    return dict(zip(FIELDS, row, strict=True))


def _value(place: str, value: Any) -> str:
    """Return a TOML value; exact numbers keep their digits."""
    if hasattr(value, "item") and getattr(value, "ndim", None) == 0:
        value = value.item()  # a scalar of NumPy
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, float):
        return repr(value)
    if isinstance(value, int):
        return str(value)
    if isinstance(value, Fraction):
        return _text(f"{value.numerator}/{value.denominator}")
    if isinstance(value, Decimal):
        return _text(str(value))
    if isinstance(value, Mapping):
        items = (f"{_text(k)} = {_value(f'{place}, {k}', v)}" for k, v in value.items())
        return "{ " + ", ".join(items) + " }"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_value(place, v) for v in value) + "]"
    kind = "number" if isinstance(value, numbers.Number) else type(value).__name__
    raise RobotError(f"{place} is {value!r}, a {kind} that a robot description cannot hold")


def _text(text: Any) -> str:
    """Return a TOML basic string; its escapes are those of JSON."""
    return json.dumps(str(text), ensure_ascii=False).replace("\x7f", "\\u007f")
