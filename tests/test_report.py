"""The report in a real browser."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import pytest
import roberval as rv
from browser import Page, page
from wheels import robot_file

HOSTILE = "</title></style><script>alert(1)</script><img src=x onerror=alert(2)>\"'&\u202e"
"""A robot, link and joint name that would be markup or code if it were not escaped."""

MOST_BYTES = 1_000_000
PHONE = 390


@pytest.fixture(scope="module")
def browser() -> Iterator[Page]:
    with page() as opened:
        yield opened


@pytest.fixture(scope="module")
def puma_page(base: rv.BaseParameters, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return base.report(tmp_path_factory.mktemp("report") / "puma.html")


@pytest.mark.parametrize("dark", [False, True])
@pytest.mark.parametrize("width", [1200, PHONE])
def test_the_page_opens_without_a_complaint_and_fits_the_screen(
    browser: Page, puma_page: Path, width: int, dark: bool
) -> None:
    browser.look(width, dark=dark, phone=width == PHONE)
    browser.open(puma_page)
    assert browser.complaints == []
    assert browser.run("document.documentElement.scrollWidth") == width
    lightness = browser.run(
        "getComputedStyle(document.body).backgroundColor.match(/\\d+/g).map(Number)"
    )
    assert (max(lightness) < 128) == dark


def test_every_figure_is_drawn(browser: Page, puma_page: Path, base: rv.BaseParameters) -> None:
    browser.look(1200)
    browser.open(puma_page)
    # What has no size is not seen.
    marks = browser.run(
        "[...document.querySelectorAll('figure')].map(f => [...f.querySelectorAll('.m')]"
        ".filter(m => m.getBoundingClientRect().width > 0).length)"
    )
    coefficients = sum(len(terms) - 1 for terms in base.relations.values())
    effect = len(base.base) + len(base.regrouped)
    assert marks == [7, 6 + 66, coefficients, effect, effect]
    for where in (":not(details)", "details"):  # in numbers; in D3, R3, D4, R4
        found = browser.run(f"document.querySelectorAll('{where} > .rel').length")
        assert found == len(base.regrouped_into)
    assert browser.run("document.querySelector('msub').getBoundingClientRect().height") > 0


def test_values_are_read_by_touch_and_by_keys(browser: Page, puma_page: Path) -> None:
    browser.look(PHONE, phone=True)
    browser.open(puma_page)
    browser.tap("svg.wide .m")
    read = "document.querySelector('figure:has(svg.wide) output').textContent"
    assert browser.run(read) == "ZZR_1 takes up 1 Ia_1"
    browser.press("ArrowRight")
    assert browser.run(read) == "ZZR_1 takes up 1 YY_2"
    browser.run("document.querySelector('figure:has(.grid) .plot').focus()")
    browser.press("ArrowDown")
    grid = "document.querySelector('figure:has(.grid) output').textContent"
    assert browser.run(grid) == "link 1, revolute joint: 1 of 11 parameters kept"


def test_files_saved_from_the_page_are_those_of_the_command(
    browser: Page, puma_page: Path, base: rv.BaseParameters, tmp_path: Path
) -> None:
    browser.look(1200)
    browser.open(puma_page)
    saved = browser.run(
        "Promise.all([...document.querySelectorAll('a[data-name]')].map(async (link) => {"
        "const packed = Uint8Array.from(atob(link.href.split(',')[1]), (c) => c.charCodeAt(0));"
        "const plain = new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'));"
        "return [link.dataset.name, await new Response(plain).text()]; }))"
    )
    files = dict(saved)
    assert list(files) == ["PUMA-560.csv", "PUMA-560.json", "PUMA-560-certificate.json"]
    assert files["PUMA-560.csv"] == base.to_csv()
    assert json.loads(files["PUMA-560.json"]) == json.loads(base.to_json())
    assert json.loads(files["PUMA-560-certificate.json"])["rank"] == base.rank
    browser.save_downloads(tmp_path)
    browser.tap("a[data-name]")
    browser.run("new Promise(done => setTimeout(done, 1000))")
    assert (tmp_path / "PUMA-560.csv").read_text() == base.to_csv()
    assert browser.complaints == []


def test_hostile_names_are_text(browser: Page, tmp_path: Path) -> None:
    name = json.dumps(HOSTILE)
    robot = rv.Robot.from_toml(
        f"name = {name}\nlink = [{{ name = {name}, alpha = 0, d = 0, theta = 0, r = 0 }},"
        " { alpha = '90 deg', d = 0.1, theta = 0, r = 0 }]"
    )
    path = robot.base_parameters().report(tmp_path / "hostile.html")
    browser.look(1200)
    browser.open(path)
    assert browser.complaints == []
    assert browser.run("document.querySelectorAll('img').length") == 0
    assert browser.run("document.scripts.length") == 1
    shown = HOSTILE.replace("\u202e", "\\u{202e}")
    assert browser.run("document.querySelector('h1').textContent") == shown


@pytest.mark.filterwarnings("ignore::roberval.RobotWarning")
@pytest.mark.parametrize("file", ["erd/romeo_description/urdf/romeo.urdf"])
def test_the_report_of_a_humanoid_is_small(browser: Page, file: str, tmp_path: Path) -> None:
    robot = rv.load(robot_file(file))
    with pytest.warns(rv.RobotWarning, match="as written the file has 386"):
        base = robot.base_parameters()
    path = base.report(tmp_path / "humanoid.html")
    assert path.stat().st_size < MOST_BYTES
    browser.look(PHONE, phone=True)
    browser.open(path)
    assert browser.complaints == []
    assert browser.run("document.documentElement.scrollWidth") == PHONE


def test_a_report_replaces_a_file_as_a_whole(base: rv.BaseParameters, tmp_path: Path) -> None:
    path = tmp_path / "report.html"
    path.write_text("old")
    assert base.report(path) == path
    assert path.read_text() == base.to_html()
    assert [file.name for file in tmp_path.iterdir()] == ["report.html"]
    with pytest.raises(FileNotFoundError):
        base.report(tmp_path / "nowhere" / "report.html")
