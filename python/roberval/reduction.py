"""Streaming least squares: from joint states and torques to the R factor, in one pass."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt

from . import _core, arrays
from .arrays import Array
from .base import BaseParameters
from .errors import OptionError, ShapeError, UnknownParameterError
from .robot import Robot

FRICTION = ("viscous", "coulomb", "offset")
"""Kinds of columns that stand for a joint's friction: qd, sign(qd) and 1."""


class ObservationQR:
    """The R factor of the observation matrix and the torques, taken in block by block.

    Memory does not grow with the samples. The result depends on the samples and their order
    only, bit by bit, not on how they are cut into updates, nor on the number of threads, nor on
    the vector width of the processor (if it fuses products and sums, as all with AVX2 or NEON).

    Parameters
    ----------
    model : Robot or BaseParameters
        Whose columns: all standard parameters with an effect on the torques, or the base
        parameters.
    columns : sequence of str, optional
        Labels of the parameters to take instead.
    friction : iterable of {"viscous", "coulomb", "offset"}
        Columns for each joint's friction, after the others: qd, sign(qd), 1.
    threads : int, optional
        Threads for large updates; by default all cores.

    Examples
    --------
    >>> import numpy as np
    >>> import roberval as rv
    >>> puma = rv.load("puma560")
    >>> base = puma.base_parameters()
    >>> q, qd, qdd = np.random.default_rng(0).uniform(-1, 1, (3, 500, 6))
    >>> X = np.arange(66.0)
    >>> qr = rv.ObservationQR(base)
    >>> qr.update(q, qd, qdd, puma.torques(q, qd, qdd, X))
    >>> qr.r_factor.shape
    (40, 40)
    >>> bool(np.allclose(qr.solve(), base.values(X)))
    True
    """

    def __init__(
        self,
        model: Robot | BaseParameters,
        columns: Sequence[str] | None = None,
        friction: Iterable[str] = (),
        threads: int | None = None,
    ) -> None:
        robot = model if isinstance(model, Robot) else model._robot
        if columns is None:
            columns = robot.parameters if isinstance(model, Robot) else model.base
        places = {label: place for place, label in enumerate(robot.parameters)}
        missing = [label for label in columns if label not in places]
        if missing:
            raise UnknownParameterError(f"{robot.name} has no parameter {missing[0]}")
        kinds = (friction,) if isinstance(friction, str) else tuple(friction)
        unknown = [kind for kind in kinds if kind not in FRICTION]
        if unknown:
            raise OptionError(f"friction is {unknown[0]!r}, expected some of {FRICTION}")
        self._robot = robot
        wanted = (FRICTION[0] in kinds, FRICTION[1] in kinds, FRICTION[2] in kinds)
        self._inner = _core.Accumulator.new(
            robot._inner, [places[label] for label in columns], wanted, arrays.thread_count(threads)
        )

    @classmethod
    def load(
        cls, path: str | os.PathLike[str], model: Robot | BaseParameters, threads: int | None = None
    ) -> ObservationQR:
        """Return the accumulator that `save` wrote, to go on with the same bits.

        Raises
        ------
        CheckpointError
            The file is damaged, or of another robot.
        """
        new = cls.__new__(cls)
        new._robot = model if isinstance(model, Robot) else model._robot
        data = Path(path).read_bytes()
        new._inner = _core.Accumulator.from_bytes(
            data, new._robot._inner, arrays.thread_count(threads)
        )
        return new

    @property
    def columns(self) -> tuple[str, ...]:
        """Labels of the P columns: parameters, then ``viscous_joint`` and so on."""
        chosen, kinds = self._inner.columns
        labels = [self._robot.parameters[place] for place in chosen]
        for kind, wanted in zip(FRICTION, kinds, strict=True):
            labels += [f"{kind}_{joint}" for joint in self._robot.joints if wanted]
        return tuple(labels)

    @property
    def samples(self) -> int:
        """Number of samples taken in."""
        return self._inner.samples

    def update(
        self,
        q: npt.ArrayLike,
        qd: npt.ArrayLike,
        qdd: npt.ArrayLike,
        tau: npt.ArrayLike,
        weights: npt.ArrayLike | None = None,
    ) -> None:
        """Take samples in: all, or after an exception (and Ctrl-C) none.

        Parameters
        ----------
        q, qd, qdd, tau : array_like, shape (n,) or (N, n)
            Joint states and torques.
        weights : array_like, shape (n,) or (N, n), optional
            How much the squared residual of each joint's or each row's torque counts.

        Raises
        ------
        ShapeError, ArrayError
            An array has the wrong shape or a number that is not finite: its row is named.
        """
        n = self._robot.n
        states = arrays.states(q, qd, qdd, self._robot.nq, n)
        torques = np.atleast_2d(arrays.numbers("tau", tau))
        if torques.shape != states.qd.shape:
            raise ShapeError(f"tau has shape {torques.shape} and qd has {states.qd.shape}")
        joints, rows = None, None
        if weights is not None:
            given = arrays.numbers("weights", weights)
            if given.shape == (n,):
                joints = given
            elif given.shape == torques.shape:
                rows = given
            else:
                raise ShapeError(
                    f"weights has shape {given.shape}, expected ({n},) for one weight a joint or "
                    f"{torques.shape} for one a row"
                )
        self._inner.update(states.q, states.qd, states.qdd, torques, joints, rows)

    def merge(self, other: ObservationQR) -> None:
        """Take in what another accumulator of the same columns has taken in."""
        if other.columns != self.columns:
            raise OptionError("these accumulators have different columns")
        self._inner.merge(other._inner)

    @property
    def r_factor(self) -> Array:
        """R, shape (P, P), upper triangular with nonnegative diagonal: R'R = W'W."""
        return self._inner.factor()[:-1, :-1]

    @property
    def qt_tau(self) -> Array:
        """Q'tau, shape (P,)."""
        return self._inner.factor()[:-1, -1]

    @property
    def residual_norm(self) -> float:
        """The norm of tau - W x at the least-squares x."""
        return float(self._inner.factor()[-1, -1])

    def solve(self) -> Array:
        """Return the least-squares coefficients x of the P columns.

        Raises
        ------
        NumericalError
            The samples do not determine a column: it is named.
        """
        return self._inner.solve()

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the accumulator to a file, as a whole or not at all, with a checksum."""
        write_whole(Path(path), self._inner.to_bytes())

    def save_factor(self, path: str | os.PathLike[str]) -> None:
        """Write R, qt_tau, residual_norm, samples and columns as an NPZ file."""
        target = Path(path)
        factor = self._inner.factor()
        with tempfile.TemporaryDirectory(
            dir=target.resolve().parent, prefix=".roberval-"
        ) as folder:
            written = Path(folder) / "R.npz"
            np.savez(
                written,
                R=factor[:-1, :-1],
                qt_tau=factor[:-1, -1],
                residual_norm=factor[-1, -1],
                samples=self.samples,
                columns=np.array(self.columns),
            )
            written.replace(target)

    def _copy(self) -> ObservationQR:
        new = type(self).__new__(type(self))
        new._robot, new._inner = self._robot, self._inner.copy()
        return new

    def __repr__(self) -> str:
        columns = len(self.columns)
        return f"ObservationQR({self._robot.name!r}, {columns} columns, {self.samples} samples)"

    def __reduce__(self) -> tuple[object, ...]:
        return _restore, (self._robot, self._inner.to_bytes())


def _restore(robot: Robot, data: bytes) -> ObservationQR:
    new = ObservationQR.__new__(ObservationQR)
    new._robot = robot
    new._inner = _core.Accumulator.from_bytes(data, robot._inner, None)
    return new


def write_whole(path: Path, data: bytes) -> None:
    """Write a file as a whole or not at all."""
    target = path.resolve()
    # Always of one name: what a killed process leaves behind is overwritten.
    written = target.with_name(f".{target.name}.part")
    try:
        with written.open("wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        written.replace(target)
    except BaseException:
        written.unlink(missing_ok=True)
        raise
