from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import roberval as rv
from roberval import checkpoints, logs, reducing

# Rounding of R over some thousand rows, relative to its largest entry (issue 5).
ACCURACY = 1e-14


@pytest.fixture(scope="module")
def puma() -> rv.Robot:
    return rv.load("puma560")


@pytest.fixture(scope="module")
def base(puma: rv.Robot) -> rv.BaseParameters:
    return puma.base_parameters()


def data(n: int, count: int, seed: int = 0) -> tuple[np.ndarray, ...]:
    return tuple(np.random.default_rng(seed).uniform(-2, 2, (4, count, n)))


def one_shot(W: np.ndarray, tau: np.ndarray) -> np.ndarray:
    R = np.asarray(np.linalg.qr(np.column_stack([W, tau]), mode="r"))
    return R * np.where(np.diag(R) < 0, -1, 1)[:, None]


def same(a: rv.ObservationQR, b: rv.ObservationQR) -> bool:
    return bool(
        np.array_equal(a.r_factor, b.r_factor)
        and np.array_equal(a.qt_tau, b.qt_tau)
        and a.residual_norm == b.residual_norm
    )


def test_r_is_numpys(base: rv.BaseParameters) -> None:
    q, qd, qdd, tau = data(6, 777)
    qr = rv.ObservationQR(base, friction=("viscous", "coulomb", "offset"))
    qr.update(q, qd, qdd, tau)
    W = base.regressor(q, qd, qdd).reshape(-1, base.rank)
    eye = np.tile(np.eye(6), (777, 1))
    kinds = [qd.reshape(-1, 1) * eye, np.sign(qd).reshape(-1, 1) * eye, eye]
    R = one_shot(np.column_stack([W, *kinds]), tau.ravel())
    assert np.abs(qr.r_factor - R[:-1, :-1]).max() <= ACCURACY * np.abs(R).max()
    assert np.abs(qr.qt_tau - R[:-1, -1]).max() <= ACCURACY * np.abs(R).max()
    assert abs(qr.residual_norm - R[-1, -1]) <= ACCURACY * np.abs(R).max()
    assert qr.columns[40:47] == (*(f"viscous_{j}" for j in rv.load("puma560").joints), "coulomb_1")
    assert qr.samples == 777


def test_solve_finds_the_parameters_and_names_what_is_not_determined(
    puma: rv.Robot, base: rv.BaseParameters
) -> None:
    q, qd, qdd, _ = data(6, 300)
    X = np.arange(66.0)
    tau = puma.torques(q, qd, qdd, X)
    qr = rv.ObservationQR(base)
    qr.update(q, qd, qdd, tau, weights=np.array([1, 2, 3, 4, 5, 6.0]))
    np.testing.assert_allclose(qr.solve(), base.values(X), rtol=1e-10, atol=1e-9)
    everything = rv.ObservationQR(puma)
    everything.update(q, qd, qdd, tau)
    with pytest.raises(rv.NumericalError, match="column XX_1 is zero"):
        everything.solve()


def test_saved_and_pickled_accumulators_go_on_with_the_same_bits(
    base: rv.BaseParameters, puma: rv.Robot, tmp_path: Path
) -> None:
    q, qd, qdd, tau = data(6, 500)
    qr = rv.ObservationQR(base, threads=2)
    qr.update(q[:123], qd[:123], qdd[:123], tau[:123])
    qr.save(tmp_path / "qr")
    resumed = [rv.ObservationQR.load(tmp_path / "qr", puma), pickle.loads(pickle.dumps(qr))]
    for each in (qr, *resumed):
        each.update(q[123:], qd[123:], qdd[123:], tau[123:])
    assert same(qr, resumed[0])
    assert same(qr, resumed[1])
    assert [file.name for file in tmp_path.iterdir()] == ["qr"]
    damaged = bytearray((tmp_path / "qr").read_bytes())
    damaged[1000] ^= 4
    (tmp_path / "qr").write_bytes(damaged)
    with pytest.raises(rv.CheckpointError, match="damaged"):
        rv.ObservationQR.load(tmp_path / "qr", puma)


