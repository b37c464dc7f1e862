"""Robots: load or build one, look at it, evaluate its regressor."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, SupportsIndex

import numpy as np
import numpy.typing as npt

from . import _core, arrays, mdh, rendering
from .arrays import Array
from .base import BaseParameters, Comparison, analyse
from .conventions import Order, ParameterOrder
from .errors import OptionError, RobervalError, RobotWarning, ShapeError
from .options import Choice, Engine, Model, Number, Reading, Snap, options, reading
from .plots import RobotPlots
from .rendering import Rendered
from .scaling import Scaling, scaling_options

if TYPE_CHECKING:
    from .importers import Text


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


class Robot(Rendered):
    """A robot: a chain or tree of links and joints. Immutable.

    Make one with `load`, `Robot.from_mdh`, `Robot.from_toml` or `Robot.from_urdf`.

    The inertial parameters are linear in the models: ``tau = d(q, qd, qdd) @ X``. X holds
    for each link the paper's eleven (Gautier 1991, eq. (3)), or ten where the joint has no
    rotor::

        XX XY XZ YY YZ ZZ  kg m^2, about the origin of the link's frame and in that frame
        MX MY MZ           kg m, first moments
        M                  kg
        Ia                 kg m^2 (prismatic: kg), rotor inertia seen from the joint's side
    """

    __slots__ = ("_labels", "_links", "_packed", "_reading")

    _inner: _core.Robot
    _reading: Reading
    _labels: tuple[str, ...]
    _links: tuple[Link, ...]
    _packed: dict[str, tuple[list[list[int]], int]]

    def __init__(self) -> None:
        raise TypeError("make a Robot with roberval.load, Robot.from_mdh, from_toml or from_urdf")

    @classmethod
    def _of(cls, core: _core.Robot, reading: Reading) -> Robot:
        for warning in core.warnings:
            warnings.warn(f"{core.name}: {warning}", RobotWarning, stacklevel=3)
        return cls._quietly(core, reading)

    @classmethod
    def _quietly(cls, core: _core.Robot, reading: Reading) -> Robot:
        robot = object.__new__(cls)
        robot._inner = core
        robot._reading = reading
        robot._labels = tuple(core.labels)
        robot._links = tuple(Link(*link) for link in core.links)
        robot._packed = {}
        return robot

    @classmethod
    def from_mdh(
        cls,
        rows: Iterable[mdh.Row],
        *,
        name: str = "robot",
        gravity: Sequence[Number] = (0, 0, "-9.81"),
        constants: Mapping[str, Number] | None = None,
        snap: Snap = "default",
    ) -> Robot:
        """Build a robot from modified Denavit-Hartenberg parameters (Khalil and Kleinfinger).

        Parameters
        ----------
        rows : iterable of dict or tuple
            One row a link. A dict has the keys of a robot TOML: ``name``, ``antecedent``,
            ``joint`` (``"revolute"``, ``"prismatic"``, ``"fixed"``), ``active``, ``rotor``,
            ``gamma``, ``b``, ``alpha``, ``d``, ``theta``, ``r``, ``inertia``; all but
            ``alpha``, ``d``, ``theta`` and ``r`` may be left out. A tuple is
            (alpha, d, theta, r). Lengths in m, angles in rad or text (``"-90 deg"``,
            ``"pi/2"``); texts may use `constants`.
        name : str
            The robot's name.
        gravity : 3 numbers
            Acceleration of gravity in the base frame, m/s^2.
        constants : dict
            Named values for the expressions in `rows`.
        snap : {"default", "off", "aggressive"}
            Whether rounded angles are set right, as in `load`.

        Returns
        -------
        Robot

        Raises
        ------
        RobotError
            A row is not valid; the message names the link and the field.

        Examples
        --------
        >>> import roberval as rv
        >>> planar = rv.Robot.from_mdh([(0, 0, 0, 0), (0, "L", 0, 0)],
        ...                            gravity=[0, "-9.81", 0], constants={"L": 0.5})
        >>> planar.base_parameters().rank
        7
        """
        text = mdh.robot_toml(rows, name, gravity, constants)
        asked = reading(snap=snap)
        return cls._of(_core.Robot.from_rows(text, "from_mdh", asked), asked)

    @classmethod
    def from_toml(cls, text: str, *, snap: Snap = "default") -> Robot:
        """Read the text of a robot TOML.

        Parameters
        ----------
        text : str
            The robot TOML.
        snap : {"default", "off", "aggressive"}
            Whether rounded angles are set right, as in `load`.

        Raises
        ------
        RobotError
            The text is not valid; the message names the line and what would be right.
        """
        asked = reading(snap=snap)
        return cls._of(_core.Robot.from_toml(text, "robot.toml", asked), asked)

    @classmethod
    def from_urdf(
        cls,
        text_or_path: str | os.PathLike[str],
        *,
        keep_fixed: bool = False,
        floating: bool = False,
        rotors: bool = True,
        snap: Snap = "default",
        gravity: Sequence[Number] | None = None,
    ) -> Robot:
        """Read a URDF: its text (anything that begins with ``<``), or the path of a file.

        Links keep their URDF frames and are numbered depth first in file order. No mesh is
        opened. Inertial values are not needed.

        Parameters
        ----------
        text_or_path : str or path
            The URDF.
        keep_fixed : bool
            Keep links on fixed joints as links of their own; by default they are lumped
            into their parents.
        floating, rotors, snap, gravity
            As in `load`.

        Raises
        ------
        RobotError
            The file or text is not valid; the message names the line and what would be right.
        """
        asked = reading(
            keep_fixed=keep_fixed, floating=floating, rotors=rotors, snap=snap, gravity=gravity
        )
        text = os.fspath(text_or_path)
        if text.lstrip("\ufeff \t\r\n").startswith("<"):
            return cls._of(_core.Robot.from_urdf(text, "robot.urdf", asked), asked)
        return cls._of(_core.Robot.load(text, asked), asked)

    @classmethod
    def from_mujoco(
        cls,
        model: Any,
        *,
        rotors: bool = True,
        snap: Snap = "default",
        gravity: Sequence[Number] | None = None,
    ) -> Robot:
        """Read a MuJoCo model (needs the package mujoco).

        The frame of a link lies at its joint, in the axes of its body. A body with several
        joints becomes several links, the first ones without mass; ball joints become three
        hinges; a free joint makes a base that floats if all others are on it and there are no
        loops. Equality constraints of two joints become couples; what is not applied is
        warned of. Joint variables are 0 where the model has ``qpos0``.

        Parameters
        ----------
        model : mujoco.MjModel, mujoco.MjSpec, str or path
            The model, MJCF text (anything that begins with ``<``), or the path of a file.
        rotors, snap, gravity
            As in `load`.

        Raises
        ------
        MissingPackageError
            mujoco is not installed.
        RobotError
            The model cannot be read.
        """
        from .importers import mujoco

        return cls._imported(
            mujoco.from_any(model), reading(rotors=rotors, snap=snap, gravity=gravity)
        )

    @classmethod
    def from_pinocchio(
        cls,
        model: Any,
        *,
        rotors: bool = True,
        snap: Snap = "default",
        gravity: Sequence[Number] | None = None,
    ) -> Robot:
        """Read a Pinocchio model (needs the package pin).

        Links have the frames of the joints, and the names of the bodies there.

        Parameters
        ----------
        model : pinocchio.Model
        rotors, snap, gravity
            As in `load`.

        Raises
        ------
        MissingPackageError
            Pinocchio is not installed.
        RobotError
            A joint has a type that is not supported.
        """
        from .importers import pinocchio

        return cls._imported(
            pinocchio.from_model(model), reading(rotors=rotors, snap=snap, gravity=gravity)
        )

    @classmethod
    def _imported(cls, read: Text, asked: Reading) -> Robot:
        make = _core.Robot.from_urdf if read.kind == "urdf" else _core.Robot.from_toml
        robot = cls._quietly(make(read.text, "imported model", asked), asked)
        for warning in (*read.warnings, *robot.warnings):
            warnings.warn(f"{robot.name}: {warning}", RobotWarning, stacklevel=3)
        return robot

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
            The robot comes from a URDF, whose frames the form cannot hold.

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

        None for a robot without loops.
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
    def plot(self) -> RobotPlots:
        """Plots with matplotlib: ``robot.plot.tree()``."""
        return RobotPlots(self)

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

    def regressor(
        self,
        q: npt.ArrayLike,
        qd: npt.ArrayLike | None = None,
        qdd: npt.ArrayLike | None = None,
        model: Model = "d",
        *,
        out: Array | None = None,
        threads: int | None = None,
    ) -> Array:
        """Evaluate a model, linear in the standard parameters, at joint states.

        Parameters
        ----------
        q : array_like, shape (nq,) or (N, nq)
            Positions, rad or m, in the order of `positions`: those of the joints. A floating
            robot's q begins as Pinocchio's: place of the base (x, y, z), then its attitude, a
            quaternion (x, y, z, w) of length 1.
        qd, qdd : array_like, shape (n,) or (N, n)
            Velocities (per s) and accelerations (per s^2). Model h needs no `qdd`, model d0
            no `qd`. Those of a floating robot begin with the velocity v of the base's origin
            and its angular velocity w, in the base's frame, and with their rates; the origin's
            own acceleration is ``dv + w x v``.
        model : {"d", "d0", "h"}
            d: joint torques, ``tau = d @ X`` (Gautier 1991, eq. (5)); d0: the same at rest
            (eq. (8)); h: energy, of which only differences mean anything (eq. (10)).
        out : ndarray of float64, C-contiguous
            Where to write the result. For many states hand in the same array again: fresh
            memory costs more than the arithmetic.
        threads : int, optional
            Threads for large batches, by default all cores. The bits are the same.

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
            An array does not hold finite real numbers, or `out` cannot be written.

        Examples
        --------
        >>> import numpy as np
        >>> import roberval as rv
        >>> puma = rv.load("puma560")
        >>> q = qd = qdd = np.zeros((100, 6))
        >>> puma.regressor(q, qd, qdd).shape
        (100, 6, 66)
        """
        return self._rows(model, None, q, qd, qdd, out, threads)

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
        """Evaluate only the numbers of a model that are not always zero, in tiles of samples.

        The fastest form: `regressor` writes two to five times as much. Arguments are those of
        `regressor`.

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
        (216, True)
        """
        states = self._states(model, q, qd, qdd)
        entries, lanes = self._packed_layout(model)
        shape = (-(-len(states.q) // lanes), len(entries), lanes)
        out = arrays.output(out, shape)
        threads = arrays.thread_count(threads)
        self._inner.packed(model, states.q, states.qd, states.qdd, out, threads)
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
    ) -> Array:
        """Evaluate the regressor, or some of its columns (with their number)."""
        states = self._states(model, q, qd, qdd)
        chosen, width = columns or (None, len(self._labels))
        threads = arrays.thread_count(threads)
        rows = () if model == "h" else (self.n,)
        out = arrays.output(out, (*states.lead, *rows, width))
        self._inner.regressor(model, chosen, states.q, states.qd, states.qdd, out, threads)
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
        states = arrays.states(q, qd, qdd, self.nq, self.n)
        x = self._standard_parameters(X)
        out = arrays.output(out, (*states.lead, self.n))
        threads = arrays.thread_count(threads)
        self._inner.torques(x, states.q, states.qd, states.qdd, out, threads)
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

    def base_parameters(
        self,
        model: Model = "d",
        *,
        engine: Engine | None = None,
        choice: Choice | None = None,
        keep: Sequence[str] = (),
        drop: Sequence[str] = (),
        seed: SupportsIndex = 0,
        rows: SupportsIndex | None = None,
        tolerance: float | str | None = None,
        samples: Scaling | tuple[npt.ArrayLike, npt.ArrayLike, npt.ArrayLike] | None = None,
    ) -> BaseParameters:
        """Find the base inertial parameters and how the others regroup onto them.

        Parameters
        ----------
        model : {"d", "d0", "h"}
            The model whose columns are analysed; all give the same answer.
        engine : {"exact", "precise", "qr", "qrii", "svd"}
            Elimination modulo primes, which needs no tolerance (the default; for loops it
            becomes precise); the same in high-precision floats; QR without
            pivoting (Gautier 1991, eq. (13)), QR with column pivoting (eq. (14)) or SVD
            (eq. (21)-(27)). All give the same answer.
        choice : {"paper", "pivoted", "prefer"}
            Which parameters to keep. paper (the default): the parameters of largest subscript
            are regrouped; pivoted: the best conditioned columns are kept; prefer: the paper's
            rule after `keep` and `drop`.
        keep, drop : sequence of str
            Labels to keep if possible, the most important first, and to regroup if possible,
            the least wanted first.
        seed : int
            Names the random samples.
        rows : int
            Rows of the observation matrix W; by default twice its columns or more.
        tolerance : float or {"paper", "paper-ieee"}
            What counts as zero for the float engines: a ratio to the column's norm, or the
            paper's rule ``tau = r |T11| eps`` with its own eps 2^-56 or IEEE's 2^-52.
        samples : Scaling or (q, qd, qdd)
            Joint states to take instead of random ones; `rows` and `seed` then play no part.

        Returns
        -------
        BaseParameters

        Raises
        ------
        OptionError, UnknownParameterError
            An option is not usable.
        NumericalError
            A factorisation failed.

        Warns
        -----
        DoubtfulRankWarning
            The rank is in doubt: see the result's `diagnosis`.
        RobotWarning
            There is no doubt, but the file as written has another number of base parameters.

        Examples
        --------
        >>> import roberval as rv
        >>> base = rv.load("puma560").base_parameters()
        >>> base.rank
        40
        >>> dict(base.relations["XX_6"])
        {'XX_6': 1.0, 'YY_6': -1.0}
        """
        answer = analyse(
            self,
            options(
                model=model,
                engine=engine,
                choice=choice,
                keep=keep,
                drop=drop,
                seed=seed,
                rows=rows,
                tolerance=tolerance,
            ),
            None if samples is None else self._samples(samples),
        )
        answer._warn()
        return answer

    def _samples(
        self, samples: Scaling | tuple[npt.ArrayLike, npt.ArrayLike, npt.ArrayLike]
    ) -> tuple[Array, Array, Array]:
        if isinstance(samples, Scaling):
            return samples.q, samples.qd, samples.qdd
        if not isinstance(samples, tuple) or len(samples) != 3:
            raise OptionError("samples is no tuple (q, qd, qdd) and no Scaling")
        q, qd, qdd = samples
        return arrays.states(q, qd, qdd, self.nq, self.n)[:3]

    def scale(
        self,
        model: Model = "h",
        *,
        seed: SupportsIndex = 0,
        rows: SupportsIndex | None = None,
        target: float | None = None,
        starts: SupportsIndex | None = None,
        rounds: SupportsIndex | None = None,
        weights: tuple[float, float] | None = None,
    ) -> Scaling:
        """Search for samples that show all parameters evenly (Gautier 1991, "Scaling of W").

        Parameters
        ----------
        model : {"h", "d", "d0"}
            The model whose observation matrix W is scaled.
        seed : int
            Names the random starts.
        rows : int
            Rows of W; by default c, as in the paper, and at least 24 samples of d and d0.
        target : float
            The S = max |W_ij| / min |W_ij| to stop at; by default 100.
        starts : int
            Random states that compete to start a search.
        rounds : int
            How often, on average, a piece of W is searched again while the target is missed.
        weights : (float, float)
            l1 and l2 of the criterion J = l1 ||W||_F + l2 S.

        Returns
        -------
        Scaling
            Its samples can be given to `base_parameters`.

        Raises
        ------
        OptionError
            An option is not usable.

        Examples
        --------
        >>> import roberval as rv
        >>> puma = rv.load("puma560")
        >>> scaling = puma.scale("h")
        >>> scaling.after.s < 200 < scaling.before.s
        True
        >>> puma.base_parameters("h", samples=scaling).rank
        40
        """
        asked = scaling_options(model, seed, rows, target, starts, rounds, weights)
        return Scaling._of(model, self._labels, self._inner.scale(asked))

    def compare(
        self,
        *,
        choice: Choice | None = None,
        keep: Sequence[str] = (),
        drop: Sequence[str] = (),
        tolerance: float | str | None = None,
        seed: SupportsIndex = 0,
    ) -> Comparison:
        """Run all models by all engines and tell whether they agree.

        Parameters are those of `base_parameters`.

        Returns
        -------
        Comparison

        Examples
        --------
        >>> import roberval as rv
        >>> rv.load("puma560").compare().agree
        True
        """
        asked = options(choice=choice, keep=keep, drop=drop, tolerance=tolerance, seed=seed)
        return Comparison._of(self, asked, self._inner.compare(asked))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Robot):
            return NotImplemented
        return self._inner.same(other._inner)

    def __hash__(self) -> int:
        return hash((self.name, self._labels))

    def __reduce__(self) -> tuple[Any, ...]:
        return _restore, (*self._inner.state(), self._reading)

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


def _restore(format: str, text: str, name: str, asked: Reading) -> Robot:
    """Return a robot from its pickled state."""
    read = _core.Robot.from_urdf if format == "urdf" else _core.Robot.from_toml
    return Robot._quietly(read(text, name, asked), asked)
