"""Base parameters of real robots against counts found by other means.

The counts are exact ranks of the same files, computed once by an independent program modulo a
prime, rotor inertias included. "Clean": angles within 1e-4 rad of a multiple of pi/12 set right,
dust taken for zero. "Literal": decimals as written.
"""

from __future__ import annotations

import warnings

import pytest
import roberval as rv
from wheels import robot_file

COUNTS = {
    "erd/asr_twodof_description/urdf/TwoDofs.urdf": (7, 5, 5),
    "erd/borinot_description/urdf/borinot_flying_arm_2.urdf": (9, 7, 7),
    "rtb/lynxmotion_al5d_description/urdf/al5d_robot.urdf": (34, 24, 27),
    "erd/hextilt_description/urdf/hextilt_flying_arm_5.urdf": (36, 26, 27),
    "rtb/abb_irb140_description/urdf/irb140.urdf": (56, 40, 40),
    "erd/kinova_description/robots/kinova.urdf": (57, 40, 43),
    "rtb/kuka_description/kuka_kr16/urdf/kr16_2.urdf": (56, 40, 40),
    "rtb/unimation_puma560_description/urdf/puma560_robot.urdf": (55, 40, 42),
    "erd/so_arm_description/urdf/so100.urdf": (56, 40, 42),
    "erd/so_arm_description/urdf/so101.urdf": (57, 40, 43),
    "upkie/upkie.urdf": (28, 22, 30),
    "erd/ur_description/urdf/ur10_robot.urdf": (57, 40, 40),
    "erd/ur_description/urdf/ur5_robot.urdf": (57, 40, 40),
    "erd/ur_description/urdf/ur5_gripper.urdf": (57, 40, 40),
    "rtb/kuka_description/kuka_lbr_iiwa/urdf/lbr_iiwa_14_r820.urdf": (67, 48, 48),
    "erd/talos_data/robots/talos_left_arm.urdf": (69, 50, 50),
    "erd/xarm_description/urdf/xarm7.urdf": (66, 48, 49),
    "erd/z1_description/urdf/z1.urdf": (66, 48, 48),
    "erd/anymal_b_simple_description/robots/anymal.urdf": (104, 72, 72),
    "erd/go2_description/urdf/go2.urdf": (104, 72, 72),
    "erd/hyq_description/robots/hyq_no_sensors.urdf": (104, 72, 76),
    "erd/solo_description/robots/solo12.urdf": (104, 72, 72),
    "erd/tiago_description/robots/tiago_no_hand.urdf": (92, 64, 66),
    "erd/allegro_hand_description/urdf/allegro_left_hand.urdf": (142, 102, 102),
    "armar/armar6.urdf": (162, 116, 116),
    "erd/anymal_b_simple_description/robots/anymal-kinova.urdf": (161, 112, 115),
    "erd/alex_description/urdf/alex_nub_hands.urdf": (200, 144, 144),
    "erd/icub_description/robots/icub_reduced.urdf": (294, 214, 217),
    "erd/romeo_description/urdf/romeo_small.urdf": (297, 218, 218),
    "erd/panda_description/urdf/panda.urdf": (87, 54, 55),
    "erd/baxter_description/urdf/baxter.urdf": (178, 109, 111),
    "erd/tiago_pro_description/robots/tiago_pro.urdf": (295, 162, 167),
    "erd/pr2_description/urdf/pr2.urdf": (278, 149, 149),
}
"""c clean, b clean and b literal of each file; the last four have mimic joints."""

