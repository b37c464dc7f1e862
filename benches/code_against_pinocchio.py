"""Time generated inverse dynamics in C against Pinocchio's rnea in C++, in one program.

    pip install .[peers] && cargo build --release
    python benches/code_against_pinocchio.py [ROBOT.urdf]

Needs g++, gcc and Eigen's headers (libeigen3-dev). Both run in one thread, in turn, on the same
states; the torques are compared first. Trust the ratio of the best rounds, not the times.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from importlib.metadata import distribution
from pathlib import Path

import numpy as np
import pinocchio as pin
import roberval as rv

DEFAULT = "cmeel.prefix/share/example-robot-data/robots/xarm_description/urdf/xarm7.urdf"
PREFIX = "cmeel.prefix"
# What Pinocchio's own CMake files define for those who use it.
DEFINES = (
    "-DBOOST_MPL_LIMIT_LIST_SIZE=30",
    "-DBOOST_MPL_LIMIT_VECTOR_SIZE=30",
    "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS",
    "-DBOOST_FUSION_INVOKE_MAX_ARITY=12",
)

DRIVER = r"""
#include <pinocchio/multibody.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <chrono>
#include <cstdio>
#include <vector>
extern "C" {
void PREPARE(const double *x, double *k);
void TAU(const double *q, const double *qd, const double *qdd, const double *k, double *tau);
}
using Clock = std::chrono::steady_clock;
static double since(Clock::time_point start) {
  return std::chrono::duration<double, std::nano>(Clock::now() - start).count();
}
int main() {
  pinocchio::Model model;
JOINTS
  pinocchio::Data data(model);
  const int n = N, states = 1000, rounds = 200;
  if (model.nv != n || model.nq != n) { std::puts("other joints"); return 1; }
  const double x[] = {VALUES};
  double k[KS];
  PREPARE(x, k);
  std::vector<Eigen::VectorXd> q, v, a;
  for (int i = 0; i < states; i++) {
    q.push_back(Eigen::VectorXd::Random(n) * 3);
    v.push_back(Eigen::VectorXd::Random(n));
    a.push_back(Eigen::VectorXd::Random(n));
  }
  double error = 0, theirs = 1e300, ours = 1e300, sum = 0;
  Eigen::VectorXd tau(n);
  for (int i = 0; i < states; i++) {
    TAU(q[i].data(), v[i].data(), a[i].data(), k, tau.data());
    auto rnea = pinocchio::rnea(model, data, q[i], v[i], a[i]);
    error = std::max(error, (tau - rnea).cwiseAbs().maxCoeff());
  }
  for (int round = 0; round < rounds; round++) {
    auto start = Clock::now();
    for (int i = 0; i < states; i++) sum += pinocchio::rnea(model, data, q[i], v[i], a[i])[0];
    theirs = std::min(theirs, since(start) / states);
    start = Clock::now();
    for (int i = 0; i < states; i++) {
      TAU(q[i].data(), v[i].data(), a[i].data(), k, tau.data());
      sum += tau[0];
    }
    ours = std::min(ours, since(start) / states);
  }
  std::printf("largest difference %.1e Nm (%g)\n", error, sum);
  std::printf("rnea %.0f ns, generated code %.0f ns: ", theirs, ours);
  std::printf("%.2f times faster\n", theirs / ours);
}
"""


def main() -> None:
    """Generate, compile, run."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("robot", nargs="?", type=Path)
    robot = parser.parse_args().robot
    site = Path(str(distribution("pin").locate_file("")))
    with tempfile.TemporaryDirectory() as folder:
        bench(robot or site / DEFAULT, Path(folder), site / PREFIX)


def bench(written: Path, here: Path, prefix: Path) -> None:
    """Generate, compile and run in a folder, with the robot's rounded angles set right."""
    robot = here / "robot.urdf"
    command = "from roberval.command import main; main()"
    run([sys.executable, "-c", command, "clean", str(written), "-o", str(robot)], here)
    base = rv.load(robot, rotors=False).base_parameters()
    code = base.code("c", "tau")
    values = ", ".join(repr(float(x)) for x in base.values())
    count = code.text.split(f"{code.function}_prepare(const double x[")[1].split("double k[")[1]
    text = DRIVER
    for key, value in {
        "PREPARE": f"{code.function}_prepare",
        "TAU": code.function,
        "JOINTS": joints(robot),
        "VALUES": values,
        "KS": count.split("]")[0],
        "= N,": f"= {base.robot.n},",
    }.items():
        text = text.replace(key, value)
    (here / "driver.cpp").write_text(text)
    code.write(here / "tau.c")
    flags = ["-O3", "-march=native", "-DNDEBUG"]
    run(["gcc", "-std=c99", *flags, "-c", "tau.c"], here)
    includes = [f"-I{prefix}/include", "-I/usr/include/eigen3"]
    libraries = [f"-L{prefix}/lib", "-lpinocchio_default", f"-Wl,-rpath,{prefix}/lib", "-lm"]
    sources = ["driver.cpp", "tau.o", "-o", "driver"]
    run(["g++", "-std=c++17", *flags, *DEFINES, *includes, *sources, *libraries], here)
    cost = f"{code.count.mul} mul, {code.count.add} add, {code.count.trig} trig"
    print(f"{base.robot.name}: {cost}; {np.size(base.values())} base parameters")
    print(run([str(here / "driver")], here))


def joints(path: Path) -> str:
    """Return C++ that makes the model which Pinocchio reads from a URDF."""
    model = pin.buildModelFromUrdf(str(path))
    lines = []
    for j in range(1, model.njoints):
        kind = model.joints[j].shortname()
        if kind not in {f"JointModel{k}{axis}" for k in "RP" for axis in "XYZ"}:
            sys.exit(f"joint {model.names[j]} is a {kind}")
        place, inertia = model.jointPlacements[j], model.inertias[j]
        rotation = ", ".join(repr(float(x)) for x in place.rotation.ravel())
        origin, lever = (
            ", ".join(repr(float(x)) for x in v) for v in (place.translation, inertia.lever)
        )
        tensor = ", ".join(repr(float(x)) for x in inertia.inertia.ravel())
        lines.append(
            f"""  {{ Eigen::Matrix3d R, I; R << {rotation}; I << {tensor};
    auto j = model.addJoint({model.parents[j]}, pinocchio::{kind}(),
      pinocchio::SE3(R, Eigen::Vector3d({origin})), "j{j}");
    model.appendBodyToJoint(j, pinocchio::Inertia({float(inertia.mass)!r},
      Eigen::Vector3d({lever}), I)); }}"""
        )
    return "\n".join(lines)


def run(command: list[str], folder: Path) -> str:
    """Run a command that must succeed; give what it prints."""
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}\n{done.stderr[-4000:]}{done.stdout}")
    return done.stdout


if __name__ == "__main__":
    main()
