"""Certificates and cleaned files: what Python writes, and what it says when it cannot."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any

import pytest
import roberval as rv
from conftest import SHARED

ROUNDED = """<robot name="arm"><link name="base"/><link name="upper"/><!-- kept -->
<joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/>
<origin xyz="0 0 0.3" rpy="1.5708 1.57 0"/><axis xyz="0 0 1"/></joint></robot>
"""


def checker(*arguments: object) -> tuple[int, str]:
    """Run the checker; return its exit code and all it says."""
    command = [sys.executable, "-m", "roberval.check_certificate", *map(str, arguments)]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    return run.returncode, run.stdout + run.stderr


def test_a_saved_certificate_is_accepted_and_a_changed_one_refused(
    tmp_path: Path, base: rv.BaseParameters
) -> None:
    path = tmp_path / "cert.json"
    base.save_certificate(path)
    assert json.loads(path.read_text(encoding="utf-8")) == base.certificate()
    assert checker(path) == (0, "accepted: PUMA 560: 40 base parameters of 66\n")
    path.write_text(path.read_text().replace('"MX_2"', '"MX_3"', 1))
    code, said = checker(path)
    assert code == 1
    assert said.startswith("refused: ")


@pytest.mark.parametrize(
    ("text", "words"),
    [(None, "No such file"), ("", "Expecting value"), ("{}", "no certificate"), ("[", "Expecting")],
)
def test_what_is_no_certificate_is_told_from_a_wrong_one(
    tmp_path: Path, text: str | None, words: str
) -> None:
    path = tmp_path / "cert.json"
    if text is not None:
        path.write_text(text)
    code, said = checker(path)
    assert (code, said.count("\n")) == (2, 1)
    assert said.startswith(f"cannot read {path}: ")
    assert words in said
    assert checker()[0] == 2


def test_only_the_exact_engine_certifies(tmp_path: Path, puma: rv.Robot) -> None:
    path = tmp_path / "cert.json"
    with pytest.raises(rv.OptionError, match="leave the engine at exact"):
        puma.base_parameters(engine="qr").save_certificate(path)
    assert not path.exists()


def test_a_file_that_cannot_be_written_leaves_nothing(
    tmp_path: Path, base: rv.BaseParameters
) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "file").touch()
    for place in ("folder", "missing/cert.json", "file/cert.json"):
        target = tmp_path / place
        with pytest.raises(OSError, match=r"directory") as told:
            base.save_certificate(target)
        # Not the draft beside it, which nobody asked for.
        assert (told.value.filename, told.value.filename2) == (str(target), None)
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["file", "folder"]


def test_a_cleaned_file_has_its_roundings_set_right_and_the_rest_as_it_was(tmp_path: Path) -> None:
    source, target = tmp_path / "arm.urdf", tmp_path / "clean.urdf"
    source.write_text(ROUNDED)
    cleaned = rv.clean_file(source, target)
    assert target.read_text() == ROUNDED.replace("1.5708", "1.5707963267948966")
    assert [len(part) for part in cleaned] == [1, 1]
    assert "1.5708" in cleaned.changes[0]
    assert "1.57" in cleaned.near_misses[0]
    assert rv.clean_file(source, source, aggressive=True).near_misses == ()
    assert "1.57 " not in source.read_text()
    with pytest.raises(rv.RobotError, match="no such file"):
        rv.clean_file(tmp_path / "none.urdf", target)


@pytest.mark.parametrize("path", [3, None, b"arm.urdf", ["puma560"]])
def test_what_is_no_path_is_told_what_would_be(path: Any) -> None:
    with pytest.raises(TypeError, match="load takes a file's path or the name of a built-in"):
        rv.load(path)


def test_files_that_ros_reads_are_read_with_a_warning() -> None:
    folder = SHARED / "data" / "kuka_lwr4_flobaroid"
    if not folder.is_dir():
        pytest.skip(f"no {folder} beside the checkout")
    for file in sorted(folder.glob("*.urdf")):
        with pytest.warns(rv.RobotWarning, match="line 55.*a second <origin>: the first is taken"):
            robot = rv.load(file)
        assert robot.base_parameters().rank == 48


def test_links_without_inertia_are_shown_and_not_warned_of(recwarn: Any) -> None:
    robot = rv.Robot.from_urdf(ROUNDED.replace("1.57 ", "0.2 "))
    assert robot.base_parameters().rank == 3
    assert not recwarn.list
    assert "needs none" in robot.to_markdown()


def test_links_stay_links(tmp_path: Path, base: rv.BaseParameters) -> None:
    (tmp_path / "far").mkdir()
    link = tmp_path / "link"
    link.symlink_to(tmp_path / "far" / "file")
    qr = rv.ObservationQR(base)
    for save in (qr.save, qr.save_factor, base.save_certificate):
        # The first time the link points to nothing.
        save(link)
        assert link.is_symlink()
    assert [path.name for path in (tmp_path / "far").iterdir()] == ["file"]


def test_what_is_no_file_is_written_to(tmp_path: Path, base: rv.BaseParameters) -> None:
    # A pipe: a device of the machine's own must not depend on a test that may fail.
    if not hasattr(os, "mkfifo"):
        pytest.skip("there are no pipes with names")
    pipe, link, read = tmp_path / "pipe", tmp_path / "link", list[bytes]()
    os.mkfifo(pipe)
    link.symlink_to(pipe)
    qr = rv.ObservationQR(base)
    for target in (pipe, link):
        # A daemon: it would wait for ever at a pipe that was replaced.
        reader = threading.Thread(target=lambda: read.append(pipe.read_bytes()), daemon=True)
        reader.start()
        qr.save(target)
        assert pipe.is_fifo()
        reader.join(60)
    qr.save(tmp_path / "file")
    assert b"".join(read) == 2 * (tmp_path / "file").read_bytes()


def test_errors_of_writing_name_the_file_and_nothing_else(
    tmp_path: Path, base: rv.BaseParameters
) -> None:
    locked, qr = tmp_path / "locked", rv.ObservationQR(base)
    locked.write_text("kept")
    locked.chmod(0o444)
    for save in (qr.save, qr.save_factor, base.save_certificate):
        for target in (tmp_path / "no" / "file", tmp_path, locked):
            with pytest.raises(OSError, match=r"^\[Errno \d+\] [^>]*$") as told:
                save(target)
            assert str(told.value).endswith(f": {str(target)!r}")
    assert locked.read_text() == "kept"


def test_drafts_of_killed_processes_are_swept_and_those_of_others_are_not(
    tmp_path: Path, base: rv.BaseParameters
) -> None:
    old, young = tmp_path / ".roberval-1-0.tmp", tmp_path / ".roberval-2-0.tmp"
    for draft in (old, young):
        draft.write_text("half")
    os.utime(old, (0, 0))
    rv.ObservationQR(base).save_factor(tmp_path / "R.npz")
    assert not old.exists()
    assert young.exists()
