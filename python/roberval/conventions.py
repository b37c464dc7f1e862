"""Inertial parameters in the orders and about the points that others use.

All forms are of the same body. Products of inertia are entries of the tensor everywhere:
XY = Ixy = -(integral of x y dm).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, get_args

import numpy as np
import numpy.typing as npt

from . import _core, arrays
from .arrays import Array
from .errors import ArrayError, OptionError, ShapeError

if TYPE_CHECKING:
    from .description import Description

Order = Literal["paper", "pinocchio", "urdf", "mujoco"]
"""Whose order: see `Convention`."""


@dataclass(frozen=True)
class Convention:
    """How one program or paper writes the inertia of a body.

    Attributes
    ----------
    name : {"paper", "pinocchio", "urdf", "mujoco"}
        * ``paper``: XX XY XZ YY YZ ZZ MX MY MZ M about the origin of the link's frame;
        * ``pinocchio``: m mx my mz Ixx Ixy Iyy Ixz Iyz Izz about the same point, which is the
          joint's frame of a URDF (``pinocchio.Inertia.toDynamicParameters``);
        * ``urdf``: mass, centre of mass, ixx ixy ixz iyy iyz izz about the centre of mass in
          the link's axes;
        * ``mujoco``: ``body_mass``, ``body_ipos``, ``body_iquat`` (w x y z), ``body_inertia``:
          about the centre of mass, principal axes.
    columns : tuple of str
        The names of its numbers.
    place : str
        Where they are meant, in a sentence.

    Examples
    --------
    >>> import roberval as rv
    >>> ball = rv.convention("urdf").to_paper([2, 0, 0, 3, 0.5, 0, 0, 0.5, 0, 0.5])
    >>> ball.tolist()
    [18.5, 0.0, 0.0, 18.5, 0.0, 0.5, 0.0, 0.0, 6.0, 2.0]
    >>> rv.convention("pinocchio").from_paper(ball).tolist()
    [2.0, 0.0, 0.0, 6.0, 18.5, 0.0, 18.5, 0.0, 0.0, 0.5]
    """

    name: str
    columns: tuple[str, ...]
    place: str

    def from_paper(self, parameters: npt.ArrayLike) -> Array:
        """Convert the paper's ten parameters of one or many bodies.

        Parameters
        ----------
        parameters : array_like, shape (..., 10)
            XX XY XZ YY YZ ZZ MX MY MZ M about the origin of the link's frame.

        Returns
        -------
        ndarray, shape (..., len(columns))

        Raises
        ------
        ArrayError
            A first moment without mass has no centre of mass.
        """
        return self._convert(parameters, 10, len(self.columns), to_paper=False)

    def to_paper(self, numbers: npt.ArrayLike) -> Array:
        """Convert this convention's numbers of one or many bodies to the paper's ten.

        Parameters
        ----------
        numbers : array_like, shape (..., len(columns))

        Returns
        -------
        ndarray, shape (..., 10)
        """
        return self._convert(numbers, len(self.columns), 10, to_paper=True)

    def _convert(self, given: npt.ArrayLike, width: int, out: int, *, to_paper: bool) -> Array:
        array = np.asarray(given, dtype=float)
        if array.ndim == 0 or array.shape[-1] != width:
            names = " ".join(self.columns) if to_paper else "XX XY XZ YY YZ ZZ MX MY MZ M"
            raise ShapeError(
                f"numbers of shape {array.shape}, expected (..., {width}): {names} for each body"
            )
        if not np.isfinite(array).all():
            raise ArrayError("numbers that are not finite: a body has none")
        rows = [
            _core.convert(self.name, to_paper, row) for row in array.reshape(-1, width).tolist()
        ]
        for index, row in enumerate(rows):
            if row is None:
                what = "a quaternion of length 0" if to_paper else "a first moment without mass"
                raise ArrayError(f"body {index} has {what}: there is no such form of it")
        return np.array(rows, dtype=float).reshape(*array.shape[:-1], out)


CONVENTIONS: Mapping[str, Convention] = {
    name: Convention(name, tuple(columns), place) for name, columns, place in _core.conventions()
}


def convention(name: Order) -> Convention:
    """Return a convention by its name: paper, pinocchio, urdf or mujoco."""
    try:
        return CONVENTIONS[name]
    except KeyError:
        names = ", ".join(map(repr, get_args(Order)))
        raise OptionError(f"order is {name!r}, expected one of {names}") from None


class ParameterOrder:
    """A robot's standard parameters X and a convention's numbers, body by body.

    Made by `Robot.order`. Bodies are the robot's links, a row each in the order of `links`: other
    programs number theirs in an order of their own, so match them by name, such as
    ``model.inertias[model.getJointId(link.joint_name)]`` of Pinocchio. What is lumped
    into a link is part of it, as in Pinocchio. Rotor inertias (Pinocchio's and MuJoCo's
    armature) are beside them.

    Attributes
    ----------
    convention : Convention
    links : tuple of str
        The bodies, in order.
    """

    __slots__ = ("_inertia", "_names", "_rotors", "convention", "links")

    def __init__(self, robot: Description, name: Order) -> None:
        self.convention = convention(name)
        self.links = tuple(link.name for link in robot.links)
        self._names = robot.parameters
        rows, rotors, start = [], [], 0
        for link in robot.links:
            rows.append(range(start, start + 10))
            rotors.append(start + 10 if link.rotor else -1)
            start += 11 if link.rotor else 10
        self._inertia = np.array(rows)
        self._rotors = np.array(rotors)

    def from_paper(self, X: npt.ArrayLike | Mapping[str, float]) -> tuple[Array, Array]:
        """Convert standard parameters.

        Parameters
        ----------
        X : array_like of shape (C,), or mapping from labels to values

        Returns
        -------
        numbers : ndarray, shape (links, len(convention.columns))
        armature : ndarray, shape (links,)
            Rotor inertias, 0 where a link has none.
        """
        x = arrays.vector("X", X, self._names)
        armature = np.where(self._rotors >= 0, x[self._rotors], 0.0)
        return self.convention.from_paper(x[self._inertia]), armature

    def to_paper(
        self, numbers: npt.ArrayLike, armature: npt.ArrayLike | Sequence[float] | None = None
    ) -> Array:
        """Convert to standard parameters X.

        Parameters
        ----------
        numbers : array_like, shape (links, len(convention.columns))
        armature : array_like, shape (links,)
            Rotor inertias; zero by default. Those of links without one must be 0.

        Returns
        -------
        ndarray, shape (C,)
        """
        given = self.convention.to_paper(numbers)
        count = len(self.links)
        rotors = np.zeros(count) if armature is None else np.asarray(armature, dtype=float)
        for name, array, shape in (("numbers", given, (count, 10)), ("armature", rotors, (count,))):
            if array.shape != shape:
                raise ShapeError(f"{name} for {array.shape[:1]} links, the robot has {count}")
        without = self._rotors < 0
        if np.any(rotors[without] != 0):
            link = self.links[int(np.flatnonzero(without & (rotors != 0))[0])]
            raise ArrayError(f"armature of link {link!r}, which has no rotor of its own")
        x = np.zeros(len(self._names))
        x[self._inertia] = given
        x[self._rotors[~without]] = rotors[~without]
        return x

    def __repr__(self) -> str:
        return f"ParameterOrder({self.convention.name!r}, {len(self.links)} links)"
