"""Robots on a base that floats, and planar joints: against Pinocchio and published counts."""

from __future__ import annotations

import json
import pickle
import warnings
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
import roberval as rv
from conftest import random_states
from wheels import robot_file

Array = npt.NDArray[np.float64]

PEER_ERROR = 1e-14
"""Relative to the largest entry (issue 5); two recursions differ by 4e-15 and less."""

KINDS = ("M", "MX", "MY", "MZ", "XX", "XY", "YY", "XZ", "YZ", "ZZ")
"""Pinocchio's parameters of a body, in our names."""

ROBOTS = {
    "ur5": "erd/ur_description/urdf/ur5_robot.urdf",
    "solo12": "erd/solo_description/robots/solo12.urdf",
    "anymal": "erd/anymal_b_simple_description/robots/anymal.urdf",
    "a1": "erd/a1_description/urdf/a1.urdf",
    "go2": "erd/go2_description/urdf/go2.urdf",
    "g1": "erd/g1_description/urdf/g1_29dof_rev_1_0.urdf",
    "talos": "erd/talos_data/robots/talos_reduced.urdf",
    "icub": "erd/icub_description/robots/icub_reduced.urdf",
}

COUNTS = {
    "erd/asr_twodof_description/urdf/TwoDofs.urdf": 24,
    "erd/finger_edu_description/robots/finger_edu.urdf": 31,
    "rtb/lynxmotion_al5d_description/urdf/al5d_robot.urdf": 38,
    "erd/ur_description/urdf/ur5_robot.urdf": 52,
    "erd/ur_description/urdf/ur10_robot.urdf": 52,
    "erd/kinova_description/robots/kinova.urdf": 52,
    "erd/bolt_description/robots/bolt.urdf": 52,
    "erd/xarm_description/urdf/xarm7.urdf": 59,
    "erd/talos_data/robots/talos_left_arm.urdf": 59,
    "erd/tiago_description/robots/tiago_no_hand.urdf": 91,
    "erd/solo_description/robots/solo12.urdf": 94,
    "erd/a1_description/urdf/a1.urdf": 94,
    "erd/go2_description/urdf/go2.urdf": 94,
    "erd/anymal_b_simple_description/robots/anymal.urdf": 94,
    "erd/anymal_c_simple_description/urdf/anymal.urdf": 94,
    "erd/allegro_hand_description/urdf/allegro_left_hand.urdf": 122,
    "erd/g1_description/urdf/g1_29dof_rev_1_0.urdf": 213,
    "erd/icub_description/robots/icub.urdf": 234,
    "erd/talos_data/robots/talos_reduced.urdf": 234,
}
"""Rank at random states of the rigid bodies' parameters alone, computed by other programs."""

BODY = """<link name='{0}'><inertial><origin xyz='0.1 -0.2 0.3' rpy='0.4 0.5 0.6'/>
<mass value='{1}'/><inertia ixx='1' ixy='.1' ixz='.2' iyy='2' iyz='.3' izz='2.5'/>
</inertial></link>"""

FREE = f"""<robot name='r'><link name='world'/>{BODY.format("hull", 3)}{BODY.format("fin", 2)}
<joint name='free' type='floating'><parent link='world'/><child link='hull'/>
<origin xyz='1 2 3' rpy='0.3 -0.8 2'/></joint>
<joint name='hinge' type='revolute'><parent link='hull'/><child link='fin'/>
<origin xyz='.1 .2 .3' rpy='1 0 .5'/><axis xyz='0 1 0'/>
<limit lower='-9' upper='9' effort='1' velocity='1'/></joint></robot>"""

PLANAR = FREE.replace("'floating'", "'planar'").replace("2'/></joint>", "2'/>{0}</joint>", 1)


def load(name: str, **options: Any) -> rv.Robot:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rv.RobotWarning)
        return rv.load(robot_file(name), **options)


def from_urdf(text: str, **options: Any) -> rv.Robot:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rv.RobotWarning)
        return rv.Robot.from_urdf(text, **options)


