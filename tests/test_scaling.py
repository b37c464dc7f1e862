"""Scaled samples from Python."""

from __future__ import annotations

import pickle
import signal
import threading
from typing import Any

import numpy as np
import pytest
import roberval as rv


def test_scaling_evens_the_entries_of_w(puma: rv.Robot) -> None:
    scaling = puma.scale()
    assert scaling.model == "h"
    assert scaling.W.shape == (55, 55) == (len(scaling.row_s), len(scaling.columns))
    assert scaling.q.shape == (56, 6), "one more: the reference"
    entries = np.abs(scaling.W[scaling.W != 0])
    assert entries.max() / entries.min() == pytest.approx(scaling.after.s)
    assert scaling.after.s < scaling.before.s / 100
    assert scaling.after.rank == 40
    assert repr(scaling).startswith("Scaling(model h, W 55 x 55: S from ")


def test_scaled_samples_give_the_same_answer(puma: rv.Robot, base: rv.BaseParameters) -> None:
    scaling = puma.scale()
    scaled = puma.base_parameters("h", samples=scaling)
    assert scaled.base == base.base
    assert scaled.rows == 55
    assert (pickle.loads(pickle.dumps(scaled)).beta == scaled.beta).all()


def test_own_samples_are_taken_and_checked(puma: rv.Robot, base: rv.BaseParameters) -> None:
    q, qd, qdd = np.random.default_rng(0).uniform(-1, 1, (3, 30, 6))
    assert puma.base_parameters(samples=(q, qd, qdd)).base == base.base
    with pytest.raises(rv.ShapeError, match="qd has shape"):
        puma.base_parameters(samples=(q, qd[:, :5], qdd))
    with pytest.raises(rv.OptionError, match="samples is no tuple"):
        puma.base_parameters(samples=(q, qd))  # type: ignore[arg-type]
    with pytest.raises(rv.OptionError, match="W has 6 rows for"):
        puma.base_parameters(samples=(q[0], qd[0], qdd[0]))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"model": "x"}, 'model is "x"'),
        ({"target": 0.5}, "target is 0.5, expected a finite number of at least 1"),
        ({"target": float("nan")}, "target is nan"),
        ({"starts": 0}, "starts is 0, expected an integer from 1"),
        ({"rounds": -1}, "rounds is -1, expected an integer from 0"),
        ({"rows": 10}, "10 rows for 55 parameters"),
        ({"weights": (1,)}, r"weights is \(1,\), expected the two numbers"),
        ({"weights": (1, -1)}, "a weight is -1"),
    ],
)
def test_bad_options_are_refused(puma: rv.Robot, options: dict[str, Any], message: str) -> None:
    with pytest.raises(rv.OptionError, match=message):
        puma.scale(**options)


def test_ctrl_c_stops_a_search(puma: rv.Robot) -> None:
    timer = threading.Timer(0.05, lambda: signal.raise_signal(signal.SIGINT))

    def endless() -> None:
        timer.start()
        puma.scale("h", target=1, rounds=10**9)

    with pytest.raises(KeyboardInterrupt):
        endless()
