"""Time roberval and Pinocchio on the same robots, in one run, in one thread.

    pip install .[peers] && cargo build --release
    python benches/against_pinocchio.py [--binary target/release/roberval]

Three tasks: the regressor at one state; at N states (one call against a Python loop that
fills a matrix made before); the base parameters (`Robot.base_parameters` against that loop
followed by NumPy's QR without pivoting, eq. (13) of Gautier 1991). Then the whole process
`roberval base FILE`.

A shared core may be taken away or run at half its speed for seconds. So CPU time is counted,
the two are timed in turn, and a calibration around them (a matrix product of fixed size) tells
which rounds to drop: those in which it ran below 90 % of its best. Trust the ratios, not the
times: they say how many times faster roberval is. Only the process is timed by the clock.
"""

from __future__ import annotations

import argparse
import os
import statistics
import subprocess
import sys
import time
import warnings
from collections.abc import Callable
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from typing import Any

os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")

import numpy as np

FOLDER = "cmeel.prefix/share/example-robot-data/robots"
ROBOTS = {
    "ur5": "ur_description/urdf/ur5_robot.urdf",
    "xarm7": "xarm_description/urdf/xarm7.urdf",
    "solo12": "solo_description/robots/solo12.urdf",
    "g1": "g1_description/urdf/g1_29dof_rev_1_0.urdf",
}
BATCH = 1000
ROUNDS = 15
STEADY = 0.9
DEPENDENT = 1e-10
SAMPLES = 24

Task = Callable[[], object]


class Peer:
    """Pinocchio's view of a robot whose joints all have one q and one qd."""

    def __init__(self, pin: Any, path: Path) -> None:
        self.pin = pin
        self.model = pin.buildModelFromUrdf(str(path))
        self.data = self.model.createData()

    def regressor(self, q: Any, qd: Any, qdd: Any) -> Any:
        """Evaluate Pinocchio's n x 10 n regressor."""
        return self.pin.computeJointTorqueRegressor(self.model, self.data, q, qd, qdd)

    def batch(self, states: Any, W: Any) -> None:
        """Fill W, (N, n, 10 n or more), state by state."""
        width = 10 * self.model.nv
        for row, q, qd, qdd in zip(W, *states, strict=True):
            row[:, :width] = self.regressor(q, qd, qdd)

    def base_parameters(self, seed: int = 0) -> tuple[int, Any]:
        """Find rank and beta by a loop, NumPy's QR and |R_ii|, rotor inertias included."""
        n = self.model.nv
        states = np.random.default_rng(seed).uniform(-np.pi, np.pi, (3, SAMPLES, n))
        W = np.zeros((SAMPLES, n, 11 * n))
        self.batch(states, W)
        W[:, range(n), range(10 * n, 11 * n)] = states[2]
        W = W.reshape(-1, 11 * n)
        norms = np.abs(W).max(axis=0)
        W = W[:, norms > DEPENDENT * norms.max()]
        R = np.linalg.qr(W / np.linalg.norm(W, axis=0), mode="r")
        kept = np.abs(np.diag(R)) > DEPENDENT
        R = np.linalg.qr(np.hstack([W[:, kept], W[:, ~kept]]), mode="r")
        b = int(kept.sum())
        return b, np.linalg.solve(R[:b, :b], R[:b, b:])


def seconds(task: Task) -> float:
    """CPU time of a call, repeated until it takes a hundredth of a second."""
    repeats = 1
    while True:
        start = time.process_time()
        for _ in range(repeats):
            task()
        taken = time.process_time() - start
        if taken > 0.01:
            return taken / repeats
        repeats = 2 * repeats if taken < 0.003 else repeats + repeats // 2 + 1


def calibration() -> float:
    """Measure the core's speed, GFLOP/s of a small matrix product."""
    a = np.ones((192, 192))
    return 2e-9 * 192**3 / seconds(lambda: a @ a)


def in_turn(ours: Task, theirs: Task) -> tuple[float, float, str]:
    """Time two tasks in turn: medians in seconds over the undisturbed rounds."""
    rounds = []
    for _ in range(ROUNDS):
        before = calibration()
        times = seconds(ours), seconds(theirs)
        rounds.append((min(before, calibration()), *times))
    best = max(speed for speed, _, _ in rounds)
    steady = [r for r in rounds if r[0] >= STEADY * best] or [max(rounds)]
    note = f"{len(steady)}/{ROUNDS} at {best:.0f} GFLOP/s"
    return statistics.median(r[1] for r in steady), statistics.median(r[2] for r in steady), note


def line(robot: str, task: str, ours: float, theirs: float, note: str) -> None:
    """Print one row of the table."""
    row = f"{robot:8} {task:22} {ours * 1e6:12.1f} {theirs * 1e6:12.1f} {theirs / ours:8.1f}"
    print(f"{row}   {note}", flush=True)


def compare(name: str, rv: Any, pin: Any, path: Path) -> None:
    """Time the three tasks on one robot."""
    robot, peer = rv.load(path), Peer(pin, path)
    n = robot.n
    states = np.random.default_rng(1).uniform(-1, 1, (3, BATCH, n))
    one = tuple(states[:, 0])
    W, theirs = np.empty((BATCH, n, len(robot.parameters))), np.zeros((BATCH, n, 10 * n))
    tasks: list[tuple[str, Task, Task]] = [
        ("regressor", lambda: robot.regressor(*one), lambda: peer.regressor(*one)),
        (
            f"regressor x {BATCH}",
            lambda: robot.regressor(*states, out=W),
            lambda: peer.batch(states, theirs),
        ),
        ("base parameters", lambda: robot.base_parameters(engine="qr"), peer.base_parameters),
    ]
    for task, ours, other in tasks:
        line(f"{name}({n})", task, *in_turn(ours, other))
    ranks = robot.base_parameters(engine="qr").rank, peer.base_parameters()[0]
    print(f"{name:8} base parameters found: {ranks[0]} and {ranks[1]}")


def process(binary: Path, path: Path) -> None:
    """Time the whole command."""
    command = [str(binary), "base", str(path)]
    times = []
    for _ in range(ROUNDS):
        start = time.perf_counter()
        subprocess.run(command, capture_output=True, check=False)
        times.append(time.perf_counter() - start)
    median, best = statistics.median(times) * 1e3, min(times) * 1e3
    command_line = f"{binary.name} base {path.name}"
    print(f"process `{command_line}`: median {median:.1f} ms, best {best:.1f} ms")


def main() -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(description="roberval against Pinocchio")
    parser.add_argument("--binary", type=Path, default=Path("target/release/roberval"))
    binary = parser.parse_args().binary
    try:
        import pinocchio as pin
        import roberval as rv

        folder = Path(str(distribution("example-robot-data").locate_file(FOLDER)))
    except (ImportError, PackageNotFoundError) as missing:
        print(f"skipped: {missing}; pip install .[peers] brings what is compared")
        return 0
    warnings.simplefilter("ignore")
    print(f"roberval {rv.__version__}, Pinocchio {pin.__version__}, NumPy {np.__version__}")
    print(f"{'robot':8} {'task':22} {'roberval us':>12} {'Pinocchio us':>12} {'times':>8}   steady")
    for name, path in ROBOTS.items():
        compare(name, rv, pin, folder / path)
    if binary.exists():
        for name in ("xarm7", "g1"):
            process(binary, folder / ROBOTS[name])
    else:
        print(f"no process time: there is no {binary}; cargo build --release makes it")
    return 0


if __name__ == "__main__":
    sys.exit(main())
