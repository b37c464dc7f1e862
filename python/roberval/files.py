"""Files that are written as a whole or not at all."""

from __future__ import annotations

import errno
import os
import secrets
import stat
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

_DRAFT = ".roberval-"
"""What the names of drafts begin with."""

_ABANDONED = 3600.0
"""Seconds after which a draft is that of a killed process: others live for one writing."""


def write(path: str | os.PathLike[str], content: str | bytes) -> Path:
    """Write a file by way of a draft beside it; return its absolute path.

    A link stays a link, and what is no file (a device, a pipe) is written to.
    """
    target = Path(path).absolute()
    data = content.encode() if isinstance(content, str) else content
    with _naming(path):
        mode = _mode(target)
        if mode is None or stat.S_ISREG(mode):
            if mode is not None and not mode & 0o222:
                raise PermissionError(errno.EACCES, "the file is read-only")
            _replace(Path(os.path.realpath(target)), data, mode)
        else:
            with target.open("wb", buffering=0) as file:
                _write_all(file.fileno(), data)
    return target


def _mode(target: Path) -> int | None:
    """Return type and permissions of what is there, if anything is."""
    try:
        return target.stat().st_mode
    except FileNotFoundError:
        return None


def _replace(place: Path, data: bytes, mode: int | None) -> None:
    """Write a draft and give it the file's name."""
    _sweep(place.parent)
    # No other thread, process or machine has this name.
    draft = place.with_name(f"{_DRAFT}{os.getpid()}-{secrets.token_hex(8)}.tmp")
    try:
        with draft.open("xb", buffering=0) as file:
            _write_all(file.fileno(), data)
            os.fsync(file.fileno())
        if mode is not None:
            draft.chmod(mode & 0o777)
        draft.replace(place)
    except BaseException:
        # The first error is the one to tell.
        with suppress(OSError):
            draft.unlink()
        raise


def _write_all(file: int, data: bytes) -> None:
    rest = memoryview(data)
    while rest:
        rest = rest[os.write(file, rest) :]


def _sweep(folder: Path) -> None:
    """Remove the drafts of processes that were killed."""
    before = time.time() - _ABANDONED
    # What cannot be listed, or another process has swept, stays or goes without us.
    with suppress(OSError):
        for draft in folder.glob(f"{_DRAFT}*.tmp"):
            if draft.stat().st_mtime < before:
                draft.unlink()


@contextmanager
def _naming(path: str | os.PathLike[str]) -> Iterator[None]:
    """Let errors of the system name the file that was asked for, not its draft."""
    try:
        yield
    except OSError as error:
        if error.errno is None:
            raise
        raise OSError(error.errno, error.strerror, os.fspath(path)) from None
