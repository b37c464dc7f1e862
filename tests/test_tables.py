"""Answers as people and programs read them."""

from __future__ import annotations

import csv
import io
import json
import re
import sys
from html.parser import HTMLParser

import pytest
import roberval as rv

WIDTH = 100
"""The longest line of a text table."""

HOSTILE = '<script>alert("&")</script>'


def hostile_robot() -> rv.Robot:
    """A robot whose names are markup."""
    rows = [
        {"name": HOSTILE, "alpha": 0, "d": 0, "theta": 0, "r": 0},
        {"name": "=1+1", "alpha": "pi/2", "d": 0.3, "theta": 0, "r": 0},
    ]
    return rv.Robot.from_mdh(rows, name=HOSTILE)


class Tags(HTMLParser):
    """Collects the tags and the words of a page."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.words = ""
        self.feed(html)
        self.close()

    def handle_starttag(self, tag: str, attrs: object) -> None:
        self.tags.append(tag)

    def handle_data(self, data: str) -> None:
        self.words += data


def test_the_table_shows_table_v(base: rv.BaseParameters) -> None:
    table = base.table()
    relation = "ZZR_1 = ZZ_1 + YY_2 + YY_3 + 0.4 MZ_3 + 0.2904 (M_4 + M_5 + M_6) + 0.29 M_3 + Ia_1"
    assert relation in table.splitlines()
    assert relation in str(base.relations)
    assert max(map(len, table.splitlines())) <= WIDTH


def test_json_has_the_agreed_form(base: rv.BaseParameters) -> None:
    answer = json.loads(base.to_json())
    assert answer["schema"] == 1
    assert answer["rank"] == 40
    assert answer["base"] == list(base.base)
    assert answer["no_effect"] == list(base.no_effect)
    assert answer["regrouped"] == list(base.regrouped)
    assert answer["unchanged"] == list(base.unchanged)
    assert answer["regrouped_into"] == list(base.regrouped_into)
    assert [p["label"] for p in answer["parameters"]] == list(base.parameters)
    for label, terms in base.relations.items():
        others = {other: beta for other, beta in terms.items() if other != label}
        assert answer["beta"].get(label, {}) == others
    assert answer["values"]["XB"] == dict(zip(base.base, base.values().tolist(), strict=True))


def test_csv_has_a_row_for_each_parameter(base: rv.BaseParameters) -> None:
    rows = list(csv.DictReader(io.StringIO(base.to_csv())))
    assert [row["label"] for row in rows] == list(base.parameters)


def test_latex_and_markdown_are_what_they_say(puma: rv.Robot, base: rv.BaseParameters) -> None:
    for answer in (puma, base, puma.compare()):
        assert r"\toprule" in answer.to_latex()
        assert re.search(r"^\|( ?:?-+:? ?\|)+$", answer.to_markdown(), re.M)
        assert json.loads(answer.to_json())
        assert len(list(csv.reader(io.StringIO(answer.to_csv())))) > 1


def test_relations_are_a_mapping_with_a_text(base: rv.BaseParameters) -> None:
    relations = base.relations
    assert len(relations) == 40
    assert "XX_6" in relations
    assert relations.text[-1] == "XXR_6 = XX_6 - YY_6"
    assert len(relations.text) == 17


def test_the_frame_has_the_table(base: rv.BaseParameters) -> None:
    pytest.importorskip("pandas")
    frame = base.to_frame()
    assert list(frame.index) == list(base.parameters)
    assert list(frame.columns) == ["kind", "link", "class", "X", "XB", "relation"]
    assert frame["class"].value_counts().to_dict() == {
        "unchanged": 23,
        "regrouped into": 17,
        "regrouped": 15,
        "no effect": 11,
    }
    kept = frame.loc[list(base.base)]
    assert (kept["XB"].to_numpy() == base.values()).all()
    assert frame.loc[list(base.regrouped), "XB"].isna().all()
    assert frame["X"].isna()["M_1"]
    assert frame.loc["XX_6", "relation"] == "XXR_6 = XX_6 - YY_6"


def test_a_frame_without_values_has_none() -> None:
    pytest.importorskip("pandas")
    frame = hostile_robot().base_parameters().to_frame()
    assert frame[["X", "XB"]].isna().all().all()
    assert "=1+1" in set(frame["link"])


def test_a_missing_pandas_is_named(
    base: rv.BaseParameters, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(rv.MissingPackageError, match="pip install pandas"):
        base.to_frame()


def test_notebooks_show_the_answer(puma: rv.Robot, base: rv.BaseParameters) -> None:
    assert "40 base" in Tags(base._repr_html_()).words
    assert "XXR_6 = XX_6 - YY_6" in Tags(base._repr_html_()).words
    assert "9 routes agree" in Tags(puma.compare()._repr_html_()).words
    assert "PUMA 560" in Tags(puma._repr_html_()).words


def test_hostile_names_stay_text() -> None:
    robot = hostile_robot()
    base = robot.base_parameters()
    for html in (robot._repr_html_(), base._repr_html_(), robot.compare()._repr_html_()):
        page = Tags(html)
        assert "script" not in page.tags
        assert set(page.tags) <= {"p", "pre", "table", "thead", "tbody", "tr", "th", "td"}
    assert HOSTILE in Tags(base._repr_html_()).words
    cells = [cell for row in csv.reader(io.StringIO(base.to_csv())) for cell in row]
    assert not [cell for cell in cells if re.match(r"[=+@\t\r]", cell)]
