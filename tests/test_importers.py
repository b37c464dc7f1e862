"""Other programs' models: the same robot by every way, and their own dynamics as the judge."""

from __future__ import annotations

import html
import json
import pickle
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import roberval as rv
from roberval import importers
from roberval.arrays import Array
from roberval.importers.placed import DUST, roll_pitch_yaw
from wheels import robot_file

ROUNDING = 1e-12
"""Torques and parameters of about 1 to 100, by two programs' arithmetic."""

ARMS = [
    "erd/ur_description/urdf/ur5_robot.urdf",
    "erd/panda_description/urdf/panda.urdf",
    "erd/xarm_description/urdf/xarm7.urdf",
    "erd/kinova_description/robots/kinova.urdf",
    "erd/z1_description/urdf/z1.urdf",
    "erd/talos_data/robots/talos_left_arm.urdf",
    "erd/double_pendulum_description/urdf/double_pendulum.urdf",
]

LOOPED = ("four_bar", "delta")
"""Built-in robots with loops."""

COUPLED = ("hitachi_hpr", "sr400")
"""Built-in robots with joints that follow from several others."""

TRICKY = """<mujoco model="tricky"><option gravity="0 1 -9"/><worldbody>
<body name="stand" pos="0 0 1">
 <body name="slider" pos=".1 .2 .3" quat=".9 .1 .2 .3">
  <joint name="sx" type="slide" axis="1 0 0" armature=".3"/>
  <joint name="sy" type="slide" axis="0 1 1"/>
  <joint name="tz" axis="0 .2 1" pos=".1 0 .2" armature=".1"/>
  <inertial pos=".1 .2 .1" mass="2" diaginertia=".3 .2 .2" quat="1 .2 .1 .5"/>
  <body name="welded" pos="0 .1 0" euler="10 20 30">
   <inertial pos=".1 .2 .1" mass="1" diaginertia=".3 .2 .2"/>
   <body name="arm" pos=".3 0 0"><joint name="a" axis="0 1 0" pos="0 0 .1" ref="20"/>
    <inertial pos=".1 .2 .1" mass="3" fullinertia=".3 .2 .3 .01 .02 .03"/>
    <body name="last"><joint name="b" axis="1 0 0"/>
     <inertial pos=".1 0 .1" mass=".5" diaginertia=".03 .02 .02"/></body></body></body></body>
</body></worldbody>%s</mujoco>"""


def without_meshes(path: Path) -> str:
    pattern = r"<(visual|collision)\b.*?</\1>|<(visual|collision)\b[^>]*/>"
    return re.sub(pattern, "", path.read_text(), flags=re.DOTALL)


@pytest.mark.filterwarnings("ignore::roberval.RobotWarning")
@pytest.mark.parametrize("file", ARMS)
def test_urdf_mjcf_and_pinocchio_give_the_same_base_parameters(file: str) -> None:
    mujoco = pytest.importorskip("mujoco")
    pinocchio = pytest.importorskip("pinocchio")
    text = without_meshes(robot_file(file))
    robot = rv.Robot.from_urdf(text)
    base = robot.base_parameters()
    others = [
        rv.Robot.from_mujoco(mujoco.MjModel.from_xml_string(text)),
        rv.Robot.from_pinocchio(pinocchio.buildModelFromXML(text, mimic=True)),
    ]
    for other in others:
        assert other.parameters == robot.parameters
        assert other.joints == robot.joints
        assert other.base_parameters().base == base.base
        assert other.base_parameters().relations.text == base.relations.text
        assert robot.X is not None
        assert other.X is not None
        np.testing.assert_allclose(other.X, robot.X, atol=ROUNDING)


def test_torques_of_a_tricky_model_are_mujocos() -> None:
    mujoco = pytest.importorskip("mujoco")
    model = mujoco.MjModel.from_xml_string(TRICKY % "")
    robot = rv.Robot.from_mujoco(model, snap="off")
    names = [link.name for link in robot.links]
    assert names == ["slider/sx", "slider/sy", "slider", "arm", "last"]
    q, qd, qdd = np.random.default_rng(1).normal(size=(3, model.nv))
    data = mujoco.MjData(model)
    data.qpos[:] = model.qpos0 + q
    data.qvel[:], data.qacc[:] = qd, qdd
    mujoco.mj_inverse(model, data)
    torques = robot.torques(q, qd, qdd)
    np.testing.assert_allclose(torques, data.qfrc_inverse, atol=ROUNDING * 100)


