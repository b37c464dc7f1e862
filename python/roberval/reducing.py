"""Files of samples to the R factor: CSV, NPZ and Parquet, piece by piece; Dask datasets.

`roberval reduce ROBOT FILES -o R.npz` is here, because Parquet is read by pyarrow.
"""

from __future__ import annotations

import argparse
import csv
import errno
import io
import os
import sys
import time
import zipfile
import zlib
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Any, get_args

import numpy as np

from .arrays import Array
from .base import BaseParameters
from .errors import (
    ArrayError,
    CheckpointError,
    MissingPackageError,
    RobervalError,
    ShapeError,
)
from .loading import load
from .options import Snap
from .reduction import FRICTION, Inputs, ObservationQR, robot_of
from .robot import Robot

ARRAYS = ("q", "qd", "qdd", "tau")
"""What a sample has; columns are named q_1 or q_NAME and so on."""

PIECE = 1 << 16
"""Samples in memory at a time."""

LINES = 1 << 13
"""Rows of a CSV or Parquet file read at a time: Ctrl-C waits for them."""

SAVING = 0.05
"""The part of the time that may go into checkpoints."""

INTERRUPTED = 130
"""The exit code after Ctrl-C, as a shell tells it."""

Piece = tuple[Array, Array, Array, Array]


def titles(robot: Robot, names: Sequence[str], source: str) -> list[list[str]]:
    """Return for q, qd, qdd and tau the title of each coordinate's column among `names`."""
    known = {name.strip().lstrip("\ufeff"): name for name in names}
    links = {link.joint_name or link.name: link.name for link in robot.links}
    coordinates = (robot.positions, robot.velocities, robot.velocities, robot.rows)
    found = []
    for array, of_robot in zip(ARRAYS, coordinates, strict=True):
        of_array = []
        for number, coordinate in enumerate(of_robot, 1):
            keys = (coordinate, links.get(coordinate, coordinate), str(number))
            wanted = list(dict.fromkeys(f"{array}_{key}" for key in keys))
            match = [known[title] for title in wanted if title in known]
            if not match:
                raise ShapeError(f"{source}: there is no column {' or '.join(wanted)}")
            of_array.append(match[0])
        found.append(of_array)
    return found


def pieces(path: Path, robot: Robot) -> Iterator[tuple[Piece, float]]:
    """Read a file of samples piece by piece, each with the part of the file read so far."""
    try:
        yield from reader_of(path)(path, robot)
    except UnicodeDecodeError as error:
        raise ArrayError(f"{path}: this is no text in UTF-8: {error}") from None
    except (zipfile.BadZipFile, zlib.error, EOFError, csv.Error) as error:
        form = path.suffix[1:].upper()
        raise ArrayError(f"{path}: this is no whole {form} file: {error}") from None


def reader_of(path: Path) -> Callable[[Path, Robot], Iterator[tuple[Piece, float]]]:
    """Return the reader of a file by its ending."""
    readers = {".csv": from_csv, ".npz": from_npz, ".parquet": from_parquet}
    reader = readers.get(path.suffix.lower())
    if reader is None:
        raise RobervalError(f"{path}: samples are a .csv, .npz or .parquet file")
    return reader


def from_csv(path: Path, robot: Robot) -> Iterator[tuple[Piece, float]]:
    """Read a CSV file with a header line."""
    with path.open("rb") as raw, io.TextIOWrapper(raw, "utf-8-sig", newline="") as file:
        rows = csv.reader(file)
        first = next(rows, None)
        if first is None:
            raise ShapeError(f"{path}: the file is empty")
        header = [title.strip() for title in first]
        wanted = titles(robot, header, str(path))
        places = [[header.index(title) for title in of_array] for of_array in wanted]
        line, size = 1, max(path.stat().st_size, 1)
        while block := list(islice(rows, LINES)):
            table = numbers(block, len(header), path, line)
            line += len(block)
            q, qd, qdd, tau = (np.ascontiguousarray(table[:, place]) for place in places)
            yield (q, qd, qdd, tau), raw.tell() / size


