"""The `roberval` command: the core's command line with the shell's manners."""

from __future__ import annotations

import signal
import sys

from . import _core


def main() -> int:
    """Run the command line with the arguments of this process; return the exit code."""
    # The core does the work outside Python, where Python's handlers never run: Ctrl-C and
    # a closed pipe end the process as they end any other command.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    if hasattr(signal, "SIGPIPE"):
        signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    sys.stdout.flush()
    return _core.run_cli(sys.argv[1:])


if __name__ == "__main__":
    sys.exit(main())
