"""Base parameters: the answer of an analysis, to look at and to use."""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from . import _core, arrays, excel, files, rendering
from .arrays import Array
from .code import Code, Compiled
from .diagnosis import Diagnosis
from .errors import DoubtfulRankWarning, MissingPackageError, OptionError, RobotWarning
from .exact import Exact, coefficient
from .options import Options
from .plots import BasePlots
from .relations import Relations
from .rendering import Rendered
from .symbolic import SymbolicRelations

if TYPE_CHECKING:
    import pandas
    import polars

    from .robot import Robot


CLASSES = {
    "no effect": "rgba(128, 128, 128, 0.1)",
    "unchanged": "rgba(64, 160, 64, 0.35)",
    "regrouped into": "rgba(48, 112, 224, 0.35)",
    "regrouped": "rgba(224, 144, 32, 0.35)",
}
"""The classes of parameters and the colours that notebooks show them in."""


class BaseParameters(Rendered):
    """The base inertial parameters of a robot (Gautier 1991). Immutable.

    The C standard parameters divide into `no_effect`, `base` (X1) and `regrouped` (X2); the
    base parameters into `unchanged` and `regrouped_into`. With W1 and W2 the columns of the
    kept and the regrouped ones::

        W2 = W1 beta          eq. (17)
        XB1 = X1 + beta X2    eq. (20)
        tau = d1 XB1

    Made by `Robot.base_parameters`.
    """

    __slots__ = ("_beta", "_columns_ready", "_options", "_robot", "_samples")

    _inner: _core.Answer
    _robot: Robot
    _options: Options
    _samples: tuple[Array, Array, Array] | None
    _beta: Array
    _columns_ready: tuple[_core.Columns, int] | None

    def __init__(self) -> None:
        raise TypeError("make BaseParameters with Robot.base_parameters")

    @classmethod
    def _of(
        cls,
        robot: Robot,
        options: Options,
        core: _core.Answer,
        samples: tuple[Array, Array, Array] | None = None,
    ) -> BaseParameters:
        answer = object.__new__(cls)
        answer._inner = core
        answer._robot = robot
        answer._options = options
        answer._samples = samples
        answer._columns_ready = None
        answer._beta = core.beta()
        answer._beta.flags.writeable = False
        return answer

    def _warn(self) -> None:
        """Warn of doubt, of a file that as written has another number, and of near misses."""
        literal = self._inner.literal
        told = [
            (DoubtfulRankWarning, self._inner.messages, not self._inner.clear),
            (
                RobotWarning,
                self._inner.messages,
                # The last digits of doubles are nobody's fault: they are told, not warned of.
                self._inner.clear and literal is not None and literal[0][1] != self.rank,
            ),
            (RobotWarning, self._inner.warnings, bool(self._inner.warnings)),
        ]
        for category, texts, wanted in told:
            if wanted:
                text = "; ".join(texts)
                warnings.warn(f"{self._robot.name}: {text}", category, stacklevel=3)

    def _labels(self, columns: list[int]) -> tuple[str, ...]:
        labels = self._robot.parameters
        return tuple(labels[column] for column in columns)

    @property
    def robot(self) -> Robot:
        """The robot analysed."""
        return self._robot

    @property
    def model(self) -> str:
        """The model used: d, d0 or h."""
        return self._inner.model

    @property
    def engine(self) -> str:
        """The engine used."""
        return self._inner.engine

    @property
    def choice(self) -> str:
        """The rule by which the kept parameters were chosen."""
        return self._inner.choice

    @property
    def seed(self) -> int:
        """The seed of the random samples."""
        return self._inner.seed

    @property
    def rows(self) -> int:
        """Rows r of the observation matrix W."""
        return self._inner.rows

    @property
    def rank(self) -> int:
        """Number of base parameters b."""
        return len(self._inner.base)

    @property
    def parameters(self) -> tuple[str, ...]:
        """Labels of the C standard parameters."""
        return self._robot.parameters

    @property
    def no_effect(self) -> tuple[str, ...]:
        """Parameters without effect on the robot's motion."""
        return self._labels(self._inner.no_effect)

    @property
    def base(self) -> tuple[str, ...]:
        """The b kept parameters X1."""
        return self._labels(self._inner.base)

    @property
    def regrouped(self) -> tuple[str, ...]:
        """The parameters X2 that are regrouped onto the kept ones."""
        return self._labels(self._inner.regrouped)

    @property
    def unchanged(self) -> tuple[str, ...]:
        """Base parameters that stay as they are."""
        return self._labels(self._inner.unchanged)

    @property
    def regrouped_into(self) -> tuple[str, ...]:
        """Base parameters that others regroup into."""
        return self._labels(self._inner.regrouped_into)

    @property
    def beta(self) -> Array:
        """The regrouping coefficients, shape (b, len(regrouped)), read-only."""
        return self._beta

    @property
    def beta_exact(self) -> dict[str, dict[str, Exact]] | None:
        """The nonzero entries of beta without rounding: base label -> {regrouped label: number}.

        Fractions where the geometry is rational; sums with square roots; floats, correctly
        rounded, where there is no such form. None from the float engines.
        """
        rows = self._inner.beta_exact
        if rows is None:
            return None
        regrouped = self.regrouped
        beta = {}
        for label, row in zip(self.base, rows, strict=True):
            numbers = zip(regrouped, map(coefficient, row), strict=True)
            terms = {other: number for other, number in numbers if number != 0}
            if terms:
                beta[label] = terms
        return beta

    @property
    def relations(self) -> Relations:
        """Each base parameter as a sum: label -> {label: coefficient}, itself included."""
        regrouped = self.regrouped
        relations = {}
        for label, row in zip(self.base, self._beta.tolist(), strict=True):
            terms = {r: beta for r, beta in zip(regrouped, row, strict=True) if beta != 0}
            relations[label] = {label: 1.0, **terms}
        return Relations(relations, self._inner.relations)

    @property
    def classes(self) -> dict[str, str]:
        """The class of each parameter: no effect, unchanged, regrouped into or regrouped."""
        members = (self.no_effect, self.unchanged, self.regrouped_into, self.regrouped)
        of = {
            label: name for name, labels in zip(CLASSES, members, strict=True) for label in labels
        }
        return {label: of[label] for label in self.parameters}

    @property
    def diagnosis(self) -> Diagnosis:
        """How sure the rank is."""
        return Diagnosis._of(self._inner, self._robot.parameters)

    def values(self, X: npt.ArrayLike | Mapping[str, float] | None = None) -> Array:
        """Return the base parameters of standard ones: XB1 = X1 + beta X2 (Gautier 1991, eq. (20)).

        Parameters
        ----------
        X : array_like of shape (C,), or mapping from labels to values
            Standard parameters (a dict or pandas Series may leave some out: zero); by
            default those of the robot file.

        Returns
        -------
        ndarray, shape (b,)
            In the order of `base`.

        Raises
        ------
        ShapeError, ArrayError, UnknownParameterError
            X is not usable.
        """
        return self.regrouped_values(X)

    def regrouped_values(
        self,
        X: npt.ArrayLike | Mapping[str, float] | None = None,
        XR2: npt.ArrayLike | Mapping[str, float] | None = None,
    ) -> Array:
        """Another member of the family: XR1 = X1 + beta (X2 - XR2) (Gautier 1991, eq. (19)).

        Parameters
        ----------
        X : array_like of shape (C,), or mapping
            Standard parameters, as in `values`.
        XR2 : array_like of shape (len(regrouped),), or mapping
            What the regrouped parameters shall be; zero by default.

        Returns
        -------
        ndarray, shape (b,)
            The kept parameters that give, with XR2, the torques of X.
        """
        x = self._robot._standard_parameters(X)
        regrouped = self.regrouped
        xr2 = arrays.vector("XR2", {} if XR2 is None else XR2, regrouped)
        return self._inner.regrouped_values(x, xr2)

    def minimum_norm(self, X: npt.ArrayLike | Mapping[str, float] | None = None) -> Array:
        """Return the member of smallest norm: XM = V1 V1' X.

        Parameters
        ----------
        X : array_like of shape (C,), or mapping
            Standard parameters, as in `values`.

        Returns
        -------
        ndarray, shape (C,)
            Standard parameters that give the torques of X; zero where without effect.
        """
        return self._inner.minimum_norm(self._robot._standard_parameters(X))

    def regressor(
        self,
        q: npt.ArrayLike,
        qd: npt.ArrayLike | None = None,
        qdd: npt.ArrayLike | None = None,
        *,
        out: Array | None = None,
        threads: int | None = None,
        keep_zeros: bool = False,
    ) -> Array:
        """Evaluate the reduced model d1 (d0, h1: the model of the analysis).

        ``tau = base.regressor(q, qd, qdd) @ base.values(X)``. Arguments are those of
        `Robot.regressor`.

        Returns
        -------
        ndarray, shape (N, m, b)
            For h (N, b); for one state without the N.
        """
        if self._columns_ready is None:
            columns = self._robot._inner.columns(self.model, self._inner.base)
            self._columns_ready = (columns, self.rank)
        ready = self._columns_ready
        return self._robot._rows(self.model, ready, q, qd, qdd, out, threads, keep_zeros)

    def certificate(self) -> dict[str, Any]:
        """Return what was decided and how, for a checker that shares nothing with roberval.

        The content of the file that `save_certificate` writes.

        Raises
        ------
        OptionError
            A float engine decided.
        NumericalError
            A coefficient without an exact form is not known well enough.
        """
        content: dict[str, Any] = json.loads(self._inner.certificate())
        return content

    def save_certificate(self, path: str | os.PathLike[str]) -> None:
        """Write the certificate, which ``python -m roberval.check_certificate`` checks.

        The file is written as a whole or not at all.

        Raises
        ------
        OptionError, NumericalError
            As `certificate`.
        OSError
            The file cannot be written.
        """
        files.write(path, self._inner.certificate())

    def relations_symbolic(self, *, name_lengths: bool = False) -> SymbolicRelations:
        """Return the relations in symbols, verified at random values of them.

        Named constants of the robot's file stay symbols; where it has none, all lengths get
        names such as d3, r4 (from a URDF x3, y3, z3). Constant angles that are not right
        enter by their cosines and sines.

        Parameters
        ----------
        name_lengths : bool
            Give names to all lengths that have none.
        """
        return SymbolicRelations._of(self._inner.symbolic(name_lengths))

    def code(
        self,
        language: str = "c",
        what: str = "tau",
        *,
        parameters: str = "base",
        friction: bool = False,
    ) -> Code:
        """Return the reduced model as straight-line code, customised to the robot.

        Parameters
        ----------
        language : {"c", "rust", "python", "matlab"}
            C99, Rust without std, NumPy over any number of samples, MATLAB or Octave.
        what : {"tau", "regressor", "energy", "gravity", "mass"}
            Inverse dynamics tau(q, qd, qdd), the reduced regressor d1, the energy row h1,
            torques of gravity, mass matrix.
        parameters : {"base", "standard"}
            What the code takes as parameters.
        friction : bool
            Add ``Fv qd + Fc sign(qd)`` to tau, with two parameters more a joint.
        """
        if parameters not in ("base", "standard"):
            raise OptionError(f"parameters is {parameters!r}, expected 'base' or 'standard'")
        standard = parameters == "standard"
        return Code._of(self._inner, language, what, standard=standard, friction=friction)

    def compile(self, *, compiler: bool | None = None) -> Compiled:
        """Return a fast callable with the signature of `regressor`.

        Generated C is compiled where a C compiler is found; the package's own kernels do the
        work where there is none, where cut loops relate joints, and where they are faster: they
        are for arms, over lanes of samples, as fast as results can be written. Machine code wins
        where couples relate joints.

        Parameters
        ----------
        compiler : bool, optional
            True for machine code wherever there can be, False for the kernels; by default
            both are timed for a millisecond (results differ by rounding).
        """
        return Compiled(self, compiler=compiler)

    def to_html(self) -> str:
        """Return the report as the text of one HTML page; see `report`."""
        return self._inner.report()

    def report(self, path: str | os.PathLike[str]) -> Path:
        """Write a report to look at: one HTML page, offline, for a screen, a phone or paper.

        Parameters
        ----------
        path : str or path
            The file to write; one that exists is replaced.

        Returns
        -------
        Path
            The file, absolute.
        """
        return files.write(path, self._inner.report())

    def _columns(self) -> dict[str, list[Any]]:
        """Return the parameters as columns; None where there is no value."""
        known = self._robot.inertial_values
        values = dict(zip(self.base, self.values(), strict=True)) if known else {}
        relation = dict(zip(self.regrouped_into, self.relations.text, strict=True))
        labels = list(self.parameters)
        return {
            "parameter": labels,
            "kind": [label.split("_", 1)[0] for label in labels],
            "link": [label.split("_", 1)[1] for label in labels],
            "class": list(self.classes.values()),
            "X": [known.get(label) for label in labels],
            "XB": [float(values[label]) if label in values else None for label in labels],
            "relation": [relation.get(label, "") for label in labels],
        }

    def to_frame(self) -> pandas.DataFrame:
        """Return a pandas DataFrame with one row for each standard parameter.

        Columns: ``kind``, ``link``, ``class``; ``X`` and ``XB``, NaN where there is none;
        ``relation``, empty where trivial.

        Raises
        ------
        MissingPackageError
            pandas is not installed.
        """
        try:
            import pandas
        except ImportError:
            raise MissingPackageError("to_frame needs pandas: pip install pandas") from None
        columns = self._columns()
        index = pandas.Index(columns.pop("parameter"), name="parameter")
        for name in ("X", "XB"):
            columns[name] = [np.nan if x is None else x for x in columns[name]]
        return pandas.DataFrame(columns, index=index)

    def to_polars(self) -> polars.DataFrame:
        """Return a polars DataFrame: the columns of `to_frame`, ``parameter`` first.

        Raises
        ------
        MissingPackageError
            polars is not installed.
        """
        try:
            import polars
        except ImportError:
            raise MissingPackageError("to_polars needs polars: pip install polars") from None
        return polars.DataFrame(
            self._columns(), schema_overrides={"X": polars.Float64, "XB": polars.Float64}
        )

    def to_excel(self, path: str | os.PathLike[str]) -> Path:
        """Write an Excel workbook: the parameters, and beta. No text becomes a formula.

        Parameters
        ----------
        path : str or path
            The file to write; one that exists is replaced.

        Returns
        -------
        Path
            The file, absolute.

        Raises
        ------
        MissingPackageError
            Neither xlsxwriter nor openpyxl is installed.
        """
        columns = self._columns()
        parameters = [list(columns), *map(list, zip(*columns.values(), strict=True))]
        beta = [["", *self.regrouped]]
        beta += [[label, *row] for label, row in zip(self.base, self._beta.tolist(), strict=True)]
        return files.write(path, excel.workbook({"parameters": parameters, "beta": beta}))

    @property
    def plot(self) -> BasePlots:
        """Plots with matplotlib: ``spectrum``, ``classification``, ``beta`` and ``tree``."""
        return BasePlots(self)

    def _repr_html_(self) -> str:
        classes = self.classes
        kinds = ("XX", "XY", "XZ", "YY", "YZ", "ZZ", "MX", "MY", "MZ", "M", "Ia")
        grid = rendering.grid(
            ["link", *kinds],
            (
                [link.name, *(classes.get(f"{kind}_{link.name}", "") for kind in kinds)]
                for link in self._robot.links
            ),
            CLASSES,
        )
        doubts = "".join(rendering.paragraph(message) for message in self.diagnosis.messages)
        relations = rendering.lines(self.relations.text)
        return rendering.paragraph(repr(self)) + doubts + grid + relations

    def __reduce__(self) -> tuple[Any, ...]:
        # The same options give the same answer: cheaper to find again than to store.
        return analyse, (self._robot, self._options, self._samples)

    def __repr__(self) -> str:
        doubt = "" if self._inner.clear else ", doubtful"
        return (
            f"BaseParameters({self._robot.name!r}, model {self.model}, engine {self.engine}: "
            f"{len(self.parameters)} parameters, {len(self.no_effect)} without effect, "
            f"{self.rank} base, {len(self.regrouped)} regrouped{doubt})"
        )


def analyse(
    robot: Robot, options: Options, samples: tuple[Array, Array, Array] | None = None
) -> BaseParameters:
    """Find the base parameters of a robot with these options, at random samples or at those."""
    core = robot._inner.base_parameters(options, *(samples or ()))
    return BaseParameters._of(robot, options, core, samples)
