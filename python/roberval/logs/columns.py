"""Which column of a table is which coordinate: the core's rule, for tables that Python reads."""

from __future__ import annotations

from collections.abc import Sequence

from .. import _core
from ..errors import ShapeError
from ..robot import Robot


def columns(
    robot: Robot, titles: Sequence[str], source: str, weights: bool
) -> tuple[list[list[str]], str | None]:
    """Return for q, qd, qdd, tau (and w) the title of each coordinate's column, and a note."""
    try:
        places, note = _core.sample_columns(robot._inner, list(titles), weights)
    except ShapeError as error:
        raise ShapeError(f"{source}: {error}") from None
    return [[titles[place] for place in of_array] for of_array in places], note
