"""The `roberval` command: the core's command line with the shell's manners."""

from __future__ import annotations

import signal
import sys

from . import _core, importers, starting
from .errors import RobervalError

TAKES_A_ROBOT = ("show", "base", "compare", "clean", "regressor", "scale", "code", "lint")
"""Subcommands whose robot may be a MJCF or xacro file, or a name of robot_descriptions."""

OTHER_FILES = ("-o", "--output", "--certificate", "--report", "--sympy")
"""Options whose value is a file that is written."""

BAD_INPUT = 2


def main() -> int:
    """Run the command line with the arguments of this process; return the exit code."""
    if sys.argv[1:2] == ["reduce"]:
        return reduced(sys.argv[2:])
    # The core does the work outside Python, where Python's handlers never run: Ctrl-C and
    # a closed pipe end the process as they end any other command.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    if hasattr(signal, "SIGPIPE"):
        signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    sys.stdout.flush()
    try:
        arguments = imported(sys.argv[1:])
    except RobervalError as error:
        print(f"roberval: error: {error}", file=sys.stderr)
        return BAD_INPUT
    return _core.run_cli(arguments)


def reduced(arguments: list[str]) -> int:
    """Run ``roberval reduce``, which is in Python and ends in good order on Ctrl-C."""
    from . import reducing

    starting.take_from_system()
    code = reducing.command(arguments)
    starting.give_to_system()
    if code == reducing.INTERRUPTED and sys.platform != "win32":
        # The end of any command on Ctrl-C; the interpreter and pyarrow take 100 ms to leave.
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        signal.raise_signal(signal.SIGINT)
    return code


def imported(arguments: list[str]) -> list[str]:
    """Let the core read translations of other programs' robot files."""
    if not arguments or arguments[0] not in TAKES_A_ROBOT:
        return arguments
    changed = list(arguments)
    for place in range(1, len(arguments)):
        word = arguments[place]
        if word.startswith("-") or arguments[place - 1] in OTHER_FILES:
            continue
        changed[place] = importers.stand_in(word)
    return changed


if __name__ == "__main__":
    sys.exit(main())
