"""Base parameters of real robots against counts found by other means.

The counts are exact ranks of the same files, computed once by an independent program modulo a
prime, rotor inertias included. Only files whose geometry floats can tell are here: where a file
writes 1.5708 for a right angle the count depends on how that is read.
"""

from __future__ import annotations

import warnings

import pytest
import roberval as rv
from wheels import robot_file

COUNTS = {
    "erd/asr_twodof_description/urdf/TwoDofs.urdf": (22, 7, 5),
    "erd/borinot_description/urdf/borinot_flying_arm_2.urdf": (22, 9, 7),
    "rtb/abb_irb140_description/urdf/irb140.urdf": (66, 56, 40),
    "rtb/kuka_description/kuka_kr16/urdf/kr16_2.urdf": (66, 56, 40),
    "erd/ur_description/urdf/ur5_robot.urdf": (66, 57, 40),
    "erd/ur_description/urdf/ur10_robot.urdf": (66, 57, 40),
    "erd/ur_description/urdf/ur5_gripper.urdf": (66, 57, 40),
    "rtb/kuka_description/kuka_lbr_iiwa/urdf/lbr_iiwa_14_r820.urdf": (77, 67, 48),
    "erd/talos_data/robots/talos_left_arm.urdf": (77, 69, 50),
    "erd/z1_description/urdf/z1.urdf": (77, 66, 48),
    "erd/anymal_b_simple_description/robots/anymal.urdf": (132, 104, 72),
    "erd/go2_description/urdf/go2.urdf": (132, 104, 72),
    "erd/solo_description/robots/solo12.urdf": (132, 104, 72),
    "erd/allegro_hand_description/urdf/allegro_left_hand.urdf": (176, 142, 102),
    "erd/alex_description/urdf/alex_nub_hands.urdf": (209, 200, 144),
    "erd/romeo_description/urdf/romeo_small.urdf": (341, 297, 218),
}
"""C, c and b of each file."""


@pytest.mark.parametrize("name", COUNTS)
@pytest.mark.parametrize("engine", ["qr", "qrii", "svd"])
@pytest.mark.filterwarnings("ignore::roberval.RobotWarning")
def test_counts_are_the_references(name: str, engine: rv.Engine) -> None:
    robot = rv.load(robot_file(name))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rv.DoubtfulRankWarning)  # rounded angles, right count
        base = robot.base_parameters(engine=engine)
    C = len(base.parameters)
    assert (C, C - len(base.no_effect), base.rank) == COUNTS[name]
