"""Logs in Parquet: pyarrow reads them, a page at a time."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from ..arrays import Array
from ..errors import ArrayError, MissingPackageError
from ..robot import Robot
from . import Note, Piece, rows_of
from .columns import columns

NUMBERS = 1 << 17
"""Numbers read at a time: Ctrl-C waits for them."""


def read(path: Path, robot: Robot, weights: bool, note: Note) -> Iterator[Piece]:
    """Read a Parquet file with columns as in CSV."""
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        raise MissingPackageError(
            "reading Parquet needs the package pyarrow: pip install 'roberval[parquet]'"
        ) from None
    try:
        yield from pieces(path, robot, weights, note)
    except (pyarrow.ArrowException, OSError) as error:
        raise ArrayError(f"{path}: this cannot be read as Parquet: {error}") from None


def pieces(path: Path, robot: Robot, weights: bool, note: Note) -> Iterator[Piece]:
    """Read a Parquet file, with pyarrow's own exceptions."""
    import pyarrow.parquet as parquet

    # A page at a time: a row group may be larger than the memory there is.
    with parquet.ParquetFile(path, pre_buffer=False, buffer_size=1 << 16) as file:
        schema = file.schema_arrow
        wanted, said = columns(robot, schema.names, str(path), weights)
        if said:
            note(f"{path}: {said}")
        every = [title for of_array in wanted for title in of_array]
        for title in every:
            check_type(path, title, schema.field(schema.names.index(title)).type)
        batches = file.iter_batches(
            batch_size=max(1, NUMBERS // len(every)), columns=every, use_threads=False
        )
        done, count, most = 0, file.metadata.num_rows, rows_of(robot, weights)
        parts: list[list[Array]] = []
        for batch in batches:
            parts.append([table(path, batch, of_array) for of_array in wanted])
            done += len(batch)
            rows = sum(len(part[0]) for part in parts)
            if rows >= most or done >= count:
                arrays = [np.concatenate(of_array) for of_array in zip(*parts, strict=True)]
                yield Piece(arrays, done - rows, done / max(count, 1))
                parts = []


def check_type(path: Path, title: str, kind: Any) -> None:
    """Refuse columns of texts, truth values, times."""
    from pyarrow import types

    if not (types.is_integer(kind) or types.is_floating(kind) or types.is_decimal(kind)):
        raise ArrayError(f"{path}: column {title} has {kind}, not numbers")


def table(path: Path, batch: Any, titles: list[str]) -> Array:
    """Gather columns of an Arrow table."""
    array = np.empty((len(batch), len(titles)))
    for place, title in enumerate(titles):
        array[:, place] = floats(path, batch, title)
    return array


def floats(path: Path, batch: Any, title: str) -> Array:
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
