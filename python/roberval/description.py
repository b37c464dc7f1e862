"""What a robot is: its links, joints, frames and known inertias."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from . import _core, rendering
from .arrays import Array
from .conventions import Order, ParameterOrder
from .plots import RobotPlots
from .rendering import Rendered


class Loop(NamedTuple):
    """A joint that was cut to make a tree of the links.

    Attributes
    ----------
    between : tuple of two str
        The two links; ``"base"`` is the base.
    cut : str
        ``"revolute"``, ``"spherical"``, ``"fixed"``, ``"prismatic"`` or ``"universal"``.
    """

    between: tuple[str, str]
    cut: str


class Link(NamedTuple):
    """One link and the joint that moves it.

    Attributes
    ----------
    name : str
        The link's name.
    joint_name : str or None
        The joint's name, where the file has one.
    antecedent : str or None
        Name of the link that carries this one; None is the base.
    joint : str
        ``"revolute"``, ``"prismatic"``, ``"fixed"``, or ``"floating"`` for a base that stands
        on nothing.
    active : bool
        Whether the joint is driven.
    rotor : bool
        Whether there is a rotor inertia Ia.
    """

    name: str
    joint_name: str | None
    antecedent: str | None
    joint: str
    active: bool
    rotor: bool


class Couple(NamedTuple):
    """A joint that follows from others: by a sum of multiples, or by an expression.

    Attributes
    ----------
    joint : str
        The joint that follows.
    equals : dict of str to str
        The joints it follows, with their multipliers as written.
    offset : str
        Its position where those stand at 0, as written.
    expression : str or None
        In place of these, an expression of the joints it follows.
    """

    joint: str
    equals: dict[str, str]
    offset: str
    expression: str | None = None


class Description(Rendered):
    """A robot as it is understood, without what can be computed with it."""

    __slots__ = ("_labels", "_links")

    _inner: _core.Robot
    _labels: tuple[str, ...]
    _links: tuple[Link, ...]

    def order(self, name: Order) -> ParameterOrder:
        """Map standard parameters to another convention and back.

        Parameters
        ----------
        name : {"paper", "pinocchio", "urdf", "mujoco"}
            See `Convention`.

        Examples
        --------
        >>> import numpy as np
        >>> import roberval as rv
        >>> ur5 = rv.load("ur5")
        >>> X = np.arange(66.0)
        >>> there, armature = ur5.order("pinocchio").from_paper(X)
        >>> there[0].tolist()  # m mx my mz Ixx Ixy Iyy Ixz Iyz Izz of the first link
        [9.0, 6.0, 7.0, 8.0, 0.0, 1.0, 3.0, 2.0, 4.0, 5.0]
        >>> bool((ur5.order("pinocchio").to_paper(there, armature) == X).all())
        True
        """
        return ParameterOrder(self, name)

    @property
    def plot(self) -> RobotPlots:
        """Plots with matplotlib: ``robot.plot.tree()``."""
        return RobotPlots(self)

    def to_urdf(self) -> str:
        """Return the robot as the text of a URDF: the same links, frames and known inertias.

        Rotor inertias and gravity, which URDF does not have, are comments.

        Raises
        ------
        RobotError
            A joint follows from several others, which URDF cannot say.

        Examples
        --------
        >>> import roberval as rv
        >>> arm = rv.load("ur5")
        >>> rv.Robot.from_urdf(arm.to_urdf()).base_parameters().base == arm.base_parameters().base
        True
        """
        return self._inner.to_urdf()

    def to_toml(self, *, cleaned: bool = False) -> str:
        """Return the robot as robot TOML.

        Parameters
        ----------
        cleaned : bool
            Write the numbers as they were understood (pi/2) instead of as they were written
            (1.5708).

        Raises
        ------
        RobotError
            The robot comes from a URDF: the form has no limits, and lumps no fixed joints.

        Examples
        --------
        >>> import roberval as rv
        >>> puma = rv.load("puma560")
        >>> rv.Robot.from_toml(puma.to_toml()) == puma
        True
        """
        return self._inner.to_toml(cleaned)

    @property
    def name(self) -> str:
        """The robot's name."""
        return self._inner.name

    @property
    def links(self) -> tuple[Link, ...]:
        """The links in the order of the parameters: each after its antecedent."""
        return self._links

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the independent joints in the order of q; of their links if they have none."""
        return self.velocities[6 if self.is_floating else 0 :]

    @property
    def loops(self) -> tuple[Loop, ...]:
        """The loops that are closed by joints which were cut."""
        return tuple(Loop((sides[0], sides[1]), cut) for sides, cut in self._inner.loops)

    @property
    def closed(self) -> Array | None:
        """Variables of all joints of the tree where the loops are closed: they name the branch.

        Without those of a base that floats. None for a robot without loops.
        """
        closed = self._inner.closed
        return None if closed is None else np.array(closed)

    @property
    def is_floating(self) -> bool:
        """Whether the first link is a base that moves freely."""
        return self.nq > self.n

    @property
    def axes(self) -> Array:
        """The joints' unit axes in the links' frames, shape (links, 3)."""
        return np.array([axis for _, _, axis in self._inner.placements])

    def frames(self) -> Array:
        """Return the links' frames in the base frame at joint variables 0.

        Returns
        -------
        ndarray, shape (links, 4, 4)
            Homogeneous transformations: columns are the axes x, y, z and the origin (m).
        """
        frames = np.zeros((len(self._links), 4, 4))
        index = {link.name: j for j, link in enumerate(self._links)}
        for j, (rotation, origin, _) in enumerate(self._inner.placements):
            on = np.eye(4)
            on[:3, :3], on[:3, 3] = rotation, origin
            above = self._links[j].antecedent
            frames[j] = on if above is None else frames[index[above]] @ on
        return frames

    @property
    def n(self) -> int:
        """Degrees of freedom: length of qd and qdd, number of rows of d."""
        return self._inner.dof

    @property
    def moving(self) -> tuple[str, ...]:
        """Names of all moving joints, in link order: those that follow others among them."""
        moving = (link for link in self._links if link.joint in ("revolute", "prismatic"))
        return tuple(link.joint_name or link.name for link in moving)

    @property
    def couples(self) -> tuple[Couple, ...]:
        """The joints that follow from others (couples of a robot TOML, mimic of a URDF)."""
        rows = self._inner.couples
        return tuple(
            Couple(joint, dict(terms), offset, text) for joint, terms, offset, text in rows
        )

    @property
    def nq(self) -> int:
        """Length of q: n, or n + 1 for a floating robot, whose attitude is a quaternion."""
        return self._inner.positions

    @property
    def positions(self) -> tuple[str, ...]:
        """Names of the entries of q: joints; ``L.x L.y L.z L.qx L.qy L.qz L.qw`` if L floats."""
        return tuple(self._inner.coordinates[0])

    @property
    def velocities(self) -> tuple[str, ...]:
        """Names of the entries of qd and qdd: joints; ``L.vx`` to ``L.wz`` if a link L floats."""
        return tuple(self._inner.coordinates[1])

    @property
    def rows(self) -> tuple[str, ...]:
        """Names of the rows of d: joints; the wrench ``L.fx`` to ``L.mz`` if a link L floats."""
        return tuple(self._inner.coordinates[2])

    @property
    def parameters(self) -> tuple[str, ...]:
        """Labels of the C standard parameters, the columns of the regressor: KIND_link."""
        return self._labels

    @property
    def gravity(self) -> Array:
        """Acceleration of gravity in the base frame, m/s^2, shape (3,)."""
        return np.array(self._inner.gravity)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What the reader of the robot file noticed."""
        return tuple(self._inner.warnings)

    @property
    def changes(self) -> tuple[str, ...]:
        """Numbers of the description that were set right, one sentence each."""
        return tuple(self._inner.changes)

    @property
    def near_misses(self) -> tuple[str, ...]:
        """Numbers that look rounded and were left alone, one sentence each."""
        return tuple(self._inner.near_misses)

    @property
    def X(self) -> Array | None:  # noqa: N802
        """The standard parameters, shape (C,); what the file does not give is zero.

        None where the file gives no value at all.
        """
        return self._inner.standard_parameters()

    @property
    def inertial_values(self) -> dict[str, float]:
        """The standard parameters that the robot file gives, by label."""
        x = self.X
        if x is None:
            return {}
        rows = zip(self._labels, x.tolist(), self._inner.known, strict=True)
        return {label: value for label, value, known in rows if known}

    def __repr__(self) -> str:
        kinds = [link.joint for link in self._links]
        joints = ", ".join(
            f"{kinds.count(kind)} {kind} joint{'s' if kinds.count(kind) > 1 else ''}"
            for kind in ("floating", "revolute", "prismatic", "fixed")
            if kind in kinds
        )
        return f"Robot({self.name!r}, {joints}, {len(self._labels)} parameters)"

    def _repr_html_(self) -> str:
        header = ["link", "antecedent", "joint", "type", "active", "rotor"]
        rows = (
            [
                link.name,
                link.antecedent or "base",
                link.joint_name or "",
                link.joint,
                "yes" if link.active else "no",
                "yes" if link.rotor else "no",
            ]
            for link in self._links
        )
        return rendering.paragraph(repr(self)) + rendering.grid(header, rows)
