"""Loading, building, looking at and keeping robots."""

from __future__ import annotations

import copy
import pickle
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import roberval as rv
from conftest import random_states

URDF = """<?xml version="1.0"?>
<robot name="crane">
  <link name="world"/>
  <link name="boom"><inertial>
    <origin xyz="0.5 0 0"/><mass value="2"/>
    <inertia ixx="0.1" iyy="0.2" izz="0.3" ixy="0" ixz="0" iyz="0"/>
  </inertial></link>
  <link name="hook"/>
  <link name="load"><inertial>
    <mass value="3"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>
  </inertial></link>
  <joint name="slew" type="revolute">
    <parent link="world"/><child link="boom"/><axis xyz="0 0 1"/>
    <limit effort="1" velocity="1" lower="-1" upper="1"/>
  </joint>
  <joint name="hoist" type="prismatic">
    <parent link="boom"/><child link="hook"/><axis xyz="0 0 -1"/><origin xyz="1 0 0"/>
    <limit effort="1" velocity="1" lower="-1" upper="1"/>
  </joint>
  <joint name="eye" type="fixed">
    <parent link="hook"/><child link="load"/><origin xyz="0 0 -0.2"/>
  </joint>
</robot>
"""


def test_every_robot_of_the_catalogue_loads_and_is_clear() -> None:
    assert len(rv.catalogue()) >= 6
    for entry in rv.catalogue():
        robot = rv.load(entry.name)
        assert entry.title
        assert entry.source
        assert 0 < robot.base_parameters().rank < len(robot.parameters)


def test_puma_shows_itself(puma: rv.Robot) -> None:
    assert puma.name == "PUMA 560"
    assert puma.n == 6
    assert puma.joints == ("1", "2", "3", "4", "5", "6")
    assert puma.links[0] == ("1", None, None, "revolute", True, True)
    assert puma.links[5].antecedent == "5"
    assert puma.parameters[:3] == ("XX_1", "XY_1", "XZ_1")
    assert len(puma.parameters) == 66
    assert puma.gravity.tolist() == [0, 0, -9.81]
    assert puma.inertial_values["Ia_2"] == 4.5
    assert "M_1" not in puma.inertial_values
    assert puma.X is not None
    assert puma.X.shape == (66,)
    assert repr(puma) == "Robot('PUMA 560', 6 revolute joints, 66 parameters)"


@pytest.mark.parametrize("as_path", [str, Path])
def test_load_reads_files_by_their_content(tmp_path: Path, as_path: Any) -> None:
    toml, urdf = tmp_path / "a.toml", tmp_path / "crane.urdf"
    toml.write_text(rv.load("puma560").to_toml())
    urdf.write_text(URDF)
    assert rv.load(as_path(toml)) == rv.load("puma560")
    assert rv.load(as_path(urdf)).joints == ("slew", "hoist")


def test_urdf_text_and_file_are_one_robot(tmp_path: Path) -> None:
    path = tmp_path / "robot.urdf"
    path.write_text(URDF)
    text, file = rv.Robot.from_urdf(URDF), rv.Robot.from_urdf(path)
    assert text == file == rv.load(path)
    assert text.joints == ("slew", "hoist")
    assert text.inertial_values["M_hook"] == 3, "the load on a fixed joint is lumped"


@pytest.mark.filterwarnings("ignore::roberval.RobotWarning")  # the hook has no inertial
def test_fixed_joints_stay_on_request() -> None:
    robot = rv.Robot.from_urdf(URDF, keep_fixed=True)
    assert [link.joint for link in robot.links] == ["revolute", "prismatic", "fixed"]
    assert robot.n == 2
    lumped = rv.Robot.from_urdf(URDF)
    q, qd, qdd = random_states(robot, 4)
    assert np.allclose(robot.torques(q, qd, qdd), lumped.torques(q, qd, qdd), rtol=1e-14)


def test_a_urdf_robot_has_no_toml() -> None:
    with pytest.raises(rv.RobotError, match="cannot be written as robot TOML"):
        rv.Robot.from_urdf(URDF).to_toml()


def row(**keys: Any) -> dict[str, Any]:
    """A link with these keys, zero geometry else."""
    return {"alpha": 0, "d": 0, "theta": 0, "r": 0, **keys}


def test_rows_are_the_toml() -> None:
    robot = rv.Robot.from_mdh(
        [
            row(name="arm", theta="90 deg", inertia={"ZZ": 0.1, "M": Decimal("2.50")}),
            row(antecedent="arm", alpha="-pi/2", d="L/2", r=Fraction(1, 3)),
            row(antecedent="arm", joint="prismatic", r=np.float64(0.1), rotor=False),
        ],
        name='the "arm" \\ 1',
        gravity=(0, 0, 9.81),
        constants={"L": "0.29"},
    )
    text = robot.to_toml()
    assert rv.Robot.from_toml(text) == robot
    assert robot.name == 'the "arm" \\ 1'
    assert [link.antecedent for link in robot.links] == [None, "arm", "arm"]
    assert [link.joint for link in robot.links] == ["revolute", "revolute", "prismatic"]
    for literal in ("L/2", "1/3", "0.29", "2.50", "90 deg"):
        assert literal in text, "numbers stay as written"
    assert len(robot.parameters) == 32
    assert robot.inertial_values == {"ZZ_arm": 0.1, "M_arm": 2.5}


