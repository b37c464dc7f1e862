"""Robots: load or build one, find its base parameters."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, SupportsIndex

import numpy.typing as npt

from . import _core, arrays, mdh
from .arrays import Array
from .base import BaseParameters, analyse
from .comparison import Comparison
from .description import Link
from .errors import OptionError, RobotWarning
from .models import Models
from .options import Choice, Engine, Model, Number, Reading, Snap, options, reading
from .scaling import Scaling, scaling_options
from .symbolic import SymbolicRelations

if TYPE_CHECKING:
    from .importers import Text


class Robot(Models):
    """A robot: links and joints, a chain, a tree or with loops. Immutable.

    Make one with `load` or with `Robot.from_mdh`, `from_toml`, `from_urdf`, `from_mujoco` or
    `from_pinocchio`.

    The inertial parameters are linear in the models: ``tau = d(q, qd, qdd) @ X``. X holds
    for each link the paper's eleven (Gautier 1991, eq. (3)), or ten where the joint has no
    rotor::

        XX XY XZ YY YZ ZZ  kg m^2, about the origin of the link's frame and in that frame
        MX MY MZ           kg m, first moments
        M                  kg
        Ia                 kg m^2 (prismatic: kg), rotor inertia seen from the joint's side
    """

    __slots__ = ("_reading",)

    _reading: Reading

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
        hinges; a free joint makes a base that floats if all others are on it and no loop is
        closed on the world. Equality constraints of two joints become couples; what is not
        applied is warned of. Joint variables are 0 where the model has ``qpos0``.

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

        Links have the frames of the joints, and the names of the bodies there. Pinocchio takes
        the mimic joints of a URDF for free ones unless it is asked:
        ``pinocchio.buildModelFromUrdf(path, mimic=True)``.

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
        core = make(read.text, "imported model", asked)
        for warning in core.warnings:
            warnings.warn(f"{core.name}: {warning}", RobotWarning, stacklevel=3)
        return cls._quietly(core, asked)

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
            Elimination modulo primes, which needs no tolerance (the default; where prime
            fields do not hold a loop or an expression it becomes precise, and says why);
            the same in high-precision floats; QR without
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
            There is no doubt, but the file as written has another number of base parameters, or
            numbers that look like roundings (1.57, 3.14) were left as written.

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

    def closed_form_rules(self, *, name_lengths: bool = False) -> SymbolicRelations:
        """Return what the closed-form rules of Gautier and Khalil alone say, in symbols.

        They need no regressor. On most chains and trees they leave the base parameters; what
        the numerical method still removes of what they leave is `SymbolicRelations.left_over`.

        Parameters
        ----------
        name_lengths : bool
            Give names to all lengths that have none.

        Examples
        --------
        >>> import roberval as rv
        >>> rules = rv.load("puma560").closed_form_rules()
        >>> rules.rank, rules.left_over
        (40, ())
        >>> rules.made_by["XX_6"]
        ("rule: mass along a revolute joint's axis",)
        """
        return SymbolicRelations._of(self._inner.rules(name_lengths))

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


def _restore(format: str, text: str, name: str, asked: Reading) -> Robot:
    """Return a robot from its pickled state."""
    read = _core.Robot.from_urdf if format == "urdf" else _core.Robot.from_toml
    return Robot._quietly(read(text, name, asked), asked)
