"""The GIL is released, threads do not disturb each other, Ctrl-C is answered."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import textwrap
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import roberval as rv
from conftest import random_states

PATIENCE = 60.0
"""Seconds after which a test that hangs fails; it takes well under one."""

TRIES = 20
"""Works that keep the GIL fail all of them."""


def overlaps(work: Callable[[], object]) -> bool:
    """Whether Python code runs while `work` does: only if `work` releases the GIL.

    The switch interval is made so long that no other thread ever gets the GIL by asking.
    """
    started, seen = threading.Event(), []

    def worker() -> None:
        started.set()
        work()
        seen.append("worker")

    def watcher() -> None:
        started.wait(PATIENCE)
        seen.append("watcher")

    interval = sys.getswitchinterval()
    threads = [threading.Thread(target=watcher), threading.Thread(target=worker)]
    try:
        sys.setswitchinterval(PATIENCE)
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(PATIENCE)
    finally:
        sys.setswitchinterval(interval)
    return seen == ["watcher", "worker"]


def test_the_gil_is_released(puma: rv.Robot) -> None:
    q, qd, qdd = random_states(puma, 20_000)
    out = np.empty((20_000, 6, 66))
    base = puma.base_parameters()
    works: dict[str, Callable[[], object]] = {
        "regressor": lambda: puma.regressor(q, qd, qdd, out=out),
        "torques": lambda: puma.torques(q, qd, qdd),
        "reduced": lambda: base.regressor(q, qd, qdd),
        "base_parameters": lambda: puma.base_parameters(engine="svd", rows=2000),
        "compare": puma.compare,
    }
    # On a busy machine a work of a millisecond may end before the watcher is woken.
    seen = {name: any(overlaps(work) for _ in range(TRIES)) for name, work in works.items()}
    assert seen == dict.fromkeys(works, True)


def test_the_watch_for_the_gil_can_fail() -> None:
    assert not any(overlaps(lambda: sum(range(10_000))) for _ in range(TRIES))


def test_threads_get_the_serial_answers(puma: rv.Robot) -> None:
    def work(seed: int) -> tuple[bytes, bytes, int]:
        states = random_states(puma, 200, seed)
        base = puma.base_parameters(seed=seed)
        return puma.regressor(*states).tobytes(), base.beta.tobytes(), base.rank

    serial = [work(seed) for seed in range(16)]
    with ThreadPoolExecutor(8) as pool:
        assert list(pool.map(work, range(16))) == serial


@pytest.mark.parametrize("threads", [10**9, 2**70])
def test_more_threads_than_samples_are_not_begun(puma: rv.Robot, threads: int) -> None:
    states = random_states(puma, 3000)
    np.testing.assert_array_equal(
        puma.regressor(*states, threads=threads), puma.regressor(*states, threads=1)
    )


@pytest.mark.parametrize("threads", [0, -1, 1.5, "2"])
def test_a_number_of_threads_is_a_whole_one(puma: rv.Robot, threads: Any) -> None:
    with pytest.raises(rv.OptionError, match="threads is"):
        puma.regressor(*random_states(puma, 3), threads=threads)


def test_threads_may_read_one_array_and_write_parts_of_another(puma: rv.Robot) -> None:
    q, qd, qdd = random_states(puma, 800)
    out = np.empty((800, 6, 66))

    def work(first: int) -> None:
        part = slice(first, first + 100)
        puma.regressor(q[part], qd[part], qdd[part], out=out[part])

    with ThreadPoolExecutor(8) as pool:
        list(pool.map(work, range(0, 800, 100)))
    assert (out == puma.regressor(q, qd, qdd)).all()


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
def test_a_forked_child_computes(puma: rv.Robot) -> None:
    child = os.fork()
    if child == 0:
        os._exit(puma.base_parameters().rank)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 40


def test_small_calls_while_another_thread_writes_get_their_own_answers(puma: rv.Robot) -> None:
    q, qd, qdd = random_states(puma, 20_000)
    one = q[0], qd[0], qdd[0]
    expected = puma.regressor(*one)
    large = np.empty((20_000, 6, 66))
    with ThreadPoolExecutor(1) as pool:
        writing = pool.submit(lambda: [puma.regressor(q, qd, qdd, out=large) for _ in range(5)])
        out = np.empty((6, 66))
        same = [(puma.regressor(*one, out=out) == expected).all()]
        while not writing.done():
            same.append((puma.regressor(*one, out=out) == expected).all())
        writing.result()
    assert all(same)
    assert (large[0] == expected).all()


LONG_CALLS = {
    "many short calls": """
        q = np.zeros((1_000, 6))
        out = np.empty((1_000, 6, 66))
        robot = rv.load("puma560")
        ready()
        while True:
            robot.regressor(q, q, q, out=out)
    """,
    "one of minutes": """
        rows = [(twist, 0.1, 0, 0.2) for twist in ("pi/2", "-pi/2") * 75]
        robot = rv.Robot.from_mdh(rows)
        ready()
        robot.compare()
    """,
}


def test_no_call_imports_what_ctrl_c_could_keep_away() -> None:
    # rust-numpy panics where an import of NumPy's fails.
    script = """
