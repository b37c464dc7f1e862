"""Streaming least squares: from joint states and torques to the R factor, in one pass."""

from __future__ import annotations

import io
import json
import os
import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _core, arrays, files
from .arrays import Array
from .base import BaseParameters
from .errors import (
    CheckpointError,
    NumericalError,
    OptionError,
    ShapeError,
    UnknownParameterError,
)
from .robot import Robot

FRICTION = ("viscous", "coulomb", "offset")
"""Kinds of columns that stand for a joint's friction: qd, sign(qd) and 1."""

Inputs = list[tuple[str, int]]
"""What tells the files that an accumulator has begun to take in (a digest and the name) and their
sizes: see `checkpoints.identity`."""


class ObservationQR:
    """The R factor of the observation matrix and the torques, taken in block by block.

    Memory does not grow with the samples. The result depends on the samples and their order
    only, bit by bit, not on how they are cut into updates, nor on the number of threads, nor on
    the vector width of the processor (if it fuses products and sums, as all with AVX2 or NEON).

    Threads may share an accumulator: their updates and merges wait for each other, in the order
    of the calls. Whoever reads meanwhile, and a process forked meanwhile, sees the accumulator as
    it was before the update under way.

    Parameters
    ----------
    model : Robot or BaseParameters
        Whose columns: all standard parameters, those without effect on the torques too (such
        columns are zero), or the base parameters (of model d, whose rows the torques are).
    columns : str or sequence of str, optional
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
        columns: str | Sequence[str] | None = None,
        friction: Iterable[str] = (),
        threads: int | None = None,
    ) -> None:
        robot = robot_of(model)
        if columns is None:
            columns = robot.parameters if isinstance(model, Robot) else model.base
        columns = _listed("columns", columns)
        places = {label: place for place, label in enumerate(robot.parameters)}
        missing = [label for label in columns if label not in places]
        if missing:
            raise UnknownParameterError(f"{robot.name} has no parameter {missing[0]}")
        twice = [label for place, label in enumerate(columns) if label in columns[:place]]
        if twice:
            raise OptionError(f"columns has {twice[0]} twice, expected each label once")
        kinds = _listed("friction", friction)
        unknown = [kind for kind in kinds if kind not in FRICTION]
        if unknown:
            raise OptionError(f"friction is {unknown[0]!r}, expected some of {FRICTION}")
        self._robot = robot
        self._independent = _independent(model, columns)
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
        return cls._load_with_inputs(path, model, threads)[0]

    @classmethod
    def _load_with_inputs(
        cls, path: str | os.PathLike[str], model: Robot | BaseParameters, threads: int | None
    ) -> tuple[ObservationQR, Inputs | None]:
        """Return the accumulator, and its files if `_save_with_inputs` wrote it."""
        new = cls.__new__(cls)
        new._robot = robot_of(model)
        count = arrays.thread_count(threads)
        data = Path(path).read_bytes()
        try:
            new._inner, note = _core.Accumulator.from_bytes(data, new._robot._inner, count)
        except CheckpointError as error:
            raise CheckpointError(f"{path}: {error}") from None
        new._independent = _independent(model, new.columns)
        inputs = [(str(name), int(size)) for name, size in json.loads(note)] if note else None
        return new, inputs

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
        """Number of samples taken in by the updates that have ended."""
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
            An array has the wrong shape, or a number that is not finite or so large that R
            would not be: it is named, with its row in the array given.
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
        """Take in what another accumulator of the same robot and columns has taken in.

        Raises
        ------
        NumericalError
            R would not be finite; nothing is taken in.
        """
        if not isinstance(other, ObservationQR):
            raise TypeError(f"merge takes an ObservationQR, not {_told(other)}")
        if other is self:
            raise OptionError("an accumulator cannot be merged with itself: samples count once")
        if other._inner.identity != self._inner.identity:
            raise OptionError(
                f"these accumulators are of different robots: {self._robot.name} and "
                f"{other._robot.name}, whose geometry or parameters differ"
            )
        if other.columns != self.columns:
            only = [label for label in self.columns if label not in other.columns]
            only += [label for label in other.columns if label not in self.columns]
            what = f"{only[0]} is in one only" if only else "their order differs"
            raise OptionError(f"these accumulators have different columns: {what}")
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
            The samples do not determine a column: it is named. Or there are none.
        """
        if self.samples == 0:
            raise NumericalError("there are no samples yet to solve for: update takes them in")
        try:
            return self._inner.solve()
        except NumericalError as error:
            # The core counts columns; the one after the last is the torque's.
            labels = (*self.columns, "tau")
            said = re.sub(
                r"^column (\d+)", lambda found: f"column {labels[int(found[1])]}", str(error)
            )
            if said.endswith("these data"):
                said += ": give data that move more"
                if not self._independent:
                    said += ", or columns that are independent (robot.base_parameters())"
            raise NumericalError(said) from None

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the accumulator to a file, as a whole or not at all, with a checksum."""
        files.write(path, self._inner.to_bytes())

    def _save_with_inputs(self, path: Path, inputs: Inputs) -> None:
        """Write the accumulator and what files it has begun to take in."""
        files.write(path, self._inner.to_bytes(json.dumps(inputs).encode()))

    def save_factor(self, path: str | os.PathLike[str]) -> None:
        """Write R, qt_tau, residual_norm, samples and columns as an NPZ file."""
        # Another thread may go on updating this one.
        inner = self._inner.copy()
        factor, archive = inner.factor(), io.BytesIO()
        np.savez(
            archive,
            R=factor[:-1, :-1],
            qt_tau=factor[:-1, -1],
            residual_norm=factor[-1, -1],
            samples=inner.samples,
            columns=np.array(self.columns),
        )
        files.write(path, archive.getvalue())

    def _copy(self) -> ObservationQR:
        new = type(self).__new__(type(self))
        new.__dict__ |= self.__dict__ | {"_inner": self._inner.copy()}
        return new

    def __repr__(self) -> str:
        columns = len(self.columns)
        return f"ObservationQR({self._robot.name!r}, {columns} columns, {self.samples} samples)"

    def __reduce__(self) -> tuple[object, ...]:
        others = {name: value for name, value in self.__dict__.items() if name != "_inner"}
        return _restore, (type(self), self._robot, self._inner.to_bytes()), others


def _restore(cls: type[ObservationQR], robot: Robot, data: bytes) -> ObservationQR:
    new = cls.__new__(cls)
    new._inner, _ = _core.Accumulator.from_bytes(data, robot._inner, None)
    return new


def _independent(model: Robot | BaseParameters, columns: Sequence[str]) -> bool:
    """Tell whether the robot's own columns are known to be independent."""
    own = set(columns) & set(robot_of(model).parameters)
    return isinstance(model, BaseParameters) and own <= set(model.base)


def robot_of(model: Robot | BaseParameters) -> Robot:
    """Return the robot of what `ObservationQR` takes for a model."""
    if isinstance(model, Robot):
        return model
    if not isinstance(model, BaseParameters):
        raise TypeError(
            f"model is {_told(model)}, expected a Robot (roberval.load) or its base_parameters()"
        )
    if model.model != "d":
        raise OptionError(
            f"these are base parameters of model {model.model}, and torques are rows of model d: "
            'take base_parameters(model="d")'
        )
    return model._robot


def _listed(name: str, value: str | Iterable[str]) -> tuple[str, ...]:
    """Return labels as a tuple; one may stand alone."""
    if isinstance(value, str):
        return (value,)
    try:
        labels = tuple(value)
    except TypeError:
        raise OptionError(f"{name} is {_told(value)}, expected a list of labels") from None
    wrong = [label for label in labels if not isinstance(label, str)]
    if wrong:
        raise OptionError(f"{name} has {_told(wrong[0])}, expected labels")
    return labels


def _told(value: Any) -> str:
    """Return a value of a wrong type as it stands in a message."""
    return f"{value!r:.60} ({type(value).__name__})"