def test_couples_of_a_model_are_applied_and_other_constraints_warned_of() -> None:
    pytest.importorskip("mujoco")
    equality = """<equality><joint name="gear" joint1="b" joint2="a" polycoef="0 2 0 0 0"/>
        <joint name="curve" joint1="tz" joint2="a" polycoef="0 1 1 0 0"/></equality>"""
    with pytest.warns(rv.RobotWarning, match="'curve'.*not applied"):
        robot = rv.Robot.from_mujoco(TRICKY % equality)
    assert "Ia_last" not in robot.parameters
    assert robot.base_parameters().rank < rv.Robot.from_mujoco(TRICKY % "").base_parameters().rank


FOUR_BAR = """<mujoco model="four-bar"><option gravity="0 0 -9.81"/>
<default><geom type="capsule" size=".02"/></default><worldbody>
<body name="crank"><joint name="crank" axis="0 1 0"/><geom fromto="0 0 0 0 0 .3"/>
 <body name="coupler" pos="0 0 .3"><joint name="coupler" axis="0 1 0"/>
  <geom fromto="0 0 0 .9 0 .1"/></body></body>
<body name="rocker" pos="1 0 0"><joint name="rocker" axis="0 1 0"/>
 <geom fromto="0 0 0 -.1 0 .4"/></body></worldbody>
<equality><%s/></equality>
<actuator><motor joint="crank"/></actuator></mujoco>"""


