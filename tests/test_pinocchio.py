"""The regressor and the torques against Pinocchio, joint by joint, parameter by parameter."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
import roberval as rv
from wheels import robot_file

Array = npt.NDArray[np.float64]

PEER_ERROR = 1e-14
"""Relative to the largest entry (issue 5); two recursions differ by 4e-15 and less."""

KINDS = ("M", "MX", "MY", "MZ", "XX", "XY", "YY", "XZ", "YZ", "ZZ")
"""Pinocchio's m, m c, Ixx Ixy Iyy Ixz Iyz Izz about the joint's frame, in our names."""

ROBOTS = {
    "ur5": "erd/ur_description/urdf/ur5_robot.urdf",
    "ur10": "erd/ur_description/urdf/ur10_robot.urdf",
    "kinova, continuous joints": "erd/kinova_description/robots/kinova.urdf",
    "xarm7": "erd/xarm_description/urdf/xarm7.urdf",
    "z1": "erd/z1_description/urdf/z1.urdf",
    "so100, tilted axes": "erd/so_arm_description/urdf/so100.urdf",
    "solo12, quadruped": "erd/solo_description/robots/solo12.urdf",
    "anymal, quadruped": "erd/anymal_b_simple_description/robots/anymal.urdf",
    "hyq, quadruped": "erd/hyq_description/robots/hyq_no_sensors.urdf",
    "allegro, hand": "erd/allegro_hand_description/urdf/allegro_left_hand.urdf",
    "alex, humanoid, axes askew": "erd/alex_description/urdf/alex_nub_hands.urdf",
    "g1, humanoid": "erd/g1_description/urdf/g1_29dof_rev_1_0.urdf",
    "romeo, humanoid": "erd/romeo_description/urdf/romeo_small.urdf",
    "talos, humanoid": "erd/talos_data/robots/talos_reduced.urdf",
    "icub, humanoid": "erd/icub_description/robots/icub_reduced.urdf",
}

pin = pytest.importorskip("pinocchio", reason="pin is not installed: pip install roberval[peers]")


class Pair:
    """One robot read by both libraries."""

    def __init__(self, name: str) -> None:
        path = robot_file(ROBOTS[name])
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", rv.RobotWarning)
            self.robot = rv.load(path, snap="off")  # Pinocchio takes 1.5708 literally
        self.model = pin.buildModelFromUrdf(str(path))
        self.data = self.model.createData()
        joints = [j.joint_name or j.name for j in self.robot.links]
        self.joints = [self.model.getJointId(name) for name in joints]
        self.velocities = [self.model.idx_vs[joint] for joint in self.joints]

    def columns(self) -> list[int]:
        """Our column of each of Pinocchio's parameters, joint after joint in our order."""
        column = {label: at for at, label in enumerate(self.robot.parameters)}
        return [column[f"{kind}_{link.name}"] for link in self.robot.links for kind in KINDS]

    def configuration(self, q: Array) -> Array:
        """Pinocchio's q: continuous joints are (cos, sin)."""
        configuration = np.array(pin.neutral(self.model))
        for joint, value in zip(self.joints, q, strict=True):
            at = self.model.idx_qs[joint]
            if self.model.nqs[joint] == 2:
                configuration[at : at + 2] = np.cos(value), np.sin(value)
            else:
                configuration[at] = value
        return configuration

    def velocity(self, values: Array) -> Array:
        """Pinocchio's order of velocities."""
        velocity = np.zeros(self.model.nv)
        velocity[self.velocities] = values
        return velocity

    def regressor(self, q: Array, qd: Array, qdd: Array) -> Array:
        """Pinocchio's regressor with our rows, and its columns joint by joint in our order."""
        state = (self.configuration(q), self.velocity(qd), self.velocity(qdd))
        full = np.array(pin.computeJointTorqueRegressor(self.model, self.data, *state))
        blocks = [np.arange(10) + 10 * (joint - 1) for joint in self.joints]
        return np.asarray(full[np.ix_(self.velocities, np.concatenate(blocks))])

    def parameters(self) -> Array:
        """Pinocchio's parameters, joint by joint in our order."""
        inertias = [self.model.inertias[joint] for joint in self.joints]
        return np.concatenate([inertia.toDynamicParameters() for inertia in inertias])

    def torques(self, q: Array, qd: Array, qdd: Array) -> Array:
        state = (self.configuration(q), self.velocity(qd), self.velocity(qdd))
        return np.asarray(pin.rnea(self.model, self.data, *state))[self.velocities]

    def states(self, count: int, seed: int) -> Any:
        random = np.random.default_rng(seed)
        for _ in range(count):
            yield tuple(random.uniform(-3, 3, self.robot.n) for _ in range(3))


@pytest.fixture(params=ROBOTS, scope="module")
def pair(request: pytest.FixtureRequest) -> Pair:
    return Pair(request.param)


def test_both_know_the_same_joints(pair: Pair) -> None:
    assert pair.robot.n == pair.model.nv
    assert sorted(pair.joints) == list(range(1, pair.model.njoints))


def test_regressor_is_pinocchios(pair: Pair) -> None:
    columns = pair.columns()
    for state in pair.states(5, seed=1):
        ours = pair.robot.regressor(*state)[:, columns]
        theirs = pair.regressor(*state)
        assert np.abs(ours - theirs).max() <= PEER_ERROR * np.abs(theirs).max()


def test_other_columns_are_rotor_inertias_times_acceleration(pair: Pair) -> None:
    others = sorted(set(range(len(pair.robot.parameters))) - set(pair.columns()))
    labels = [pair.robot.parameters[column] for column in others]
    joint = {f"Ia_{link.name}": row for row, link in enumerate(pair.robot.links)}
    for q, qd, qdd in pair.states(2, seed=2):
        expected = np.zeros((pair.robot.n, len(others)))
        for column, label in enumerate(labels):
            expected[joint[label], column] = qdd[joint[label]]
        assert (pair.robot.regressor(q, qd, qdd)[:, others] == expected).all()


def test_inertial_values_are_pinocchios(pair: Pair) -> None:
    ours, theirs = pair.robot.X, pair.parameters()
    assert ours is not None
    assert np.abs(ours[pair.columns()] - theirs).max() <= PEER_ERROR * np.abs(theirs).max()


def test_torques_are_pinocchios(pair: Pair) -> None:
    for state in pair.states(5, seed=3):
        ours, theirs = pair.robot.torques(*state), pair.torques(*state)
        assert np.abs(ours - theirs).max() <= PEER_ERROR * np.abs(theirs).max()
