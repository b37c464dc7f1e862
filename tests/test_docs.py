"""What the documentation names exists."""

from __future__ import annotations

import re
import runpy
import subprocess
import sys
from pathlib import Path

import pytest
import roberval as rv

ROOT = Path(__file__).parents[1]
TABLE = (ROOT / "docs/concordance.md").read_text().partition("|")[2]
NAMES = re.findall(r"`([\w/.-]+\.\w+(?:::\w+)?)`", TABLE)


def test_the_concordance_names_something() -> None:
    assert len(NAMES) > 40


@pytest.mark.parametrize("name", sorted(set(NAMES)))
def test_everything_in_the_concordance_exists(name: str) -> None:
    path, _, function = name.partition("::")
    file = ROOT / path if path.startswith("tests/") else ROOT / "crates" / f"roberval-{path}"
    text = file.read_text()
    if function:
        assert re.search(rf"\b(fn|def) {function}\b", text)


def test_links_between_documents_lead_somewhere() -> None:
    for page in [*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md")]:
        for link in re.findall(r"\]\(([^)#:]+)\)", page.read_text()):
            assert (page.parent / link).exists(), f"{page.name}: {link}"


def test_the_command_line_reference_is_what_the_command_says() -> None:
    tool = runpy.run_path(str(ROOT / "docs/cli.py"))
    assert tool["page"]() == (ROOT / "docs/cli.md").read_text()


def test_the_notebook_runs() -> None:
    for package in ("nbclient", "ipykernel", "matplotlib", "pandas"):
        pytest.importorskip(package)
    command = [sys.executable, "docs/notebook.py", "--check"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_every_public_name_is_in_the_reference() -> None:
    page = (ROOT / "docs/api.md").read_text()
    listed = set(re.findall(r"^::: roberval\.(\w+)", page, re.MULTILINE))
    errors = set(rv.errors.__all__)
    plain = {"__version__", "Choice", "Engine", "Model", "Number", "Snap"}
    small = {"Blame", "CatalogueEntry", "Grade", "Route", "Surd"}
    assert set(rv.__all__) - errors - plain - small <= listed
