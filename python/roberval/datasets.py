"""Datasets on a Dask cluster to the R factor, one partition a task."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from . import arrays, logs
from .arrays import Array
from .base import BaseParameters
from .errors import ArrayError, MissingPackageError, OptionError, ShapeError
from .logs.columns import columns as columns_of
from .reduction import FRICTION, ObservationQR, robot_of
from .robot import Robot

COLUMNS = "columns"
"""The word for weights that are columns of the dataset."""


def reduce_dataset(
    dataset: Any,
    model: Robot | BaseParameters,
    columns: str | Sequence[str] | None = None,
    friction: str | Iterable[str] = (),
    weights: npt.ArrayLike | None = None,
) -> ObservationQR:
    """Reduce a Dask DataFrame (``dask.dataframe.read_parquet``), one partition a task.

    The partitions' R factors are merged in pairs, a fixed tree: the same bits for any number
    of workers. Other partitions of the same samples are another tree, and give other last bits.

    Parameters
    ----------
    dataset : dask.dataframe.DataFrame
        Columns ``q_1`` .. or ``q_NAME``, likewise qd, qdd and tau; others are not read.
    model, columns, friction
        As for `ObservationQR`.
    weights : array_like, shape (n,), or "columns", optional
        How much the squared residual of each row's torque counts; ``"columns"``: as the
        columns ``w_1`` .. or ``w_NAME`` say, row by row.

    Raises
    ------
    ShapeError, ArrayError
        A column is not there, or twice; it has no numbers; or one that is not finite: its
        partition and row are named.
    """
    dask = checked(dataset)
    robot = robot_of(model)
    # What is asked is checked here, and base parameters are found here, not in every task.
    chosen, kinds = ObservationQR(model, columns, friction, threads=1)._inner.columns
    labels = [robot.parameters[place] for place in chosen]
    wanted_kinds = [kind for kind, wanted in zip(FRICTION, kinds, strict=True) if wanted]
    in_columns, rows = weights_of(weights, robot.n)
    titles, _ = columns_of(robot, [str(name) for name in dataset.columns], "dataset", in_columns)
    selected = dataset[[title for of_array in titles for title in of_array]]
    for title, kind in selected.dtypes.items():
        check_kind(title, kind)
    one, two = dask.delayed(reduce_partition, pure=False), dask.delayed(merged, pure=False)
    parts = [
        one(part, number, robot, labels, wanted_kinds, titles, rows)
        for number, part in enumerate(selected.to_delayed())
    ]
    while len(parts) > 1:
        pairs = [two(*parts[at : at + 2]) for at in range(0, len(parts) - 1, 2)]
        parts = pairs + parts[2 * len(pairs) :]
    result: ObservationQR = parts[0].compute()
    if result.samples == 0:
        raise ArrayError("dataset: there are no samples in it")
    return result


def checked(dataset: Any) -> Any:
    """Return the package dask, or refuse what is none of its tables."""
    try:
        import dask
    except ImportError:
        raise MissingPackageError(
            "datasets need the package dask: pip install 'roberval[dask]'"
        ) from None
    if hasattr(dataset, "to_delayed") and hasattr(dataset, "dtypes"):
        return dask
    if isinstance(dataset, str | os.PathLike):
        hint = f"open it by dask.dataframe.read_parquet({os.fspath(dataset)!r})"
    elif hasattr(dataset, "iloc"):
        hint = "make it one by dask.dataframe.from_pandas(frame, npartitions=8)"
    else:
        hint = "dask.dataframe.read_parquet gives one"
    raise TypeError(f"dataset is a {type(dataset).__name__}, expected a Dask DataFrame: {hint}")


def weights_of(weights: npt.ArrayLike | None, n: int) -> tuple[bool, Array | None]:
    """Return whether weights are in columns, and those that are not."""
    if weights is None:
        return False, None
    if isinstance(weights, str):
        if weights != COLUMNS:
            raise OptionError(f"weights is {weights!r}, expected {n} numbers or {COLUMNS!r}")
        return True, None
    rows = arrays.numbers("weights", weights)
    if rows.shape != (n,):
        raise ShapeError(f"weights has shape {rows.shape}, expected ({n},), one weight a row")
    return False, rows


def reduce_partition(
    frame: Any,
    number: int,
    robot: Robot,
    labels: list[str],
    friction: list[str],
    titles: list[list[str]],
    weights: Array | None,
) -> ObservationQR:
    """Reduce one pandas table, in pieces."""
    qr = ObservationQR(robot, labels, friction, threads=1)
    most = logs.rows_of(robot, len(titles) > len(logs.ARRAYS))
    for first in range(0, len(frame), most):
        piece = frame.iloc[first : first + most]
        q, qd, qdd, tau, *w = [table(piece, of_array) for of_array in titles]
        try:
            qr.update(q, qd, qdd, tau, w[0] if w else weights)
        except ArrayError as error:
            where = logs.placed(error, first)
            raise ArrayError(f"dataset: partition {number}: {where}") from None
    return qr


def table(frame: Any, titles: list[str]) -> Array:
    """Gather columns of a pandas table."""
    array = np.empty((len(frame), len(titles)))
    for place, title in enumerate(titles):
        column = frame[title]
        check_kind(title, column.dtype)
        array[:, place] = column.to_numpy(dtype=np.float64, na_value=np.nan)
    return array


def check_kind(title: str, kind: Any) -> None:
    """Refuse columns of texts, truth values, times."""
    from pandas.api import types

    if (
        not types.is_numeric_dtype(kind)
        or types.is_bool_dtype(kind)
        or types.is_complex_dtype(kind)
    ):
        raise ArrayError(f"dataset: column {title} has {kind}, not numbers")


def merged(first: ObservationQR, second: ObservationQR) -> ObservationQR:
    """Return both in one; neither is changed."""
    result = first._copy()
    result.merge(second)
    return result