def test_bad_samples_are_named(base: rv.BaseParameters) -> None:
    q, qd, qdd, tau = data(6, 50)
    qr = rv.ObservationQR(base)
    tau[17, 3] = np.nan
    with pytest.raises(rv.ArrayError, match=r"tau\[17, 3\]"):
        qr.update(q, qd, qdd, tau)
    with pytest.raises(rv.ShapeError, match="tau"):
        qr.update(q, qd, qdd, tau[:, :5])
    with pytest.raises(rv.OptionError, match="friction"):
        rv.ObservationQR(base, friction=("viscose",))
    with pytest.raises(rv.UnknownParameterError, match="XX_9"):
        rv.ObservationQR(base, columns=("XX_9",))
    assert qr.samples == 0


ROBOTS = ("four_bar", "hitachi_hpr", "floating")


def any_robot(name: str) -> rv.Robot:
    if name != "floating":
        return rv.load(name)
    return rv.Robot.from_urdf(
        """<robot name="two"><link name="body"><inertial><mass value="2"/>
        <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
        <link name="arm"><inertial><mass value="1"/><origin xyz="0.1 0.2 0.3"/>
        <inertia ixx="1" iyy="2" izz="3" ixy="0" ixz="0" iyz="0"/></inertial></link>
        <joint name="shoulder" type="revolute"><parent link="body"/><child link="arm"/>
        <axis xyz="0 1 0"/><origin xyz="0.2 0 0.1" rpy="0.3 0 0"/>
        <limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>""",
        floating=True,
    )


def states_of(robot: rv.Robot, count: int) -> tuple[np.ndarray, ...]:
    random = np.random.default_rng(3)
    q, qd, qdd = (random.uniform(-1, 1, (count, k)) for k in (robot.nq, robot.n, robot.n))
    if robot.is_floating:
        q[:, 3:7] /= np.linalg.norm(q[:, 3:7], axis=1)[:, None]
    return q, qd, qdd


@pytest.mark.parametrize("name", ROBOTS)
def test_loops_couples_and_floating_bases_reduce_too(name: str) -> None:
    robot = any_robot(name)
    base = robot.base_parameters()
    q, qd, qdd = states_of(robot, 500)
    tau = np.random.default_rng(4).uniform(-1, 1, (500, robot.n))
    qr = rv.ObservationQR(base, friction=("viscous",))
    for cut in np.array_split(np.arange(500), 7):
        qr.update(q[cut], qd[cut], qdd[cut], tau[cut])
    joints = len(robot.joints)
    rubbing = np.zeros((500, robot.n, joints))
    for j in range(joints):
        row = robot.n - joints + j
        rubbing[:, row, j] = qd[:, row]
    W = np.concatenate([base.regressor(q, qd, qdd), rubbing], axis=2)
    R = one_shot(W.reshape(-1, base.rank + joints), tau.ravel())
    assert np.abs(qr.r_factor - R[:-1, :-1]).max() <= ACCURACY * np.abs(R).max()
    assert len(qr.columns) == base.rank + joints
    if name == "four_bar":
        q[3] = np.nan
    elif name == "floating":
        q[3, 3:7] = 0
    else:
        return
    with pytest.raises(rv.ArrayError, match=r"q\[3, "):
        qr.update(q, qd, qdd, tau)
    assert qr.samples == 500


@pytest.mark.parametrize("name", [*ROBOTS, "puma560"])
@pytest.mark.parametrize("model", ["d", "d0", "h"])
def test_packed_tiles_and_threads_give_the_rows_bit_by_bit(
    name: str, model: rv.options.Model
) -> None:
    robot = any_robot(name)
    count = 9000 if name == "puma560" else 3000
    q, qd, qdd = states_of(robot, count)
    rows = robot.regressor(q, qd, qdd, model, threads=1)
    assert np.array_equal(rows, robot.regressor(q, qd, qdd, model, threads=3))
    packed = robot.packed(q, qd, qdd, model, threads=2)
    tiles, _, lanes = packed.shape
    flat = np.zeros((tiles * lanes, robot.n if model != "h" else 1, rows.shape[-1]))
    entries = robot.packed_entries(model)
    flat[:, entries[:, 0], entries[:, 1]] = packed.transpose(0, 2, 1).reshape(tiles * lanes, -1)
    assert np.array_equal(flat[:count].reshape(rows.shape), rows)
    if model == "d":
        X = np.arange(1.0, rows.shape[-1] + 1)
        tau = robot.torques(q, qd, qdd, X, threads=3)
        assert np.array_equal(tau, robot.torques(q, qd, qdd, X, threads=1))
        assert np.abs(tau - rows @ X).max() <= 1e-13 * np.abs(rows * X).sum(axis=-1).max()
    q[count - 2, -1] = np.inf
    with pytest.raises(rv.ArrayError, match=rf"q\[{count - 2}, "):
        robot.regressor(q, qd, qdd, model, threads=3)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
