"""Checkpoints of reductions: of which files they are, and whose they are now."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from hashlib import blake2b
from pathlib import Path

from .base import BaseParameters
from .errors import CheckpointError
from .reduction import Inputs, ObservationQR
from .robot import Robot

WHOLE = 1 << 28
"""Files of no more bytes are digested whole: a quarter of a second."""

PIECE = 1 << 20
"""Bytes read at a time."""

END = 1 << 16
"""Bytes of a larger file's beginning and end that are: there ZIP has a CRC of each array, Parquet
its footer."""

BLOCKS, BLOCK = 64, 1 << 12
"""How many blocks between them are, and their bytes."""

DIGEST = 32
"""Digits of a digest."""


def identity(path: Path, weights: str) -> tuple[str, int]:
    """Return what tells a file from others, a digest and the name, and its size.

    The digest is of the file's ends and of blocks between, some milliseconds' work, and of the
    weights: with others a checkpoint has another R.
    """
    if not path.is_file():
        raise CheckpointError(
            f"{path}: a checkpoint is of regular files, which can be read again, and this is none"
        )
    size = path.stat().st_size
    digest = blake2b(weights.encode(), digest_size=DIGEST // 2)
    with path.open("rb") as file:
        if size <= WHOLE:
            while piece := file.read(PIECE):
                digest.update(piece)
        else:
            digest.update(file.read(END))
            for block in range(BLOCKS):
                file.seek(END + (size - 2 * END) * block // BLOCKS)
                digest.update(file.read(BLOCK))
            file.seek(size - END)
            digest.update(file.read())
    return f"{digest.hexdigest()} {path.name}", size


def resumed(
    checkpoint: Path,
    fresh: ObservationQR,
    model: Robot | BaseParameters,
    inputs: Inputs,
    threads: int | None,
) -> ObservationQR:
    """Return the accumulator of a checkpoint if it is of the same columns and files."""
    qr, begun = ObservationQR._load_with_inputs(checkpoint, model, threads)
    if qr.columns != fresh.columns:
        counts = f"{len(qr.columns)} columns, not the {len(fresh.columns)}"
        raise CheckpointError(f"{checkpoint} has {counts} asked for: --base and --friction differ")
    if begun is None:
        raise CheckpointError(
            f"{checkpoint} was saved by ObservationQR.save, which does not know of which files: "
            "go on from it in Python (ObservationQR.load), or give another --checkpoint"
        )
    for place, seen in enumerate(begun):
        given = inputs[place] if place < len(inputs) else None
        if seen != given:
            raise CheckpointError(f"{checkpoint} {other(place + 1, seen, given)}")
    return qr


def other(number: int, seen: tuple[str, int], given: tuple[str, int] | None) -> str:
    """Return in words that a checkpoint's file is not the one given."""
    digest, _, name = seen[0].partition(" ")
    if len(digest) != DIGEST:
        return "is of an earlier version, which did not look into the files: begin another"
    was = f"was saved from other files: number {number} was {name} of {seen[1]} bytes, and is "
    right = "; give the same, or another --checkpoint"
    if given is None:
        return f"{was}none{right}"
    given_name = given[0].partition(" ")[2]
    if (given_name, given[1]) == (name, seen[1]):
        return f"{was}one of the same name and size with other content, or --weights{right}"
    return f"{was}{given_name} of {given[1]} bytes{right}"


@contextmanager
def alone(checkpoint: Path) -> Iterator[None]:
    """Hold a checkpoint against other processes; the system lets go of it when this one dies."""
    if sys.platform == "win32":
        yield
        return
    import fcntl

    lock = checkpoint.resolve().with_name(f".{checkpoint.resolve().name}.lock")
    while True:
        file = os.open(lock, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o666)
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            holder = os.pread(file, 20, 0).decode("ascii", "replace").strip() or "unknown"
            os.close(file)
            raise CheckpointError(f"{checkpoint} is in use by process {holder}") from None
        # Whoever held it before may have removed the file that is locked now.
        with suppress(FileNotFoundError):
            if os.path.samestat(os.fstat(file), lock.stat()):
                break
        os.close(file)
    try:
        os.truncate(file, 0)
        os.pwrite(file, str(os.getpid()).encode(), 0)
        yield
    finally:
        lock.unlink(missing_ok=True)
        os.close(file)


def distinct(output: Path | None, checkpoint: Path | None, inputs: Sequence[Path]) -> str | None:
    """Return in words which file would be overwritten that is needed, if one would be."""
    for option, target in (("-o", output), ("--checkpoint", checkpoint)):
        for path in inputs:
            if target is not None and same(target, path):
                return f"{option} {target} is {path}, which is read: it would be lost"
    if output is not None and checkpoint is not None and same(output, checkpoint):
        return f"-o {output} is the checkpoint, too: give another file"
    return None


def same(one: Path, two: Path) -> bool:
    """Tell whether two paths are of one file."""
    try:
        return one.samefile(two)
    except OSError:
        return one.resolve() == two.resolve()