@pytest.mark.filterwarnings("ignore::roberval.RobotWarning")
def test_what_an_importer_drops_is_told_wherever_the_robot_is(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    file = tmp_path / "curved.xml"
    curve = '<joint name="curve" joint1="tz" joint2="a" polycoef="0 1 1 0 0"/>'
    file.write_text(TRICKY % f"<equality>{curve}</equality>")
    robot = rv.load(file)
    [dropped] = robot.warnings
    assert "'curve'" in dropped
    assert "not applied" in dropped
    base = robot.base_parameters()
    assert dropped in robot.table()
    assert dropped in json.loads(base.to_json())["warnings"]
    base.report(tmp_path / "report.html")
    page = html.unescape((tmp_path / "report.html").read_text())
    assert "equality 'curve'" in page
    assert pickle.loads(pickle.dumps(robot)).warnings == robot.warnings
    assert rv.Robot.from_toml(robot.to_toml()).warnings == robot.warnings
    [finding] = rv.lint(file)
    assert (finding.rule, finding.what, finding.line) == ("remark", dropped, None)
    command = [sys.executable, "-m", "roberval", "base", str(file)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.stderr.count("'curve'") == 1, done.stderr


@pytest.mark.filterwarnings("ignore::roberval.DoubtfulRankWarning")
@pytest.mark.filterwarnings("ignore::roberval.RobotWarning")
def test_sites_close_the_loop_that_bodies_close() -> None:
    pytest.importorskip("mujoco")
    text = FOUR_BAR
    for name, end in (("p", ".9 0 .1"), ("q", "-.1 0 .4")):
        geom = f'<geom fromto="0 0 0 {end}"/>'
        text = text.replace(geom, f'{geom}<site name="{name}" pos="{end}"/>')
    by_bodies = rv.Robot.from_mujoco(
        text % 'connect body1="coupler" body2="rocker" anchor=".9 0 .1"'
    )
    by_sites = rv.Robot.from_mujoco(text % 'connect site1="p" site2="q"')
    assert not by_sites.warnings
    assert len(by_sites.loops) == 1
    assert by_sites.loops == by_bodies.loops
    assert by_sites.base_parameters().relations.text == by_bodies.base_parameters().relations.text


@pytest.mark.filterwarnings("ignore::roberval.DoubtfulRankWarning")
@pytest.mark.filterwarnings("ignore::roberval.RobotWarning")
def test_a_connect_of_two_bodies_closes_a_loop() -> None:
    pytest.importorskip("mujoco")
    connect = 'connect body1="coupler" body2="rocker" anchor=".9 0 .1"'
    closed = rv.Robot.from_mujoco(FOUR_BAR % connect)
    passive = [link.name for link in closed.links if not link.active]
    assert passive == ["coupler", "rocker"]
    free = rv.Robot.from_mujoco(FOUR_BAR % (connect + ' active="false"'), rotors=False)
    base = closed.base_parameters()
    assert base.engine == "exact"
    assert 0 < base.rank < free.base_parameters().rank


def test_a_free_body_with_loops_floats_unless_a_loop_holds_it_to_the_world() -> None:
    pytest.importorskip("mujoco")
    links, rest = FOUR_BAR.split("<worldbody>")[1].split("</worldbody>")
    hull = (
        '<body name="hull"><freejoint/><geom type="sphere" size=".1" mass="3"/>' + links + "</body>"
    )
    text = FOUR_BAR.split("<worldbody>")[0] + f"<worldbody>{hull}</worldbody>{rest}"
    robot = rv.Robot.from_mujoco(text % 'connect body1="coupler" body2="rocker" anchor=".9 0 .1"')
    assert robot.is_floating
    assert (robot.n, robot.joints[-1]) == (7, "crank")
    assert robot.base_parameters().engine == "exact"
    with pytest.warns(rv.RobotWarning, match="held still"):
        held = rv.Robot.from_mujoco(text % 'connect body1="coupler" body2="world" anchor=".9 0 .1"')
    assert not held.is_floating


def random_model(pin: Any) -> Any:
    pin.seed(3)
    axes = pin.SE3.Random().rotation
    composite = pin.JointModelComposite()
    composite.addJoint(pin.JointModelRX(), pin.SE3.Random())
    composite.addJoint(pin.JointModelPZ(), pin.SE3.Random())
    model, joint = pin.Model(), 0
    for kind in (
        pin.JointModelRX(),
        pin.JointModelRevoluteUnaligned(axes[:, 0]),
        pin.JointModelPrismaticUnaligned(axes[:, 1]),
        pin.JointModelPY(),
        composite,
    ):
        joint = model.addJoint(joint, kind, pin.SE3.Random(), f"j{joint}")
        model.appendBodyToJoint(joint, pin.Inertia.Random(), pin.SE3.Identity())
    model.armature = np.random.default_rng(0).uniform(0, 1, model.nv)
    return model


def test_torques_of_a_random_model_are_pinocchios() -> None:
    pin = pytest.importorskip("pinocchio")
    model = random_model(pin)
    robot = rv.Robot.from_pinocchio(model, snap="off")
    q, qd, qdd = np.random.default_rng(2).normal(size=(3, model.nv))
    expected = pin.rnea(model, model.createData(), q, qd, qdd)
    np.testing.assert_allclose(robot.torques(q, qd, qdd), expected, atol=ROUNDING * 100)


@pytest.mark.filterwarnings("ignore:.*inertia that no body has:roberval.RobotWarning")
@pytest.mark.parametrize(
    "entry", [e.name for e in rv.catalogue() if e.name not in COUPLED + LOOPED]
)
def test_a_robot_written_as_urdf_is_the_same_robot(entry: str) -> None:
    robot = rv.load(entry, rotors=False)
    again = rv.Robot.from_urdf(robot.to_urdf(), rotors=False, gravity=robot.gravity.tolist())
    assert again.parameters == robot.parameters
    base, other = robot.base_parameters(), again.base_parameters()
    assert other.base == base.base
    assert other.relations.text == base.relations.text
    assert other.diagnosis.messages == base.diagnosis.messages


@pytest.mark.parametrize("entry", LOOPED)
def test_a_robot_with_loops_is_not_written_as_urdf(entry: str) -> None:
    with pytest.raises(rv.RobotError, match="trees only"):
        rv.load(entry).to_urdf()


@pytest.mark.parametrize("entry", COUPLED)
def test_a_joint_that_follows_from_several_is_no_mimic_joint(entry: str) -> None:
    with pytest.raises(rv.RobotError, match="follows from several joints"):
        rv.load(entry).to_urdf()


def test_missing_packages_are_told_with_the_command_that_installs_them(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    file = tmp_path / "arm.xml"
    file.write_text(TRICKY % "")
    xacro = tmp_path / "arm.xacro"
    xacro.write_text('<robot xmlns:xacro="http://ros.org/wiki/xacro"><xacro:x/></robot>')
    for package in ("mujoco", "pinocchio", "xacrodoc", "robot_descriptions"):
        monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(rv.MissingPackageError, match="pip install mujoco"):
        rv.load(file)
    with pytest.raises(rv.MissingPackageError, match="pip install pin"):
        rv.Robot.from_pinocchio(None)
    with pytest.raises(rv.MissingPackageError, match="pip install xacrodoc"):
        rv.load(xacro)
    with pytest.raises(rv.MissingPackageError, match="pip install robot_descriptions"):
        rv.load("ur5_description")


def test_the_command_takes_mjcf_by_its_content(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    file = tmp_path / "arm.urdf"  # the name says nothing
    file.write_text(TRICKY % "")
    command = [sys.executable, "-m", "roberval", "base", str(file), "--no-rotors"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("tricky\n5 links (3 revolute, 2 prismatic)")


@pytest.mark.parametrize("entry", ["show", "base", "code", "clean", "lint"])
def test_commands_name_the_file_that_was_asked_for(entry: str, tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    file = tmp_path / "round.xml"
    file.write_text((TRICKY % "").replace('euler="10 20 30"', 'euler="0.00001 0 0"'))
    command = [sys.executable, "-m", "roberval", entry, str(file)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode in (0, 1), done.stderr
    if entry == "lint":  # nobody wrote the numbers of the translation
        assert (done.stdout, rv.lint(file)) == ("", [])
    if entry == "clean":
        assert rv.Robot.from_toml(done.stdout).name == "tricky"
    assert "Traceback" not in done.stderr


def test_a_model_without_joints_is_refused() -> None:
    pytest.importorskip("mujoco")
    with pytest.raises(rv.RobotError, match="nothing moves"):
        rv.Robot.from_mujoco("<mujoco/>")


def test_xacro_is_expanded(tmp_path: Path) -> None:
    pytest.importorskip("xacrodoc")
    file = tmp_path / "arm.urdf.xacro"
    file.write_text(
        """<robot name="arm" xmlns:xacro="http://ros.org/wiki/xacro">
        <xacro:property name="L" value="0.5"/><link name="a"/><link name="b"/>
        <joint name="j" type="continuous"><parent link="a"/><child link="b"/>
        <origin xyz="${2 * L} 0 0"/></joint></robot>"""
    )
    assert rv.load(file).base_parameters().rank > 0


def test_only_what_says_itself_that_it_is_xacro_is_evaluated(tmp_path: Path) -> None:
    file = tmp_path / "arm.urdf"
    body = '<link name="a"/><link name="${9**9**9}"/></robot>'
    file.write_text(f'<robot name="arm">{body}')
    assert importers.kind_of(file) is None
    with pytest.raises(rv.RobotError, match="xacro"):
        rv.load(file)
    # Expanded files keep the namespace: nothing in them needs xacro.
    head = '<robot name="arm" xmlns:xacro="http://ros.org/wiki/xacro">'
    file.write_text(f'{head}<link name="a"/></robot>')
    assert importers.kind_of(file) is None
    file.write_text(f"{head}{body}")
    assert importers.kind_of(file) == "xacro"
    file.write_text('<robot name="arm"><xacro:include filename="b"/></robot>')
    assert importers.kind_of(file) == "xacro"


def test_optional_packages_are_imported_only_when_used() -> None:
    names = ("pandas", "polars", "matplotlib", "mujoco", "pinocchio", "xacrodoc", "openpyxl")
    script = f"import sys, roberval; print([n for n in {names} if n in sys.modules])"
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "[]"


@pytest.mark.parametrize("from_pole", [1.0, 1e-3, 1e-9, 1e-13, 0.0])
def test_rotations_near_the_pole_keep_their_digits(from_pole: float) -> None:
    rng = np.random.default_rng(3)
    for roll, yaw, sign in rng.uniform(-np.pi, np.pi, (200, 3)):
        asked = turned(roll, np.copysign(np.pi / 2 - from_pole, sign), yaw)
        found = turned(*roll_pitch_yaw(asked))
        assert np.abs(found - asked).max() <= 2 * DUST


def turned(roll: float, pitch: float, yaw: float) -> Array:
    """The rotation of angles about fixed axes."""

    def about(axis: int, angle: float) -> Array:
        i, j = (axis + 1) % 3, (axis + 2) % 3
        rotation = np.eye(3)
        rotation[[i, j], [i, j]] = np.cos(angle)
        rotation[i, j], rotation[j, i] = -np.sin(angle), np.sin(angle)
        return rotation

    return about(2, yaw) @ about(1, pitch) @ about(0, roll)
