"""Arrays as they come: each is taken rightly, or refused with the argument's name."""

from __future__ import annotations

import re
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
import roberval as rv
from conftest import States, random_states
from roberval import arrays

Array = npt.NDArray[Any]

N, n, C = 5, 6, 66


@pytest.fixture(scope="module")
def states(puma: rv.Robot) -> States:
    return random_states(puma, N)


def strided(array: Array) -> Array:
    """The same numbers, every other entry of a larger array."""
    wide = np.zeros((2 * array.shape[0], 2 * array.shape[1]))
    wide[::2, ::2] = array
    return wide[::2, ::2]


def misaligned(array: Array) -> Array:
    raw = np.zeros(array.nbytes + 1, dtype=np.uint8)[1:]
    view = raw.view(np.float64).reshape(array.shape)
    view[:] = array
    return view


def read_only(array: Array) -> Array:
    array = array.copy()
    array.flags.writeable = False
    return array


SAME_NUMBERS: dict[str, Callable[[Array], Any]] = {
    "nested list": lambda a: a.tolist(),
    "tuple of arrays": tuple,
    "Fortran order": np.asfortranarray,
    "strided view": strided,
    "negative strides": lambda a: a[::-1, ::-1].copy()[::-1, ::-1],
    "big-endian": lambda a: a.astype(">f8"),
    "misaligned": misaligned,
    "read-only": read_only,
    "long double": lambda a: a.astype(np.longdouble),
    "matrix": lambda a: a.view(np.matrix),
    "masked, no entry masked": lambda a: np.ma.masked_array(a, mask=False),
    "transposed twice": lambda a: a.T.copy().T,
}


@pytest.mark.parametrize("name", SAME_NUMBERS)
def test_same_numbers_give_the_same_regressor(puma: rv.Robot, states: States, name: str) -> None:
    expected = puma.regressor(*states)
    q, qd, qdd = (SAME_NUMBERS[name](state) for state in states)
    assert (puma.regressor(q, qd, qdd) == expected).all()


@pytest.mark.parametrize("dtype", ["f4", "f2", "i1", "i8", "u2", "u8"])
def test_other_real_types_count_as_their_float64(puma: rv.Robot, dtype: str) -> None:
    q = np.arange(N * n).reshape(N, n).astype(dtype)
    plain = q.astype(np.float64)
    expected = puma.regressor(plain, plain, plain)
    assert (puma.regressor(q, q, q) == expected).all()


def test_broadcast_states_are_taken(puma: rv.Robot) -> None:
    q = np.broadcast_to(np.linspace(0, 1, n), (N, n))
    rows = puma.regressor(q, q, q)
    assert (rows == rows[0]).all()


def test_a_data_frame_is_an_array(puma: rv.Robot, states: States) -> None:
    pandas = pytest.importorskip("pandas")
    q, qd, qdd = (pandas.DataFrame(state) for state in states)
    assert (puma.regressor(q, qd, qdd) == puma.regressor(*states)).all()


@pytest.mark.parametrize("model", ["d", "d0", "h"])
def test_no_sample_gives_no_row(puma: rv.Robot, model: rv.Model) -> None:
    q = np.zeros((0, n))
    shape = (0, C) if model == "h" else (0, n, C)
    assert puma.regressor(q, q, q, model).shape == shape


def test_entries_far_apart_are_taken(puma: rv.Robot, states: States) -> None:
    q, qd, qdd = (state.copy() for state in states)
    qd[0, 0], qdd[0, 0], q[0, 0] = 5e-324, -0.0, 1e6
    assert np.isfinite(puma.regressor(q, qd, qdd)).all()


