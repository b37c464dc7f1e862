"""Files that are written as a whole or not at all."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path


def write(path: str | os.PathLike[str], content: str | bytes) -> Path:
    """Write a file by way of a draft beside it; return its absolute path."""
    target = Path(path).absolute()
    data = content.encode() if isinstance(content, str) else content
    # A link stays a link.
    place = target.resolve()
    handle, name = tempfile.mkstemp(prefix=".roberval-", suffix=".tmp", dir=place.parent)
    draft = Path(name)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
        mode = place.stat().st_mode & 0o777 if place.exists() else 0o666 & ~_umask()
        draft.chmod(mode)
        draft.replace(place)
    except BaseException:
        draft.unlink(missing_ok=True)
        raise
    return target


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
