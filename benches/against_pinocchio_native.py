"""Time roberval's wheel against Pinocchio in C++ on the same robots, in one run and thread.

    pip install .[peers] cmeel-eigen
    python benches/against_pinocchio_native.py

The C++ loop (`pinocchio_loop.cpp`) is compiled for this processor against the headers of
Pinocchio's wheel; without a compiler or headers the script says so and ends. A calibration
around each measurement drops rounds in which the core was not all ours. Trust the ratios.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from typing import Any

os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")

import numpy as np
from against_pinocchio import FOLDER, ROUNDS, STEADY, Task, calibration, seconds

# What CMake would pass to users of Pinocchio.
DEFINITIONS = (
    "BOOST_MPL_LIMIT_LIST_SIZE=30",
    "BOOST_MPL_LIMIT_VECTOR_SIZE=30",
    "BOOST_MPL_CFG_NO_PREPROCESSED_HEADERS",
    "BOOST_FUSION_INVOKE_MAX_ARITY=12",
)
LIMBS = (
    ("base", 1, 6),
    ("base", 2, 6),
    ("base", 3, 3),
    ("3_3", 4, 7),
    ("3_3", 5, 7),
    ("3_3", 6, 1),
)
CACHED, LARGE = 64, 100_000


def tree() -> str:
    """Write a robot TOML of 30 joints, as in benches/lib.rs."""
    text = 'name = "tree"\n'
    for root, limb, joints in LIMBS:
        for joint in range(1, joints + 1):
            antecedent = root if joint == 1 else f"{limb}_{joint - 1}"
            text += (
                f'[[link]]\nname = "{limb}_{joint}"\nantecedent = "{antecedent}"\n'
                f'alpha = "{(90, 0, -90)[joint % 3]} deg"\nb = 0.{limb}\nd = 0.{joint}5\n'
                f"theta = 0\nr = 0.{joint}2\n"
            )
    return text


def described(robot: Any) -> str:
    """Return the tree of a robot as the C++ loop reads it."""
    names = [link.name for link in robot.links]
    lines = [str(len(names))]
    for link, (rotation, origin, axis) in zip(robot.links, robot._inner.placements, strict=True):
        parent = names.index(link.antecedent) if link.antecedent else -1
        numbers = (*axis, *np.ravel(rotation), *origin)
        lines.append(" ".join(map(repr, (parent, *map(float, numbers)))))
    return "\n".join(lines)


def include(package: str, name: str) -> Path | None:
    """Return a folder of headers of an installed package."""
    try:
        folder = Path(str(distribution(package).locate_file("cmeel.prefix/include"))) / name
    except PackageNotFoundError:
        return None
    return folder if folder.exists() else None


def compiled(folder: Path) -> Path | None:
    """Compile the C++ loop, or say why not."""
    compiler = shutil.which("g++")
    headers = [include("pin", ""), include("cmeel-eigen", "eigen3")]
    if compiler is None or None in headers:
        print("skipped: g++ and the headers of pin and cmeel-eigen are needed")
        return None
    binary = folder / "loop"
    source = Path(__file__).with_name("pinocchio_loop.cpp")
    flags = ["-std=c++17", "-O3", "-march=native", "-DNDEBUG", "-w"]
    flags += [f"-D{name}" for name in DEFINITIONS] + [f"-I{path}" for path in headers]
    subprocess.run([compiler, *flags, str(source), "-o", str(binary)], check=True)
    return binary


def best(task: Task) -> float:
    """Return the shortest CPU time of a call over the undisturbed rounds, in seconds."""
    rounds = []
    for _ in range(ROUNDS):
        before = calibration()
        taken = seconds(task)
        rounds.append((min(before, calibration()), taken))
    fastest = max(speed for speed, _ in rounds)
    return min(taken for speed, taken in rounds if speed >= STEADY * fastest)


def compare(name: str, rv: Any, robot: Any, regressor: float, rnea: float) -> None:
    """Print a robot's ratios."""
    base = robot.base_parameters()
    n, c, b = robot.n, len(robot.parameters), base.rank
    rng = np.random.default_rng(1)
    small, large = rng.uniform(-1, 1, (3, CACHED, n)), rng.uniform(-1, 1, (3, LARGE, n))
    tau = rng.uniform(-1, 1, (LARGE, n))
    W, B = np.empty((CACHED, n, c)), np.empty((CACHED, n, b))
    one = tuple(small[:, 0])
    qr = rv.ObservationQR(base, threads=1)
    friction = rv.ObservationQR(base, friction=("viscous", "coulomb"), threads=1)
    X = np.ones(c)
    tasks: list[tuple[str, Task, int, float]] = [
        ("one state from Python", lambda: robot.regressor(*one, out=W[0]), 1, regressor),
        ("W in cache", lambda: robot.regressor(*small, out=W), CACHED, regressor),
        ("base columns in cache", lambda: base.regressor(*small, out=B), CACHED, regressor),
        ("torques", lambda: robot.torques(*large, X), LARGE, rnea),
        ("data to R", lambda: qr.update(*large, tau), LARGE, regressor),
        ("data to R, friction", lambda: friction.update(*large, tau), LARGE, regressor),
    ]
    memory = np.zeros((LARGE if n < 20 else LARGE // 20, n, c))
    many = large[:, : len(memory)]
    tasks.append(
        ("W in memory", lambda: robot.regressor(*many, out=memory), len(memory), regressor)
    )
    for task, call, samples, theirs in tasks:
        ours = best(call) / samples * 1e9
        print(f"{name:8} {task:24} {ours:9.1f} {theirs:9.1f} {theirs / ours:7.1f}", flush=True)


def main() -> int:
    """Print the table."""
    try:
        import roberval as rv

        solo = Path(str(distribution("example-robot-data").locate_file(FOLDER)))
    except (ImportError, PackageNotFoundError) as missing:
        print(f"skipped: {missing}; pip install .[peers] brings what is compared")
        return 0
    robots = {
        "puma": rv.load("puma560"),
        "iiwa": rv.load("iiwa14"),
        "solo12": rv.load(solo / "solo_description/robots/solo12.urdf"),
        "tree30": rv.Robot.from_toml(tree()),
    }
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        binary = compiled(folder)
        if binary is None:
            return 0
        print(f"{'robot':8} {'task':24} {'roberval':>9} {'C++':>9} {'times':>7}   ns a sample")
        for name, robot in robots.items():
            path = folder / name
            path.write_text(described(robot))
            output = subprocess.run([binary, path], capture_output=True, text=True, check=True)
            compare(name, rv, robot, *map(float, output.stdout.split()))
    return 0


if __name__ == "__main__":
    sys.exit(main())
