"""Time roberval's wheel against Pinocchio in C++ on the same robots, in one run and thread.

    pip install .
    python benches/against_pinocchio_native.py --install

`--install` first installs what roberval is measured against from PyPI, into the same environment:
best a virtual one. The C++ loop (`pinocchio_loop.cpp`) is compiled for this processor against the
headers of Pinocchio's wheel; without a compiler or headers the script says so and ends. It writes
every sample's result over the one before: the targets are measured against that. "C++ that stores
W" copies each one behind the one before: that is a W, as roberval's. roberval is called from
Python, with `out=` arrays. CPU time is counted, a calibration around each measurement drops
rounds in which the core was not all ours, and C++ runs before and after. Trust the ratios.

The targets are those of issue 5 for AVX-512. For AVX2 on such a processor (other targets):

    ROBERVAL_LANES=4 python benches/against_pinocchio_native.py
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from typing import Any

os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")

import numpy as np
from against_pinocchio import FOLDER, STEADY, Task, calibration, seconds

NEEDED = ("pin>=4", "cmeel-eigen", "example-robot-data>=6", "scipy")
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
ROUNDS = 15
LARGE = 100_000
CACHED = 5 * 2**17
"""Bytes of a batch's result that stay in a second cache of 1 MiB, beside the states."""
WIDE = int(os.environ.get("ROBERVAL_LANES", "8")) >= 8
"""Whether AVX-512 may be used: its targets, or those of AVX2."""


@dataclass
class Peers:
    """Pinocchio's times, ns a sample, and the program that takes them."""

    regressor: float
    rnea: float
    cached: float
    """The regressor, each result copied behind the one before, in the cache."""
    stored: float
    """The same in memory."""
    binary: Path


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


def model(robot: Any) -> Any:
    """Return the same tree as Pinocchio's model."""
    import pinocchio as pin

    built = pin.Model()
    for line in described(robot).split("\n")[1:]:
        parent, *numbers = line.split()
        axis, rotation, origin = np.split(np.array(numbers, float), [3, 12])
        place = pin.SE3(rotation.reshape(3, 3), origin)
        joint = pin.JointModelRevoluteUnaligned(axis)
        for k, kind in enumerate((pin.JointModelRX, pin.JointModelRY, pin.JointModelRZ)):
            joint = kind() if axis[k] == 1 else joint
        added = built.addJoint(int(parent) + 1, joint, place, f"joint {built.njoints}")
        built.appendBodyToJoint(added, pin.Inertia.Random(), pin.SE3.Identity())
    return built


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
    eigen = include("cmeel-eigen", "eigen3") or Path("/usr/include/eigen3")
    headers = [include("pin", ""), eigen]
    if compiler is None or headers[0] is None or not eigen.exists():
        print("skipped: g++ is needed, and pin and cmeel-eigen, which --install brings")
        return None
    binary = folder / "loop"
    source = Path(__file__).with_name("pinocchio_loop.cpp")
    flags = ["-std=c++17", "-O3", "-march=native", "-DNDEBUG", "-w"]
    flags += [f"-D{name}" for name in DEFINITIONS] + [f"-I{path}" for path in headers]
    subprocess.run([compiler, *flags, str(source), "-o", str(binary)], check=True)
    return binary


def printed(*command: object) -> list[float]:
    """Run a program; return the numbers it prints."""
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=True)
    return list(map(float, done.stdout.split()))


def best(task: Task) -> float:
    """Return the shortest CPU time of a call over the undisturbed rounds, in seconds."""
    task()
    rounds = []
    for _ in range(ROUNDS):
        before = calibration()
        taken = seconds(task)
        rounds.append((min(before, calibration()), taken))
    fastest = max(speed for speed, _ in rounds)
    return min(taken for speed, taken in rounds if speed >= STEADY * fastest)


def row(
    name: str, task: str, ours: float, theirs: float, target: tuple[float, float] | None
) -> None:
    """Print ns a sample of both, their ratio and the target (AVX-512, AVX2)."""
    asked = "" if target is None else target[0 if WIDE else 1]
    missed = " missed" if asked and theirs / ours < float(asked) else ""
    print(
        f"{name:7} {task:33} {ours:9.1f} {theirs:9.1f} {theirs / ours:7.1f} {asked:>5}{missed}",
        flush=True,
    )


