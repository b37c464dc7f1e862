"""Base parameters: the result object and what it computes."""

from __future__ import annotations

import copy
import pickle
from typing import Any

import numpy as np
import pytest
import roberval as rv
from conftest import random_states

ROUNDING = 1e-12
"""Sums of at most C products, relative to the largest entry."""


def near(a: Any, b: Any) -> bool:
    return bool(np.abs(np.asarray(a) - b).max() <= ROUNDING * np.abs(b).max())


def test_every_parameter_has_one_class(base: rv.BaseParameters) -> None:
    classes = [*base.no_effect, *base.unchanged, *base.regrouped_into, *base.regrouped]
    assert sorted(classes) == sorted(base.parameters)
    assert sorted((*base.unchanged, *base.regrouped_into)) == sorted(base.base)
    assert base.rank == len(base.base) == 40


def test_relations_are_the_rows_of_beta(base: rv.BaseParameters) -> None:
    assert list(base.relations) == list(base.base)
    for row, (label, terms) in zip(base.beta, base.relations.items(), strict=True):
        expected = dict(zip(base.regrouped, row, strict=True)) | {label: 1.0}
        assert {k: v for k, v in expected.items() if v} == terms


def test_the_result_cannot_be_changed(base: rv.BaseParameters) -> None:
    with pytest.raises(ValueError, match="read-only"):
        base.beta[0, 0] = 1
    with pytest.raises(TypeError):
        base.relations["ZZ_1"] = {}  # type: ignore[index]
    with pytest.raises(AttributeError):
        base.rank = 41  # type: ignore[misc]
    with pytest.raises(ValueError, match="read-only"):
        base.diagnosis.spectrum[0] = 0
    with pytest.raises(TypeError, match=r"Robot\.base_parameters"):
        rv.BaseParameters()


@pytest.mark.parametrize("model", ["d", "d0", "h"])
def test_the_reduced_model_is_the_model(puma: rv.Robot, model: rv.Model) -> None:
    base = puma.base_parameters(model)
    q, qd, qdd = random_states(puma, 50)
    assert puma.X is not None
    full = puma.regressor(q, qd, qdd, model) @ puma.X
    reduced = base.regressor(q, qd, qdd) @ base.values()
    if model == "h":  # only differences of energy mean anything
        full, reduced = full - full[0], reduced - reduced[0]
    assert near(reduced, full)


def test_every_member_of_the_family_gives_the_torques(base: rv.BaseParameters) -> None:
    puma = base.robot
    states = random_states(puma, 20)
    torques = puma.torques(*states)
    random = np.random.default_rng(7)
    for xr2 in (random.normal(size=15), np.zeros(15)):
        x = dict(zip(base.base, base.regrouped_values(XR2=xr2), strict=True))
        x |= dict(zip(base.regrouped, xr2, strict=True))
        assert near(puma.torques(*states, X=x), torques)
    assert near(puma.torques(*states, X=base.minimum_norm()), torques)


def test_the_minimum_norm_is_smallest(base: rv.BaseParameters) -> None:
    smallest = np.linalg.norm(base.minimum_norm())
    random = np.random.default_rng(8)
    for _ in range(100):
        xr2 = random.normal(size=15)
        assert np.hypot(np.linalg.norm(base.regrouped_values(XR2=xr2)), np.linalg.norm(xr2)) > (
            smallest
        )


def test_values_take_arrays_dicts_and_series(base: rv.BaseParameters) -> None:
    pandas = pytest.importorskip("pandas")
    x = np.random.default_rng(3).normal(size=66)
    labelled = dict(zip(base.parameters, x, strict=True))
    expected = base.values(x)
    assert (base.values(x.tolist()) == expected).all()
    assert (base.values(labelled) == expected).all()
    assert (base.values(pandas.Series(labelled)[::-1]) == expected).all()
    assert base.values({"YY_6": 1.0})[base.base.index("XX_6")] == pytest.approx(-1, abs=ROUNDING)


@pytest.mark.parametrize("engine", ["exact", "qr", "qrii", "svd"])
@pytest.mark.parametrize("seed", [1, 2**64 - 1])
def test_the_answer_does_not_depend_on_the_seed(
    base: rv.BaseParameters, engine: rv.Engine, seed: int
) -> None:
    other = base.robot.base_parameters(engine=engine, seed=seed)
    assert other.base == base.base
    assert near(other.beta, base.beta)
    assert (other.seed, other.engine, other.model) == (seed, engine, "d")


def test_more_rows_change_nothing_but_the_rows(base: rv.BaseParameters) -> None:
    other = base.robot.base_parameters(rows=1000)
    assert other.rows >= 1000 > base.rows >= 2 * 55
    assert other.base == base.base


