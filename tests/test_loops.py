"""Robots with loops: torques against Pinocchio on the tree and MuJoCo with an equality."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
import roberval as rv

Array = npt.NDArray[np.float64]

PEER_ERROR = 1e-11
"""Relative: two recursions and the solution of the loop equations, which are well conditioned."""

LENGTHS = {"ground": 1.0, "crank": 0.3, "coupler": 0.9, "rocker": 0.7}


def four_bar() -> tuple[rv.Robot, Array]:
    """The built-in four-bar with random bodies, and its standard parameters."""
    robot = rv.load("four_bar", rotors=False)
    random = np.random.default_rng(4)
    values = dict.fromkeys(robot.parameters, 0.0)
    for link in robot.links:
        mass = random.uniform(0.5, 2.0)
        com = random.uniform(-0.2, 0.2, 3)
        spread = random.uniform(0.1, 0.3, (3, 3))
        about_com = spread @ spread.T
        about_com = np.trace(about_com) * np.eye(3) - about_com
        inertia = about_com + mass * (com @ com * np.eye(3) - np.outer(com, com))
        values |= dict(
            zip(
                (f"{k}_{link.name}" for k in ("XX", "XY", "XZ", "YY", "YZ", "ZZ")),
                inertia[np.triu_indices(3)],
                strict=True,
            )
        )
        for k, c in zip("XYZ", com, strict=True):
            values[f"M{k}_{link.name}"] = mass * c
        values[f"M_{link.name}"] = mass
    return robot, np.array([values[label] for label in robot.parameters])


def states(count: int) -> tuple[Array, Array, Array]:
    """Return random states of the crank, which turns all the way."""
    random = np.random.default_rng(8)
    q, qd, qdd = random.uniform(-3, 3, (3, count, 1))
    return q, qd, qdd


def body(x: dict[str, float], link: str) -> tuple[float, Array, Array]:
    """Mass, centre of mass and inertia about it."""
    mass = x[f"M_{link}"]
    com = np.array([x[f"M{k}_{link}"] for k in "XYZ"]) / mass
    xx, xy, xz, yy, yz, zz = (x[f"{k}_{link}"] for k in ("XX", "XY", "XZ", "YY", "YZ", "ZZ"))
    inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return mass, com, inertia - mass * (com @ com * np.eye(3) - np.outer(com, com))


def transmission(robot: rv.Robot, q: Array) -> Array:
    """G: the velocities of all joints at unit velocity of the crank."""
    _, qd, _ = robot.expand(q, np.ones_like(q), np.zeros_like(q))
    return qd


def test_torques_are_those_of_pinocchio_on_the_tree_without_the_forces_of_the_loop() -> None:
    pin = pytest.importorskip("pinocchio", reason="pin is not installed")
    robot, x = four_bar()
    values = dict(zip(robot.parameters, x.tolist(), strict=True))
    model = pin.Model()
    model.gravity.linear = robot.gravity
    joints: dict[str, int] = {}
    for link, (parent, at) in {
        "crank": (None, 0.0),
        "coupler": ("crank", LENGTHS["crank"]),
        "rocker": (None, LENGTHS["ground"]),
    }.items():
        place = pin.SE3(np.eye(3), np.array([at, 0, 0]))
        joints[link] = model.addJoint(
            joints[parent] if parent else 0, pin.JointModelRZ(), place, link
        )
        mass, com, inertia = body(values, link)
        model.appendBodyToJoint(joints[link], pin.Inertia(mass, com, inertia), pin.SE3.Identity())
    q, qd, qdd = states(40)
    order = [model.idx_qs[joints[name]] for name in ("crank", "coupler", "rocker")]
    torques = robot.torques(q, qd, qdd, x)
    all_q, all_qd, all_qdd = robot.expand(q, qd, qdd)
    g = transmission(robot, q)
    data = model.createData()
    for k in range(len(q)):
        place = np.empty((3, 3))
        for row, values_k in enumerate((all_q[k], all_qd[k], all_qdd[k])):
            place[row, order] = values_k
        tree = pin.rnea(model, data, *place)[order]
        scale = np.abs(g[k]) @ np.abs(tree)
        assert abs(g[k] @ tree - torques[k, 0]) < PEER_ERROR * scale


MJCF = """
<mujoco>
  <option gravity="0 -9.81 0"/>
  <worldbody>
    <body name="crank"><joint name="crank" axis="0 0 1"/>{crank}
      <body name="coupler" pos="0.3 0 0"><joint name="coupler" axis="0 0 1"/>{coupler}
        <site name="a" pos="0.9 0 0"/></body>
    </body>
    <body name="rocker" pos="1 0 0"><joint name="rocker" axis="0 0 1"/>{rocker}
      <site name="b" pos="0.7 0 0"/></body>
  </worldbody>
  <equality>
    <connect site1="a" site2="b"/>
  </equality>