def test_tuples_are_alpha_d_theta_r() -> None:
    rows = [(0, 0, 0, 0), ("-pi/2", 0, 0, 0), (0, 0.5, 0, 0.2)]
    keys = ("alpha", "d", "theta", "r")
    dicts = [dict(zip(keys, row, strict=True)) for row in rows]
    assert rv.Robot.from_mdh(rows) == rv.Robot.from_mdh(dicts)


BAD_ROWS: dict[str, tuple[Any, str]] = {
    "no row": ([], "no link"),
    "missing alpha": ([{"d": 1}], 'link "1": alpha is missing; write alpha = 0'),
    "three numbers": ([(0, 0, 0)], r"link 1 is \(0, 0, 0\), expected a dict .* or a tuple \(alpha"),
    "text": (["abcd"], "link 1 is 'abcd'"),
    "unknown key": ([row(a=1)], 'unknown key "a"'),
    "NaN": ([(0, 0, 0, 0), (0, float("nan"), 0, 0)], 'link "2", d: .*nan.* not a finite number'),
    "complex": ([(0, 1j, 0, 0)], "link 1, d is 1j, a number that"),
    "array": ([(0, np.zeros(2), 0, 0)], "link 1, d is array.*, a ndarray that"),
    "unknown constant": ([(0, "D9", 0, 0)], 'link "1", d: .*D9'),
    "unknown joint": ([row(joint="ball")], 'link "1": unknown joint type "ball"'),
    "no antecedent": ([row(antecedent="x")], 'antecedent "x"'),
    "circle": (
        [row(name="a", antecedent="b"), row(name="b", antecedent="a")],
        "in a circle",
    ),
    "twice": ([row(name="a"), row(name="a")], 'named "a"'),
    "fixed only": ([row(joint="fixed")], "every joint is fixed"),
    "two inertias": ([row(inertia={"ZX": 1})], 'unknown key "ZX"'),
}


@pytest.mark.parametrize("name", BAD_ROWS)
def test_bad_rows_name_link_and_field(name: str) -> None:
    rows, message = BAD_ROWS[name]
    with pytest.raises(rv.RobotError, match=message) as caught:
        rv.Robot.from_mdh(rows)
    assert caught.value.line is None, "nobody has seen the lines of the generated text"


def test_errors_say_where(tmp_path: Path) -> None:
    path = tmp_path / "bad.toml"
    path.write_text('name = "x"\n\n[[link]]\nalfa = 1\n')
    with pytest.raises(
        rv.RobotError, match=r"bad\.toml:4:1: \[E130\].*did you mean alpha"
    ) as caught:
        rv.load(path)
    error = caught.value
    assert (error.code, error.file, error.line, error.column) == ("E130", str(path), 4, 1)
    assert isinstance(error, ValueError)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("puma561", 'did you mean the built-in "puma560"'),
        ("no/such/file.urdf", "there is no such file and no built-in robot"),
        ("", "there is no such file|folder"),
        (".", "this is a folder"),
    ],
)
def test_a_robot_that_is_not_there_is_explained(name: str, message: str) -> None:
    with pytest.raises(rv.RobotError, match=message):
        rv.load(name)


def test_warnings_of_the_file_are_warnings() -> None:
    bare = URDF.replace('<mass value="2"/>', '<mass value="-2"/>')
    with pytest.warns(rv.RobotWarning, match="crane: "):
        robot = rv.Robot.from_urdf(bare)
    assert robot.warnings


@pytest.mark.parametrize(
    "robot", [rv.load("puma560"), rv.Robot.from_urdf(URDF)], ids=["toml", "urdf"]
)
def test_robots_can_be_pickled_and_copied(robot: rv.Robot) -> None:
    for twin in (pickle.loads(pickle.dumps(robot)), copy.copy(robot), copy.deepcopy(robot)):
        assert twin == robot
        assert hash(twin) == hash(robot)
        assert twin.name == robot.name


def test_robots_cannot_be_changed(puma: rv.Robot) -> None:
    with pytest.raises(AttributeError):
        puma.name = "other"  # type: ignore[misc]
    with pytest.raises(AttributeError):
        puma.colour = "red"  # type: ignore[attr-defined]
    with pytest.raises(TypeError, match=r"roberval\.load"):
        rv.Robot()
    puma.gravity[2] = 0
    assert puma.gravity[2] == -9.81


def test_torques_need_values() -> None:
    robot = rv.Robot.from_mdh([(0, 0, 0, 0)])
    assert robot.X is None
    assert robot.inertial_values == {}
    with pytest.raises(rv.RobervalError, match=r"no inertial values: give X, 11 numbers"):
        robot.torques([0], [0], [1])
    assert robot.torques([0], [0], [1], {"Ia_1": 2.0, "ZZ_1": 1.0}).tolist() == [3]