class Peer:
    """The same robot in Pinocchio."""

    def __init__(self, robot: rv.Robot, model: Any) -> None:
        self.pin = pytest.importorskip("pinocchio", reason="pip install roberval[peers]")
        self.robot, self.model, self.data = robot, model, model.createData()
        names = [link.joint_name or "root_joint" for link in robot.links]
        self.joints = [model.getJointId(name) for name in names]
        spans = [(model.idx_vs[joint], model.nvs[joint]) for joint in self.joints]
        self.rows = np.concatenate([np.arange(at, at + n) for at, n in spans])

    def configuration(self, q: Array) -> Array:
        """Pinocchio's q: that of the base is ours, continuous joints are (cos, sin)."""
        configuration = np.array(self.pin.neutral(self.model))
        base = self.model.idx_qs[self.joints[0]]
        configuration[base : base + 7] = q[:7]
        for joint, value in zip(self.joints[1:], q[7:], strict=True):
            at = self.model.idx_qs[joint]
            if self.model.nqs[joint] == 2:
                configuration[at : at + 2] = np.cos(value), np.sin(value)
            else:
                configuration[at] = value
        return configuration

    def state(self, q: Array, qd: Array, qdd: Array) -> tuple[Array, Array, Array]:
        velocities = np.zeros((2, self.model.nv))
        velocities[:, self.rows] = qd, qdd
        return self.configuration(q), velocities[0], velocities[1]

    def regressor(self, *state: Array) -> Array:
        """Our rows, and Pinocchio's columns body by body in our order."""
        full = np.array(
            self.pin.computeJointTorqueRegressor(self.model, self.data, *self.state(*state))
        )
        blocks = [np.arange(10) + 10 * (joint - 1) for joint in self.joints]
        return np.asarray(full[np.ix_(self.rows, np.concatenate(blocks))])

    def torques(self, *state: Array) -> Array:
        torques: Array = np.array(self.pin.rnea(self.model, self.data, *self.state(*state)))
        return np.asarray(torques[self.rows])

    def check(self) -> None:
        labels = self.robot.parameters
        columns = [labels.index(f"{kind}_{x.name}") for x in self.robot.links for kind in KINDS]
        for state in zip(*random_states(self.robot, 5, seed=1), strict=True):
            ours, theirs = self.robot.regressor(*state)[:, columns], self.regressor(*state)
            assert np.abs(ours - theirs).max() <= PEER_ERROR * np.abs(theirs).max()
            ours, theirs = self.robot.torques(*state), self.torques(*state)
            assert np.abs(ours - theirs).max() <= PEER_ERROR * np.abs(theirs).max()


@pytest.mark.parametrize("name", ROBOTS)
def test_regressor_and_torques_are_those_of_pinocchios_free_flyer(name: str) -> None:
    pin = pytest.importorskip("pinocchio", reason="pip install roberval[peers]")
    robot = load(ROBOTS[name], floating=True, snap="off")
    path = str(robot_file(ROBOTS[name]))
    peer = Peer(robot, pin.buildModelFromUrdf(path, pin.JointModelFreeFlyer()))
    assert (robot.n, robot.nq - 7) == (peer.model.nv, robot.n - 6)
    assert len(robot.links) == peer.model.njoints - 1
    peer.check()


def test_a_floating_joint_placed_askew_is_pinocchios() -> None:
    pin = pytest.importorskip("pinocchio", reason="pip install roberval[peers]")
    robot = from_urdf(FREE)
    assert robot.velocities[-2:] == ("hull.wz", "hinge")
    Peer(robot, pin.buildModelFromXML(FREE)).check()


