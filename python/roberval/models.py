"""Models that are linear in the standard parameters, at joint states."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from . import _core, arrays
from .arrays import Array
from .description import Description
from .errors import OptionError, RobervalError, ShapeError
from .options import Model


class Models(Description):
    """A robot with its models: their rows, torques, the states of all joints."""

    __slots__ = ("_packed",)

    _packed: dict[str, tuple[list[list[int]], int]]

    def regressor(
        self,
        q: npt.ArrayLike,
        qd: npt.ArrayLike | None = None,
        qdd: npt.ArrayLike | None = None,
        model: Model = "d",
        *,
        out: Array | None = None,
        threads: int | None = None,
        keep_zeros: bool = False,
    ) -> Array:
        """Evaluate a model, linear in the standard parameters, at joint states.

        Parameters
        ----------
        q : array_like, shape (nq,) or (N, nq)
            Positions, rad or m, in the order of `positions`: those of the joints. A floating
            robot's q begins as Pinocchio's: place of the base (x, y, z), then its attitude, a
            quaternion (x, y, z, w) of length 1.
        qd, qdd : array_like, shape (n,) or (N, n)
            Velocities (per s) and accelerations (per s^2). Model h looks at no `qdd`, model d0
            at no `qd`: None will do. Those of a floating robot begin with the velocity v of
            the base's origin and its angular velocity w, in the base's frame, and with their
            rates; the origin's own acceleration is ``dv + w x v``.
        model : {"d", "d0", "h"}
            d: joint torques, ``tau = d @ X`` (Gautier 1991, eq. (5)); d0: the same at rest
            (eq. (8)); h: energy, of which only differences mean anything (eq. (10)).
        out : ndarray of float64, C-contiguous
            Where to write the result. For many states hand in the same array again: fresh
            memory costs more than the arithmetic.
        threads : int, optional
            Threads for large batches, by default all cores. The bits are the same.
        keep_zeros : bool
            Leave entries of `out` alone that are zero in every state. They must be zero: in an
            array from an earlier call for the same robot, columns and model (d0 counts as d), or
            from ``numpy.zeros``. W of large trees takes half the time in the cache and two thirds
            in memory; arms gain little. Some zeros of the first and the last state are checked
            before anything is written; where others are none, the rows are wrong.

        Returns
        -------
        ndarray, shape (N, n, C)
            For h (N, C); for one state without the N. ``W.reshape(-1, C)`` is the
            observation matrix. The first six rows of a floating robot are the force and the
            moment on its base, in the base's frame.

        Raises
        ------
        ShapeError
            An array has the wrong shape.
        ArrayError
            An array does not hold finite real numbers, or `out` cannot be written, or has no
            zero where one is to be kept.
        OptionError
            Zeros are to be kept, but there is no `out`; or an option has no such value.

        Examples
        --------
        >>> import numpy as np
        >>> import roberval as rv
        >>> puma = rv.load("puma560")
        >>> q = qd = qdd = np.zeros((100, 6))
        >>> puma.regressor(q, qd, qdd).shape
        (100, 6, 66)
        """
        return self._rows(model, None, q, qd, qdd, out, threads, keep_zeros)

    def packed(
        self,
        q: npt.ArrayLike,
        qd: npt.ArrayLike | None = None,
        qdd: npt.ArrayLike | None = None,
        model: Model = "d",
        *,
        out: Array | None = None,
        threads: int | None = None,
    ) -> Array:
        """Evaluate a model without what its structure makes zero, in tiles of samples.

        The fastest form: `regressor` writes twice as much for an arm, seven times for a tree.
        Arguments are those of `regressor`.

        Returns
        -------
        ndarray, shape (tiles, slots, lanes)
            ``[t, s, l]`` is the entry of slot s in sample ``t * lanes + l``; the last tile is
            filled up with samples at rest. `packed_entries` says which entry a slot is.

        Examples
        --------
        >>> import numpy as np
        >>> import roberval as rv
        >>> puma = rv.load("puma560")
        >>> q = qd = qdd = np.ones((100, 6))
        >>> tiles, slots, lanes = puma.packed(q, qd, qdd).shape
        >>> slots, tiles * lanes >= 100
        (199, True)
        """
        threads = arrays.thread_count(threads)
        if out is not None and self._inner.packed(model, q, qd, qdd, out, threads):
            return out
        states = self._states(model, q, qd, qdd)
        entries, lanes = self._packed_layout(model)
        shape = (-(-len(states.q) // lanes), len(entries), lanes)
        out = arrays.lines(shape) if out is None else arrays.output(out, shape)
        arrays.done(self._inner.packed(model, *states[:3], np.asarray(out), threads))
        return out

    def packed_entries(self, model: Model = "d") -> npt.NDArray[np.intp]:
        """Row and column of each slot of `packed`: shape (slots, 2). All others are zero."""
        return np.array(self._packed_layout(model)[0], dtype=np.intp).reshape(-1, 2)

    def _packed_layout(self, model: str) -> tuple[list[list[int]], int]:
        """Row and column of each slot, and how many samples a tile has."""
        layout = self._packed.get(model)
        if layout is None:
            layout = self._packed[model] = self._inner.packed_layout(model)
        return layout

    def _rows(
        self,
        model: str,
        columns: tuple[_core.Columns, int] | None,
        q: npt.ArrayLike,
        qd: npt.ArrayLike | None,
        qdd: npt.ArrayLike | None,
        out: Array | None,
        threads: int | None,
        keep_zeros: bool,
    ) -> Array:
        """Evaluate the regressor, or some of its columns (with their number)."""
        chosen = None if columns is None else columns[0]
        threads = None if threads is None else arrays.thread_count(threads)
        if type(keep_zeros) is not bool:
            raise OptionError(f"keep_zeros is {keep_zeros!r}, expected True or False")
        evaluate = self._inner.regressor
        if out is not None and evaluate(model, chosen, q, qd, qdd, out, threads, keep_zeros):
            return out
        width = len(self._labels) if columns is None else columns[1]
        size = (width,) if model == "h" else (self.n, width)
        if out is None:
            if keep_zeros:
                raise OptionError("keep_zeros needs out: an array with zeros from an earlier call")
            out = arrays.room((q, qd, qdd), (self.nq, self.n), size)
            if out is not None and evaluate(model, chosen, q, qd, qdd, out, threads, False):
                return out
        states = self._states(model, q, qd, qdd)
        out = arrays.output(out, (*states.lead, *size))
        into = np.asarray(out) if states.lead else np.asarray(out)[None]
        arrays.done(evaluate(model, chosen, *states[:3], into, threads, keep_zeros))
        return out

    def _states(
        self,
        model: str,
        q: npt.ArrayLike,
        qd: npt.ArrayLike | None,
        qdd: npt.ArrayLike | None,
    ) -> arrays.States:
        if qd is None:
            if model != "d0":
                raise ShapeError(f"qd is missing: model {model} needs velocities")
            qd = np.zeros((*np.shape(q)[:-1], self.n))
        if qdd is None:
            if model != "h":
                raise ShapeError(f"qdd is missing: model {model} needs accelerations")
            qdd = np.zeros((*np.shape(q)[:-1], self.n))
        return arrays.states(q, qd, qdd, self.nq, self.n)

    def torques(
        self,
        q: npt.ArrayLike,
        qd: npt.ArrayLike,
        qdd: npt.ArrayLike,
        X: npt.ArrayLike | Mapping[str, float] | None = None,
        *,
        out: Array | None = None,
        threads: int | None = None,
    ) -> Array:
        """Joint torques (N m; forces in N for prismatic joints) ``tau = d @ X``.

        Forces are carried inward from body to body (Newton and Euler): rounding is that of the
        forces that pass, some 1e-15 of them, and not of the rows of d.

        Parameters
        ----------
        q, qd, qdd : array_like, shape (n,) or (N, n)
            Joint states.
        X : array_like of shape (C,), or mapping from labels to values
            Standard parameters; by default those of the robot file. Labels that a mapping
            leaves out count as zero.
        out, threads
            As for `regressor`.

        Returns
        -------
        ndarray, shape of `qd`

        Raises
        ------
        ShapeError, ArrayError, UnknownParameterError
            An argument is not usable.
        """
        threads = arrays.thread_count(threads)
        if out is None:
            out = arrays.room((q, qd, qdd), (self.nq, self.n), (self.n,))
        if out is not None and self._inner.torques(X, q, qd, qdd, out, threads):
            return out
        x = self._standard_parameters(X)
        states = arrays.states(q, qd, qdd, self.nq, self.n)
        out = arrays.output(out, (*states.lead, self.n))
        into = np.asarray(out) if states.lead else np.asarray(out)[None]
        arrays.done(self._inner.torques(x, *states[:3], into, threads))
        return out

    def _standard_parameters(self, X: npt.ArrayLike | Mapping[str, float] | None) -> Array:
        if X is None:
            X = self.X
            if X is None:
                raise RobervalError(
                    f"the description of {self.name} has no inertial values: give X, "
                    f"{len(self._labels)} numbers or a dict of labels"
                )
        return arrays.vector("X", X, self._labels)

    def expand(
        self, q: npt.ArrayLike, qd: npt.ArrayLike, qdd: npt.ArrayLike
    ) -> tuple[Array, Array, Array]:
        """Return the states of all joints of the tree, those that follow others included.

        Parameters
        ----------
        q, qd, qdd : array_like, shape (n,) or (N, n)
            States of the independent joints. Passive joints of loops are found on the branch
            of `closed`, one state after the other.

        Returns
        -------
        q, qd, qdd : ndarray, shape (tree joints,) or (N, tree joints)
            In the order of the links that move, those of a floating base first.

        Raises
        ------
        ShapeError, ArrayError
            An argument is not usable, or the loops cannot be closed at a state.

        Examples
        --------
        >>> import roberval as rv
        >>> q, qd, qdd = rv.load("four_bar").expand([1.0], [1.0], [0.0])
        >>> q.shape
        (3,)
        """
        states = arrays.states(q, qd, qdd, self.nq, self.n)
        rows = self._inner.expand(states.q, states.qd, states.qdd)
        positions, velocities, accelerations = (x.reshape(*states.lead, -1) for x in rows)
        return positions, velocities, accelerations
