"""`roberval reduce`: what it reads, refuses, and keeps."""

from __future__ import annotations

import io
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import roberval as rv
from roberval import checkpoints, logs, progress, reducing

NAMES = [f"{array}_{j}" for array in logs.ARRAYS for j in range(1, 7)]


def samples(count: int = 50, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).uniform(-2, 2, (count, 24))


def lines(rows: np.ndarray, names: list[str] = NAMES) -> list[str]:
    return [",".join(names), *(",".join(map(repr, row)) for row in rows.tolist())]


def text(folder: Path, rows: list[str], name: str = "log.csv") -> Path:
    path = folder / name
    path.write_text("\n".join(rows) + "\n")
    return path


def npz(path: Path, rows: np.ndarray, **more: Any) -> Path:
    arrays = {name: rows[:, 6 * k : 6 * k + 6] for k, name in enumerate(logs.ARRAYS)}
    np.savez(path, **(arrays | more))
    return path


def parquet(path: Path, rows: np.ndarray, names: list[str] = NAMES) -> Path:
    written = pytest.importorskip("pyarrow.parquet")
    import pyarrow

    written.write_table(pyarrow.table([pyarrow.array(c) for c in rows.T], names=names), path)
    return path


def reduced(*arguments: object, robot: str = "puma560") -> int:
    return reducing.command([robot, *map(str, arguments), "--quiet"])


def factor(path: Path) -> np.ndarray:
    with np.load(path) as written:
        return np.asarray(written["R"])


def expected(rows: np.ndarray, weights: np.ndarray | None = None) -> np.ndarray:
    qr = rv.ObservationQR(rv.load("puma560"))
    q, qd, qdd, tau = np.split(rows, 4, axis=1)
    qr.update(q, qd, qdd, tau, weights)
    return qr.r_factor


