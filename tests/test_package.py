"""The package: what it imports, what it exports, what it carries."""

from __future__ import annotations

import inspect
import json
import subprocess
import sys
from importlib.metadata import distribution, version
from pathlib import Path

import roberval as rv


def imported() -> set[str]:
    script = "import json, sys, roberval; print(json.dumps(sorted(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, check=True)
    return set(json.loads(done.stdout))


def test_import_brings_numpy_and_no_optional_package() -> None:
    optional = {"pandas", "scipy", "matplotlib", "pinocchio", "mujoco", "IPython"}
    assert not imported() & optional


def test_numpy_is_the_only_requirement() -> None:
    requirements = distribution("roberval").requires or []
    assert [r for r in requirements if "extra" not in r] == ["numpy>=1.24"]


def test_everything_exported_is_there_and_described() -> None:
    assert rv.__all__ == sorted(rv.__all__)
    for name in rv.__all__:
        item = getattr(rv, name)
        if isinstance(item, type) or inspect.isroutine(item):
            assert item.__doc__, name


def test_public_methods_say_what_they_return_and_raise() -> None:
    for kind in (rv.Robot, rv.BaseParameters, rv.Comparison, rv.Diagnosis):
        for name in dir(kind):
            item = inspect.getattr_static(kind, name)
            if not name.startswith("_") and (callable(item) or isinstance(item, property)):
                assert item.__doc__, f"{kind.__name__}.{name}"


def test_types_are_marked() -> None:
    assert (Path(rv.__file__).parent / "py.typed").exists()


def test_versions_agree() -> None:
    assert rv.__version__ == version("roberval")