WRONG: dict[str, tuple[Any, str]] = {
    "text": ("q", "dtype <U1, expected real numbers"),
    "words": ([["a"] * n] * N, "dtype <U1, expected real numbers"),
    "bytes": (np.zeros((N, n), "S1"), r"dtype \|S1, expected real numbers"),
    "None": (None, "dtype object, expected real numbers"),
    "complex": (np.zeros((N, n), complex), "dtype complex128, expected real numbers"),
    "objects": (np.zeros((N, n), object), "dtype object, expected real numbers"),
    "fractions": ([[Fraction(1, 3)] * n] * N, "dtype object, expected real numbers"),
    "booleans": (np.zeros((N, n), bool), "dtype bool, expected real numbers"),
    "times": (np.zeros((N, n), "M8[s]"), r"dtype datetime64\[s\], expected real numbers"),
    "records": (np.zeros((N, n), "f8,f8"), "expected real numbers"),
    "ragged": ([[0.0] * n, [0.0] * (n - 1)], "is no array of numbers"),
    "masked": (np.ma.masked_less(np.zeros((N, n)), 1), "has masked entries"),
    "scalar": (0.0, r"shape \(\), expected \(6,\) for one state or \(N, 6\)"),
    "empty list": ([], r"shape \(0,\), expected \(6,\) for one state or \(N, 6\)"),
    "too few joints": (np.zeros((N, n - 1)), r"shape \(5, 5\), expected .* 6 moving joints"),
    "too many joints": (np.zeros(n + 1), r"shape \(7,\), expected"),
    "transposed": (np.zeros((n, N)), r"shape \(6, 5\), expected"),
    "three dimensions": (np.zeros((1, N, n)), r"shape \(1, 5, 6\), expected"),
    "one sample more": (np.zeros((N + 1, n)), "q, qd and qdd must have one shape"),
    "one state for many": (np.zeros(n), "q, qd and qdd must have one shape"),
    "NaN": (np.full((N, n), np.nan), r"\[0, 0\] is NaN: joint states must be finite"),
    "infinite": (np.full((N, n), -np.inf), r"\[0, 0\] is -inf: joint states must be finite"),
    "long double overflow": (
        np.full((N, n), np.finfo(np.longdouble).max),
        r"\[0, 0\] is inf: joint states must be finite",
    ),
}


@pytest.mark.parametrize("name", WRONG)
@pytest.mark.parametrize("argument", ["q", "qd", "qdd"])
def test_wrong_states_are_refused_by_name(
    puma: rv.Robot, states: States, argument: str, name: str
) -> None:
    value, message = WRONG[name]
    arguments = dict(zip(("q", "qd", "qdd"), states, strict=True)) | {argument: value}
    if "one shape" in message:
        argument = r"qd?d?"  # either side of the difference
    if value is None and argument != "q":
        message = "is missing"  # the default: the model says whether it is needed
    with pytest.raises(rv.ArrayError, match=rf"^{argument}\b.*{message}"):
        puma.regressor(**arguments)
    if value is not None:
        with pytest.raises(rv.ArrayError, match=message):
            puma.torques(**arguments)


def test_the_bad_sample_is_named_far_into_the_data(puma: rv.Robot) -> None:
    # Farther than one block between two looks at Ctrl-C.
    q = np.zeros((5000, n))
    bad = q.copy()
    bad[4321, 2] = np.nan
    with pytest.raises(rv.ArrayError, match=re.escape("qd[4321, 2] is NaN")):
        puma.regressor(q, bad, q)


@pytest.mark.parametrize("threads", [1, 2])
def test_the_first_bad_sample_is_named_whatever_its_array(puma: rv.Robot, threads: int) -> None:
    q, qd, qdd = random_states(puma, 6000)
    q[3000, 1], qdd[0, 3] = np.nan, np.inf
    with pytest.raises(rv.ArrayError, match=r"qdd\[0, 3\] is inf"):
        puma.regressor(q, qd, qdd, threads=threads)


@pytest.mark.parametrize("name", ["puma560", "iiwa14"])
def test_states_that_a_model_does_not_look_at_may_hold_anything(name: str) -> None:
    # The ends of numerical derivatives often hold NaN.
    robot = rv.load(name)
    q, qd, qdd = random_states(robot, 100)
    nan = np.full_like(q, np.nan)
    assert np.array_equal(robot.regressor(q, nan, qdd, "d0"), robot.regressor(q, None, qdd, "d0"))
    assert np.array_equal(robot.regressor(q, qd, nan, "h"), robot.regressor(q, qd, None, "h"))
    with pytest.raises(rv.ArrayError, match="NaN"):
        robot.packed(q, qd, nan, "d0")