def test_a_child_forked_after_threads_ran_computes_the_same(base: rv.BaseParameters) -> None:
    q, qd, qdd, tau = data(6, 80_000)
    qr = rv.ObservationQR(base, threads=2)
    qr.update(q, qd, qdd, tau)
    W = base.regressor(q, qd, qdd, threads=2)
    child = os.fork()
    if child == 0:
        again = rv.ObservationQR(base, threads=2)
        again.update(q, qd, qdd, tau)
        equal = same(qr, again) and np.array_equal(W, base.regressor(q, qd, qdd, threads=2))
        os._exit(0 if equal else 1)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGKILL")
def test_a_killed_reduction_goes_on_with_the_same_bits(tmp_path: Path) -> None:
    q, qd, qdd, tau = data(6, 400_000)
    samples, checkpoint = tmp_path / "s.npz", tmp_path / "progress"
    np.savez(samples, q=q, qd=qd, qdd=qdd, tau=tau)

    def command(target: str, *more: str) -> list[str]:
        files = [str(samples)] * 3
        run = [sys.executable, "-m", "roberval", "reduce", "puma560", *files, "--quiet"]
        return [*run, "-o", str(tmp_path / target), *more]

    subprocess.run(command("whole.npz"), check=True)
    kills = 0
    while kills < 3:
        before = checkpoint.stat().st_mtime_ns if checkpoint.exists() else 0
        with subprocess.Popen(command("R.npz", "--checkpoint", str(checkpoint))) as process:
            while process.poll() is None:
                if checkpoint.exists() and checkpoint.stat().st_mtime_ns != before:
                    process.send_signal(signal.SIGKILL)
                    break
                time.sleep(0.001)
        kills += 1
    # Whatever was left, even a half-written successor of the checkpoint.
    (tmp_path / ".roberval-1-half.tmp").write_bytes(b"half")
    os.utime(tmp_path / ".roberval-1-half.tmp", (0, 0))
    subprocess.run(command("R.npz", "--checkpoint", str(checkpoint)), check=True)
    with np.load(tmp_path / "whole.npz") as whole, np.load(tmp_path / "R.npz") as resumed:
        assert resumed["samples"] == 1_200_000
        for name in whole.files:
            assert np.array_equal(whole[name], resumed[name])
    assert not (tmp_path / ".roberval-1-half.tmp").exists()


def write(folder: Path, samples: tuple[np.ndarray, ...]) -> list[Path]:
    """Write the same samples as CSV, NPZ and Parquet."""
    names = [f"{array}_{j}" for array in logs.ARRAYS for j in range(1, 7)]
    table = np.column_stack(samples)
    text = "\n".join(",".join(map(repr, row)) for row in table.tolist())
    (folder / "samples.csv").write_text(",".join(names) + "\n" + text + "\n")
    q, qd, qdd, tau = samples
    np.savez(folder / "samples.npz", q=q, qd=qd, qdd=qdd, tau=tau)
    paths = [folder / "samples.csv", folder / "samples.npz"]
    parquet = pytest.importorskip("pyarrow.parquet")
    import pyarrow

    columns = dict(zip(names, table.T, strict=True))
    parquet.write_table(pyarrow.table(columns), folder / "samples.parquet")
    return [*paths, folder / "samples.parquet"]


