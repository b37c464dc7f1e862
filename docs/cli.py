"""Write docs/cli.md from the command's own help.

python docs/cli.py
"""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

PAGE = Path(__file__).with_name("cli.md")


def help_of(*command: str) -> str:
    """Return a command's help as it prints it."""
    done = subprocess.run(
        [sys.executable, "-m", "roberval", *command, "--help"],
        capture_output=True,
        text=True,
        check=True,
    )
    return "\n".join(line.rstrip() for line in done.stdout.splitlines())


def commands() -> list[str]:
    """Return the names of the subcommands."""
    listed = help_of().partition("Commands:\n")[2].partition("\n\n")[0]
    names = re.findall(r"^  ([a-z-]+) ", listed, re.MULTILINE)
    return [name for name in names if name != "help"]


def page() -> str:
    """Return the page."""
    parts = ["# Command line\n", "Written by [cli.py](cli.py) from the command's own help.\n"]
    for command in ((), *((name,) for name in commands())):
        title = " ".join(("roberval", *command))
        parts.append(f"## {title}\n\n```text\n{help_of(*command)}\n```\n")
    return "\n".join(parts)


if __name__ == "__main__":
    PAGE.write_text(page())
