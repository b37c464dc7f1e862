"""Relations in symbols, generated code and compiled regressors from Python."""

from __future__ import annotations

import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
import roberval as rv

TOLERANCE = 1e-12
"""Generated code rounds in another order than the package; values are a few tens."""

ROBOTS = ("puma560", "stanford", "scara", "torso", "iiwa14")


def states(n: int, count: int = 20) -> npt.NDArray[np.float64]:
    """Return random q, qd, qdd."""
    return np.random.default_rng(1991).normal(size=(3, count, n))


def test_relations_of_the_puma_are_table_v() -> None:
    symbolic = rv.load("puma560").base_parameters().relations_symbolic()
    assert len(symbolic) == 17
    assert symbolic["XX_3"] == "XX_3 - YY_3 + YY_4 + 2 R4 MZ_4 + (R4^2 - D4^2) (M_4 + M_5 + M_6)"
    start = "MX_{R2} = MX_{2} + D_{3}\\,(M_{3} + "
    assert symbolic.latex["MX_2"].startswith(start)
    assert dict(symbolic.symbols) == {"D3": 0.5, "R3": 0.2, "D4": 0.02, "R4": 0.6}
    assert symbolic.rank == 40
    assert symbolic.special == ()
    assert symbolic.failure_probability < 1e-15
    assert symbolic.origins["YY_4"] == "rule: mass along a revolute joint's axis"


def test_the_rules_alone_leave_what_the_numerical_method_then_reduces() -> None:
    puma, sr400 = rv.load("puma560"), rv.load("sr400")
    whole, rules = puma.base_parameters().relations_symbolic(), puma.closed_form_rules()
    assert dict(rules) == dict(whole)
    assert rules.left_over == ()
    assert rules.made_by["ZZ_1"] == (
        "rule: a rotor turns (slides) as its link does",
        "rule: mass along a revolute joint's axis",
    )
    left = sr400.closed_form_rules()
    base = sr400.base_parameters()
    assert left.rank - len(left.left_over) == base.rank
    assert not set(left.left_over) & set(base.base)
    elimination = "elimination, where the rules end"
    origins = base.relations_symbolic().origins
    assert {label for label, origin in origins.items() if origin == elimination} == set(
        left.left_over
    )


@pytest.mark.parametrize("name", [*ROBOTS, "sr400"])
def test_sympy_reads_the_relations_and_gives_beta(name: str) -> None:
    pytest.importorskip("sympy")
    base = rv.load(name).base_parameters()
    symbolic = base.relations_symbolic()
    relations = symbolic.to_sympy()
    scope: dict[str, Any] = {}
    exec(symbolic.sympy_source(), scope)
    for label, expression in relations.items():
        assert scope["relations"][label].free_symbols
        values = {s: symbolic.symbols.get(s.name, s) for s in expression.free_symbols}
        given = expression.subs(values).expand()
        for other, coefficient in base.relations[label].items():
            symbol = next(s for s in given.free_symbols if s.name == other)
            assert float(given.coeff(symbol)) == pytest.approx(coefficient, abs=TOLERANCE)


def test_constants_may_have_names_that_mean_something_to_python() -> None:
    sympy = pytest.importorskip("sympy")
    text = rv.load("two_link").to_toml()
    assert "L1" in text
    for name in ("lambda", "M_2", "MXR_1", "cos", "f", "E", "I", "S", "N"):
        robot = rv.Robot.from_toml(text.replace("L1", name))
        symbolic = robot.base_parameters().relations_symbolic()
        scope: dict[str, Any] = {}
        exec(symbolic.sympy_source(), scope)
        length = sympy.Symbol(name, real=True)
        for relations in (scope["relations"], symbolic.to_sympy()):
            assert relations["MX_1"].coeff(length).free_symbols


@pytest.mark.parametrize("name", ROBOTS)
def test_numpy_code_gives_the_packages_numbers(name: str) -> None:
    base = rv.load(name).base_parameters()
    q, qd, qdd = states(base.robot.n)
    x = np.random.default_rng(1).normal(size=base.rank)
    scope: dict[str, Any] = {}
    for what in ("tau", "regressor"):
        code = base.code("python", what)
        exec(code.text, scope)
        function = scope[code.function]
        rows = base.regressor(q, qd, qdd)
        if what == "regressor":
            found = function(q, qd, qdd)
            assert np.abs(found - rows).max() < TOLERANCE * max(1, np.abs(rows).max())
        else:
            prepare = scope.get(f"{code.function}_prepare", np.asarray)
            expected = rows @ x
            found = function(q, qd, qdd, prepare(x))
            assert np.abs(found - expected).max() < TOLERANCE * max(1, np.abs(expected).max())


def test_code_names_the_robot_by_its_whole_hash() -> None:
    base = rv.load("puma560").base_parameters()
    text = str(base.code("c", "gravity"))
    assert f"robot sha256 {base.certificate()['robot_sha256']}\n" in text


