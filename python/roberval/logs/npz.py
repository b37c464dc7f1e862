"""Logs in NPZ: the arrays q, qd, qdd and tau, read some rows at a time."""

from __future__ import annotations

import zipfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from ..arrays import Array, shown
from ..errors import ArrayError, ShapeError
from ..robot import Robot
from . import Note, Piece, names, rows_of


def read(path: Path, robot: Robot, weights: bool, note: Note) -> Iterator[Piece]:
    """Read an NPZ file with the arrays q (N, nq), qd, qdd and tau (and w) (N, n)."""
    wanted = names(weights)
    with zipfile.ZipFile(path) as archive:
        check_names(path, archive.namelist(), wanted, note)
        stored = [
            Stored(archive, name, robot.nq if name == "q" else robot.n, path) for name in wanted
        ]
        counts = [array.samples for array in stored]
        if len(set(counts)) > 1:
            raise ShapeError(f"{path}: the arrays have {counts} samples: they must be as many")
        most = rows_of(robot, weights)
        for first in range(0, counts[0], most):
            count = min(most, counts[0] - first)
            arrays = [array.rows(count) for array in stored]
            yield Piece(arrays, first, (first + count) / counts[0])


def check_names(path: Path, members: list[str], wanted: tuple[str, ...], note: Note) -> None:
    """Refuse arrays that are not there, or twice; note those that are not used."""
    arrays = [member.removesuffix(".npy") for member in members]
    for name in wanted:
        if arrays.count(name) > 1:
            raise ShapeError(f"{path}: there are {arrays.count(name)} arrays {name}")
        if f"{name}.npy" not in members:
            there = f"the file has {shown(arrays, 8)}" if arrays else "the file has no array"
            raise ShapeError(f"{path}: there is no array {name}; {there}")
    unused = [name for name in arrays if name not in wanted]
    if unused:
        note(f"{path}: arrays that are not used: {', '.join(unused)}")


class Stored:
    """An array of an NPZ file, read some rows at a time, of any real type and order."""

    def __init__(self, archive: zipfile.ZipFile, name: str, width: int, path: Path) -> None:
        self.path, self.width = path, width
        member = f"{name}.npy"
        file = archive.open(member)
        try:
            version = np.lib.format.read_magic(file)
            read = (
                np.lib.format.read_array_header_1_0
                if version == (1, 0)
                else np.lib.format.read_array_header_2_0
            )
            shape, fortran, self.dtype = read(file)
        except ValueError as error:
            raise ArrayError(f"{path}: {name} is no array: {error}") from None
        if len(shape) != 2 or shape[1] != width:
            raise ShapeError(f"{path}: {name} has shape {shape}, expected (N, {width})")
        if self.dtype.kind not in "iuf":
            raise ArrayError(f"{path}: {name} has dtype {self.dtype}, expected real numbers")
        self.samples = int(shape[0])
        self.files = [file]
        if fortran:
            # Each column is read where it begins: the array need not be in memory.
            start = file.tell()
            self.files = [archive.open(member) for _ in range(width)]
            for place, column in enumerate(self.files):
                column.seek(start + place * self.samples * self.dtype.itemsize)

    def rows(self, count: int) -> Array:
        """Return the next rows as float64."""
        size = count * self.width // len(self.files) * self.dtype.itemsize
        parts = [file.read(size) for file in self.files]
        if any(len(part) < size for part in parts):
            raise ArrayError(f"{self.path}: the file ends within an array")
        if len(parts) == 1:
            table = np.frombuffer(parts[0], self.dtype).reshape(count, self.width)
        else:
            table = np.stack([np.frombuffer(part, self.dtype) for part in parts], axis=1)
        with np.errstate(over="ignore"):  # a long double beyond float64 is inf: refused later
            return np.asarray(table, np.float64, order="C")