def test_files_of_every_form_give_the_same_bits(
    base: rv.BaseParameters, puma: rv.Robot, tmp_path: Path
) -> None:
    samples = data(6, 200)
    expected = rv.ObservationQR(puma)
    for _ in range(2):
        expected.update(*samples)
    for path in write(tmp_path, samples):
        target = tmp_path / f"{path.suffix[1:]}-R.npz"
        arguments = ["puma560", str(path), str(path), "-o", str(target), "--quiet"]
        assert reducing.command(arguments) == 0
        with np.load(target) as written:
            assert np.array_equal(written["R"], expected.r_factor)
            assert written["samples"] == 400
            assert tuple(written["columns"]) == expected.columns


def test_the_command_says_what_is_wrong(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    bad = tmp_path / "bad.csv"
    names = ",".join(f"{array}_{j}" for array in logs.ARRAYS for j in range(1, 7))
    bad.write_text(names + "\n" + ",".join(["1"] * 24) + "\n" + ",".join(["1"] * 23) + ",x\n")
    out = tmp_path / "R.npz"
    assert reducing.command(["puma560", str(bad), "-o", str(out)]) == 2
    assert 'bad.csv:3: column tau_6: "x" is not a number' in capsys.readouterr().err
    bad.write_text("q_1\n1\n")
    assert reducing.command(["puma560", str(bad), "-o", str(out)]) == 2
    assert "there is no q_2, q_3" in capsys.readouterr().err
    assert not out.exists()


def test_parquet_columns_may_be_of_any_kind_of_number(
    puma: rv.Robot, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    import pyarrow

    samples = [np.round(4 * array) for array in data(6, 20_000)]
    expected = rv.ObservationQR(puma)
    expected.update(*samples)
    names = [f"{array}_{j}" for array in logs.ARRAYS for j in range(1, 7)]
    columns = [pyarrow.array(column) for array in samples for column in array.T]
    kinds = [pyarrow.int8(), pyarrow.float32(), pyarrow.float64(), pyarrow.int64()]
    columns = [column.cast(kinds[k % 4]) for k, column in enumerate(columns)]
    path, out = tmp_path / "samples.parquet", tmp_path / "R.npz"

    def reduced() -> int:
        parquet.write_table(pyarrow.table(columns, names), path, row_group_size=7000)
        return reducing.command(["puma560", str(path), "-o", str(out), "--quiet"])

    assert reduced() == 0
    with np.load(out) as written:
        assert np.array_equal(written["R"], expected.r_factor)
    holes = columns[3].to_pylist()
    holes[12_345] = None
    columns[3] = pyarrow.array(holes)
    assert reduced() == 2
    assert "q[12345, 3] is NaN" in capsys.readouterr().err
    columns[3] = pyarrow.array(["much"] * 20_000)
    assert reduced() == 2
    assert "column q_4 has string, not numbers" in capsys.readouterr().err


def test_parquet_is_read_without_pandas_which_forgets_ctrl_c(tmp_path: Path) -> None:
    pytest.importorskip("pyarrow")
    path = write(tmp_path, data(6, 10))[2]
    script = f"""
import sys
from roberval import checkpoints, logs, reducing
assert reducing.command(["puma560", {str(path)!r}, "-o", {str(tmp_path / "R.npz")!r}]) == 0
assert "pandas" not in sys.modules
"""
    subprocess.run([sys.executable, "-c", script], check=True)


def test_dask_gives_the_same_bits_for_any_number_of_workers(puma: rv.Robot, tmp_path: Path) -> None:
    frames = pytest.importorskip("dask.dataframe")
    distributed = pytest.importorskip("distributed")
    path = write(tmp_path, data(6, 400))[2]
    import pandas as pd

    whole = pd.read_parquet(path)
    dataset = frames.from_pandas(whole, npartitions=5)
    base = puma.base_parameters()
    local = rv.reduce_dataset(dataset, base, friction=("viscous",))
    assert local.samples == 400
    cluster = distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address=":0", silence_logs=50
    )
    with cluster, distributed.Client(cluster):
        assert same(rv.reduce_dataset(dataset, base, friction=("viscous",)), local)
    together = rv.ObservationQR(base, friction=("viscous",))
    table = whole.to_numpy()
    together.update(*(np.ascontiguousarray(table[:, 6 * k : 6 * k + 6]) for k in range(4)))
    R = together.r_factor
    assert np.abs(local.r_factor - R).max() <= ACCURACY * np.abs(R).max()


def test_ctrl_c_is_answered_and_nothing_taken_in() -> None:
    script = """
import os, signal, threading, time
import numpy as np
import roberval as rv
robot = rv.load("puma560")
qr = rv.ObservationQR(robot, threads=1)
samples = np.ones((4, 1_500_000, 6))
sent = []
def interrupt():
    time.sleep(0.15)
    sent.append(time.monotonic())
    os.kill(os.getpid(), signal.SIGINT)
for attempt in range(2):
    thread = threading.Thread(target=interrupt)
    thread.start()
    try:
        while True:
            qr.update(*samples)
            before = qr.samples
    except KeyboardInterrupt:
        print(time.monotonic() - sent[-1], qr.samples % 1_500_000)
    thread.join()
"""
    run = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, timeout=300, check=False
    )
    assert run.returncode == 0, run.stderr
    for line in run.stdout.splitlines():
        assert line.split()[1] == "0"


