"""Files that are written as a whole or not at all."""

from __future__ import annotations

import os
import secrets
from contextlib import suppress
from pathlib import Path


def write(path: str | os.PathLike[str], content: str | bytes) -> Path:
    """Write a file by way of a draft beside it; return its absolute path."""
    target = Path(path).absolute()
    data = content.encode() if isinstance(content, str) else content
    # A link stays a link.
    place = target.resolve()
    draft = place.with_name(f".roberval-{os.getpid()}-{secrets.token_hex(4)}.tmp")
    try:
        with draft.open("xb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        if place.exists():
            draft.chmod(place.stat().st_mode & 0o777)
        draft.replace(place)
    except OSError as error:
        # Tell of the file that was asked for, not of its draft.
        error.filename, error.filename2 = os.fspath(path), None
        raise
    finally:
        with suppress(OSError):
            draft.unlink()
    return target
