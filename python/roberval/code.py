"""Generated code, and the reduced regressor compiled from it."""

from __future__ import annotations

import ctypes
import os
import shutil
import subprocess
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from . import _core, arrays, files
from .arrays import Array
from .errors import ArrayError

if TYPE_CHECKING:
    from .base import BaseParameters

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
    """The links whose joint variables it takes."""
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

    @classmethod
    def _of(
        cls, core: _core.Answer, language: str, what: str, *, standard: bool, friction: bool
    ) -> Code:
        text, function, joints, parameters, shape, count, once, loops = core.code(
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

    def __init__(self, base: BaseParameters) -> None:
        self._base = base
        code = base.code("c", "energy" if base.model == "h" else "regressor")
        self._shape = code.shape
        self._call = _machine_code(code)

    @property
    def compiled(self) -> bool:
        """Whether a C compiler was found; without one the package's own kernels work."""
        return self._call is not None

    def __call__(
        self,
        q: npt.ArrayLike,
        qd: npt.ArrayLike | None = None,
        qdd: npt.ArrayLike | None = None,
        *,
        out: Array | None = None,
    ) -> Array:
        """Evaluate the reduced model; arguments and result of `BaseParameters.regressor`."""
        base = self._base
        if self._call is None:
            return base.regressor(q, qd, qdd, out=out)
        states = base.robot._states(base.model, q, qd, qdd)
        out = arrays.output(out, (*states.lead, *self._shape))
        used = [states.q, np.zeros_like(states.q) if base.model == "d0" else states.qd]
        if base.model != "h":
            used.append(states.qdd)
        for name, array in zip(("q", "qd", "qdd"), used, strict=False):
            if not np.isfinite(array).all():
                raise ArrayError(f"{name} has numbers that are not finite")
        pointers = [array.ctypes.data_as(ctypes.c_void_p) for array in (*used, out)]
        self._call(len(states.q), *pointers)
        return out


def _machine_code(code: Code) -> Callable[..., None] | None:
    """Compile a loop over states around the code; None without a compiler that works."""
    compiler = os.environ.get("CC") or next(filter(shutil.which, ("cc", "gcc", "clang")), None)
    if code.loops or not compiler or os.name != "posix":
        return None
    states = ["q", "qd"] if code.what == "energy" else ["q", "qd", "qdd"]
    with tempfile.TemporaryDirectory(prefix="roberval-") as folder:
        source, library = Path(folder, "code.c"), Path(folder, "code.so")
        source.write_text(code.text + _loop(code, states))
        command = [*compiler.split(), *FLAGS, "-o", str(library), str(source), "-lm"]
        try:
            subprocess.run(command, check=True, capture_output=True)
            # The file may go once it is loaded.
            loaded = ctypes.CDLL(str(library))
        except (OSError, subprocess.CalledProcessError):
            return None
    call = loaded.roberval_states
    call.argtypes = [ctypes.c_long] + [ctypes.c_void_p] * (len(states) + 1)
    call.restype = None
    result: Callable[..., None] = call
    return result


def _loop(code: Code, states: list[str]) -> str:
    size = int(np.prod(code.shape))
    parameters = ", ".join(f"const double *{name}" for name in states)
    return f"""
void roberval_states(long count, {parameters}, double *out)
{{
    for (long i = 0; i < count; i++) {{
        {code.function}({", ".join(states)}, out);
        {" ".join(f"{name} += {len(code.joints)};" for name in states)}
        out += {size};
    }}
}}
"""