def reduced(*arguments: object) -> int:
    return reducing.command(["puma560", *map(str, arguments), "--base", "--quiet"])


def arrays_of(samples: tuple[np.ndarray, ...]) -> dict[str, Any]:
    return dict(zip(logs.ARRAYS, samples, strict=True))


def test_a_checkpoint_of_other_files_is_refused_and_kept(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    first, other = tmp_path / "s.npz", tmp_path / "t.npz"
    np.savez(first, **arrays_of(data(6, 300)))
    np.savez(other, **arrays_of(data(6, 150)))
    out, checkpoint = tmp_path / "x.npz", tmp_path / "c"
    assert reduced(first, first, "-o", out, "--checkpoint", checkpoint) == 0
    kept = checkpoint.read_bytes()
    out.unlink()
    for files, words in (
        ([other], "number 1 was s.npz of"),
        ([first], "number 2 was s.npz of"),
        ([first, other], "and is t.npz of"),
    ):
        capsys.readouterr()
        assert reduced(*files, "-o", out, "--checkpoint", checkpoint) == 2
        said = capsys.readouterr().err
        assert str(checkpoint) in said
        assert words in said
        assert checkpoint.read_bytes() == kept
        assert not out.exists()


def test_more_files_after_those_of_a_checkpoint_go_on_with_the_same_bits(
    tmp_path: Path, base: rv.BaseParameters
) -> None:
    files = [tmp_path / f"{k}.npz" for k in range(2)]
    for seed, file in enumerate(files):
        np.savez(file, **arrays_of(data(6, 300, seed)))
    out, checkpoint = tmp_path / "x.npz", tmp_path / "c"
    assert reduced(files[0], "-o", out, "--checkpoint", checkpoint) == 0
    assert rv.ObservationQR.load(checkpoint, base).samples == 300
    assert reduced(*files, "-o", out, "--checkpoint", checkpoint) == 0
    whole = tmp_path / "whole.npz"
    assert reduced(*files, "-o", whole) == 0
    with np.load(out) as a, np.load(whole) as b:
        assert a["samples"] == 600
        assert np.array_equal(a["R"], b["R"])


def test_a_checkpoint_with_more_samples_than_the_files_is_refused_and_kept(
    tmp_path: Path, base: rv.BaseParameters, capsys: pytest.CaptureFixture[str]
) -> None:
    file, out, checkpoint = tmp_path / "s.npz", tmp_path / "x.npz", tmp_path / "c"
    np.savez(file, **arrays_of(data(6, 100)))
    qr = rv.ObservationQR(base)
    qr.update(*data(6, 250))
    qr.save(checkpoint)
    assert reduced(file, "-o", out, "--checkpoint", checkpoint) == 2
    assert "was saved by ObservationQR.save, which does not know" in capsys.readouterr().err
    qr._save_with_inputs(checkpoint, [checkpoints.identity(file, "None False")])
    kept = checkpoint.read_bytes()
    assert reduced(file, "-o", out, "--checkpoint", checkpoint) == 2
    assert "c has 250 samples and the files have 100" in capsys.readouterr().err
    assert checkpoint.read_bytes() == kept
    assert not out.exists()


def test_a_checkpoint_that_is_none_is_named(tmp_path: Path, puma: rv.Robot) -> None:
    path = tmp_path / "c"
    path.write_bytes(b"text")
    with pytest.raises(rv.CheckpointError, match=r"c: this is not a checkpoint of roberval"):
        rv.ObservationQR.load(path, puma)
    for old in (b"RBVLIN\x001", b"RBVLQR\x002"):
        path.write_bytes(old + bytes(100))
        with pytest.raises(rv.CheckpointError, match=r"c: this checkpoint is of another version"):
            rv.ObservationQR.load(path, puma)


def test_a_flip_of_any_bit_of_a_checkpoint_is_found(
    base: rv.BaseParameters, tmp_path: Path
) -> None:
    file, path = tmp_path / "s.npz", tmp_path / "c"
    np.savez(file, **arrays_of(data(6, 100)))
    assert reduced(file, "-o", tmp_path / "R.npz", "--checkpoint", path) == 0
    whole = path.read_bytes()
    assert b"s.npz" in whole
    for bit in (*range(8 * 200), *range(8 * 200, 8 * len(whole), 5003)):
        damaged = bytearray(whole)
        damaged[bit // 8] ^= 1 << bit % 8
        path.write_bytes(damaged)
        with pytest.raises(rv.CheckpointError):
            rv.ObservationQR.load(path, base)


def test_merge_refuses_another_robot_itself_and_what_is_no_accumulator(puma: rv.Robot) -> None:
    qr = rv.ObservationQR(puma, columns=["ZZ_1", "MX_2"])
    with pytest.raises(rv.OptionError, match="different robots: PUMA 560 and "):
        qr.merge(rv.ObservationQR(rv.load("ur5"), columns=qr.columns))
    with pytest.raises(rv.OptionError, match="with itself"):
        qr.merge(qr)
    with pytest.raises(rv.OptionError, match="different columns: MX_2 is in one only"):
        qr.merge(rv.ObservationQR(puma, columns=["ZZ_1"]))
    with pytest.raises(TypeError, match=r"takes an ObservationQR, not 3 \(int\)"):
        qr.merge(3)  # type: ignore[arg-type]
    again = rv.ObservationQR(rv.load("puma560"), columns=qr.columns)
    again.update(*data(6, 10))
    qr.merge(again)
    assert qr.samples == 10


def test_wrong_models_and_columns_are_told_what_would_be_right(puma: rv.Robot) -> None:
    with pytest.raises(TypeError, match=r"'puma560' \(str\), expected a Robot"):
        rv.ObservationQR("puma560")  # type: ignore[arg-type]
    assert rv.ObservationQR(puma, columns="ZZ_1").columns == ("ZZ_1",)
    with pytest.raises(rv.OptionError, match="columns has ZZ_1 twice"):
        rv.ObservationQR(puma, columns=["ZZ_1", "ZZ_1"])
    for wrong in (3, [3]):
        with pytest.raises(rv.OptionError, match=r"columns (is|has) 3 \(int\), expected"):
            rv.ObservationQR(puma, columns=wrong)  # type: ignore[arg-type]


@pytest.mark.parametrize("model", ["d0", "h"])
def test_base_parameters_of_other_models_are_refused(
    puma: rv.Robot, model: rv.options.Model
) -> None:
    with pytest.raises(rv.OptionError, match=rf"model {model}, and torques are rows of model d"):
        rv.ObservationQR(puma.base_parameters(model))


def test_solve_without_samples_says_so(base: rv.BaseParameters) -> None:
    with pytest.raises(rv.NumericalError, match="there are no samples yet"):
        rv.ObservationQR(base).solve()


@pytest.mark.parametrize("form", ["npz", "parquet"])
@pytest.mark.parametrize("part", [0.1, 0.5, 0.99])
def test_half_written_files_are_named(
    form: str, part: float, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = next(path for path in write(tmp_path, data(6, 500)) if path.suffix == f".{form}")
    whole = path.read_bytes()
    path.write_bytes(whole[: int(part * len(whole))])
    assert reduced(path, "-o", tmp_path / "R.npz") == 2
    said = capsys.readouterr().err
    assert said.startswith(f"roberval: error: {path}: this ")
    assert not (tmp_path / "R.npz").exists()


@pytest.mark.parametrize("form", ["npz", "parquet"])
def test_files_with_damage_in_the_middle_are_named(
    form: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = next(path for path in write(tmp_path, data(6, 500)) if path.suffix == f".{form}")
    damaged = bytearray(path.read_bytes())
    damaged[: len(damaged) // 2] = bytes(len(damaged) // 2)
    path.write_bytes(damaged)
    assert reduced(path, "-o", tmp_path / "R.npz") == 2
    assert f"roberval: error: {path}: " in capsys.readouterr().err


def test_a_csv_that_is_no_text_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "s.csv"
    path.write_bytes(b"q_1,\xff\xfe\n")
    assert reduced(path, "-o", tmp_path / "R.npz") == 2
    assert f"{path}:1: the text is not UTF-8" in capsys.readouterr().err


def test_npz_arrays_may_be_of_any_real_type_and_order(
    puma: rv.Robot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(logs, "PIECE", 128)
    q, qd, qdd, tau = (np.round(4 * array) for array in data(6, 500))
    stored: dict[str, Any] = {
        "q": q.astype(np.float32),
        "qd": np.asfortranarray(qd),
        "qdd": np.asfortranarray(qdd.astype(">i2")),
        "tau": tau.astype(np.int64),
    }
    expected = rv.ObservationQR(puma)
    expected.update(q, qd, qdd, tau)
    path, out = tmp_path / "s.npz", tmp_path / "R.npz"
    for save in (np.savez, np.savez_compressed):
        save(path, **stored)
        assert reducing.command(["puma560", str(path), "-o", str(out), "--quiet"]) == 0
        with np.load(out) as written:
            assert np.array_equal(written["R"], expected.r_factor)
            assert written["samples"] == 500


def test_npz_arrays_of_no_numbers_are_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "s.npz"
    np.savez(path, **arrays_of(data(6, 10)) | {"qd": np.ones((10, 6), complex)})
    assert reduced(path, "-o", tmp_path / "R.npz") == 2
    assert f"{path}: qd has dtype complex128, expected real" in capsys.readouterr().err


def test_a_place_that_cannot_be_written_is_named_before_the_work(
    base: rv.BaseParameters, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    samples, nowhere = tmp_path / "s.csv", tmp_path / "no" / "x.npz"
    samples.write_text("unread")
    for arguments, named in (
        (["-o", nowhere], nowhere),
        (["-o", tmp_path], tmp_path),
        (["-o", samples / "x.npz"], samples / "x.npz"),
        (["-o", tmp_path / "x.npz", "--checkpoint", nowhere], nowhere),
    ):
        assert reduced(samples, *arguments) == 2
        assert repr(str(named)) in capsys.readouterr().err
    qr = rv.ObservationQR(base)
    for save in (qr.save, qr.save_factor):
        with pytest.raises(FileNotFoundError) as told:
            save(nowhere)
        assert told.value.filename == str(nowhere)


def test_the_command_reads_the_robot_as_asked(tmp_path: Path) -> None:
    moon = rv.load("puma560", floating=True, rotors=False, gravity=(0, 0, -1.62))
    q, qd, qdd = states_of(moon, 300)
    tau = moon.torques(q, qd, qdd, np.ones(len(moon.parameters)))
    file, out = tmp_path / "states.npz", tmp_path / "R.npz"
    np.savez(file, **arrays_of((q, qd, qdd, tau)))
    options = ("--floating", "--no-rotors", "--gravity=0,0,-1.62")
    assert reduced(file, "-o", out, *options) == 0
    qr = rv.ObservationQR(moon.base_parameters())
    qr.update(q, qd, qdd, tau)
    np.testing.assert_array_equal(np.load(out)["R"], qr.r_factor)
    assert reduced(file, "-o", out, "--gravity=0,0") == 2
