"""Logs of joint states and torques, read piece by piece: CSV, NPZ and Parquet files."""

from __future__ import annotations

import re
import zipfile
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

from ..arrays import Array
from ..errors import ArrayError, RobervalError
from ..reduction import FRICTION
from ..robot import Robot

ARRAYS = ("q", "qd", "qdd", "tau")
"""What a sample has; columns are named q_1 or q_NAME and so on."""

WEIGHT = "w"
"""What it has besides where weights are asked for: one for each number of tau."""

PIECE = 1 << 16
"""Samples in memory at a time, at most."""

NUMBERS = 1 << 21
"""Numbers in memory at a time, at most."""


class Piece(NamedTuple):
    """Some samples of a file.

    Attributes
    ----------
    arrays : list of ndarray
        q, qd, qdd, tau and, where they are asked for, w.
    first : int
        The row of the file that the first sample has, from 0.
    part : float
        The part of the file that has been read so far.
    """

    arrays: list[Array]
    first: int
    part: float


Note = Callable[[str], None]
"""What is called with what the user should know."""

Reader = Callable[[Path, Robot, bool, Note], Iterator[Piece]]


def names(weights: bool) -> tuple[str, ...]:
    """Return the arrays of a log."""
    return (*ARRAYS, WEIGHT) if weights else ARRAYS


def rows_of(robot: Robot, weights: bool) -> int:
    """Return how many samples are in memory at a time."""
    width = robot.nq + (len(names(weights)) - 1) * robot.n
    return max(1, min(PIECE, NUMBERS // width))


def pieces(path: Path, robot: Robot, weights: bool, note: Note) -> Iterator[Piece]:
    """Read a file of samples piece by piece; one at least."""
    form = path.suffix[1:].upper()
    if form != "CSV" and path.exists() and not path.is_file():
        raise ArrayError(f"{path}: {form} is read from its end on, and this is no regular file")
    count = 0
    try:
        for piece in reader_of(path)(path, robot, weights, note):
            count += len(piece.arrays[0])
            yield piece
    except (zipfile.BadZipFile, zlib.error, EOFError) as error:
        raise ArrayError(f"{path}: this is no whole {form} file: {error}") from None
    if count == 0:
        raise ArrayError(f"{path}: there are no samples in it")


def reader_of(path: Path) -> Reader:
    """Return the reader of a file by its ending."""
    from . import npz, parquet, text

    readers: dict[str, Reader] = {
        ".csv": text.read,
        ".npz": npz.read,
        ".parquet": parquet.read,
    }
    reader = readers.get(path.suffix.lower())
    if reader is None:
        hint = "; kinds of friction have commas between them" if str(path) in FRICTION else ""
        raise RobervalError(f"{path}: logs are .csv, .npz or .parquet files{hint}")
    return reader


def placed(error: ArrayError, first: int) -> str:
    """Return an error of an update with the row counted in its file.

    `first` is the row of the update's first sample.
    """
    if error.row is None:
        return str(error)
    # As in "q[3, 0] is NaN" and "sample 3: the loop cannot be closed".
    return re.sub(r"(\[|\bsample )\d+", rf"\g<1>{first + error.row}", str(error), count=1)