import sys
import numpy as np, roberval as rv

robot = rv.load("puma560")
q, out = np.zeros((5_000, 6)), np.empty((5_000, 6, 66))
for name in [name for name in sys.modules if name.split(".")[0] == "numpy"]:
    sys.modules[name] = None
robot.regressor(q, q, q, out=out)
"""
    subprocess.run([sys.executable, "-c", script], check=True, timeout=60)


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGINT to send")
@pytest.mark.parametrize("name", LONG_CALLS)
def test_ctrl_c_stops_a_long_call(name: str) -> None:
    script = f"""
import numpy as np, roberval as rv

def ready():
    print("ready", flush=True)

try:
{textwrap.indent(textwrap.dedent(LONG_CALLS[name]), "    ")}
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""
    with subprocess.Popen(
        [sys.executable, "-c", script], stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        process.send_signal(signal.SIGINT)
        assert process.communicate(timeout=PATIENCE)[0] == "interrupted\n"


@pytest.mark.skipif(sys.platform != "linux", reason="counts threads as Linux does")
def test_after_ctrl_c_nothing_goes_on_computing() -> None:
    rows = [(twist, 0.1, 0, 0.2) for twist in ("pi/2", "-pi/2") * 40]
    robot = rv.Robot.from_mdh(rows)

    def computing() -> int:
        names = Path("/proc/self/task").glob("*/comm")
        return sum(name.read_text() == "roberval\n" for name in names)

    def interrupt() -> None:
        while not computing():
            time.sleep(0.001)
        signal.raise_signal(signal.SIGINT)

    watcher = threading.Thread(target=interrupt)
    watcher.start()
    with pytest.raises(KeyboardInterrupt):
        robot.compare()  # a minute
    watcher.join()
    end = time.monotonic() + PATIENCE / 4
    while computing() and time.monotonic() < end:
        time.sleep(0.001)
    assert computing() == 0


def test_ctrl_c_is_seen_between_blocks(puma: rv.Robot) -> None:
    count = 100_000  # some hundred milliseconds on one thread
    q = np.zeros((count, 6))
    out = np.full((count, 6, 66), np.nan)
    timer = threading.Timer(0.005, lambda: signal.raise_signal(signal.SIGINT))

    def call() -> None:
        timer.start()
        puma.regressor(q, q, q, out=out, threads=1)
        timer.join()

    with pytest.raises(KeyboardInterrupt):
        call()
    assert np.isnan(out[-1]).all(), "the call did not run to its end"
    assert puma.regressor(q[:2], q[:2], q[:2]).shape == (2, 6, 66), "all is well afterwards"