@pytest.mark.parametrize("name", ["solo12", "talos"])
def test_generated_code_gives_pinocchios_torques_and_mass_matrix(name: str) -> None:
    pin = pytest.importorskip("pinocchio", reason="pip install roberval[peers]")
    robot = load(ROBOTS[name], floating=True, rotors=False, snap="off")
    path = str(robot_file(ROBOTS[name]))
    peer = Peer(robot, pin.buildModelFromUrdf(path, pin.JointModelFreeFlyer()))
    base = robot.base_parameters()
    scope: dict[str, Any] = {}
    functions = {}
    for what in ("tau", "mass"):
        code = base.code("python", what)
        exec(code.text, scope)
        function, parameters = (
            scope[code.function],
            scope[f"{code.function}_prepare"](base.values()),
        )
        functions[what] = partial(function, k=parameters)
    for q, qd, qdd in zip(*random_states(robot, 5, seed=2), strict=True):
        theirs = peer.torques(q, qd, qdd)
        ours = functions["tau"](q, qd, qdd)
        assert np.abs(ours - theirs).max() <= PEER_ERROR * np.abs(theirs).max()
        upper = np.triu(pin.crba(peer.model, peer.data, peer.configuration(q)))
        theirs = (upper + np.triu(upper, 1).T)[np.ix_(peer.rows, peer.rows)]
        ours = functions["mass"](q)
        assert np.abs(ours - theirs).max() <= PEER_ERROR * np.abs(theirs).max()


@pytest.mark.filterwarnings("ignore::roberval.RobotWarning")
@pytest.mark.parametrize("name", COUNTS)
def test_counts_are_the_references_by_every_engine(name: str) -> None:
    robot = load(name, floating=True, rotors=False)
    base = robot.base_parameters()
    assert len(base.diagnosis.witnesses) == 3
    assert {base.rank, *(witness.rank for witness in base.diagnosis.witnesses)} == {COUNTS[name]}


@pytest.mark.filterwarnings("ignore::roberval.RobotWarning")
@pytest.mark.parametrize("name", ["solo12", "go2", "g1"])
def test_each_rotor_adds_one_to_the_count_of_a_floating_robot(name: str) -> None:
    robot = load(ROBOTS[name], floating=True)
    rotors = sum(link.rotor for link in robot.links)
    assert rotors == robot.n - 6
    assert robot.base_parameters().rank == COUNTS[ROBOTS[name]] + rotors


def test_a_planar_joint_has_the_base_parameters_of_three_joints() -> None:
    robot = from_urdf(PLANAR.format("<axis xyz='0 0 1'/>"))
    assert robot.joints == ("free.x", "free.y", "free", "hinge")
    assert len(robot.parameters) == 10 + 11
    # The plane is askew, so that gravity acts in it.
    base = robot.base_parameters()
    assert robot.compare().agree
    assert set(base.base) >= {"M_hull", "MX_hull", "MY_hull", "ZZ_hull", "Ia_fin"}
    assert base.diagnosis.clear


@pytest.mark.parametrize("axis", ["0 0 1", "0 -1 0", "1 2 -2", "0.6 0 0.8"])
def test_a_planar_joint_does_the_work_of_forces_in_its_plane(axis: str) -> None:
    """With gravity along the normal, sliding takes force only to accelerate."""
    text = PLANAR.format(f"<axis xyz='{axis}'/>").replace("rpy='0.3 -0.8 2'", "")
    normal = np.array([float(x) for x in axis.split()])
    normal /= np.linalg.norm(normal)
    robot = from_urdf(text, gravity=[str(-9 * x) for x in normal])
    x = dict.fromkeys(robot.parameters, 0.0) | {"M_hull": 3.0}
    q = np.array([0.3, -0.4, 0.5, 0.6])
    still = np.zeros(4)
    assert np.abs(robot.torques(q, still, still, x)).max() <= 1e-12
    qdd = np.array([1.0, 2.0, 0.0, 0.0])
    assert np.abs(robot.torques(q, still, qdd, x) - 3 * qdd).max() <= 1e-12


def test_power_of_wrench_and_torques_is_the_rate_of_energy() -> None:
    pin = pytest.importorskip("pinocchio", reason="pip install roberval[peers]")
    robot = load(ROBOTS["solo12"], floating=True, snap="off")
    model = pin.buildModelFromUrdf(str(robot_file(ROBOTS["solo12"])), pin.JointModelFreeFlyer())
    peer, step = Peer(robot, model), 1e-5
    for q, qd, qdd in zip(*random_states(robot, 3, seed=2), strict=True):
        configuration, velocity, acceleration = peer.state(q, qd, qdd)
        h = []
        for t in (-step, step):
            at = pin.integrate(model, configuration, velocity * t + acceleration * t * t / 2)
            ours = np.concatenate([at[:7], at[7:]])
            for joint, place in zip(peer.joints[1:], range(7, robot.nq), strict=True):
                ours[place] = at[model.idx_qs[joint]]
            h.append(robot.regressor(ours, qd + qdd * t, model="h"))
        rate = (h[1] - h[0]) / (2 * step)
        power = qd @ robot.regressor(q, qd, qdd)
        assert np.abs(rate - power).max() <= 1e-7 * np.abs(power).max()


