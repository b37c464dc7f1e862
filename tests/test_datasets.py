"""`reduce_dataset`: Dask datasets to the R factor."""

from __future__ import annotations

import pickle
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import roberval as rv
from roberval import datasets, logs

dask = pytest.importorskip("dask")
frames = pytest.importorskip("dask.dataframe")
pd = pytest.importorskip("pandas")

ROOT = Path(__file__).parents[1]
EXAMPLE = ROOT / "docs/reduce_on_dask.py"

NAMES = [f"{array}_{j}" for array in logs.ARRAYS for j in range(1, 7)]


@pytest.fixture(scope="module")
def base() -> rv.BaseParameters:
    return rv.load("puma560").base_parameters()


def samples(count: int) -> np.ndarray:
    return np.random.default_rng(0).uniform(-2, 2, (count, 24))


def table(count: int = 60, **more: Any) -> Any:
    return pd.DataFrame(samples(count), columns=NAMES).assign(**more)


def dataset(frame: Any, partitions: int = 3) -> Any:
    return frames.from_pandas(frame, npartitions=partitions, sort=False)


def expected(base: rv.BaseParameters, **options: Any) -> rv.ObservationQR:
    """Reduce 60 samples in three parts, the first two merged first."""
    weights = options.pop("weights", None)
    parts = [rv.ObservationQR(base, **options) for _ in range(3)]
    for k, part in enumerate(parts):
        rows = samples(60)[20 * k : 20 * k + 20]
        w = weights[20 * k : 20 * k + 20] if np.ndim(weights) == 2 else weights
        q, qd, qdd, tau = np.split(rows, 4, axis=1)
        part.update(q, qd, qdd, tau, w)
    parts[0].merge(parts[1])
    parts[0].merge(parts[2])
    return parts[0]


def reduced(*arguments: Any, **options: Any) -> rv.ObservationQR:
    with dask.config.set(scheduler="synchronous"):
        return rv.reduce_dataset(*arguments, **options)


@pytest.mark.parametrize("friction", ["viscous", ("coulomb", "offset")])
def test_one_kind_of_friction_may_stand_alone(base: rv.BaseParameters, friction: Any) -> None:
    qr = reduced(dataset(table()), base, friction=friction)
    assert np.array_equal(qr.r_factor, expected(base, friction=friction).r_factor)


def test_weights_are_numbers_or_columns(base: rv.BaseParameters) -> None:
    rows = np.array([1.0, 2, 3, 4, 5, 6])
    qr = reduced(dataset(table()), base, weights=rows)
    assert np.array_equal(qr.r_factor, expected(base, weights=rows).r_factor)
    w = np.random.default_rng(1).uniform(0.5, 2, (60, 6))
    weighted = dataset(table().assign(**{f"w_{j + 1}": w[:, j] for j in range(6)}))
    qr = reduced(weighted, base, weights="columns")
    assert np.array_equal(qr.r_factor, expected(base, weights=w).r_factor)
    with pytest.raises(rv.ShapeError, match=r"there is no w_1"):
        reduced(dataset(table()), base, weights="columns")
    with pytest.raises(rv.OptionError, match=r"expected 6 numbers or 'columns'"):
        reduced(dataset(table()), base, weights="column")
    with pytest.raises(rv.ShapeError, match=r"weights has shape \(5,\), expected \(6,\)"):
        reduced(dataset(table()), base, weights=rows[1:])


def test_numbers_that_are_not_finite_are_named_by_partition_and_row(
    base: rv.BaseParameters, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(logs, "PIECE", 8)
    frame = table()
    frame.loc[37, "q_4"] = np.nan
    with pytest.raises(rv.ArrayError, match=r"partition 1: q\[17, 3\] is NaN"):
        reduced(dataset(frame), base)


def test_columns_of_texts_and_truths_are_named(base: rv.BaseParameters) -> None:
    for wrong in (["1.5"] * 60, [True] * 60):
        with pytest.raises(rv.ArrayError, match=r"column q_4 has (string|bool|object), not num"):
            reduced(dataset(table(q_4=wrong)), base)
    qr = reduced(dataset(table(q_4=pd.array([1] * 60, dtype="Int64"))), base)
    assert qr.samples == 60


def test_a_column_that_is_there_twice_is_named(base: rv.BaseParameters) -> None:
    frame = table()
    frame.columns = [*NAMES[:-1], "q_1"]
    with pytest.raises(rv.ShapeError, match=r"columns 1 \(q_1\) and 24 \(q_1\) both give q of"):
        reduced(dataset(frame), base)


def test_what_is_no_dask_table_is_told_how_to_become_one(base: rv.BaseParameters) -> None:
    for wrong, hint in (
        ("logs/", "dask.dataframe.read_parquet('logs/')"),
        (Path("logs"), "dask.dataframe.read_parquet('logs')"),
        (table(), "dask.dataframe.from_pandas"),
        (None, "dask.dataframe.read_parquet"),
    ):
        with pytest.raises(TypeError, match="expected a Dask DataFrame") as told:
            reduced(wrong, base)
        assert hint in str(told.value)


def test_a_dataset_without_samples_is_refused(base: rv.BaseParameters) -> None:
    with pytest.raises(rv.ArrayError, match="there are no samples"):
        reduced(dataset(table().iloc[:0], 1), base)


def test_tasks_have_the_columns_they_need_and_no_base_parameters_to_be_found_anew(
    base: rv.BaseParameters, monkeypatch: pytest.MonkeyPatch
) -> None:
    sent: list[bytes] = []
    real = datasets.reduce_partition

    def spy(frame: Any, *rest: Any) -> rv.ObservationQR:
        sent.append(pickle.dumps(rest))
        assert list(frame.columns) == NAMES
        return real(frame, *rest)

    monkeypatch.setattr(datasets, "reduce_partition", spy)
    reduced(dataset(table(time=0.5)), base)
    assert len(sent) == 3
    assert all(b"BaseParameters" not in task for task in sent)


def test_the_example_runs_and_is_what_the_page_shows(tmp_path: Path) -> None:
    pytest.importorskip("distributed")
    pytest.importorskip("pyarrow")
    robot = rv.load("puma560")
    q, qd, qdd = np.random.default_rng(2).uniform(-2, 2, (3, 300, 6))
    X = np.arange(66.0)
    tau = robot.torques(q, qd, qdd, X) + 0.5 * qd
    frame = pd.DataFrame(np.column_stack([q, qd, qdd, tau]), columns=NAMES)
    for k in range(4):
        frame.iloc[75 * k : 75 * k + 75].to_parquet(tmp_path / f"{k}.parquet")
    command = [sys.executable, str(EXAMPLE), "puma560", str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    found = dict(line.split() for line in done.stdout.splitlines())
    assert abs(float(found["viscous_3"]) - 0.5) < 1e-8
    shown = (ROOT / "docs/howto.md").read_text()
    body = EXAMPLE.read_text().partition('"""\n\n')[2]
    assert body in shown