def numbers(block: list[list[str]], width: int, path: Path, line: int) -> Array:
    """Return the numbers of some lines, the first being the one after `line`."""
    try:
        return np.array(block, dtype=np.float64).reshape(len(block), width)
    except ValueError:
        pass
    for number, row in enumerate(block, line + 1):
        if len(row) != width:
            raise ShapeError(f"{path}:{number}: {len(row)} values under {width} columns")
        for word in row:
            try:
                float(word)
            except ValueError:
                raise ArrayError(f"{path}:{number}: {word!r} is not a number") from None
    raise ArrayError(f"{path}: lines {line + 1} to {line + len(block)} are no numbers")


def from_npz(path: Path, robot: Robot) -> Iterator[tuple[Piece, float]]:
    """Read an NPZ file with the arrays q (N, nq), qd, qdd and tau (N, n)."""
    widths = (robot.nq, robot.n, robot.n, robot.n)
    with zipfile.ZipFile(path) as archive:
        absent = [array for array in ARRAYS if f"{array}.npy" not in archive.namelist()]
        if absent:
            raise ShapeError(f"{path}: there is no array {absent[0]}")
        stored = [
            Stored(archive, name, width, path) for name, width in zip(ARRAYS, widths, strict=True)
        ]
        counts = [array.samples for array in stored]
        if len(set(counts)) > 1:
            raise ShapeError(f"{path}: the arrays have {counts} samples: they must be as many")
        for first in range(0, counts[0], PIECE):
            count = min(PIECE, counts[0] - first)
            q, qd, qdd, tau = (array.rows(count) for array in stored)
            yield (q, qd, qdd, tau), (first + count) / counts[0]


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


def from_parquet(path: Path, robot: Robot) -> Iterator[tuple[Piece, float]]:
    """Read a Parquet file with columns as in CSV; pyarrow does it."""
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        raise MissingPackageError(
            "reading Parquet needs the package pyarrow: pip install 'roberval[parquet]'"
        ) from None
    try:
        yield from parquet_pieces(path, robot)
    except (pyarrow.ArrowException, OSError) as error:
        raise ArrayError(f"{path}: this cannot be read as Parquet: {error}") from None


def parquet_pieces(path: Path, robot: Robot) -> Iterator[tuple[Piece, float]]:
    """Read a Parquet file, with pyarrow's own exceptions."""
    import pyarrow.parquet as parquet

    # A page at a time: a row group may be larger than the memory there is.
    with parquet.ParquetFile(path, pre_buffer=False, buffer_size=1 << 16) as file:
        wanted = titles(robot, file.schema_arrow.names, str(path))
        every = [title for of_array in wanted for title in of_array]
        done, count = 0, max(file.metadata.num_rows, 1)
        parts: list[Piece] = []
        for batch in file.iter_batches(batch_size=LINES, columns=every, use_threads=False):
            column = partial(arrow_floats, path, batch)
            parts.append(piece_of(column, len(batch), wanted))
            done += len(batch)
            if len(parts) * LINES >= PIECE or done >= count:
                q, qd, qdd, tau = map(np.concatenate, zip(*parts, strict=True))
                yield (q, qd, qdd, tau), done / count
                parts = []


def arrow_floats(path: Path, batch: Any, title: str) -> Array:
    """Return a column of an Arrow table, with NaN where there is nothing.

    From its memory: pyarrow's own conversion imports pandas, which takes half a second in which
    Ctrl-C is forgotten.
    """
    import pyarrow

    column = batch.column(title)
    try:
        if column.type != pyarrow.float64():
            column = column.cast(pyarrow.float64(), safe=False)
    except pyarrow.ArrowException:
        raise ArrayError(f"{path}: column {title} has {column.type}, not numbers") from None
    if column.null_count:
        column = column.fill_null(float("nan"))
    memory = column.buffers()[1]
    return np.frombuffer(memory, np.float64, len(column), 8 * column.offset)


def piece_of(column: Callable[[str], Any], count: int, wanted: list[list[str]]) -> Piece:
    """Gather the columns of a table."""
    arrays = []
    for of_array in wanted:
        array = np.empty((count, len(of_array)))
        for place, title in enumerate(of_array):
            array[:, place] = np.asarray(column(title), dtype=np.float64)
        arrays.append(array)
    q, qd, qdd, tau = arrays
    return q, qd, qdd, tau


