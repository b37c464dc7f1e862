"""What several test files need."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
import roberval as rv

SHARED = Path(__file__).parents[2] / "shared"

States = tuple[npt.NDArray[np.float64], ...]


def random_states(robot: rv.Robot, count: int, seed: int = 1) -> States:
    """Draw q, qd, qdd, each (count, n)."""
    random = np.random.default_rng(seed)
    return tuple(random.uniform(-3, 3, (count, robot.n)) for _ in range(3))


@pytest.fixture(scope="session")
def puma() -> rv.Robot:
    return rv.load("puma560")


@pytest.fixture(scope="session")
def base(puma: rv.Robot) -> rv.BaseParameters:
    return puma.base_parameters()
