"""Lint from Python; the rules are tested in Rust."""

from __future__ import annotations

from pathlib import Path

import pytest
import roberval as rv


def test_findings_say_where_what_and_what_to_do(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(
        '<robot name="r"><link name="a"/><link name="b"/>\n'
        '<joint name="j" type="continuous"><parent link="a"/><child link="b"/>\n'
        '<origin rpy="3.1416 0 0"/><axis xyz="0 0 2"/></joint></robot>'
    )
    findings = rv.lint(path)
    assert [(f.line, f.rule) for f in findings] == [
        (1, "missing-inertial"),
        (3, "rounded-angle"),
        (3, "axis"),
    ]
    assert str(findings[1]).startswith(f"{path}:3:9: warning: j rpy[0] = 3.1416")
    assert findings[1].remedy == "write 3.141592653589793 (pi)"
    with pytest.raises(rv.RobotError, match="no such file"):
        rv.lint(tmp_path / "nowhere.urdf")