def test_states_of_a_floating_robot_have_their_shapes() -> None:
    robot = load(ROBOTS["solo12"], floating=True)
    assert (robot.n, robot.nq, len(robot.joints)) == (18, 19, 12)
    assert robot.positions[:2] == ("base_link.x", "base_link.y")
    assert robot.rows[:6] == tuple(f"base_link.{x}" for x in ("fx", "fy", "fz", "mx", "my", "mz"))
    q, qd, qdd = random_states(robot, 4, seed=3)
    width = len(robot.parameters)
    assert robot.regressor(q, qd, qdd).shape == (4, 18, width)
    assert robot.regressor(q[0], qdd=qdd[0], model="d0").shape == (18, width)
    assert robot.regressor(q, qd, model="h").shape == (4, width)
    assert robot.torques(q, qd, qdd).shape == (4, 18)
    with pytest.raises(rv.ShapeError, match=r"q has shape \(18,\), expected \(19,\).*floating"):
        robot.torques(q[0, :18], qd[0], qdd[0])
    with pytest.raises(rv.ShapeError, match=r"qd has shape \(4, 19\), expected \(18,\)"):
        robot.torques(q, q, qdd)
    q[2, 3:7] = 0
    with pytest.raises(rv.ArrayError, match=r"q\[2, 3:7\] has length 0"):
        robot.torques(q, qd, qdd)


def test_a_free_joint_of_mujoco_and_a_free_flyer_of_pinocchio_float() -> None:
    mujoco = pytest.importorskip("mujoco", reason="pip install roberval[peers]")
    pin = pytest.importorskip("pinocchio", reason="pip install roberval[peers]")
    model = mujoco.MjModel.from_xml_string(
        """<mujoco><worldbody><body name='hull'><freejoint/><geom size='.1' mass='3'/>
        <body name='fin' pos='.1 .2 .3'><joint name='hinge' axis='0 1 0' armature='.2'/>
        <geom size='.1' pos='.3 .1 0' mass='2'/></body></body></worldbody></mujoco>"""
    )
    for robot in (
        rv.Robot.from_mujoco(model),
        rv.Robot.from_pinocchio(pin.buildModelFromXML(FREE)),
    ):
        assert robot.is_floating
        assert robot.velocities[0] == "hull.vx"
        assert robot.base_parameters().rank == 10 + 7 + 1
        assert robot.X is not None


def test_samples_that_scale_have_attitudes_and_give_the_same_base() -> None:
    robot = from_urdf(FREE)
    scaling = robot.scale("d", rounds=0, starts=20)
    assert scaling.q.shape == (len(scaling.qd), robot.nq)
    assert np.abs(np.linalg.norm(scaling.q[:, 3:7], axis=1) - 1).max() <= 1e-12
    base = robot.base_parameters(samples=scaling)
    assert base.rank == robot.base_parameters("h").rank == 10 + 7 + 1


def test_a_floating_robot_is_shown_pickled_and_written() -> None:
    puma = rv.load("puma560", floating=True)
    assert repr(puma).startswith("Robot('PUMA 560', 1 floating joint, 6 revolute joints")
    assert puma.base_parameters().rank == 10 + 6 * 8
    for again in (pickle.loads(pickle.dumps(puma)), rv.Robot.from_toml(puma.to_toml())):
        assert again == puma
    hull = from_urdf(FREE)
    assert pickle.loads(pickle.dumps(hull)) == hull
    shown = json.loads(hull.to_json())
    assert shown["robot"]["links"][0]["type"] == "floating"
    assert shown["rows"] == list(hull.rows)
    assert "hull.fx .. hull.mz" in hull.to_markdown()