def reduce_dataset(
    dataset: Any,
    model: Robot | BaseParameters,
    columns: Sequence[str] | None = None,
    friction: Sequence[str] = (),
) -> ObservationQR:
    """Reduce a Dask DataFrame (``dask.dataframe.read_parquet``), one partition a task.

    The partitions' R factors are merged in pairs, a fixed tree: the same bits for any number
    of workers. Other partitions of the same samples are another tree, and give other last bits.

    Parameters
    ----------
    dataset : dask.dataframe.DataFrame
        Columns ``q_1`` .. or ``q_NAME``, likewise qd, qdd and tau.
    model, columns, friction
        As for `ObservationQR`.
    """
    try:
        import dask
    except ImportError:
        raise MissingPackageError(
            "datasets need the package dask: pip install 'roberval[dask]'"
        ) from None
    delayed = getattr(dask, "delayed")  # noqa: B009 (dask does not export it to type checkers)
    one, two = delayed(reduce_partition, pure=False), delayed(merged, pure=False)
    parts = [one(part, model, columns, tuple(friction)) for part in dataset.to_delayed()]
    if not parts:
        return ObservationQR(model, columns, friction)
    while len(parts) > 1:
        pairs = [two(*parts[at : at + 2]) for at in range(0, len(parts) - 1, 2)]
        parts = pairs + parts[2 * len(pairs) :]
    result: ObservationQR = parts[0].compute()
    return result


def reduce_partition(
    frame: Any,
    model: Robot | BaseParameters,
    columns: Sequence[str] | None,
    friction: Sequence[str],
) -> ObservationQR:
    """Reduce one table with columns q_1 .., in pieces."""
    robot = robot_of(model)
    qr = ObservationQR(model, columns, friction, threads=1)
    wanted = titles(robot, list(frame.columns), "the dataset")
    for first in range(0, len(frame), PIECE):
        piece = frame.iloc[first : first + PIECE]
        qr.update(*piece_of(piece.__getitem__, len(piece), wanted))
    return qr


def merged(first: ObservationQR, second: ObservationQR) -> ObservationQR:
    """Return both in one; neither is changed."""
    result = first._copy()
    result.merge(second)
    return result


def _gravity(text: str) -> tuple[float, ...]:
    """Return the three numbers of an option."""
    numbers = tuple(map(float, text.split(",")))
    if len(numbers) != 3 or not np.isfinite(numbers).all():
        raise ValueError
    return numbers


