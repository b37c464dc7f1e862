"""What several test files need."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
import roberval as rv

SHARED = Path(__file__).parents[2] / "shared"

Array = npt.NDArray[np.float64]
States = tuple[Array, Array, Array]


def random_states(robot: rv.Robot, count: int, seed: int = 1) -> States:
    """Draw q, qd, qdd, each (count, n)."""
    random = np.random.default_rng(seed)
    q, qd, qdd = random.uniform(-3, 3, (3, count, robot.n))
    return q, qd, qdd


@pytest.fixture(scope="session")
def puma() -> rv.Robot:
    return rv.load("puma560")


@pytest.fixture(scope="session")
def base(puma: rv.Robot) -> rv.BaseParameters:
    return puma.base_parameters()