def test_preferences_are_followed_where_possible(base: rv.BaseParameters) -> None:
    puma = base.robot
    other = puma.base_parameters(keep=["M_6", "YY_6"], drop=["ZZ_1"])
    assert {"M_6", "YY_6"} <= set(other.base)
    assert "ZZ_1" in other.regrouped
    assert other.rank == base.rank
    assert other.choice == "prefer"
    # No other parameter can stand for one that is unchanged.
    assert puma.base_parameters(drop=base.unchanged).unchanged == base.unchanged


def test_pivoted_columns_are_another_base_of_the_same_space(base: rv.BaseParameters) -> None:
    pivoted = base.robot.base_parameters(choice="pivoted")
    assert pivoted.rank == base.rank
    assert pivoted.no_effect == base.no_effect
    states = random_states(base.robot, 20)
    assert near(
        pivoted.regressor(*states) @ pivoted.values(), base.regressor(*states) @ base.values()
    )


@pytest.mark.parametrize("engine", ["exact", "qr", "qrii", "svd"])
def test_the_diagnosis_shows_the_gap(puma: rv.Robot, engine: rv.Engine) -> None:
    diagnosis = puma.base_parameters(engine=engine).diagnosis
    assert diagnosis.clear
    assert diagnosis.messages == ()
    assert (diagnosis.spectrum > diagnosis.tolerance).sum() == 40
    assert diagnosis.gap is not None
    assert diagnosis.gap > 1e6
    assert diagnosis.residual < ROUNDING
    assert len(diagnosis.spectrum_labels) in (0, len(diagnosis.spectrum))


ROUNDED = [(0, 0, 0, 0), ("1.5708", 0, 0, 0.1), ("-1.5708", 0.4, 0, 0), ("1.5708", 0, 0, 0.2)]
EXACT = [(0, 0, 0, 0), ("pi/2", 0, 0, 0.1), ("-pi/2", 0.4, 0, 0), ("pi/2", 0, 0, 0.2)]


def test_rounded_angles_are_set_right_and_told() -> None:
    robot = rv.Robot.from_mdh(ROUNDED, name="rounded")
    assert any("link 2 alpha = 1.5708 is 3.7e-6 rad from pi/2" in text for text in robot.changes)
    with pytest.warns(rv.RobotWarning, match="rounded: as written the file has 25 base param"):
        base = robot.base_parameters()
    exact = rv.Robot.from_mdh(EXACT).base_parameters()
    assert base.base == exact.base
    assert base.beta_exact == exact.beta_exact
    literal = base.diagnosis.literal
    assert literal is not None
    assert literal.rank == 25
    assert "1.5708" in literal.blame[0].what
    assert "1.5708" in robot.to_toml()
    assert "pi/2" in robot.to_toml(cleaned=True)


def test_only_numbers_that_matter_are_blamed() -> None:
    link = '[[link]]\nname = "{}"\nxyz = [0.1, 0.2, 0.3]\nrpy = [{}, 0, {}]\n'
    about_gravity = link.format("turned", 0, 1.5708)
    text = about_gravity + link.format("tilted", 1.5708, 0) + link.format("last", "0.5", 0)
    with pytest.warns(rv.RobotWarning, match="17 base parameters instead of 16"):
        literal = rv.Robot.from_toml(text).base_parameters().diagnosis.literal
    assert literal is not None
    (blame,) = literal.blame
    assert blame.what == "tilted rpy[0] = 1.5708 is 3.7e-6 rad from pi/2"


def test_a_robot_taken_as_written_is_another_robot() -> None:
    written = rv.Robot.from_mdh(ROUNDED, snap="off")
    assert written.changes == ()
    assert written != rv.Robot.from_mdh(ROUNDED)
    assert written.base_parameters().rank == 25
    assert pickle.loads(pickle.dumps(written)) == written


def test_doubt_is_a_warning_not_an_answer() -> None:
    robot = rv.Robot.from_mdh(ROUNDED, name="rounded", snap="off")
    with pytest.warns(rv.DoubtfulRankWarning, match="rounded: .*1\\.5708 for pi/2"):
        base = robot.base_parameters(engine="qr")
    assert not base.diagnosis.clear
    assert "doubtful" in repr(base)
    assert not robot.compare().agree


def test_numbers_that_look_rounded_are_shown_and_left() -> None:
    rows = [(0, 0, 0, 0), ("1.57", 0, 0, 0.1), ("pi/2", 0.4, 0, 0)]
    robot = rv.Robot.from_mdh(rows)
    assert robot.changes == ()
    assert "1.57 is 8.0e-4 rad from pi/2" in robot.near_misses[0]
    assert rv.Robot.from_mdh(rows, snap="aggressive").changes


def test_the_exact_engine_says_how_it_decided(base: rv.BaseParameters) -> None:
    structure = base.diagnosis.structure
    assert structure is not None
    assert structure.rank == 40
    assert len(structure.primes) >= 2
    assert 0 < structure.failure_probability < 1e-15
    assert structure.generic == ()
    assert {witness.rank for witness in base.diagnosis.witnesses} == {40}
    assert base.robot.base_parameters(engine="qr").diagnosis.structure is None


