"""Answers as text, JSON, CSV, Markdown, LaTeX (the core's tables) and notebook HTML."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from typing import Protocol


class _Renders(Protocol):
    def render(self, format: str) -> str: ...


class Rendered:
    """What all answers have in common: the tables of the `roberval` command."""

    __slots__ = ("__weakref__", "_inner")

    _inner: _Renders

    def table(self) -> str:
        """Return the table that the `roberval` command prints, 100 columns wide if it can."""
        return self._inner.render("table")

    def to_json(self) -> str:
        """Return JSON as the `roberval` command writes it."""
        return self._inner.render("json")

    def to_csv(self) -> str:
        """Return CSV with a header line, safe to open in a spreadsheet."""
        return self._inner.render("csv")

    def to_markdown(self) -> str:
        """Return Markdown."""
        return self._inner.render("markdown")

    def to_latex(self) -> str:
        r"""Return LaTeX to ``\input``; it needs booktabs, longtable and amsmath."""
        return self._inner.render("latex")


def paragraph(text: str) -> str:
    """Return a paragraph of plain text as HTML."""
    return f"<p>{escape(text)}</p>"


def lines(texts: Iterable[str]) -> str:
    """Return lines of plain text as HTML, spaces kept."""
    return f'<pre style="white-space: pre-wrap">{escape(chr(10).join(texts))}</pre>'


def grid(
    header: Sequence[str], rows: Iterable[Sequence[str]], colours: dict[str, str] | None = None
) -> str:
    """Return a table of plain texts as HTML; `colours` gives cells their background by text."""
    colours = colours or {}
    head = "".join(f"<th>{escape(cell)}</th>" for cell in header)
    body = "".join(
        "<tr>" + "".join(_cell(cell, colours.get(cell)) for cell in row) + "</tr>" for row in rows
    )
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _cell(text: str, colour: str | None) -> str:
    style = f' style="background: {colour}"' if colour else ""
    return f"<td{style}>{escape(text)}</td>"