RIGID = {
    "erd/asr_twodof_description/urdf/TwoDofs.urdf": 4,
    "erd/borinot_description/urdf/borinot_flying_arm_2.urdf": 6,
    "rtb/lynxmotion_al5d_description/urdf/al5d_robot.urdf": 22,
    "rtb/abb_irb140_description/urdf/irb140.urdf": 36,
    "rtb/kuka_description/kuka_kr16/urdf/kr16_2.urdf": 36,
    "rtb/unimation_puma560_description/urdf/puma560_robot.urdf": 36,
    "erd/kinova_description/robots/kinova.urdf": 36,
    "erd/ur_description/urdf/ur5_robot.urdf": 36,
    "erd/ur_description/urdf/ur10_robot.urdf": 36,
    "erd/so_arm_description/urdf/so100.urdf": 36,
    "erd/so_arm_description/urdf/so101.urdf": 36,
    "rtb/kuka_description/kuka_lbr_iiwa/urdf/lbr_iiwa_14_r820.urdf": 43,
    "erd/xarm_description/urdf/xarm7.urdf": 43,
    "erd/z1_description/urdf/z1.urdf": 43,
    "erd/talos_data/robots/talos_left_arm.urdf": 45,
    "erd/tiago_description/robots/tiago_no_hand.urdf": 58,
    "erd/allegro_hand_description/urdf/allegro_left_hand.urdf": 94,
}
"""Published and recomputed counts of the rigid bodies' parameters alone, fixed base."""

AS_MEANT = {
    "upkie/upkie.urdf": 22,
    "erd/icub_description/robots/icub_reduced.urdf": 216,
    "erd/panda_description/urdf/panda.urdf": 54,
    "erd/tiago_pro_description/robots/tiago_pro.urdf": 166,
}
"""What the diagnosis calls the count as written: there 1.5707963267948966 does mean pi/2."""

FLOAT_SAFE = [name for name, (_, clean, literal) in COUNTS.items() if clean == literal]


def analyse(
    name: str,
    snap: rv.Snap = "default",
    engine: rv.Engine = "exact",
    rotors: bool = True,
    model: rv.Model = "d",
) -> rv.BaseParameters:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rv.RobotWarning)
        warnings.simplefilter("ignore", rv.DoubtfulRankWarning)
        robot = rv.load(robot_file(name), snap=snap, rotors=rotors)
        return robot.base_parameters(model, engine=engine)


@pytest.mark.parametrize("name", COUNTS)
@pytest.mark.parametrize("engine", ["exact", "qr", "qrii", "svd"])
def test_clean_counts_are_the_references_by_every_engine(name: str, engine: rv.Engine) -> None:
    base = analyse(name, engine=engine)
    c = len(base.parameters) - len(base.no_effect)
    assert (c, base.rank) == COUNTS[name][:2]


@pytest.mark.parametrize("name", RIGID)
@pytest.mark.parametrize("engine", ["exact", "qr", "qrii", "svd"])
def test_rigid_counts_are_the_references(name: str, engine: rv.Engine) -> None:
    base = analyse(name, engine=engine, rotors=False)
    assert len(base.parameters) == 10 * len(base.robot.links)
    assert base.rank == RIGID[name]


@pytest.mark.parametrize("name", COUNTS)
def test_literal_counts_are_the_references(name: str) -> None:
    _, clean, literal = COUNTS[name]
    assert analyse(name, snap="off").rank == literal
    told = analyse(name).diagnosis.literal
    expected = AS_MEANT.get(name, literal)
    if clean != expected:
        assert told is not None
        assert told.rank == expected
        assert told.blame


@pytest.mark.parametrize("name", FLOAT_SAFE)
@pytest.mark.parametrize("engine", ["qr", "qrii", "svd"])
def test_floats_count_right_as_written_where_nothing_is_near(name: str, engine: rv.Engine) -> None:
    assert analyse(name, snap="off", engine=engine).rank == COUNTS[name][2]


@pytest.mark.parametrize("model", ["d", "d0", "h"])
@pytest.mark.parametrize("engine", ["qr", "qrii", "svd"])
def test_rounding_of_a_small_column_raises_no_doubt_and_rounded_angles_do(
    model: rv.Model, engine: rv.Engine
) -> None:
    # In h a column of this arm is 1e-5 of what it would be if nothing cancelled.
    name = "erd/kinova_description/robots/kinova.urdf"
    assert analyse(name, engine=engine, model=model).diagnosis.clear
    if model != "h":
        assert not analyse(name, snap="off", engine=engine, model=model).diagnosis.clear
