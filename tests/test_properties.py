"""What holds for every robot: generated chains and trees."""

from __future__ import annotations

from typing import Any

import numpy as np
import roberval as rv
from hypothesis import given, settings
from hypothesis import strategies as st

ROUNDING = 1e-11
"""Relative to the largest entry: up to 6 links, 50 samples, sums of some hundred products."""

LENGTHS = st.sampled_from([0, 0.1, 0.25, "L", "1/3", "-0.4"])
ANGLES = st.sampled_from([0, "pi/2", "-90 deg", "pi", "30 deg", 0.7])
GRAVITIES: list[tuple[float | str, ...]] = [(0, 0, "-9.81"), (0, 0, 0), (1, -2, 3)]


@st.composite
def robots(draw: st.DrawFn) -> rv.Robot:
    """Draw a chain or tree of one to six links with at least one moving joint."""
    count = draw(st.integers(1, 6))
    rows: list[dict[str, Any]] = []
    for index in range(count):
        first = index == 0
        antecedent = "base" if first else f"L{draw(st.integers(0, index - 1))}"
        joints = ["revolute", "prismatic"] if first else ["revolute", "prismatic", "fixed"]
        row = {key: draw(ANGLES) for key in ("alpha", "theta", "gamma")}
        row |= {key: draw(LENGTHS) for key in ("d", "r", "b")}
        row |= {
            "name": f"L{index}",
            "antecedent": antecedent,
            "joint": draw(st.sampled_from(joints)),
        }
        rows.append(row)
    gravity = draw(st.sampled_from(GRAVITIES))
    return rv.Robot.from_mdh(rows, gravity=gravity, constants={"L": "0.35"})


def states(robot: rv.Robot, count: int) -> Any:
    return np.random.default_rng(robot.n).uniform(-2, 2, (3, count, robot.n))


def near(a: Any, b: Any, scale: Any) -> bool:
    return bool(
        np.abs(a - b).max(initial=0) <= ROUNDING * max(np.abs(scale).max(initial=0), 1e-300)
    )


@given(robots(), st.integers(0, 5))
@settings(max_examples=60)
def test_shapes_follow_the_states(robot: rv.Robot, count: int) -> None:
    n, C = robot.n, len(robot.parameters)
    q, qd, qdd = states(robot, count)
    assert robot.regressor(q, qd, qdd).shape == (count, n, C)
    assert robot.regressor(q, qd, qdd, "d0").shape == (count, n, C)
    assert robot.regressor(q, qd, qdd, "h").shape == (count, C)
    for k in range(count):
        one = robot.regressor(q[k], qd[k], qdd[k])
        assert (one == robot.regressor(q, qd, qdd)[k]).all()


@given(robots())
@settings(max_examples=60)
def test_a_reshape_gives_w_and_w_times_x_the_torques(robot: rv.Robot) -> None:
    q, qd, qdd = states(robot, 7)
    X = np.random.default_rng(1).normal(size=len(robot.parameters))
    rows = robot.regressor(q, qd, qdd)
    W = rows.reshape(-1, X.size)
    assert np.shares_memory(W, rows), "no copy: the order is that of W"
    torques = robot.torques(q, qd, qdd, X)
    assert near((W @ X).reshape(torques.shape), torques, W)


@given(robots())
@settings(max_examples=60)
def test_at_rest_d_is_d0(robot: rv.Robot) -> None:
    q, _, qdd = states(robot, 3)
    zero = np.zeros_like(q)
    assert (robot.regressor(q, zero, qdd) == robot.regressor(q, qdd=qdd, model="d0")).all()


@given(robots())
@settings(max_examples=60)
def test_power_is_the_derivative_of_energy(robot: rv.Robot) -> None:
    (q,), (qd,), (qdd,) = states(robot, 1)
    step = 1e-5

    def energy(t: float) -> Any:
        return robot.regressor(q + qd * t + qdd * t * t / 2, qd + qdd * t, model="h")

    power = (energy(step) - energy(-step)) / (2 * step)
    expected = qd @ robot.regressor(q, qd, qdd)
    # Central differences: error step^2 times third derivatives, rounding eps / step.
    assert np.abs(power - expected).max() <= 1e-6 * max(np.abs(expected).max(), 1)


@given(robots(), st.sampled_from(["d", "d0", "h"]), st.sampled_from(["exact", "qr", "qrii", "svd"]))
@settings(max_examples=100)
def test_the_base_parameters_span_the_model(
    robot: rv.Robot, model: rv.Model, engine: rv.Engine
) -> None:
    base = robot.base_parameters(model, engine=engine)
    assert base.base == robot.base_parameters().base, "all routes choose the same columns"
    q, qd, qdd = states(robot, 20)
    X = np.random.default_rng(2).normal(size=len(robot.parameters))
    rows = robot.regressor(q, qd, qdd, model)
    full, reduced = rows @ X, base.regressor(q, qd, qdd) @ base.values(X)
    if model == "h":
        full, reduced = full - full[0], reduced - reduced[0]
    assert near(reduced, full, rows)


@given(robots())
@settings(max_examples=60)
def test_descriptions_round_trip(robot: rv.Robot) -> None:
    twin = rv.Robot.from_toml(robot.to_toml())
    assert twin == robot
    assert twin.parameters == robot.parameters
    assert twin.to_toml() == robot.to_toml()