def command(arguments: Sequence[str]) -> int:
    """Run ``roberval reduce``."""
    parser = argparse.ArgumentParser(
        prog="roberval reduce", description="Reduce joint states and torques to the R factor."
    )
    parser.add_argument("robot", help="name of a built-in robot, or a robot file")
    parser.add_argument("samples", nargs="+", type=Path, help=".csv, .npz or .parquet files")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="R.npz")
    parser.add_argument("--base", action="store_true", help="only the base parameters' columns")
    parser.add_argument("--friction", nargs="*", choices=FRICTION, default=[])
    reading = parser.add_argument_group("how the robot is read", "as by roberval base")
    reading.add_argument("--keep-fixed", action="store_true", help="keep links on fixed joints")
    reading.add_argument("--floating", action="store_true", help="let the base move freely")
    reading.add_argument("--no-rotors", action="store_true", help="leave rotor inertias Ia out")
    reading.add_argument("--snap", choices=get_args(Snap), default="default")
    reading.add_argument("--gravity", type=_gravity, metavar="X,Y,Z", help="m/s^2, base frame")
    parser.add_argument("--threads", type=int, metavar="T")
    parser.add_argument(
        "--checkpoint", type=Path, metavar="FILE", help="save progress in FILE, go on from there"
    )
    parser.add_argument("--quiet", action="store_true", help="no progress bar")
    asked = parser.parse_args(arguments)
    try:
        reduce_files(asked)
    except (RobervalError, OSError, zipfile.BadZipFile, UnicodeDecodeError) as error:
        print(f"roberval: error: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("roberval: interrupted", file=sys.stderr, flush=True)
        return INTERRUPTED
    return 0


def reduce_files(asked: argparse.Namespace) -> None:
    """Reduce the files in their order, from the checkpoint on if there is one."""
    robot = load(
        asked.robot,
        keep_fixed=asked.keep_fixed,
        floating=asked.floating,
        rotors=not asked.no_rotors,
        snap=asked.snap,
        gravity=asked.gravity,
    )
    model = robot.base_parameters() if asked.base else robot
    checkpoint = asked.checkpoint
    for target in (asked.output, checkpoint):
        if target is not None:
            writable(target)
    for path in asked.samples:
        reader_of(path)
    inputs = [(path.name, path.stat().st_size) for path in asked.samples]
    qr = ObservationQR(model, None, asked.friction, asked.threads)
    if checkpoint is not None and checkpoint.exists():
        qr = resumed(checkpoint, qr, model, inputs, asked.threads)
    skip, started = qr.samples, time.monotonic()
    before = skip
    saved, pause = started, 0.0
    for number, path in enumerate(asked.samples):
        for piece, part in pieces(path, robot):
            count = len(piece[1])
            if skip >= count:
                skip -= count
                continue
            first, skip = skip, 0
            try:
                qr.update(*(array[first:] for array in piece))
            except ArrayError as error:
                raise ArrayError(f"{path}: {error} (samples are counted over all files)") from None
            now = time.monotonic()
            if checkpoint is not None and now - saved >= pause:
                qr._save_with_inputs(checkpoint, inputs[: number + 1])
                saved = time.monotonic()
                pause = (saved - now) / SAVING
            if not asked.quiet and sys.stderr.isatty():
                progress((number + part) / len(asked.samples), qr.samples, now - started)
    if not asked.quiet and sys.stderr.isatty():
        print(file=sys.stderr)
    if skip:
        raise CheckpointError(
            f"{checkpoint} has {before} samples and the files have {before - skip}: it was saved "
            "from others; give these, or another --checkpoint"
        )
    if checkpoint is not None:
        qr._save_with_inputs(checkpoint, inputs)
    qr.save_factor(asked.output)
    print(
        f"roberval: note: R of {len(qr.columns)} columns from {qr.samples} samples", file=sys.stderr
    )


def writable(path: Path) -> None:
    """Raise an error if a file cannot be written, before the work that it is to hold."""
    folder = path.resolve().parent
    fault = None
    if not folder.is_dir():
        fault = errno.ENOTDIR if folder.exists() else errno.ENOENT
    elif path.is_dir():
        fault = errno.EISDIR
    elif not os.access(folder, os.W_OK):
        fault = errno.EACCES
    if fault is not None:
        raise OSError(fault, os.strerror(fault), str(path))


def resumed(
    checkpoint: Path,
    fresh: ObservationQR,
    model: Robot | BaseParameters,
    inputs: Inputs,
    threads: int | None,
) -> ObservationQR:
    """Return the accumulator of a checkpoint if it is of the same columns and files."""
    qr, begun = ObservationQR._load_with_inputs(checkpoint, model, threads)
    if qr.columns != fresh.columns:
        counts = f"{len(qr.columns)} columns, not the {len(fresh.columns)}"
        raise CheckpointError(f"{checkpoint} has {counts} asked for: --base and --friction differ")
    # Without a list of files (from `ObservationQR.save`), the samples alone are counted.
    for place, (name, size) in enumerate(begun or []):
        if place >= len(inputs) or inputs[place] != (name, size):
            given = "none" if place >= len(inputs) else "{} of {} bytes".format(*inputs[place])
            raise CheckpointError(
                f"{checkpoint} was saved from other files: number {place + 1} was {name} of {size} "
                f"bytes, and is {given}; give the same, or another --checkpoint"
            )
    return qr


def progress(part: float, samples: int, seconds: float) -> None:
    """Draw the progress bar again."""
    width = 32
    full = int(width * part)
    bar = "#" * full + "." * (width - full)
    rate = samples / max(seconds, 1e-3) / 1e6
    print(f"\r[{bar}] {part:4.0%}, {samples} samples, {rate:.2f} M/s ", end="", file=sys.stderr)
