"""What the documentation names exists."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

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
