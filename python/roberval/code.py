"""Generated code, and the reduced regressor compiled from it."""

from __future__ import annotations

import ctypes
import os
import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from . import _core, arrays, files
from .arrays import Array
from .errors import RobervalError

if TYPE_CHECKING:
    from .base import BaseParameters

TRIAL_STATES, TRIAL_ROUNDS = 100, 20
"""What `Compiled` is timed on when it is made: a millisecond."""

QUATERNION_ROUNDING = 1e-2
"""How far a quaternion's length may be from 1, as in the package's own kernels."""

FLAGS = ("-std=c99", "-O2", "-ffp-contract=off", "-fPIC", "-shared")


@dataclass(frozen=True)
class Count:
    """Operations of code."""

    mul: int
    """Multiplications."""
    add: int
    """Additions and subtractions."""
    trig: int
    """Sines and cosines."""


@dataclass(frozen=True)
class Code:
    """Straight-line code of one model of a robot. ``str(code)`` is its text."""

    text: str
    """The text of a file."""
    language: str
    """c, rust, python or matlab."""
    what: str
    """tau, regressor, energy, gravity or mass."""
    function: str
    """The function's name."""
    joints: tuple[str, ...]
    """The links whose joint variables it takes; those of a floating base come before them."""
    parameters: tuple[str, ...]
    """The parameters it takes, or whose columns it gives."""
    shape: tuple[int, ...]
    """The shape of the result at one state."""
    count: Count
    """Operations at every state."""
    count_once: Count
    """Operations done once for a set of parameters."""
    loops: bool
    """Whether it takes the state of all joints and G, because loops relate them."""
    widths: tuple[int, int]
    """How many numbers q has at a state, and qd and qdd: 7 and 6 more than joints for a base that
    floats."""

    @classmethod
    def _of(
        cls, core: _core.Answer, language: str, what: str, *, standard: bool, friction: bool
    ) -> Code:
        text, function, joints, parameters, shape, count, once, loops, widths = core.code(
            language, what, standard, friction
        )
        return cls(
            text,
            language,
            what,
            function,
            tuple(joints),
            tuple(parameters),
            tuple(shape),
            Count(*count),
            Count(*once),
            loops,
            widths,
        )

    def __str__(self) -> str:
        return self.text

    def write(self, path: str | os.PathLike[str]) -> Path:
        """Write the code to a file; one that exists is replaced."""
        return files.write(path, self.text)


class Compiled:
    """The reduced regressor of one robot as machine code: call it like `BaseParameters.regressor`.

    Made by `BaseParameters.compile`.
    """

    __slots__ = ("_base", "_call", "_shape")

    def __init__(self, base: BaseParameters, *, compiler: bool | None) -> None:
        self._base = base
        self._call = None
        self._shape: tuple[int, ...] = ()
        if compiler is not False:
            code = base.code("c", "energy" if base.model == "h" else "regressor")
            self._shape = code.shape
            # Couples by expressions may have no value, as a root of a negative number.
            may_fail = any(couple.expression for couple in base.robot.couples)
            self._call = _machine_code(code, may_fail=may_fail)
        if compiler is None and self._call is not None and not self._is_faster():
            self._call = None

    @property
    def compiled(self) -> bool:
        """Whether machine code from a C compiler works, or else the package's own kernels."""
        return self._call is not None

    def _is_faster(self) -> bool:
        """Whether the machine code beats the kernels on a few states, best of some rounds."""
        robot = self._base.robot
        states = [np.full((TRIAL_STATES, width), 0.1) for width in (robot.nq, robot.n, robot.n)]
        if robot.is_floating:
            states[0][:, 3:7] = 0.5
        try:
            return _seconds(self, states) < _seconds(self._base.regressor, states)
        except RobervalError:  # couples without a value there
            return False

    def __call__(
        self,
        q: npt.ArrayLike,
        qd: npt.ArrayLike | None = None,
        qdd: npt.ArrayLike | None = None,
        *,
        out: Array | None = None,
        threads: int | None = None,
    ) -> Array:
        """Evaluate the reduced model; arguments and result of `BaseParameters.regressor`.

        Machine code runs on one thread, whatever `threads` allows.
        """
        base = self._base
        if self._call is None:
            return base.regressor(q, qd, qdd, out=out, threads=threads)
        arrays.thread_count(threads)
        states = base.robot._states(base.model, q, qd, qdd)
        out = arrays.output(out, (*states.lead, *self._shape))
        used = [states.q, np.zeros_like(states.qd) if base.model == "d0" else states.qd]
        if base.model != "h":
            used.append(states.qdd)
        pointers = [array.__array_interface__["data"][0] for array in (*used, out)]
        if not self._call(len(states.q), *pointers):
            return base.regressor(q, qd, qdd, out=out, threads=threads)  # says what is wrong
        return out


def _seconds(work: Callable[..., Array], states: list[Array]) -> float:
    """Return the time of the fastest call."""
    out = work(*states)
    times = []
    for _ in range(TRIAL_ROUNDS):
        start = time.perf_counter()
        work(*states, out=out)
        times.append(time.perf_counter() - start)
    return min(times)


def _machine_code(code: Code, *, may_fail: bool) -> Callable[..., int] | None:
    """Compile a loop over states around the code; None without a compiler that works."""
    compiler = os.environ.get("CC") or next(filter(shutil.which, ("cc", "gcc", "clang")), None)
    if code.loops or not compiler or os.name != "posix":
        return None
    states = ["q", "qd"] if code.what == "energy" else ["q", "qd", "qdd"]
    with tempfile.TemporaryDirectory(prefix="roberval-") as folder:
        source, library = Path(folder, "code.c"), Path(folder, "code.so")
        source.write_text(code.text + _loop(code, states, may_fail=may_fail))
        command = [*compiler.split(), *FLAGS, "-o", str(library), str(source), "-lm"]
        try:
            subprocess.run(command, check=True, capture_output=True)
            # The file may go once it is loaded.
            loaded = ctypes.CDLL(str(library))
        except (OSError, subprocess.CalledProcessError):
            return None
    call = loaded.roberval_states
    call.argtypes = [ctypes.c_long] + [ctypes.c_void_p] * (len(states) + 1)
    call.restype = ctypes.c_int
    result: Callable[..., int] = call
    return result


def _loop(code: Code, states: list[str], *, may_fail: bool) -> str:
    """Write a loop over states in C that gives 0 where the kernels would refuse one."""
    size = int(np.prod(code.shape))
    parameters = ", ".join(f"const double *{name}" for name in states)
    positions, velocities = code.widths
    widths = [positions if name == "q" else velocities for name in states]
    checks = [
        f"for (int j = 0; j < {width}; j++) good &= isfinite({name}[j]) != 0;"
        for name, width in zip(states, widths, strict=True)
    ]
    if positions > velocities:
        square = " + ".join(f"q[{j}] * q[{j}]" for j in range(3, 7))
        checks.append(f"good &= fabs(sqrt({square}) - 1.0) <= {QUATERNION_ROUNDING};")
    steps = [f"{name} += {width};" for name, width in zip(states, widths, strict=True)]
    results = f"for (int j = 0; j < {size}; j++) good &= isfinite(out[j]) != 0;"
    newline = "\n        "
    return f"""
int roberval_states(long count, {parameters}, double *out)
{{
    int good = 1;
    for (long i = 0; i < count; i++) {{
        {newline.join(checks)}
        {code.function}({", ".join(states)}, out);
        {results if may_fail else ""}
        {" ".join(steps)}
        out += {size};
    }}
    return good;
}}
"""