def test_no_room_is_made_for_states_that_do_not_fit(puma: rv.Robot) -> None:
    q = np.zeros((2, 6))
    made = arrays.room((q, q, q), (6, 6), (6, 66))
    assert made is not None
    assert made.shape == (2, 6, 66)
    single = q.astype("f4")
    for states in [(q, q[0], q), (q, None, q), (single,) * 3, (q[None],) * 3, (q[:, 1:],) * 3]:
        assert arrays.room(states, (6, 6), (6, 66)) is None


def test_models_say_which_states_they_need(puma: rv.Robot) -> None:
    q = np.zeros(n)
    with pytest.raises(rv.ShapeError, match="qd is missing: model d needs velocities"):
        puma.regressor(q)
    with pytest.raises(rv.ShapeError, match="qdd is missing: model d0 needs accelerations"):
        puma.regressor(q, model="d0")
    assert puma.regressor(q, qdd=q, model="d0").shape == (n, C)
    assert puma.regressor(q, q, model="h").shape == (C,)


BAD_OUT: dict[str, tuple[Any, str]] = {
    "a list": ([[0.0] * C] * n, "is a list, expected a NumPy array"),
    "float32": (np.zeros((N, n, C), "f4"), "has dtype <f4, expected float64"),
    "integers": (np.zeros((N, n, C), "i8"), "has dtype <i8, expected float64"),
    "big-endian": (np.zeros((N, n, C), ">f8"), "has dtype >f8, expected float64"),
    "read-only": (read_only(np.zeros((N, n, C))), "is read-only"),
    "broadcast": (np.broadcast_to(np.zeros(C), (N, n, C)), "is read-only"),
    "Fortran order": (np.zeros((N, n, C), order="F"), "is not C-contiguous"),
    "strided": (np.zeros((N, n, 2 * C))[..., ::2], "is not C-contiguous"),
    "reversed": (np.zeros((N, n, C))[::-1], "is not C-contiguous"),
    "misaligned": (misaligned(np.zeros((N, n, C))), "is not aligned"),
    "masked": (np.ma.zeros((N, n, C)), "is a MaskedArray, expected a NumPy array"),
    "rows first": (np.zeros((n, N, C)), r"has shape \(6, 5, 66\), expected \(5, 6, 66\)"),
    "W": (np.zeros((N * n, C)), r"has shape \(30, 66\), expected \(5, 6, 66\)"),
    "one state": (np.zeros((n, C)), r"has shape \(6, 66\), expected \(5, 6, 66\)"),
}


@pytest.mark.parametrize("name", BAD_OUT)
def test_wrong_out_is_refused_and_untouched(puma: rv.Robot, states: States, name: str) -> None:
    out, message = BAD_OUT[name]
    before = np.array(out)
    with pytest.raises(rv.ArrayError, match=f"^out {message}"):
        puma.regressor(*states, out=out)
    assert (np.array(out) == before).all()


def test_out_is_filled_and_returned(puma: rv.Robot, states: States) -> None:
    out = np.full((N, n, C), np.nan)
    assert puma.regressor(*states, out=out) is out
    assert (out == puma.regressor(*states)).all()


def test_arrays_of_subclasses_are_written_as_plain_ones(
    puma: rv.Robot, states: States, tmp_path: Path
) -> None:
    W = puma.regressor(*states)
    on_disk = np.memmap(tmp_path / "W", float, "w+", shape=(N, n, C))
    assert puma.regressor(*states, out=on_disk) is on_disk
    np.testing.assert_array_equal(on_disk, W)
    tau: Array = np.empty((N, n)).view(type("Torques", (np.ndarray,), {}))
    X = np.ones(C)
    np.testing.assert_array_equal(puma.torques(*states, X, out=tau), puma.torques(*states, X))
    tiles = puma.packed(*states)
    view = np.empty(tiles.shape).view(type(tau))
    np.testing.assert_array_equal(puma.packed(*states, out=view), tiles)


