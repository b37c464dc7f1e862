"""Accumulators that threads and processes share, and data that would spoil them."""

from __future__ import annotations

import os
import pickle
import signal
import threading
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import roberval as rv

LONG = 400_000
"""Samples of an update that takes a while: several waves on any number of threads."""

TRIES = 10
"""A thread may be late on a busy machine; what never works fails all of them."""

PATIENCE = 60
"""Seconds after which what hangs has failed."""


def data(count: int, seed: int = 0) -> list[np.ndarray]:
    return list(np.random.default_rng(seed).uniform(-2, 2, (4, count, 6)))


def same(a: rv.ObservationQR, b: rv.ObservationQR) -> bool:
    return bool(
        np.array_equal(a.r_factor, b.r_factor)
        and np.array_equal(a.qt_tau, b.qt_tau)
        and a.residual_norm == b.residual_norm
        and a.samples == b.samples
    )


def beside(work: Callable[[], object]) -> threading.Thread:
    thread = threading.Thread(target=work)
    thread.start()
    return thread


@pytest.mark.parametrize("threads", [1, 2])
def test_an_update_that_fails_takes_nothing_from_other_threads(
    base: rv.BaseParameters, threads: int
) -> None:
    bad, small = data(LONG), data(1000)
    bad[3][-1, 0] = np.nan
    qr = rv.ObservationQR(base, threads=threads)
    said: list[str] = []

    def failing() -> None:
        try:
            qr.update(*bad)
        except rv.ArrayError as error:
            said.append(str(error))

    thread, done = beside(failing), 0
    while thread.is_alive() or done < 3:
        qr.update(*small)
        done += 1
    thread.join()
    assert qr.samples == 1000 * done
    assert said == [f"tau[{LONG - 1}, 0] is NaN: samples must be finite numbers"]
    alone = rv.ObservationQR(base)
    for _ in range(done):
        alone.update(*small)
    assert same(qr, alone)


def test_updates_and_merges_of_many_threads_are_all_there(base: rv.BaseParameters) -> None:
    qr, part, small = rv.ObservationQR(base), rv.ObservationQR(base), data(1000)
    part.update(*small)

    def work() -> None:
        for _ in range(20):
            qr.update(*small)
            qr.merge(part)

    for thread in [beside(work) for _ in range(4)]:
        thread.join()
    assert qr.samples == 4 * 20 * 2000


def test_nobody_sees_half_an_update(base: rv.BaseParameters, tmp_path: Path) -> None:
    qr, long = rv.ObservationQR(base, threads=1), data(LONG)
    thread, seen = beside(lambda: qr.update(*long)), set()
    while thread.is_alive():
        qr.save_factor(tmp_path / "R.npz")
        with np.load(tmp_path / "R.npz") as factor:
            seen |= {qr.samples, int(factor["samples"])}
            assert factor["R"].any() == (factor["samples"] > 0)
    assert seen <= {0, LONG}


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
def test_a_child_forked_during_an_update_has_the_accumulator_of_before(
    base: rv.BaseParameters,
) -> None:
    small, long = data(1000), data(LONG)
    before = rv.ObservationQR(base)
    before.update(*small)
    after = pickle.loads(pickle.dumps(before))
    after.update(*small)
    for _ in range(4):
        qr = rv.ObservationQR(base, threads=2)
        qr.update(*small)
        thread = beside(lambda qr=qr: qr.update(*long))  # type: ignore[misc]
        time.sleep(0.01)
        late = not thread.is_alive()
        child = os.fork()
        if child == 0:
            signal.alarm(PATIENCE)
            fits = late or same(qr, before)
            qr.update(*small)
            os._exit(0 if fits and (late or same(qr, after)) else 1)
        thread.join()
        assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
        assert qr.samples == LONG + 1000


def interrupted_while_waiting(base: rv.BaseParameters) -> bool:
    qr, long = rv.ObservationQR(base, threads=1), data(LONG)

    def work() -> None:
        for _ in range(3):
            qr.update(*long)

    thread = beside(work)
    timer = threading.Timer(0.05, signal.raise_signal, [signal.SIGINT])
    timer.start()
    try:
        while thread.is_alive():
            qr.update(*long)
    except KeyboardInterrupt:
        answered = thread.is_alive()
    else:
        answered = False
        with pytest.raises(KeyboardInterrupt):
            time.sleep(PATIENCE)
    thread.join()
    timer.join()
    assert qr.samples % LONG == 0
    return answered


@pytest.mark.skipif(os.name == "nt", reason="Windows has no such signals")
def test_ctrl_c_is_answered_while_waiting_for_another_thread(base: rv.BaseParameters) -> None:
    assert any(interrupted_while_waiting(base) for _ in range(TRIES))


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="needs timers")
def test_a_signal_handler_that_would_wait_for_itself_is_told(base: rv.BaseParameters) -> None:
    qr, long, small = rv.ObservationQR(base, threads=1), data(LONG), data(10)
    told: list[str] = []

    def handler(*_: object) -> None:
        try:
            qr.update(*small)
        except RuntimeError as error:
            told.append(str(error))

    before = signal.signal(signal.SIGALRM, handler)
    try:
        for _ in range(TRIES):
            signal.setitimer(signal.ITIMER_REAL, 0.01)
            qr.update(*long)
            if told:
                break
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
    assert told
    assert "is being changed by the call that a signal interrupted" in told[0]


