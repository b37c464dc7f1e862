"""The `roberval` command as the wheel installs it, and `python -m roberval`."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import sysconfig
from contextlib import suppress
from functools import partial
from pathlib import Path

import pytest
import roberval as rv
from roberval import _core

SCRIPT = Path(sysconfig.get_path("scripts")) / ("roberval.exe" if os.name == "nt" else "roberval")


def run(*arguments: str, module: bool = False) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "roberval"] if module else [str(SCRIPT)]
    return subprocess.run([*command, *arguments], capture_output=True, text=True, check=False)


@pytest.fixture(autouse=True)
def _installed() -> None:
    if not SCRIPT.exists():
        pytest.skip("the roberval script is not beside this Python: pip install .")


@pytest.mark.parametrize("module", [False, True])
def test_the_command_prints_what_python_returns(base: rv.BaseParameters, module: bool) -> None:
    done = run("base", "puma560", module=module)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.rstrip("\n") == base.table().rstrip("\n")


def test_json_comes_alone_on_stdout() -> None:
    done = run("base", "puma560", "--format", "json", "--model", "h", "--engine", "svd")
    assert json.loads(done.stdout)["rank"] == 40


def test_bad_input_ends_with_2_and_a_sentence() -> None:
    done = run("base", "puma561")
    assert (done.returncode, done.stdout) == (2, "")
    assert 'did you mean the built-in "puma560"' in done.stderr
    assert "Traceback" not in done.stderr


def test_help_is_help() -> None:
    done = run("--help")
    assert done.returncode == 0
    assert "base" in done.stdout


@pytest.mark.skipif(not hasattr(signal, "SIGPIPE"), reason="no pipes that break")
def test_a_closed_pipe_is_quiet() -> None:
    reader, writer = os.pipe()
    os.close(reader)
    command = [str(SCRIPT), "base", "puma560"]
    done = subprocess.run(command, stdout=writer, stderr=subprocess.PIPE, check=False)
    os.close(writer)
    assert done.stderr == b""
    assert done.returncode in (0, -signal.SIGPIPE)


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGINT to send")
def test_ctrl_c_ends_the_command(tmp_path: Path) -> None:
    # A pipe without a writer keeps the command waiting for its robot.
    fifo = tmp_path / "robot.toml"
    os.mkfifo(fifo)
    command = [str(SCRIPT), "base", str(fifo)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        writer = os.open(fifo, os.O_WRONLY)  # returns once the command reads
        process.send_signal(signal.SIGINT)
        assert process.communicate(timeout=60) == (b"", b"")
        os.close(writer)
    assert process.returncode == -signal.SIGINT


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGINT to send")
def test_ctrl_c_ends_reduce_and_leaves_no_file(tmp_path: Path) -> None:
    fifo, output = tmp_path / "samples.csv", tmp_path / "R.npz"
    os.mkfifo(fifo)
    command = [sys.executable, "-m", "roberval", "reduce", "puma560", str(fifo), "-o", str(output)]
    # What runs in the background ignores the signal, and so would its children.
    heed = partial(signal.signal, signal.SIGINT, signal.SIG_DFL)
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    with subprocess.Popen(command, preexec_fn=heed, **pipes) as process:  # type: ignore[call-overload]
        writer = os.open(fifo, os.O_WRONLY)  # returns once the command has opened it
        told = None
        for _ in range(6):
            # Python sleeps over a signal between its last look and the read that waits.
            process.send_signal(signal.SIGINT)
            with suppress(subprocess.TimeoutExpired):
                told = process.communicate(timeout=10)
                break
        process.kill()
        assert told == (b"", b"roberval: interrupted\n")
        os.close(writer)
    assert process.returncode == -signal.SIGINT
    assert not output.exists()


def test_the_help_of_reduce_lists_what_it_takes() -> None:
    told = re.findall(r"--([a-z-]+)", run("reduce", "--help").stdout.partition("Options:")[2])
    asked = _core.reduce_arguments(["reduce", "puma560", "log.csv", "-o", "R.npz"])
    assert isinstance(asked, dict)
    taken = {name.removeprefix("no-").replace("-", "_") for name in told} - {"help"}
    assert taken | {"robot", "samples", "weight_columns"} == set(asked)