def test_out_may_be_part_of_a_larger_array(puma: rv.Robot, states: States) -> None:
    large = np.full((3 * N, n, C), np.nan)
    puma.regressor(*states, out=large[N : 2 * N])
    assert (large[N : 2 * N] == puma.regressor(*states)).all()
    assert np.isnan(large[:N]).all()
    assert np.isnan(large[2 * N :]).all()


@pytest.mark.parametrize("argument", [0, 1, 2])
@pytest.mark.parametrize("first", [0, 7, N * n * (C - 1)])
def test_out_may_share_memory_with_the_states(
    puma: rv.Robot, states: States, argument: int, first: int
) -> None:
    expected = puma.regressor(*states)
    memory = np.empty(N * n * C)
    given = list(states)
    given[argument] = memory[first : first + N * n].reshape(N, n)
    given[argument][:] = states[argument]
    q, qd, qdd = given
    assert (puma.regressor(q, qd, qdd, out=memory.reshape(N, n, C)) == expected).all()


def test_torques_may_take_the_place_of_the_states(puma: rv.Robot, states: States) -> None:
    X = np.linspace(1, 2, C)
    expected = puma.torques(*states, X)
    for argument in range(3):
        given = [array.copy() for array in states]
        q, qd, qdd = given
        assert (puma.torques(q, qd, qdd, X, out=given[argument]) == expected).all()


def test_parameters_in_any_form_give_the_same_torques(puma: rv.Robot, states: States) -> None:
    X = np.linspace(1, 2, C)
    expected = puma.torques(*states, X)
    twice = np.repeat(X, 2)[::2]
    labelled = dict(zip(puma.parameters, X, strict=True))
    for same in (list(X), twice, X.astype(np.longdouble), labelled):
        assert (puma.torques(*states, same) == expected).all()


@pytest.mark.parametrize("count", [1, 5, 8, 6000])
@pytest.mark.parametrize("model", ["d", "d0", "h"])
def test_kept_zeros_give_the_same_rows(puma: rv.Robot, count: int, model: rv.Model) -> None:
    # 6000 states of d go past the cache.
    assert_kept_zeros_give_the_same_rows(puma, count, model)


@pytest.mark.parametrize("floating", [False, True])
@pytest.mark.parametrize("name", ["torso", "sr400", "four_bar"])
def test_kept_zeros_give_the_same_rows_of_trees_couples_and_loops(
    name: str, floating: bool
) -> None:
    robot = rv.load(name, floating=floating)
    for model in ("d", "h"):
        assert_kept_zeros_give_the_same_rows(robot, 600, model)


def assert_kept_zeros_give_the_same_rows(robot: rv.Robot, count: int, model: rv.Model) -> None:
    out = robot.regressor(*random_states(robot, count), model=model)
    q, qd, qdd = (array[1:] for array in random_states(robot, count + 1))
    expected = robot.regressor(q, qd, qdd, model)
    assert (expected != out).any()
    assert robot.regressor(q, qd, qdd, model, out=out, keep_zeros=True) is out
    np.testing.assert_array_equal(out, expected)
    base = robot.base_parameters(model=model)
    d1 = np.zeros_like(base.regressor(q, qd, qdd))
    base.regressor(q, qd, qdd, out=d1, keep_zeros=True)
    np.testing.assert_array_equal(d1, base.regressor(q, qd, qdd))