def regressors(name: str, robot: Any, base: Any, cpp: Peers) -> None:
    """Print rows of d in the cache, and torques."""
    n, c, b = robot.n, len(robot.parameters), base.rank
    X = np.ones(c)
    loop = python_loop(robot, samples(n, 64))

    def ns(call: Callable[..., Any], numbers: int, *extra: Any, **kept: bool) -> float:
        states = samples(n, max(8, CACHED // (8 * numbers) // 8 * 8))
        out = call(*states, *extra)
        task = partial(call, *states, *extra, out=out, threads=1, **kept)
        return best(task) / states.shape[1] * 1e9

    packed = ns(robot.packed, len(robot.packed_entries()))
    row(name, "packed, in cache", packed, cpp.regressor, (36, 23))
    row(name, "packed, in cache / Python loop", packed, loop, (30, 30))
    times = ns(base.regressor, n * b)
    row(name, "base columns (N, n, b), in cache", times, cpp.regressor, None)
    times = ns(robot.regressor, n * c)
    row(name, "W, in cache", times, cpp.regressor, (12, 12))
    row(name, "W, in cache / C++ that stores W", times, cpp.cached, None)
    row(name, "W, in cache / Python loop", times, loop, (30, 30))
    times = ns(robot.regressor, n * c, keep_zeros=True)
    row(name, "W, zeros kept, in cache", times, cpp.regressor, (12, 12))
    row(name, "W, zeros kept / C++ that stores W", times, cpp.cached, None)
    row(name, "W, zeros kept / Python loop", times, loop, (30, 30))
    times = ns(robot.torques, 192, X)  # of 512 samples
    row(name, "torques / rnea", times, cpp.rnea, (10, 10))
    one, W = tuple(samples(n, 1)[:, 0]), np.zeros((n, c))
    times = best(lambda: robot.regressor(*one, out=W)) * 1e9
    row(name, "one state / Pinocchio from Python", times, python_call(robot, one), None)


def in_memory(name: str, robot: Any, cpp: Peers) -> None:
    """Print W past the cache, and its share of the rate of stores, for zeros that of zeros."""
    n, c = robot.n, len(robot.parameters)
    count = min(LARGE, 2**29 // (8 * n * c))
    large = np.random.default_rng(1).uniform(-1, 1, (3, count, n))
    memory = np.zeros((count, n, c))
    evaluate = partial(robot.regressor, *large, out=memory, threads=1)
    times = best(evaluate) / count * 1e9
    row(name, "W, in memory", times, cpp.regressor, (8, 8))
    row(name, "W, in memory / C++ that stores W", times, cpp.stored, None)
    stores, zeros = map(max, zip(*(printed(cpp.binary) for _ in range(3)), strict=True))
    lines = memory.ravel()[-memory.ctypes.data // 8 % 8 :][: 8 * LARGE].reshape(-1, 8)
    empty = 1 - np.mean(lines.any(axis=1))
    share = 8 * n * c * (empty / zeros + (1 - empty) / stores) / times
    missed = "" if share >= 0.6 else " missed"
    rate = f"of {stores:.0f} GB/s, zeros {zeros:.0f}"
    print(f"{name:7} {rate:33} {share:27.0%}   60%{missed}", flush=True)
    times = best(partial(evaluate, keep_zeros=True)) / count * 1e9
    row(name, "W, zeros kept, in memory", times, cpp.regressor, (8, 8))
    row(name, "the same / C++ that stores W", times, cpp.stored, None)


def samples(n: int, count: int) -> Any:
    """Return q, qd and qdd of so many samples."""
    return np.random.default_rng(1).uniform(-1, 1, (3, count, n))


def python_call(robot: Any, one: Any) -> float:
    """Time a call of Pinocchio's regressor from Python, ns."""
    import pinocchio as pin

    built = model(robot)
    data = built.createData()
    return best(lambda: pin.computeJointTorqueRegressor(built, data, *one)) * 1e9


def python_loop(robot: Any, states: Any) -> float:
    """Time a Python loop over Pinocchio that fills a matrix made before, ns a sample."""
    import pinocchio as pin

    built = model(robot)
    data = built.createData()
    rows = np.zeros((states.shape[1], robot.n, 10 * robot.n))

    def loop() -> None:
        for to, q, qd, qdd in zip(rows, *states, strict=True):
            to[:] = pin.computeJointTorqueRegressor(built, data, q, qd, qdd)

    return best(loop) / states.shape[1] * 1e9


def lapack(W: Any, tau: Any) -> tuple[float, float]:
    """Time LAPACK's QR of the stored matrix, ns a sample.

    The faster of NumPy's R and the bare factorisation in place; SciPy's R.
    """
    from scipy.linalg import qr
    from scipy.linalg.lapack import dgeqrf

    samples = len(W)
    stored = np.asfortranarray(np.column_stack([W.reshape(-1, W.shape[2]), tau.ravel()]))
    copy = stored.copy("F")

    def bare() -> None:
        copy[:] = stored
        dgeqrf(copy, overwrite_a=True)

    refilling = best(lambda: np.copyto(copy, stored))
    fastest = min(best(bare) - refilling, best(lambda: np.linalg.qr(stored, mode="r")))
    usual = best(lambda: qr(stored, mode="r", check_finite=False))
    return fastest / samples * 1e9, usual / samples * 1e9


def factors(name: str, rv: Any, robot: Any, base: Any, cpp: Peers) -> None:
    """Print data to R, in millions of samples a second."""
    n = robot.n
    rng = np.random.default_rng(2)
    states, tau = rng.uniform(-1, 1, (3, LARGE, n)), rng.uniform(-1, 1, (LARGE, n))
    few = 20_000 if n < 20 else 2_000
    W = base.regressor(*states[:, :few])
    fastest, usual = (cpp.regressor + times for times in lapack(W, tau[:few]))
    del W
    qr = rv.ObservationQR(base, threads=1)
    ours = best(lambda: qr.update(*states, tau)) / LARGE * 1e9
    target = (28, 28) if n == 7 else None
    row(name, "data to R / C++ and SciPy's qr", ours, usual, target)
    row(name, "data to R / C++ and dgeqrf", ours, fastest, target)
    friction = rv.ObservationQR(base, friction=("viscous", "coulomb"), threads=1)
    rubbing = best(lambda: friction.update(*states, tau)) / LARGE * 1e9
    targets = {7: ((4, 3.5), (2, 2)), 30: ((0.28, 0), (0, 0))}
    asked = targets.get(n, ((0, 0), (0, 0)))[0 if WIDE else 1]
    for what, times, target in (("", ours, asked[0]), (", friction", rubbing, asked[1])):
        rate = 1e3 / times
        missed = " missed" if rate < target else ""
        print(
            f"{name:7} data to R{what:24} {rate:9.2f} M samples/s {target or '':>11}{missed}",
            flush=True,
        )


def scalar_path(robots: dict[str, Any]) -> None:
    """Print ns a sample of the scalar path, state after state, and with zeros kept.

    Run with ROBERVAL_LANES=1. The rows stay in the cache, as those of the C++ loop, which writes
    the same ones anew.
    """
    for robot in robots.values():
        size = robot.n * len(robot.parameters)
        states = samples(robot.n, min(64, CACHED // (8 * size)))
        count = states.shape[1]
        out = np.zeros((count, robot.n, len(robot.parameters)))
        for kept in (False, True):
            task = partial(robot.regressor, *states, out=out, threads=1, keep_zeros=kept)
            print(best(task) / count * 1e9)


def main() -> int:
    """Print the table."""
    if sys.argv[1:] == ["--install"]:
        subprocess.run([sys.executable, "-m", "pip", "install", *NEEDED], check=True)
        # Pinocchio's folder is found by an interpreter that starts after it was installed.
        return subprocess.run([sys.executable, __file__], check=False).returncode
    try:
        import pinocchio  # noqa: F401
        import roberval as rv
        import scipy  # noqa: F401

        solo = Path(str(distribution("example-robot-data").locate_file(FOLDER)))
    except (ImportError, PackageNotFoundError) as missing:
        print(f"skipped: {missing}; --install brings what is compared")
        return 0
    robots = {
        "puma": rv.load("puma560"),
        "iiwa": rv.load("iiwa14"),
        "solo12": rv.load(solo / "solo_description/robots/solo12.urdf"),
        "tree30": rv.Robot.from_toml(tree()),
    }
    if sys.argv[1:] == ["--scalar-path"]:
        scalar_path(robots)
        return 0
    with tempfile.TemporaryDirectory() as name:
        binary = compiled(Path(name))
        if binary is None:
            return 0
        scalar = subprocess.run(
            [sys.executable, __file__, "--scalar-path"],
            env={**os.environ, "ROBERVAL_LANES": "1"},
            capture_output=True,
            text=True,
            check=True,
        )
        times = iter(map(float, scalar.stdout.split()))
        alone = dict(zip(robots, zip(times, times, strict=True), strict=True))
        titles = f"{'roberval':>9} {'theirs':>9} {'times':>7} asked; ns a sample"
        print(f"{'robot':7} {'task':33} {titles}")
        for name, robot in robots.items():
            path = Path(binary.parent, name)
            path.write_text(described(robot))
            pairs = [printed(binary, path) for _ in range(3)]
            cpp = Peers(*map(min, zip(*pairs, strict=True)), binary)
            base = robot.base_parameters()
            regressors(name, robot, base, cpp)
            in_memory(name, robot, cpp)
            whole, kept = alone[name]
            row(name, "one state, scalar path", whole, cpp.regressor, (5, 5))
            row(name, "one state, zeros kept", kept, cpp.regressor, (5, 5))
            factors(name, rv, robot, base, cpp)
            after = printed(binary, path)
            print(f"{name:7} C++ again afterwards: {after[0]:.1f} and {after[1]:.1f} ns")
    return 0


if __name__ == "__main__":
    sys.exit(main())
