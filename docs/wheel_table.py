"""Run `roberval lint` and `roberval base` over every URDF of some folders; write docs/wheels.md.

    python docs/wheel_table.py path/to/roberval example-robot-data=folder pybullet=folder ...

Each folder is an unpacked wheel. Every file must end in exit code 0, 1 or 2 within `LIMIT`
seconds, and a refusal must name the file and say why; anything else stops the run.
"""

from __future__ import annotations

import re
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

LIMIT = 120
"""Seconds after which a run counts as hanging."""

PAGE = Path(__file__).with_name("wheels.md")

HEAD = """# Robots of PyPI's wheels

`roberval lint` and `roberval base` over every URDF in wheels on PyPI, written by
[wheel_table.py](wheel_table.py). No run crashed or hung, and every refusal names the file and
the reason.

| wheel | URDF files | base parameters found | in doubt | refused | without findings | findings |
|---|---|---|---|---|---|---|
"""


def run(command: str, *arguments: str) -> tuple[int, str, str]:
    """Run the command; return exit code, stdout and stderr."""
    done = subprocess.run(
        [command, *arguments],
        capture_output=True,
        text=True,
        errors="replace",
        timeout=LIMIT,
        check=False,
    )
    if done.returncode not in (0, 1, 2) or "panicked" in done.stderr:
        raise SystemExit(f"{arguments}: exit code {done.returncode}\n{done.stderr[-2000:]}")
    return done.returncode, done.stdout, done.stderr


def reason(stderr: str, path: Path) -> str:
    """Return why a file was refused, with names and numbers left out."""
    errors = [line for line in stderr.splitlines() if line.startswith("roberval: error: ")]
    if len(errors) != 1 or path.name not in errors[0]:
        raise SystemExit(f"{path}: a refusal without a reason\n{stderr[-2000:]}")
    text = errors[0].partition(path.name)[2].partition(": ")[2]
    text = re.sub(r'(link|joint|the robot) "[^"]*"(, [^:]*)?: ?', "", text)
    return re.sub(r'"[^"]*"', '"..."', text).partition(";")[0]


def main() -> None:
    """Run over all folders and write the page."""
    command, *folders = sys.argv[1:]
    rows, refusals, rules, slowest = [], Counter(), Counter(), (0.0, "")
    for folder in folders:
        wheel, _, place = folder.partition("=")
        files = sorted(Path(place).rglob("*.urdf"))
        codes, clean, findings = Counter(), 0, 0
        for path in files:
            start = time.monotonic()
            code, _, stderr = run(command, "base", str(path), "--format", "json")
            slowest = max(slowest, (time.monotonic() - start, path.name))
            codes[code] += 1
            if code == 2:
                refusals[reason(stderr, path)] += 1
            _, found, _ = run(command, "lint", str(path))
            clean += not found
            findings += len(found.splitlines())
            rules.update(re.findall(r"\[([\w-]+)\](?:;|$)", found, re.MULTILINE))
        rows.append(
            f"| {wheel} | {len(files)} | {codes[0] + codes[1]} | {codes[1]} | {codes[2]} |"
            f" {clean} | {findings} |"
        )
        print(rows[-1], flush=True)
    lines = [HEAD + "\n".join(rows), "", "## Why files were refused", ""]
    lines += ["| reason | files |", "|---|---|"]
    lines += [f"| {text.replace('|', '/')} | {count} |" for text, count in refusals.most_common()]
    lines += ["", "## What lint found", "", "| rule | findings |", "|---|---|"]
    lines += [f"| {rule} | {count} |" for rule, count in rules.most_common()]
    PAGE.write_text("\n".join(lines) + "\n")
    print(f"slowest: {slowest[1]}, {slowest[0]:.1f} s")


if __name__ == "__main__":
    main()
