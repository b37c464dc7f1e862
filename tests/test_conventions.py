"""Parameters in others' orders, judged by the others."""

from __future__ import annotations

import numpy as np
import pytest
import roberval as rv
from hypothesis import given
from hypothesis import strategies as st

ROUNDING = 1e-10
"""Values up to 100; roots and eigenvectors cost some digits."""


@st.composite
def bodies(draw: st.DrawFn) -> np.ndarray:
    """Ten parameters of a body that exists."""
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    points = random.normal(size=(4, 3)) + random.normal(size=3)
    masses = random.uniform(0.1, 2, 4)
    tensor = sum(
        m * ((p @ p) * np.eye(3) - np.outer(p, p)) for m, p in zip(masses, points, strict=True)
    )
    return np.array([*tensor[np.triu_indices(3)], *(masses @ points), masses.sum()])


@given(bodies())
def test_every_convention_leads_back(paper: np.ndarray) -> None:
    for name in ("paper", "pinocchio", "urdf", "mujoco"):
        convention = rv.convention(name)
        there = convention.from_paper(paper)
        assert there.shape == (len(convention.columns),)
        np.testing.assert_allclose(convention.to_paper(there), paper, atol=ROUNDING)


@given(bodies())
def test_pinocchios_order_is_that_of_to_dynamic_parameters(paper: np.ndarray) -> None:
    pin = pytest.importorskip("pinocchio")
    mass, *rest = rv.convention("urdf").from_paper(paper)
    xx, xy, xz, yy, yz, zz = rest[3:]
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    inertia = pin.Inertia(mass, np.array(rest[:3]), tensor)
    there = rv.convention("pinocchio").from_paper(paper)
    np.testing.assert_allclose(there, inertia.toDynamicParameters(), atol=ROUNDING)


@given(bodies())
def test_mujocos_numbers_are_those_of_a_compiled_model(paper: np.ndarray) -> None:
    mujoco = pytest.importorskip("mujoco")
    mass, x, y, z, xx, xy, xz, yy, yz, zz = rv.convention("urdf").from_paper(paper).tolist()
    model = mujoco.MjModel.from_xml_string(
        f"""<mujoco><worldbody><body><joint/><inertial mass="{mass}" pos="{x} {y} {z}"
        fullinertia="{xx} {yy} {zz} {xy} {xz} {yz}"/></body></worldbody></mujoco>"""
    )
    numbers = rv.convention("mujoco").from_paper(paper)
    np.testing.assert_allclose(numbers[0], model.body_mass[1], atol=ROUNDING)
    np.testing.assert_allclose(numbers[1:4], model.body_ipos[1], atol=ROUNDING)
    np.testing.assert_allclose(numbers[8:], model.body_inertia[1], atol=ROUNDING)
    theirs = np.concatenate(
        [model.body_mass[1:2], model.body_ipos[1], model.body_iquat[1], model.body_inertia[1]]
    )
    np.testing.assert_allclose(rv.convention("mujoco").to_paper(theirs), paper, atol=ROUNDING)


@pytest.mark.parametrize("name", ["paper", "pinocchio", "urdf", "mujoco"])
def test_a_whole_robots_parameters_lead_back(name: rv.conventions.Order) -> None:
    robot = rv.load("torso")
    random = np.random.default_rng(0)
    X = random.uniform(-1, 1, len(robot.parameters))
    X[[label.startswith("M_") for label in robot.parameters]] = 2.0
    order = robot.order(name)
    numbers, armature = order.from_paper(X)
    assert numbers.shape == (len(robot.links), len(order.convention.columns))
    np.testing.assert_allclose(order.to_paper(numbers, armature), X, atol=ROUNDING)


def test_what_has_no_such_form_is_refused() -> None:
    massless = np.zeros(10)
    massless[6] = 1.0
    with pytest.raises(rv.ArrayError, match="without mass"):
        rv.convention("urdf").from_paper(massless)
    with pytest.raises(rv.ArrayError, match="quaternion"):
        rv.convention("mujoco").to_paper(np.zeros(11))
    with pytest.raises(rv.ShapeError, match="Ixx Ixy Iyy"):
        rv.convention("pinocchio").to_paper(np.zeros(9))
    with pytest.raises(rv.OptionError, match="'mujoco'"):
        rv.convention("drake")  # type: ignore[arg-type]
