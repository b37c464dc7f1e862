"""The `roberval` command: the core's command line with the shell's manners."""

from __future__ import annotations

import signal
import sys
import tempfile
from contextlib import ExitStack
from pathlib import Path

from . import _core, importers
from .errors import RobervalError

TAKES_A_ROBOT = ("show", "base", "compare", "regressor", "scale", "lint")
"""Subcommands whose robot may be a MJCF or xacro file, or a name of robot_descriptions."""

OTHER_FILES = ("-o", "--output", "--certificate", "--report")
"""Options whose value is a file that is written."""

BAD_INPUT = 2


def main() -> int:
    """Run the command line with the arguments of this process; return the exit code."""
    if sys.argv[1:2] == ["reduce"]:
        from . import reducing

        return reducing.command(sys.argv[2:])
    # The core does the work outside Python, where Python's handlers never run: Ctrl-C and
    # a closed pipe end the process as they end any other command.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    if hasattr(signal, "SIGPIPE"):
        signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    sys.stdout.flush()
    with ExitStack() as stack:
        try:
            arguments = imported(sys.argv[1:], stack)
        except RobervalError as error:
            print(f"roberval: error: {error}", file=sys.stderr)
            return BAD_INPUT
        return _core.run_cli(arguments)


def imported(arguments: list[str], stack: ExitStack) -> list[str]:
    """Put in the place of other programs' robot files what the core reads itself."""
    if not arguments or arguments[0] not in TAKES_A_ROBOT:
        return arguments
    changed = list(arguments)
    for place in range(1, len(arguments)):
        word = arguments[place]
        if word.startswith("-") or arguments[place - 1] in OTHER_FILES:
            continue
        path = Path(word)
        if not path.exists() and not (path := importers.described(word) or path).exists():
            continue
        if kind := importers.kind_of(path):
            read = importers.read(path, kind)
            for warning in read.warnings:
                print(f"roberval: warning: {warning}", file=sys.stderr)
            folder = stack.enter_context(tempfile.TemporaryDirectory(prefix="roberval-"))
            target = Path(folder) / f"{path.stem}.{read.kind}"
            target.write_text(read.text, encoding="utf-8")
            changed[place] = str(target)
        elif str(path) != word:
            changed[place] = str(path)
    return changed


if __name__ == "__main__":
    sys.exit(main())
