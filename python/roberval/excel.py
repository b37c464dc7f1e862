"""Excel workbooks by whichever library is there. No text becomes a formula or a link."""

from __future__ import annotations

import io
import re
from collections.abc import Mapping, Sequence
from typing import Any

from .errors import MissingPackageError

Sheet = Sequence[Sequence[str | float | None]]

FORBIDDEN = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ufffe\uffff]")
"""Characters that the form cannot hold."""


def workbook(sheets: Mapping[str, Sheet]) -> bytes:
    """Return the file of a workbook with these sheets, the first row of each frozen."""
    try:
        import xlsxwriter
    except ImportError:
        return _openpyxl(sheets)
    stream = io.BytesIO()
    options = {"in_memory": True, "strings_to_formulas": False, "strings_to_urls": False}
    with xlsxwriter.Workbook(stream, options) as book:
        for name, rows in sheets.items():
            sheet = book.add_worksheet(name)
            sheet.freeze_panes(1, 1)
            for i, row in enumerate(rows):
                for j, cell in enumerate(row):
                    if isinstance(cell, str):
                        sheet.write_string(i, j, FORBIDDEN.sub("?", cell))
                    elif cell is not None:
                        sheet.write_number(i, j, cell)
    return stream.getvalue()


def _openpyxl(sheets: Mapping[str, Sheet]) -> bytes:
    try:
        import openpyxl
    except ImportError:
        what = "to_excel needs xlsxwriter or openpyxl: pip install xlsxwriter"
        raise MissingPackageError(what) from None
    book = openpyxl.Workbook()
    book.remove(book.active)
    for name, rows in sheets.items():
        sheet: Any = book.create_sheet(name)
        sheet.freeze_panes = "B2"
        for i, row in enumerate(rows, 1):
            for j, value in enumerate(row, 1):
                cell = sheet.cell(i, j)
                cell.value = FORBIDDEN.sub("?", value) if isinstance(value, str) else value
                if isinstance(value, str):
                    cell.data_type = "s"  # "=1+1" stays a text
    stream = io.BytesIO()
    book.save(stream)
    return stream.getvalue()
