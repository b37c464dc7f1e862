"""The options of an analysis: types are checked here, values in the core."""

from __future__ import annotations

import operator
from collections.abc import Iterable, Sequence
from decimal import Decimal
from fractions import Fraction
from typing import Any, Literal, SupportsIndex, TypeAlias, TypedDict

from .errors import OptionError

Model: TypeAlias = Literal["d", "d0", "h"]
"""Dynamic model, dynamic model at rest, energy model."""

Engine: TypeAlias = Literal["exact", "precise", "qr", "qrii", "svd"]
"""Route to rank, choice and relations."""

Choice: TypeAlias = Literal["paper", "pivoted", "prefer"]
"""Rule by which the kept parameters are chosen."""


Snap: TypeAlias = Literal["default", "off", "aggressive"]
"""Whether rounded angles and dust of a robot file are set right."""

Number: TypeAlias = float | str | Decimal | Fraction
"""A number of a robot description; as text, Decimal or Fraction it is exact."""


class Reading(TypedDict):
    """How a robot file is read."""

    keep_fixed: bool
    floating: bool
    rotors: bool
    snap: str
    gravity: list[str] | None


def reading(
    *,
    snap: str,
    keep_fixed: bool = False,
    floating: bool = False,
    rotors: bool = True,
    gravity: Sequence[Number] | None = None,
) -> Reading:
    """Return how a robot file is read, as the core takes it."""
    if gravity is not None and (isinstance(gravity, str) or len(gravity) != 3):
        raise OptionError(f"gravity is {gravity!r}, expected three numbers in m/s^2")
    return {
        "keep_fixed": bool(keep_fixed),
        "floating": bool(floating),
        "rotors": bool(rotors),
        "snap": text("snap", snap),
        "gravity": None if gravity is None else [str(component) for component in gravity],
    }


class Options(TypedDict):
    """What the core is asked to do."""

    model: str
    engine: str | None
    choice: str | None
    keep: list[str]
    drop: list[str]
    seed: int
    rows: int | None
    tolerance: float | str | None


def options(
    *,
    model: str = "d",
    engine: str | None = None,
    choice: str | None,
    keep: Iterable[str],
    drop: Iterable[str],
    seed: SupportsIndex,
    rows: SupportsIndex | None = None,
    tolerance: float | str | None,
) -> Options:
    """Return the options as the core takes them."""
    return {
        "model": text("model", model),
        "engine": None if engine is None else text("engine", engine),
        "choice": None if choice is None else text("choice", choice),
        "keep": _labels("keep", keep),
        "drop": _labels("drop", drop),
        "seed": integer("seed", seed, 0, 2**64 - 1),
        "rows": None if rows is None else integer("rows", rows, 1, 2**63 - 1),
        "tolerance": _tolerance(tolerance),
    }


def text(name: str, value: Any) -> str:
    """Return a word, or refuse anything else."""
    if not isinstance(value, str):
        raise OptionError(f"{name} is {value!r}, expected a word")
    return value


def _labels(name: str, value: Any) -> list[str]:
    if isinstance(value, str):
        raise OptionError(f"{name} is the text {value!r}, expected a list of labels")
    return [text(f"an entry of {name}", label) for label in value]


def integer(name: str, value: Any, least: int, most: int) -> int:
    """Return an integer of this range, or refuse anything else."""
    try:
        number = operator.index(value)
    except TypeError:
        number = least - 1
    if not least <= number <= most:
        raise OptionError(f"{name} is {value!r}, expected an integer from {least} to {most}")
    return number


def _tolerance(value: Any) -> float | str | None:
    if value is None or isinstance(value, str):
        return value
    try:
        return float(value)
    except (TypeError, ValueError):
        raise OptionError(
            f"tolerance is {value!r}, expected a ratio or the name of a rule"
        ) from None
