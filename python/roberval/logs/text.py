"""Logs in CSV: the core reads them."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from .. import _core
from ..robot import Robot
from . import Note, Piece

NUMBERS = 1 << 16
"""Numbers read at a time: Ctrl-C waits for them."""


def read(path: Path, robot: Robot, weights: bool, note: Note) -> Iterator[Piece]:
    """Read a CSV file with a header line; a pipe, too."""
    with path.open("rb", buffering=0) as file:
        samples = _core.CsvSamples.open(robot._inner, file, str(path), weights)
        if samples.note:
            note(f"{path}: {samples.note}")
        size = path.stat().st_size if path.is_file() else 0
        most = max(1, NUMBERS // (robot.nq + 3 * robot.n))
        first = 0
        while (arrays := samples.read(most)) is not None:
            yield Piece(arrays, first, file.tell() / size if size else 0.0)
            first += len(arrays[0])