def test_zeros_to_keep_that_are_none_are_refused_before_anything_is_written(
    puma: rv.Robot,
) -> None:
    # 2000 states are shared out in pieces.
    for count in (20, 2000):
        states = random_states(puma, count)
        out = puma.regressor(*states)
        wrong = np.where(out == 0, 3.0, -1.0)
        before = wrong.copy()
        with pytest.raises(rv.ArrayError, match=r"^out has 3 in row \d+, column \d+ of sample 0, "):
            puma.regressor(*states, out=wrong, keep_zeros=True)
        np.testing.assert_array_equal(wrong, before)
        wrong[:-1] = 0
        before = wrong.copy()
        with pytest.raises(rv.ArrayError, match=rf"of sample {count - 1}, which is zero in every"):
            puma.regressor(*states, out=wrong, keep_zeros=True)
        np.testing.assert_array_equal(wrong, before)
        # In the memory of the states, too.
        shared = np.full(out.size + puma.n, 3.0)
        q = shared[: count * puma.n].reshape(count, puma.n)
        rows = shared[: out.size].reshape(out.shape)
        with pytest.raises(rv.ArrayError, match=r"of sample 0, which is zero in every state"):
            puma.regressor(q, *states[1:], out=rows, keep_zeros=True)
        assert (shared == 3).all()


def test_a_single_state_keeps_zeros_too(puma: rv.Robot) -> None:
    one, other = ([array[k] for array in random_states(puma, 2)] for k in range(2))
    expected = puma.regressor(*one)
    for out in (np.zeros((n, C)), puma.regressor(*other)):
        puma.regressor(*one, out=out, keep_zeros=True)
        np.testing.assert_array_equal(out, expected)
    wrong = np.full((n, C), 3.0)
    with pytest.raises(rv.ArrayError, match=r"^out has 3 in row \d+, column \d+ of sample 0, "):
        puma.regressor(*one, out=wrong, keep_zeros=True)
    assert (wrong == 3).all()


def test_minus_zero_is_no_zero_to_keep(puma: rv.Robot, states: States) -> None:
    with pytest.raises(rv.ArrayError, match="out has -0 in row"):
        puma.regressor(*states, out=-np.zeros((len(states[0]), n, C)), keep_zeros=True)


def test_keep_zeros_is_a_bool_and_needs_out(puma: rv.Robot, states: States) -> None:
    out = np.zeros((N, n, C))
    with pytest.raises(rv.OptionError, match="keep_zeros is 1, expected True or False"):
        puma.regressor(*states, out=out, keep_zeros=1)  # type: ignore[arg-type]
    with pytest.raises(rv.OptionError, match="keep_zeros needs out"):
        puma.regressor(*states, keep_zeros=True)


def test_the_reduced_model_takes_out_too(base: rv.BaseParameters) -> None:
    states = random_states(base.robot, N)
    out = np.empty((N, n, base.rank))
    assert base.regressor(*states, out=out) is out
    with pytest.raises(rv.ShapeError, match=r"out has shape \(5, 6, 66\), expected \(5, 6, 40\)"):
        base.regressor(*states, out=np.empty((N, n, C)))


BAD_X: dict[str, tuple[Any, type[rv.RobervalError], str]] = {
    "too short": (np.zeros(C - 1), rv.ShapeError, r"X has shape \(65,\), expected \(66,\)"),
    "matrix": (np.zeros((n, 11)), rv.ShapeError, r"X has shape \(6, 11\), expected \(66,\)"),
    "NaN": (np.full(C, np.nan), rv.ArrayError, "X has nan for XX_1"),
    "complex": (np.zeros(C, complex), rv.ArrayError, "X has dtype complex128"),
    "unknown label": ({"ZZ_9": 1.0}, rv.UnknownParameterError, "X has a value for 'ZZ_9'"),
    "text value": ({"ZZ_1": "one"}, rv.ArrayError, "X has dtype <U"),
    "infinite value": ({"ZZ_3": np.inf}, rv.ArrayError, "X has inf for ZZ_3"),
}


@pytest.mark.parametrize("name", BAD_X)
def test_wrong_parameters_are_refused(base: rv.BaseParameters, name: str) -> None:
    x, error, message = BAD_X[name]
    for call in (base.values, base.minimum_norm, base.regrouped_values):
        with pytest.raises(error, match=message):
            call(x)
    q, qd, qdd = random_states(base.robot, 1)
    with pytest.raises(error, match=message):
        base.robot.torques(q, qd, qdd, x)
