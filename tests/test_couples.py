"""Joints that follow from others: against Pinocchio on the opened tree, and the interface."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
import roberval as rv
from wheels import robot_file

# Torques, relative to their largest: some hundred eps.
ROUNDING = 1e-12

MIMIC = {
    "erd/panda_description/urdf/panda.urdf": 1,
    "erd/baxter_description/urdf/baxter.urdf": 2,
    "erd/pr2_description/urdf/pr2.urdf": 10,
    "erd/talos_data/robots/talos_full_v2.urdf": 12,
    "erd/romeo_description/urdf/romeo.urdf": 22,
}
"""Mimic joints of each file."""

GEARS = """
gravity = [0, -9.81, 0]
[[link]]
name = "motor"
alpha = 0
d = 0
r = 0
[[link]]
name = "rack"
joint = "prismatic"
antecedent = "base"
alpha = "90 deg"
d = 0.2
theta = 0
[[link]]
name = "arm"
antecedent = "base"
alpha = 0
d = 0.5
r = 0
[[couple]]
joint = "arm"
equals = { "motor" = "-1/5" }
offset = "pi/2"
[[couple]]
joint = "rack"
equals = { "motor" = 0.02 }
"""


def load(name: str) -> rv.Robot:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rv.RobotWarning)
        return rv.load(robot_file(name), rotors=False, snap="off")


def test_couples_and_independent_joints_are_told() -> None:
    robot = rv.Robot.from_toml(GEARS)
    assert robot.moving == ("motor", "rack", "arm")
    assert (robot.n, robot.joints) == (1, ("motor",))
    assert robot.couples == (
        rv.Couple("arm", {"motor": "-1/5"}, "pi/2"),
        rv.Couple("rack", {"motor": "0.02"}, "0"),
    )
    assert [link.rotor for link in robot.links] == [True, False, False]
    assert rv.Robot.from_toml(robot.to_toml()) == robot


def test_states_and_rows_are_those_of_the_independent_joints() -> None:
    robot = rv.Robot.from_toml(GEARS)
    rng = np.random.default_rng(1)
    q, qd, qdd = rng.uniform(-2, 2, (3, 7, 1))
    assert robot.regressor(q, qd, qdd).shape == (7, 1, 31)
    with pytest.raises(rv.ShapeError, match="expected \\(1,\\)"):
        robot.regressor(*np.zeros((3, 7, 3)))
    tree = rv.Robot.from_toml(GEARS.split("[[couple]]")[0].replace("r = 0", "r = 0\nrotor = true"))
    g, start = np.array([1, 0.02, -0.2]), np.array([0, 0, np.pi / 2])
    every = [q * g + start, qd * g, qdd * g]
    rows = np.einsum("i,kic->kc", g, tree.regressor(*every))
    shared = [tree.parameters.index(label) for label in robot.parameters]
    assert np.allclose(robot.regressor(q, qd, qdd)[:, 0], rows[:, shared], rtol=0, atol=1e-12)


def test_the_diagnosis_tells_what_the_couples_remove() -> None:
    base = rv.load("hitachi_hpr").base_parameters()
    structure = base.diagnosis.structure
    assert structure is not None
    assert (base.rank, structure.tree_rank, len(structure.removed)) == (35, 46, 11)
    assert "MX_5" in structure.removed
    tree = rv.load("puma560").base_parameters().diagnosis.structure
    assert tree is not None
    assert (tree.tree_rank, tree.removed) == (None, ())


@pytest.mark.parametrize("name", MIMIC)
def test_torques_are_those_of_pinocchio_on_the_opened_tree(name: str) -> None:
    pin = pytest.importorskip("pinocchio")
    robot = load(name)
    assert len(robot.couples) == MIMIC[name] == len(robot.moving) - robot.n
    model = pin.buildModelFromUrdf(str(robot_file(name)))
    data = model.createData()
    ids = [model.getJointId(joint) for joint in robot.moving]
    assert 0 < min(ids) <= max(ids) < model.njoints
    g, start = np.zeros((len(robot.moving), robot.n)), np.zeros(len(robot.moving))
    row = {joint: i for i, joint in enumerate(robot.moving)}
    for k, joint in enumerate(robot.joints):
        g[row[joint], k] = 1
    for couple in robot.couples:  # these files have no chains
        ((source, multiplier),) = couple.equals.items()
        g[row[couple.joint]] = float(multiplier) * g[row[source]]
        start[row[couple.joint]] = float(couple.offset)
    rng = np.random.default_rng(0)
    for q, qd, qdd in rng.uniform(-2, 2, (20, 3, robot.n)):
        every = start + g @ q, g @ qd, g @ qdd
        configuration, v, a = pin.neutral(model), np.zeros(model.nv), np.zeros(model.nv)
        for i, joint in enumerate(ids):
            at, velocity = model.joints[joint].idx_q, model.joints[joint].idx_v
            angle = every[0][i]
            if model.joints[joint].nq == 2:
                configuration[at : at + 2] = np.cos(angle), np.sin(angle)
            else:
                configuration[at] = angle
            v[velocity], a[velocity] = every[1][i], every[2][i]
        tau = pin.rnea(model, data, configuration, v, a)
        expected = g.T @ [tau[model.joints[joint].idx_v] for joint in ids]
        ours = robot.torques(q, qd, qdd)
        assert np.abs(ours - expected).max() <= ROUNDING * (1 + np.abs(tau).max())


def test_inverse_dynamics_are_those_of_mujoco_with_a_joint_equality() -> None:
    """Torques at the motor that hold the coupled joint's constraint force up."""
    mujoco = pytest.importorskip("mujoco")
    xml = """
    <mujoco><option gravity="0 -9.81 0" timestep="0.001"/><worldbody>
      <body><joint name="a" axis="0 0 1"/>
        <inertial pos=".1 .02 0" mass="2" diaginertia=".1 .1 .1"/>
        <body pos=".5 0 0"><joint name="b" axis="0 0 1"/>
          <inertial pos=".2 0 0" mass="1.5" diaginertia=".05 .06 .07"/></body></body>
    </worldbody>
    <equality><joint joint1="b" joint2="a" polycoef="0.3 -2 0 0 0"/></equality></mujoco>"""
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    robot = rv.Robot.from_toml(
        """
        gravity = [0, -9.81, 0]
        [[link]]
        name = "a"
        rotor = false
        alpha = 0
        d = 0
        r = 0
        inertia = { M = 2, MX = 0.2, MY = 0.04, XX = 0.1008, XY = -0.004, YY = 0.12, ZZ = 0.1208 }
        [[link]]
        name = "b"
        alpha = 0
        d = 0.5
        r = 0
        inertia = { M = 1.5, MX = 0.3, XX = 0.05, YY = 0.12, ZZ = 0.13 }
        [[couple]]
        joint = "b"
        equals = { "a" = -2 }
        offset = 0.3
        """
    )
    g = np.array([1.0, -2.0])
    for q, qd, qdd in np.random.default_rng(3).uniform(-2, 2, (20, 3)):
        data.qpos[:], data.qvel[:], data.qacc[:] = g * q + [0, 0.3], g * qd, g * qdd
        mujoco.mj_inverse(model, data)
        # Virtual work: the constraint's force on (a, b), which MuJoCo takes out, is
        # orthogonal to g.
        expected = g @ data.qfrc_inverse
        assert robot.torques([q], [qd], [qdd]) == pytest.approx([expected], rel=1e-11)
