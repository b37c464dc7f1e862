"""Plots and tables for other programs; each library is optional."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import roberval as rv

FORMULA = '=HYPERLINK("http://x")'


@pytest.fixture
def pyplot() -> Iterator[None]:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    import matplotlib.pyplot

    yield
    matplotlib.pyplot.close("all")


@pytest.mark.usefixtures("pyplot")
def test_each_plot_returns_its_axes_with_what_it_shows(base: rv.BaseParameters) -> None:
    spectrum = base.plot.spectrum()
    sizes = [np.size(line.get_xdata()) for line in spectrum.lines]
    assert [size for size in sizes if size > 2] == [55, 55]
    assert len(base.plot.classification().patches) == 66
    image = base.plot.beta().images[0].get_array()
    assert image is not None
    assert np.count_nonzero(np.isfinite(image)) == np.count_nonzero(base.beta)
    assert len(base.plot.tree().texts) == len(base.robot.plot.tree().texts) == 6


@pytest.mark.usefixtures("pyplot")
def test_a_plot_is_drawn_where_it_is_asked_to_be(base: rv.BaseParameters) -> None:
    import matplotlib.pyplot

    _, axes = matplotlib.pyplot.subplots(3)
    for ax, plot in zip(
        axes, (base.plot.spectrum, base.plot.classification, base.plot.beta), strict=True
    ):
        assert plot(ax) is ax
    assert matplotlib.pyplot.get_fignums() == [1]


def test_frames_of_the_links_are_those_of_the_paper(puma: rv.Robot) -> None:
    frames = puma.frames()
    assert frames.shape == (6, 4, 4)
    # D3 along x2, R3 along z3, which is y of the base turned by alpha2 = -90 deg.
    np.testing.assert_allclose(frames[2, :3, 3], [0.5, 0.2, 0], atol=1e-15)
    np.testing.assert_allclose(puma.axes, np.tile([0, 0, 1], (6, 1)))


@pytest.fixture
def hostile() -> rv.BaseParameters:
    robot = rv.Robot.from_mdh(
        [(0, 0, 0, 0), {"name": FORMULA, "alpha": "90 deg", "d": 0.1, "theta": 0, "r": 0}]
    )
    return robot.base_parameters()


@pytest.mark.parametrize("library", ["xlsxwriter", "openpyxl"])
def test_excel_has_values_and_no_formula(
    hostile: rv.BaseParameters, library: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    openpyxl = pytest.importorskip("openpyxl")
    pytest.importorskip(library)
    if library == "openpyxl":
        monkeypatch.setitem(sys.modules, "xlsxwriter", None)
    path = hostile.to_excel(tmp_path / "base.xlsx")
    book = openpyxl.load_workbook(path)
    assert book.sheetnames == ["parameters", "beta"]
    cells = [cell for sheet in book for row in sheet.rows for cell in row]
    assert all(cell.data_type != "f" and cell.hyperlink is None for cell in cells)
    assert FORMULA in [cell.value for cell in cells]
    beta = [[cell.value for cell in row[1:]] for row in list(book["beta"].rows)[1:]]
    np.testing.assert_array_equal(np.array(beta, dtype=float), hostile.beta)


def test_polars_and_pandas_have_the_same_rows(base: rv.BaseParameters) -> None:
    pytest.importorskip("polars")
    pytest.importorskip("pandas")
    polars, pandas = base.to_polars(), base.to_frame()
    assert polars["parameter"].to_list() == pandas.index.to_list()
    assert polars["class"].to_list() == pandas["class"].to_list()
    np.testing.assert_array_equal(polars["XB"].to_numpy(), pandas["XB"].to_numpy())


def test_missing_libraries_are_told(
    base: rv.BaseParameters, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    for name in ("matplotlib", "matplotlib.pyplot", "polars", "xlsxwriter", "openpyxl"):
        monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(rv.MissingPackageError, match="pip install matplotlib"):
        base.plot.spectrum()
    with pytest.raises(rv.MissingPackageError, match="pip install polars"):
        base.to_polars()
    with pytest.raises(rv.MissingPackageError, match="pip install xlsxwriter"):
        base.to_excel(tmp_path / "base.xlsx")