@pytest.mark.parametrize("form", ["csv", "parquet"])
def test_numbers_that_are_names_of_other_joints_are_refused(
    form: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    names = [f"{array}_{j}" for array in logs.ARRAYS for j in range(1, 6)]
    rows = samples()[:, :20]
    if form == "csv":
        path = text(tmp_path, lines(rows, names))
    else:
        path = parquet(tmp_path / "log.parquet", rows, names)
    out = tmp_path / "R.npz"
    assert reduced(path, "-o", out, robot="hitachi_hpr") == 2
    assert "columns 2 (q_2) and 3 (q_3) both give q of joint 2" in capsys.readouterr().err
    assert not out.exists()


@pytest.mark.parametrize("robot", [entry.name for entry in rv.catalogue()])
def test_titles_of_a_robots_own_joints_are_its_columns_in_order(robot: str) -> None:
    model = rv.load(robot)
    coordinates = (model.positions, model.velocities, model.velocities, model.rows)
    of = zip(logs.ARRAYS, coordinates, strict=True)
    titles = [[f"{array}_{name}" for name in names] for array, names in of]
    mixed = sum(reversed(titles), ["time"])
    from roberval.logs.columns import columns

    found, note = columns(model, mixed, "log", weights=False)
    assert found == titles
    assert note == "columns that are not used: time"


def test_csv_is_read_by_the_rules_of_regressor(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rows = samples()
    plain, out = lines(rows), tmp_path / "R.npz"
    for good in (
        [*plain, "", ""],
        [*plain[:20], "", *plain[20:]],
        ["mode," + plain[0], *("auto," + line for line in plain[1:])],
        ["\ufeff" + plain[0], *plain[1:]],
    ):
        assert reduced(text(tmp_path, good), "-o", out) == 0
        assert np.array_equal(factor(out), expected(rows))
    out.unlink()
    bad = [plain[30].split(",") for _ in range(4)]
    for words, word in zip(bad, ("nan", "1_0", "\u0663", ""), strict=True):
        words[3] = word
    for faulty, said in (
        ([*plain[:30], ",".join(bad[0]), *plain[31:]], ":31: column q_4: "),
        ([*plain[:30], "", ",".join(bad[1])], ':32: column q_4: "1_0" is not a number'),
        ([*plain[:30], ",".join(bad[2])], ":31: column q_4: "),
        ([*plain[:30], ",".join(bad[3])], ':31: column q_4: "" is not a number'),
        (plain[:1], "there is a header line but no state below it"),
        ([line.replace(",", ";") for line in plain], "columns must be separated by commas"),
        (plain[1:], "the first line must name the columns"),
        ([plain[0].replace("q_2", "q_1", 1), *plain[1:]], "columns 1 (q_1) and 2 (q_1) both give"),
    ):
        good_one = npz(tmp_path / "first.npz", rows)
        assert reduced(good_one, text(tmp_path, faulty), "-o", out) == 2
        assert f"{tmp_path / 'log.csv'}" in (told := capsys.readouterr().err)
        assert said in told
        assert not out.exists()


ROOT_OF_Q = """
[[link]]
name = "crank"
alpha = 0
d = 0
theta = 0
r = 0
[[link]]
name = "follower"
antecedent = "crank"
alpha = "90 deg"
d = 0.1
theta = 0
r = 0
[[couple]]
joint = "follower"
expression = "sqrt(q.crank)"
"""


def test_states_without_a_value_are_counted_within_their_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(logs, "PIECE", 16)
    robot = tmp_path / "follower.toml"
    robot.write_text(ROOT_OF_Q)
    q = np.linspace(1, 2, 40)[:, None]
    q[33] = -1
    log = tmp_path / "log.npz"
    np.savez(log, q=q, qd=q, qdd=q, tau=q)
    assert reduced(log, "-o", tmp_path / "R.npz", robot=str(robot)) == 2
    assert f"{log}: sample 33: " in capsys.readouterr().err


@pytest.mark.parametrize("form", ["npz", "parquet"])
def test_rows_are_counted_within_their_file(
    form: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(logs, "PIECE", 16)
    write = npz if form == "npz" else parquet
    first, rows = write(tmp_path / f"a.{form}", samples()), samples()
    rows[33, 3] = np.inf
    second = write(tmp_path / f"b.{form}", rows)
    assert reduced(first, second, "-o", tmp_path / "R.npz") == 2
    assert f"{second}: q[33, 3] is inf" in capsys.readouterr().err


@pytest.mark.parametrize("form", ["npz", "parquet"])
def test_files_without_samples_are_refused(
    form: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = (npz if form == "npz" else parquet)(tmp_path / f"a.{form}", samples(0))
    assert reduced(path, "-o", tmp_path / "R.npz") == 2
    assert f"{path}: there are no samples in it" in capsys.readouterr().err


def test_parquet_columns_are_there_once_and_numbers(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, out = tmp_path / "log.parquet", tmp_path / "R.npz"
    parquet(path, np.column_stack([samples(), np.ones(50)]), [*NAMES, "q_1"])
    assert reduced(path, "-o", out) == 2
    assert "columns 1 (q_1) and 25 (q_1) both give q of joint 1" in capsys.readouterr().err
    import pyarrow
    from pyarrow.parquet import write_table

    for wrong in ([True] * 50, ["1.5"] * 50):
        columns = [pyarrow.array(column) for column in samples().T]
        columns[5] = pyarrow.array(wrong)
        write_table(pyarrow.table(columns, names=NAMES), path)
        assert reduced(path, "-o", out) == 2
        assert f"{path}: column q_6 has " in capsys.readouterr().err


def test_a_checkpoint_of_another_file_of_the_same_name_and_size_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    # Beyond what is digested whole, too.
    for count in (50, 10_000):
        files = []
        for seed, folder in enumerate(("a", "b")):
            (tmp_path / folder).mkdir(exist_ok=True)
            files.append(npz(tmp_path / folder / "log.npz", samples(count, seed)))
        out, checkpoint = tmp_path / "R.npz", tmp_path / f"c{count}"
        assert reduced(files[0], "-o", out, "--checkpoint", checkpoint) == 0
        kept = factor(out)
        assert reduced(files[0], "-o", out, "--checkpoint", checkpoint) == 0
        assert np.array_equal(factor(out), kept)
        assert reduced(files[1], "-o", out, "--checkpoint", checkpoint) == 2
        assert "of the same name and size with other content" in capsys.readouterr().err
        arguments = (files[0], "-o", out, "--checkpoint", checkpoint, "--weights", "1,1,1,1,1,2")
        assert reduced(*arguments) == 2
        assert "or --weights" in capsys.readouterr().err


def test_a_checkpoint_of_an_earlier_version_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, checkpoint = npz(tmp_path / "log.npz", samples()), tmp_path / "c"
    qr = rv.ObservationQR(rv.load("puma560"))
    qr._save_with_inputs(checkpoint, [("log.npz", path.stat().st_size)])
    assert reduced(path, "-o", tmp_path / "R.npz", "--checkpoint", checkpoint) == 2
    assert "c is of an earlier version" in capsys.readouterr().err


def test_outputs_that_would_replace_what_is_read_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log, link = npz(tmp_path / "log.npz", samples()), tmp_path / "link.npz"
    link.symlink_to(log)
    robot = tmp_path / "arm.toml"
    robot.write_text(rv.load("puma560").to_toml())
    out, kept = tmp_path / "R.npz", log.read_bytes()
    for arguments, said in (
        (("-o", log), "which is read"),
        (("-o", link), "which is read"),
        (("-o", robot), "which is read"),
        (("-o", out, "--checkpoint", log), "which is read"),
        (("-o", out, "--checkpoint", out), "is the checkpoint, too"),
    ):
        assert reduced(log, *arguments, robot=str(robot)) == 2
        assert said in capsys.readouterr().err
        assert log.read_bytes() == kept
        assert not out.exists()


def test_a_dash_is_the_standard_output(tmp_path: Path) -> None:
    log = npz(tmp_path / "log.npz", samples())
    command = [sys.executable, "-m", "roberval", "reduce", "puma560", str(log), "-o", "-"]
    done = subprocess.run(command, capture_output=True, check=True, cwd=tmp_path)
    with np.load(io.BytesIO(done.stdout)) as written:
        assert np.array_equal(written["R"], expected(samples()))
    assert [path.name for path in tmp_path.iterdir()] == ["log.npz"]


@pytest.mark.skipif(sys.platform == "win32", reason="no file locks")
def test_one_process_at_a_time_has_a_checkpoint(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log, checkpoint = npz(tmp_path / "log.npz", samples()), tmp_path / "c"
    arguments = (log, "-o", tmp_path / "R.npz", "--checkpoint", checkpoint)
    script = f"""
import time
from pathlib import Path
from roberval.checkpoints import alone
with alone(Path({str(checkpoint)!r})):
    print("held", flush=True)
    time.sleep(60)
"""
    holder = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE)
    with holder:
        assert holder.stdout is not None
        assert holder.stdout.readline() == b"held\n"
        assert reduced(*arguments) == 2
        assert f"c is in use by process {holder.pid}" in capsys.readouterr().err
        holder.kill()
    assert reduced(*arguments) == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["R.npz", "c", "log.npz"]


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes with names")
def test_pipes_are_read_as_csv_and_refused_elsewhere(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out, log = tmp_path / "R.npz", npz(tmp_path / "log.npz", samples())
    for name in ("c", "pipe.npz", "pipe.csv"):
        os.mkfifo(tmp_path / name)
    assert reduced(log, "-o", out, "--checkpoint", tmp_path / "c") == 2
    assert "c: this is no regular file" in capsys.readouterr().err
    assert reduced(tmp_path / "pipe.npz", "-o", out) == 2
    assert "pipe.npz: NPZ is read from its end on" in capsys.readouterr().err
    assert reduced(tmp_path / "pipe.csv", "-o", out, "--checkpoint", tmp_path / "d") == 2
    assert "pipe.csv: a checkpoint is of regular files" in capsys.readouterr().err
    source = text(tmp_path, lines(samples()))
    with subprocess.Popen(["sh", "-c", f"cat '{source}' > '{tmp_path / 'pipe.csv'}'"]):
        assert reduced(tmp_path / "pipe.csv", "-o", out) == 0
    assert np.array_equal(factor(out), expected(samples()))


def test_weights_are_numbers_or_columns_of_the_logs(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rows, out = samples(), tmp_path / "R.npz"
    log = npz(tmp_path / "log.npz", rows)
    assert reduced(log, "-o", out, "--weights", "1,2,3,4,5,6") == 0
    assert np.array_equal(factor(out), expected(rows, np.array([1.0, 2, 3, 4, 5, 6])))
    w = np.random.default_rng(1).uniform(0.5, 2, (50, 6))
    names = [*NAMES, *(f"w_{j}" for j in range(1, 7))]
    table = np.column_stack([rows, w])
    for path in (
        text(tmp_path, lines(table, names)),
        npz(tmp_path / "w.npz", rows, w=w),
        parquet(tmp_path / "w.parquet", table, names),
    ):
        assert reduced(path, "-o", out, "--weights", "columns") == 0
        assert np.array_equal(factor(out), expected(rows, w))
        assert reduced(path, "-o", out) == 0
        assert "not used: w" in capsys.readouterr().err
        assert np.array_equal(factor(out), expected(rows))
    assert reduced(log, "-o", out, "--weights", "columns") == 2
    assert "there is no array w" in capsys.readouterr().err
    assert reduced(log, "-o", out, "--weights", "1,2") == 2
    assert "--weights has shape (2,), expected (6,)" in capsys.readouterr().err


def test_options_are_read_as_by_other_commands(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    log, out = npz(tmp_path / "log.npz", samples()), tmp_path / "R.npz"
    assert reduced("--friction", "viscous,coulomb", log, "-o", out) == 0
    assert factor(out).shape == (78, 78)
    capfd.readouterr()
    assert reduced(log, "-o", out, "--gravity", "0,0") == 2
    assert "2 numbers, expected three such as 0,0,-9.81" in capfd.readouterr().err
    assert reduced(log, "-o", out, "--friction", "viscous", "coulomb") == 2
    assert "kinds of friction have commas between them" in capfd.readouterr().err
    assert reduced("--help") == 0
    assert "Usage: roberval reduce" in capfd.readouterr().out


def test_warnings_of_the_robot_are_said_as_by_other_commands(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    robot = tmp_path / "arm.urdf"
    robot.write_text(
        "<robot name='arm'><link name='b'/><link name='a'/>"
        "<joint name='j' type='continuous'><parent link='b'/><child link='a'/>"
        "<origin xyz='0, 0, 1'/></joint></robot>"
    )
    log = text(tmp_path, ["q_1,qd_1,qdd_1,tau_1", "1,2,3,4"])
    with pytest.warns(rv.RobotWarning) as expected:
        rv.load(robot)
    assert reduced(log, "-o", tmp_path / "R.npz", robot=str(robot)) == 0
    said = capsys.readouterr().err
    for warning in expected:
        assert f"roberval: warning: {str(warning.message).partition(': ')[2]}\n" in said


def test_the_bar_ends_its_line_and_counts_this_runs_samples(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    monkeypatch.setattr(time, "monotonic", iter([0.0, 1.0]).__next__)
    with progress.Progress(2, 5_000_000, True) as bar:
        bar.draw(1.0, 7_000_000)
    assert capsys.readouterr().err.endswith("50%, 7000000 samples, 2.00 M/s \n")


@pytest.mark.skipif(sys.platform == "win32", reason="Windows ends processes otherwise")
def test_ctrl_c_while_the_command_is_imported_ends_it_without_a_traceback(tmp_path: Path) -> None:
    script = tmp_path / "roberval"
    script.write_text(
        "import os, signal, sys\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "class Interrupt:\n"
        "    def find_spec(self, name, path=None, target=None):\n"
        "        if name == 'numpy':\n"
        "            os.kill(os.getpid(), signal.SIGINT)\n"
        "sys.meta_path.insert(0, Interrupt())\n"
        "import roberval.command\n"
    )
    command = [sys.executable, str(script), "reduce", "puma560", "log.csv", "-o", "R.npz"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (-signal.SIGINT, "")


def test_a_digest_sees_every_byte_of_a_file(tmp_path: Path) -> None:
    path = tmp_path / "log"
    content = bytearray(3 * checkpoints.PIECE + 7)
    path.write_bytes(content)
    plain = checkpoints.identity(path, "")
    for place in np.random.default_rng(0).integers(0, len(content), 20):
        content[place] = 1
        path.write_bytes(content)
        assert checkpoints.identity(path, "") != plain
        content[place] = 0


def test_a_digest_sees_the_ends_of_large_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(checkpoints, "WHOLE", 1 << 20)
    path = tmp_path / "log"
    content = bytearray(3 * checkpoints.WHOLE)
    path.write_bytes(content)
    plain = checkpoints.identity(path, "")
    for place in (0, len(content) // 2, len(content) - 1):
        content[place] = 1
        path.write_bytes(content)
        assert checkpoints.identity(path, "") != plain
        content[place] = 0
    assert json.loads(json.dumps([plain])) == [list(plain)]


def test_samples_too_large_for_r_are_refused_and_nothing_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rows = samples()
    rows[20:, 6:12] *= 1e200
    good, bad = npz(tmp_path / "good.npz", samples()), npz(tmp_path / "bad.npz", rows)
    out, checkpoint = tmp_path / "R.npz", tmp_path / "c"
    assert reduced(good, bad, "-o", out, "--checkpoint", checkpoint) == 2
    assert f"roberval: error: {bad}: " in capsys.readouterr().err
    assert not out.exists()
