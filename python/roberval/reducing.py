"""`roberval reduce ROBOT FILES -o R.npz`: in Python, because Parquet is read by pyarrow."""

from __future__ import annotations

import errno
import os
import sys
import tempfile
import time
import warnings
from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import TypedDict

from . import _core, logs
from .arrays import Array, vector
from .base import BaseParameters
from .checkpoints import alone, distinct, identity, resumed
from .errors import (
    ArrayError,
    CheckpointError,
    DoubtfulRankWarning,
    OptionError,
    RobervalError,
    RobotWarning,
)
from .loading import load
from .options import Snap
from .progress import Progress
from .reduction import Inputs, ObservationQR
from .robot import Robot

SAVING = 0.05
"""The part of the time that may go into checkpoints."""

CLEAR, DOUBTFUL, BAD_INPUT = 0, 1, 2
"""Exit codes, as of other commands."""

INTERRUPTED = 130
"""The exit code after Ctrl-C, as a shell tells it."""

STDOUT = Path("-")
"""The output that is no file."""


class Asked(TypedDict):
    """The arguments of the command, as the core has read them."""

    robot: str
    samples: list[Path]
    output: Path
    base: bool
    friction: list[str]
    weights: list[float] | None
    weight_columns: bool
    threads: int | None
    checkpoint: Path | None
    quiet: bool
    keep_fixed: bool
    floating: bool
    rotors: bool
    snap: Snap
    gravity: list[str] | None


def command(arguments: Sequence[str]) -> int:
    """Run ``roberval reduce``; return the exit code."""
    try:
        asked = _core.reduce_arguments(["reduce", *arguments])
        return asked if isinstance(asked, int) else reduce(asked)
    except (RobervalError, OSError) as error:
        say("error", str(error))
        return BAD_INPUT
    except KeyboardInterrupt:
        print("roberval: interrupted", file=sys.stderr, flush=True)
        return INTERRUPTED


def say(what: str, message: str) -> None:
    """Tell the user one thing."""
    print(f"roberval: {what}: {message}", file=sys.stderr, flush=True)


def reduce(asked: Asked) -> int:
    """Reduce the files in their order, from the checkpoint on if there is one."""
    check_files(asked)
    model, code = read_robot(asked)
    checkpoint = asked["checkpoint"]
    with alone(checkpoint) if checkpoint else nullcontext():
        run = Reduction(asked, model)
        qr = run.run()
    write(qr, asked["output"])
    say("note", f"R of {len(qr.columns)} columns from {qr.samples} samples")
    return code


def check_files(asked: Asked) -> None:
    """Refuse files that cannot be read or written, before the work."""
    output = None if asked["output"] == STDOUT else asked["output"]
    robot_file = Path(asked["robot"])
    inputs = [*asked["samples"], *([robot_file] if robot_file.is_file() else [])]
    if fault := distinct(output, asked["checkpoint"], inputs):
        raise OptionError(fault)
    for target in (output, asked["checkpoint"]):
        if target is not None:
            writable(target)
    checkpoint = asked["checkpoint"]
    if checkpoint is not None and checkpoint.exists() and not checkpoint.is_file():
        raise CheckpointError(f"{checkpoint}: this is no regular file, which a checkpoint must be")
    for path in asked["samples"]:
        logs.reader_of(path)
        path.stat()


def writable(path: Path) -> None:
    """Raise an error if a file cannot be written, before the work that it is to hold."""
    folder = path.resolve().parent
    fault = None
    if not folder.is_dir():
        fault = errno.ENOTDIR if folder.exists() else errno.ENOENT
    elif path.is_dir():
        fault = errno.EISDIR
    elif not os.access(folder, os.W_OK) or (path.exists() and not path.stat().st_mode & 0o222):
        fault = errno.EACCES
    if fault is not None:
        raise OSError(fault, os.strerror(fault), str(path))