def test_coefficients_without_rounding_may_hold_roots() -> None:
    rows = [(0, 0, 0, 0), ("30 deg", 0, 0, 0.5), ("-pi/4", 0.4, 0, 0.1)]
    base = rv.Robot.from_mdh(rows).base_parameters()
    assert base.beta_exact is not None
    numbers = [number for row in base.beta_exact.values() for number in row.values()]
    surds = [number for number in numbers if isinstance(number, rv.Surd)]
    assert surds
    assert "sqrt(" in str(surds[0])
    for kept, row in base.beta_exact.items():
        for regrouped, number in row.items():
            assert float(number) == pytest.approx(base.relations[kept][regrouped], rel=ROUNDING)
    assert base.robot.base_parameters(engine="svd").beta_exact is None


def test_comparisons_tell_who_agrees(puma: rv.Robot) -> None:
    comparison = puma.compare(seed=3)
    assert comparison.agree
    routes = {(route.answer.model, route.answer.engine) for route in comparison.routes}
    assert len(routes) == 12
    assert all(route.same_columns for route in comparison.routes)
    assert max(route.beta_difference for route in comparison.routes) < ROUNDING
    assert repr(comparison) == "Comparison(12 routes agree: 40 base parameters)"


def test_results_can_be_pickled_and_copied(base: rv.BaseParameters) -> None:
    special = base.robot.base_parameters("h", engine="svd", keep=["M_6"], seed=4, rows=300)
    for answer in (base, special):
        for twin in (pickle.loads(pickle.dumps(answer)), copy.deepcopy(answer)):
            assert twin.base == answer.base
            assert (twin.beta == answer.beta).all()
            assert repr(twin) == repr(answer)
            assert not twin.beta.flags.writeable


BAD_OPTIONS: dict[str, tuple[dict[str, Any], type[Exception], str]] = {
    "model": ({"model": "x"}, rv.OptionError, 'model is "x", expected one of "d", "d0", "h"'),
    "engine": ({"engine": "lu"}, rv.OptionError, 'engine is "lu", expected one of "exact"'),
    "choice": ({"choice": "best"}, rv.OptionError, 'choice is "best", expected one of "paper"'),
    "unknown label": (
        {"keep": ["ZZ1"]},
        rv.UnknownParameterError,
        'no parameter "ZZ1"; did you mean ZZ_1',
    ),
    "kept and dropped": (
        {"keep": ["M_6"], "drop": ["M_6"]},
        rv.OptionError,
        "asked to be kept and to be dropped",
    ),
    "lists without prefer": (
        {"keep": ["M_6"], "choice": "pivoted"},
        rv.OptionError,
        'keep and drop go with choice "prefer"',
    ),
    "a label for a list": ({"keep": "M_6"}, rv.OptionError, "keep is the text 'M_6', expected a"),
    "too few rows": ({"rows": 54}, rv.OptionError, "54 rows for 55 parameters"),
    "no rows": ({"rows": 0}, rv.OptionError, "rows is 0, expected"),
    "negative rows": ({"rows": -1}, rv.OptionError, "rows is -1, expected"),
    "too many rows": ({"rows": 2**62}, rv.OptionError, "rows are more than fit in memory"),
    "half a row": ({"rows": 1.5}, rv.OptionError, "rows is 1.5, expected"),
    "negative seed": ({"seed": -1}, rv.OptionError, "seed is -1, expected"),
    "large seed": ({"seed": 2**64}, rv.OptionError, "seed is 18446744073709551616, expected"),
    "seed of text": ({"seed": "a"}, rv.OptionError, "seed is 'a', expected"),
    "no tolerance": ({"tolerance": 0.0}, rv.OptionError, "tolerance is 0, expected a ratio"),
    "large tolerance": ({"tolerance": 1.0}, rv.OptionError, "tolerance is 1, expected a ratio"),
    "NaN tolerance": ({"tolerance": np.nan}, rv.OptionError, "tolerance is NaN, expected a rat"),
    "tolerance by name": ({"tolerance": "small"}, rv.OptionError, 'tolerance is "small", expec'),
    "tolerance of a list": ({"tolerance": [1]}, rv.OptionError, r"tolerance is \[1\], expected"),
}


@pytest.mark.parametrize("name", BAD_OPTIONS)
def test_bad_options_are_refused(puma: rv.Robot, name: str) -> None:
    options, error, message = BAD_OPTIONS[name]
    with pytest.raises(error, match=message):
        puma.base_parameters(**options)


def test_numpy_integers_are_integers(puma: rv.Robot) -> None:
    assert puma.base_parameters(seed=np.int64(3), rows=np.int32(200)).seed == 3


def test_unknown_labels_read_as_a_sentence(puma: rv.Robot) -> None:
    with pytest.raises(KeyError) as caught:
        puma.base_parameters(keep=["XX_7"])
    assert str(caught.value).startswith('the robot has no parameter "XX_7"')
