"""Arguments become plain arrays here: float64, C order, the right shape, or a clear error."""

from __future__ import annotations

import math
import operator
from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from .errors import ArrayError, OptionError, ShapeError, UnknownParameterError

Array: TypeAlias = npt.NDArray[np.float64]
"""A float64 array."""

_FLOAT = np.dtype(np.float64)

_LINE = 64
"""Bytes of a cache line."""


def numbers(name: str, value: npt.ArrayLike) -> Array:
    """Return `value` as a float64 array in C order, of any shape.

    `name` is the argument's, for messages.
    """
    if np.ma.isMaskedArray(value) and np.ma.getmaskarray(value).any():
        raise ArrayError(f"{name} has masked entries: fill them or take the samples out")
    try:
        array = np.asarray(value)
    except ValueError as error:
        raise ArrayError(f"{name} is no array of numbers: {error}") from None
    if array.dtype.kind not in "iuf":
        raise ArrayError(f"{name} has dtype {array.dtype}, expected real numbers (float64)")
    with np.errstate(over="ignore"):  # a long double beyond float64 becomes inf: refused later
        plain = np.require(array, np.float64, ["C", "ALIGNED", "ENSUREARRAY"])
    return plain.reshape(array.shape)


class States(NamedTuple):
    """States, q (N, nq), qd and qdd (N, n), and what stands before n in the caller's shape."""

    q: Array
    qd: Array
    qdd: Array
    lead: tuple[int, ...]


def _plain(value: object) -> bool:
    """Tell whether nothing need be done to an array: most calls, and their time counts."""
    return type(value) is np.ndarray and value.dtype is _FLOAT and value.flags.carray


def states(q: npt.ArrayLike, qd: npt.ArrayLike, qdd: npt.ArrayLike, nq: int, n: int) -> States:
    """Return q, (nq,) or (N, nq), qd and qdd, (n,) or (N, n)."""
    if nq == n and _plain(q) and _plain(qd) and _plain(qdd):
        shape = q.shape  # type: ignore[union-attr]
        if qd.shape == shape and qdd.shape == shape and shape[-1:] == (n,):  # type: ignore[union-attr]
            if len(shape) == 1:
                return States(q[None], qd[None], qdd[None], ())  # type: ignore[index, call-overload, arg-type]
            if len(shape) == 2:
                return States(q, qd, qdd, shape[:1])  # type: ignore[arg-type, unused-ignore]
    arrays = [numbers("q", q), numbers("qd", qd), numbers("qdd", qdd)]
    joints = f"{n} moving joints" if nq == n else f"{n - 6} moving joints and a floating base"
    for name, array, width in zip(("q", "qd", "qdd"), arrays, (nq, n, n), strict=True):
        if array.ndim not in (1, 2) or array.shape[-1] != width:
            raise ShapeError(
                f"{name} has shape {array.shape}, expected ({width},) for one state "
                f"or (N, {width}) for N states: the robot has {joints}"
            )
        if array.shape[:-1] != arrays[0].shape[:-1]:
            raise ShapeError(
                f"{name} has shape {array.shape} and q has {arrays[0].shape}: "
                "q, qd and qdd must have one shape"
                + ("" if nq == n else " but for the last number of q")
            )
    q, qd, qdd = (np.atleast_2d(array) for array in arrays)
    return States(q, qd, qdd, arrays[0].shape[:-1])


def room(
    states: tuple[object, object, object], widths: tuple[int, int], size: tuple[int, ...]
) -> Array | None:
    """Return a new array for `size` numbers a state, if the states are plain arrays that fit."""
    for array, width in zip(states, (*widths, widths[1]), strict=True):
        if type(array) is not np.ndarray or array.dtype is not _FLOAT:
            return None
        if array.ndim > 2 or array.shape[-1:] != (width,):
            return None
    lead = {array.shape[:-1] for array in states}  # type: ignore[attr-defined]
    return np.empty((*lead.pop(), *size)) if len(lead) == 1 else None


def output(out: Array | None, shape: tuple[int, ...]) -> Array:
    """Return `out`, or a new array if it is None, to be written by the core."""
    if out is None:
        return np.empty(shape)
    if not isinstance(out, np.ndarray) or isinstance(out, np.ma.MaskedArray):
        raise ArrayError(f"out is a {type(out).__name__}, expected a NumPy array of float64")
    if out.dtype != np.float64 or not out.dtype.isnative:
        raise ArrayError(f"out has dtype {out.dtype.str}, expected float64 in native byte order")
    if out.shape != shape:
        raise ShapeError(f"out has shape {out.shape}, expected {shape}")
    if not out.flags.writeable:
        raise ArrayError("out is read-only")
    for fits, what in (
        (out.flags.c_contiguous, "C-contiguous"),
        (out.flags.aligned, "aligned to 8 bytes"),
    ):
        if not fits:
            raise ArrayError(f"out is not {what}: make it with numpy.empty(shape)")
    return out


def lines(shape: tuple[int, ...]) -> Array:
    """Return a new array that begins with a cache line: tiles are written line by line."""
    count = math.prod(shape)
    numbers = np.empty(count + _LINE // 8)
    first = -numbers.ctypes.data % _LINE // 8
    return numbers[first : first + count].reshape(shape)


def done(filled: bool) -> None:
    """Raise an error if a call with plain arrays did nothing."""
    if not filled:
        raise ArrayError("q, qd or qdd is the output of a call that another thread has begun")


_MOST_THREADS = 256
"""More threads than this are of no use: samples come in pieces."""


def thread_count(threads: int | None) -> int | None:
    """Return a number of threads; None means all cores."""
    if threads is None or (type(threads) is int and 0 < threads <= _MOST_THREADS):
        return threads
    try:
        count = operator.index(threads)
    except TypeError:
        raise OptionError(f"threads is {threads!r}, expected a whole number or None") from None
    if count < 1:
        raise OptionError(f"threads is {count}, expected 1 or more")
    return min(count, _MOST_THREADS)


def vector(name: str, value: npt.ArrayLike | Mapping[str, float], labels: tuple[str, ...]) -> Array:
    """Return one finite number for each label.

    A mapping (dict, pandas Series) may leave labels out: they count as zero.
    """
    if isinstance(value, Mapping) or hasattr(value, "to_dict"):
        array = _from_mapping(name, value, labels)
    else:
        array = numbers(name, value)
    if array.shape != (len(labels),):
        raise ShapeError(f"{name} has shape {array.shape}, expected ({len(labels)},)")
    if not np.isfinite(array).all():
        at = int(np.argmin(np.isfinite(array)))
        raise ArrayError(f"{name} has {array[at]} for {labels[at]}: values must be finite numbers")
    return array


def _from_mapping(name: str, value: Any, labels: tuple[str, ...]) -> Array:
    values = dict(value if isinstance(value, Mapping) else value.to_dict())
    unknown = [label for label in values if label not in labels]
    if unknown:
        raise UnknownParameterError(
            f"{name} has a value for {shown(unknown)}, expected labels such as {shown(labels)}"
        )
    return numbers(name, [values.get(label, 0.0) for label in labels])


def shown(labels: Iterable[object], most: int = 3) -> str:
    """Return the first labels as they stand in a message."""
    listed = [repr(label) for label in labels]
    dots = [", ..."] if len(listed) > most else []
    return "".join([", ".join(listed[:most]), *dots])