def test_one_absurd_sample_is_named_and_leaves_the_accumulator_as_it_was(
    base: rv.BaseParameters, tmp_path: Path
) -> None:
    good, absurd = data(1000), data(1, 1)
    absurd[1] *= 1e120
    qr = rv.ObservationQR(base)
    qr.update(*good)
    kept = pickle.loads(pickle.dumps(qr))
    place = int(np.abs(absurd[1]).argmax())
    with pytest.raises(rv.ArrayError, match=rf"^qd\[0, {place}\] is .*e1..: .*\(rad or m") as told:
        qr.update(*absurd)
    assert told.value.row == 0
    among = [np.concatenate([a, b, a]) for a, b in zip(good, absurd, strict=True)]
    with pytest.raises(rv.ArrayError, match=rf"^qd\[1000, {place}\] is ") as told:
        qr.update(*among)
    assert told.value.row == 1000
    qr.save(tmp_path / "c")
    assert same(rv.ObservationQR.load(tmp_path / "c", base), kept)
    assert same(qr, kept)
    assert np.isfinite(qr.solve()).all()


def test_factors_that_would_overflow_together_are_not_merged(base: rv.BaseParameters) -> None:
    q, qd, qdd, tau = data(100)
    parts = [rv.ObservationQR(base) for _ in range(2)]
    for part in parts:
        part.update(q, qd, qdd, tau / np.linalg.norm(tau) * 0.99e150)
    with pytest.raises(rv.NumericalError, match="squares in R overflow"):
        parts[0].merge(parts[1])
    assert same(*parts)


def test_weights_and_rows_are_named_as_they_were_given(base: rv.BaseParameters) -> None:
    qr, (q, qd, qdd, tau) = rv.ObservationQR(base), data(500)
    for _ in range(2):
        with pytest.raises(rv.ArrayError, match=r"^weights\[2\] is NaN"):
            qr.update(q, qd, qdd, tau, weights=[1, 1, np.nan, 1, 1, 1])
        with pytest.raises(rv.ArrayError, match=r"^weights\[2\] is -1"):
            qr.update(q, qd, qdd, tau, weights=[1, 1, -1, 1, 1, 1])
        bad = data(500)
        bad[1][3, 2] = np.inf
        with pytest.raises(rv.ArrayError, match=r"^qd\[3, 2\] is inf") as told:
            qr.update(*bad)
        assert told.value.row == 3
        qr.update(q, qd, qdd, tau)


def test_solve_says_whether_a_column_is_zero_or_dependent(
    puma: rv.Robot, base: rv.BaseParameters
) -> None:
    q, qd, qdd, tau = data(300)
    still, all_of_it = rv.ObservationQR(base), rv.ObservationQR(puma)
    still.update(q, 0 * qd, 0 * qdd, tau)
    moved = "is zero in all these data: give data that move more$"
    with pytest.raises(rv.NumericalError, match=rf"^column {base.base[0]} {moved}"):
        still.solve()
    all_of_it.update(q, qd, qdd, tau)
    with pytest.raises(rv.NumericalError, match=r"^column XX_1 is zero .*base_parameters\(\)\)$"):
        all_of_it.solve()
    again = pickle.loads(pickle.dumps(still))
    with pytest.raises(rv.NumericalError, match=f"{moved}"):
        again.solve()
    once = rv.ObservationQR(base)
    once.update(*(x[:1] for x in (q, qd, qdd, tau)))
    with pytest.raises(
        rv.NumericalError, match="depends on the columns before it in these data: give data that"
    ):
        once.solve()


class Mine(rv.ObservationQR):
    note = "of the class"


def test_a_subclass_keeps_its_class_and_attributes_when_pickled(base: rv.BaseParameters) -> None:
    mine = Mine(base)
    mine.note = "of this one"
    mine.update(*data(10))
    again = pickle.loads(pickle.dumps(mine))
    assert (type(again), again.note) == (Mine, "of this one")
    assert same(again, mine)


def test_threads_that_save_to_one_path_leave_one_whole_file(
    base: rv.BaseParameters, tmp_path: Path
) -> None:
    path, qr = tmp_path / "c", rv.ObservationQR(base)
    qr.update(*data(10))
    qr.save(path)
    faults: Counter[str] = Counter()

    def work(call: Callable[[], object]) -> None:
        for _ in range(30):
            try:
                call()
            except Exception as error:
                faults[repr(error)] += 1

    calls: list[Callable[[], object]] = [lambda: qr.save(path)] * 3
    calls.append(lambda: rv.ObservationQR.load(path, base))
    for thread in [beside(lambda call=call: work(call)) for call in calls]:  # type: ignore[misc]
        thread.join()
    assert not faults
    assert [file.name for file in tmp_path.iterdir()] == ["c"]