def read_robot(asked: Asked) -> tuple[Robot | BaseParameters, int]:
    """Return whose columns are asked for, and the exit code; say what is to be known of it."""
    with warnings.catch_warnings():
        # They are said below, as other commands do.
        warnings.simplefilter("ignore", RobotWarning)
        warnings.simplefilter("ignore", DoubtfulRankWarning)
        robot = load(
            asked["robot"],
            keep_fixed=asked["keep_fixed"],
            floating=asked["floating"],
            rotors=asked["rotors"],
            snap=asked["snap"],
            gravity=asked["gravity"],
        )
        base = robot.base_parameters() if asked["base"] else None
    for warning in robot._inner.warnings:
        say("warning", warning)
    if base is None:
        return robot, CLEAR
    for message in base.diagnosis.messages:
        say("doubt", message)
    return base, CLEAR if base.diagnosis.clear else DOUBTFUL


class Reduction:
    """One run of the command."""

    def __init__(self, asked: Asked, model: Robot | BaseParameters) -> None:
        self.files, self.checkpoint = asked["samples"], asked["checkpoint"]
        self.robot = model if isinstance(model, Robot) else model._robot
        self.weights: Array | None = None
        if asked["weights"] is not None:
            self.weights = vector("--weights", asked["weights"], self.robot.rows)
        self.in_columns = asked["weight_columns"]
        self.qr = ObservationQR(model, None, asked["friction"], asked["threads"])
        self.inputs: Inputs = []
        if self.checkpoint is not None:
            told = f"{asked['weights']} {asked['weight_columns']}"
            self.inputs = [identity(path, told) for path in self.files]
            if self.checkpoint.exists():
                self.qr = resumed(self.checkpoint, self.qr, model, self.inputs, asked["threads"])
        self.before = self.skip = self.qr.samples
        self.progress = Progress(len(self.files), self.before, not asked["quiet"])
        self.saved, self.pause = time.monotonic(), 0.0

    def run(self) -> ObservationQR:
        """Take in what the checkpoint has not."""
        with self.progress:
            for number, path in enumerate(self.files):
                for piece in logs.pieces(path, self.robot, self.in_columns, self.note):
                    if self.take(path, piece):
                        self.save(self.inputs[: number + 1], self.pause)
                        self.progress.draw(number + piece.part, self.qr.samples)
        if self.skip:
            raise CheckpointError(
                f"{self.checkpoint} has {self.before} samples and the files have "
                f"{self.before - self.skip}: it was saved from others; give these, or another "
                "--checkpoint"
            )
        self.save(self.inputs, 0.0)
        return self.qr

    def note(self, what: str) -> None:
        """Tell what the user should know of a file."""
        say("note", what)

    def take(self, path: Path, piece: logs.Piece) -> bool:
        """Take a piece in; tell whether the checkpoint did not have it whole."""
        count = len(piece.arrays[0])
        if self.skip >= count:
            self.skip -= count
            return False
        start, self.skip = self.skip, 0
        q, qd, qdd, tau, *w = [array[start:] for array in piece.arrays]
        try:
            self.qr.update(q, qd, qdd, tau, w[0] if w else self.weights)
        except ArrayError as error:
            where = logs.placed(error, piece.first + start)
            raise ArrayError(f"{path}: {where}") from None
        return True

    def save(self, begun: Inputs, pause: float) -> None:
        """Save the checkpoint if the last was long enough ago."""
        now = time.monotonic()
        if self.checkpoint is not None and now - self.saved >= pause:
            self.qr._save_with_inputs(self.checkpoint, begun)
            self.saved = time.monotonic()
            self.pause = (self.saved - now) / SAVING


def write(qr: ObservationQR, output: Path) -> None:
    """Write R to its file, or to the standard output."""
    if output != STDOUT:
        qr.save_factor(output)
        return
    if sys.stdout is None:
        raise OSError(errno.EBADF, os.strerror(errno.EBADF), "standard output")
    with tempfile.TemporaryDirectory(prefix="roberval-") as folder:
        written = Path(folder) / "R.npz"
        qr.save_factor(written)
        sys.stdout.buffer.write(written.read_bytes())
    sys.stdout.flush()