</mujoco>
"""


def mujoco_model(mujoco: Any, x: dict[str, float]) -> Any:
    """The same four-bar; inertias are diagonal in the frames that they are given in."""
    texts = {}
    for link in ("crank", "coupler", "rocker"):
        mass, com, inertia = body(x, link)
        full = [inertia[0, 0], inertia[1, 1], inertia[2, 2]]
        full += [inertia[0, 1], inertia[0, 2], inertia[1, 2]]
        numbers = " ".join(repr(float(v)) for v in full)
        at = " ".join(repr(float(v)) for v in com)
        texts[link] = f'<inertial pos="{at}" mass="{mass!r}" fullinertia="{numbers}"/>'
    return mujoco.MjModel.from_xml_string(MJCF.format(**texts))


def test_torques_are_those_of_mujocos_inverse_dynamics_with_an_equality_constraint() -> None:
    mujoco = pytest.importorskip("mujoco", reason="mujoco is not installed")
    robot, x = four_bar()
    model = mujoco_model(mujoco, dict(zip(robot.parameters, x.tolist(), strict=True)))
    data = mujoco.MjData(model)
    q, qd, qdd = states(40)
    torques = robot.torques(q, qd, qdd, x)
    all_q, all_qd, all_qdd = robot.expand(q, qd, qdd)
    g = transmission(robot, q)
    for k in range(len(q)):
        data.qpos[:], data.qvel[:], data.qacc[:] = all_q[k], all_qd[k], all_qdd[k]
        mujoco.mj_inverse(model, data)
        # The constraint is active, and its forces do no work on the motion of the loop.
        assert data.nefc >= 2
        jacobian = data.efc_J.reshape(-1, model.nv)[: data.nefc]
        np.testing.assert_allclose(jacobian @ g[k], 0, atol=1e-12)
        assert np.abs(data.efc_pos[: data.nefc]).max() < 1e-12
        work = g[k] @ (data.qfrc_inverse + data.qfrc_constraint)
        scale = np.abs(g[k]) @ (np.abs(data.qfrc_inverse) + np.abs(data.qfrc_constraint))
        assert abs(work - torques[k, 0]) < PEER_ERROR * scale
        assert abs(g[k] @ data.qfrc_inverse - torques[k, 0]) < PEER_ERROR * scale


def test_the_loop_is_closed_at_every_state() -> None:
    robot, _ = four_bar()
    q, qd, qdd = robot.expand(*states(200))
    crank, coupler, rocker = q.T
    u = np.exp(1j * crank)
    end = LENGTHS["crank"] * u + LENGTHS["coupler"] * u * np.exp(1j * coupler)
    other = LENGTHS["ground"] + LENGTHS["rocker"] * np.exp(1j * rocker)
    np.testing.assert_allclose(end, other, atol=1e-12)
    assert (np.imag(end) > 0).all(), "the other assembly mode"
    assert qd.shape == qdd.shape == (200, 3)


def test_the_answer_says_how_it_was_decided_and_what_the_loop_removes() -> None:
    base = rv.load("four_bar").base_parameters()
    assert (base.rank, base.engine) == (8, "precise")
    assert base.diagnosis.structure is None
    assert base.diagnosis.precision is not None
    assert base.diagnosis.precision.gap is not None
    assert base.diagnosis.precision.gap > 1e20
    text = base.to_markdown()
    assert "not an exact decision" in " ".join(text.split())
    assert "exact elimination" not in text
    assert "MX_rocker" in text


def test_a_robot_with_loops_is_built_from_its_text() -> None:
    robot = rv.load("four_bar")
    assert rv.Robot.from_toml(robot.to_toml()) == robot
    assert robot.loops == (rv.Loop(("coupler", "rocker"), "revolute"),)
    assert (robot.n, robot.joints) == (1, ("crank",))
    closed = robot.closed
    assert closed is not None
    assert closed.shape == (3,)


def test_a_state_that_the_loop_cannot_reach_is_told_with_its_number() -> None:
    toml = rv.load("four_bar").to_toml().replace("d = 0.3", "d = 0.7")
    robot = rv.Robot.from_toml(toml.replace("crank = 1,", "crank = 0.5,"))
    q = np.array([[0.5], [3.0]])
    with pytest.raises(rv.ArrayError, match="sample 1: the loops cannot be closed"):
        robot.regressor(q, q, q)