@pytest.mark.parametrize("model", ["d", "d0", "h"])
@pytest.mark.parametrize("name", ROBOTS)
def test_a_compiled_regressor_is_the_regressor(name: str, model: rv.Model) -> None:
    base = rv.load(name).base_parameters(model=model)
    compiled = base.compile(compiler=True)
    q, qd, qdd = states(base.robot.n)
    assert base.compile(compiler=False).compiled is False
    expected = base.regressor(q, qd, qdd)
    out = np.empty_like(expected)
    assert compiled(q, qd, qdd, out=out) is out
    assert np.abs(out - expected).max() < TOLERANCE * max(1, np.abs(expected).max())
    assert np.array_equal(compiled(q[3], qd[3], qdd[3]), out[3])


SLIDER = """
name = "slider crank"
gravity = [0, -9.81, 0]
link = [
    { name = "crank", alpha = 0, d = 0, r = 0 },
    { name = "slide", joint = "prismatic", antecedent = "base", alpha = "pi/2", d = 0, theta = 0 },
]
[[couple]]
joint = "slide"
expression = "0.2*cos(q.crank) + sqrt(0.03 - 0.04*sin(q.crank)*sin(q.crank))"
"""


def test_a_compiled_regressor_follows_expressions_as_far_as_they_have_values() -> None:
    base = rv.Robot.from_toml(SLIDER).base_parameters()
    compiled = base.compile(compiler=True)
    q, qd, qdd = 0.1 * states(1)
    expected = base.regressor(q, qd, qdd)
    assert np.abs(compiled(q, qd, qdd) - expected).max() < TOLERANCE
    q[7] = np.pi / 2
    with pytest.raises(rv.RobervalError, match="slide"):
        compiled(q, qd, qdd)


@pytest.mark.parametrize("model", ["d", "d0", "h"])
def test_a_compiled_regressor_of_a_floating_base_is_the_regressor(model: rv.Model) -> None:
    base = rv.load("two_link", floating=True).base_parameters(model=model)
    random = np.random.default_rng(3)
    q, (qd, qdd) = random.normal(size=(9, base.robot.nq)), random.normal(size=(2, 9, base.robot.n))
    q[:, 3:7] /= np.linalg.norm(q[:, 3:7], axis=1, keepdims=True)
    compiled, expected = base.compile(compiler=True), base.regressor(q, qd, qdd)
    scale = max(1, np.abs(expected).max())
    assert np.abs(compiled(q, qd, qdd) - expected).max() < TOLERANCE * scale
    q[4, 3:7] *= 2
    with pytest.raises(rv.RobervalError, match="quaternion"):
        compiled(q, qd, qdd)


def test_without_a_compiler_the_package_does_the_work(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", "/no/such/compiler")
    base = rv.load("two_link").base_parameters()
    compiled = base.compile()
    assert not compiled.compiled
    q, qd, qdd = states(2)
    expected = base.regressor(q, qd, qdd)
    assert np.array_equal(compiled(q, qd, qdd), expected)
    assert np.array_equal(compiled(q, qd, qdd, threads=2), expected)


def test_a_compiled_regressor_refuses_what_the_regressor_refuses() -> None:
    compiled = rv.load("two_link").base_parameters().compile()
    q, qd, qdd = states(2)
    with pytest.raises(rv.ShapeError):
        compiled(q, qd[:3], qdd)
    q[0, 0] = np.nan
    with pytest.raises(rv.ArrayError):
        compiled(q, qd, qdd)


def test_fewer_operations_than_sympybotics_and_the_literature() -> None:
    # SymPyBotics (its Newton-Euler of Khalil and sympy's cse, the same base parameters):
    # PUMA 323 multiplications and 248 additions, Stanford arm 269 and 219.
    for name, least in (("puma560", 323 + 248), ("stanford", 269 + 219)):
        count = rv.load(name).base_parameters().code("c", "tau").count
        assert count.mul + count.add < least


def test_bad_requests_are_told() -> None:
    base = rv.load("two_link").base_parameters()
    for arguments in (("cobol", "tau"), ("c", "nothing")):
        with pytest.raises(rv.OptionError):
            base.code(*arguments)
    with pytest.raises(rv.OptionError):
        base.code("c", "mass", friction=True)
    with pytest.raises(rv.OptionError):
        base.code("c", "tau", parameters="some")


def test_names_of_robot_files_cannot_leave_comments(tmp_path: Path) -> None:
    hostile = "*/ int x; /* %{ ??/ && #" + "y" * 900
    text = f"""
name = "{hostile}"
[[link]]
name = "a */ b"
alpha = 0
d = 0.5
r = 0
inertia = {{ ZZ = 1 }}
[[link]]
name = "while"
alpha = 0
d = 0.5
r = 0.25
"""
    path = tmp_path / "robot.toml"
    path.write_text(text)
    base = rv.load(path).base_parameters()
    source = base.code("c", "tau", friction=True).write(tmp_path / "code.c")
    command = [
        "cc",
        "-std=c99",
        "-Wall",
        "-Wextra",
        "-Werror",
        "-c",
        str(source),
        "-o",
        str(tmp_path / "o"),
    ]
    try:
        done = subprocess.run(command, capture_output=True, text=True)
    except FileNotFoundError:
        pytest.skip("no C compiler here")
    assert done.returncode == 0, done.stderr
    compile(base.code("python", "tau").text, "code.py", "exec")
