"""What several test files need."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
import roberval as rv
from hypothesis import settings

# A test that is slow once, as when it imports a peer, is not wrong.
settings.register_profile("no deadline", settings.default, deadline=None)
settings.load_profile("no deadline")

SHARED = Path(__file__).parents[2] / "shared"

Array = npt.NDArray[np.float64]
States = tuple[Array, Array, Array]


def random_states(robot: rv.Robot, count: int, seed: int = 1) -> States:
    """Draw q, qd, qdd, each (count, n); a floating robot's attitudes of length 1."""
    random = np.random.default_rng(seed)
    q, qd, qdd = random.uniform(-3, 3, (3, count, robot.n))
    if robot.is_floating:
        attitude = random.normal(size=(count, 4))
        attitude /= np.linalg.norm(attitude, axis=1, keepdims=True)
        q = np.hstack([q[:, :3], attitude, q[:, 6:]])
    return q, qd, qdd


@pytest.fixture(scope="session")
def puma() -> rv.Robot:
    return rv.load("puma560")


@pytest.fixture(scope="session")
def base(puma: rv.Robot) -> rv.BaseParameters:
    return puma.base_parameters()
