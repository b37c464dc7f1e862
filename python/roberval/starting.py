"""Ctrl-C while the command is still being imported: the end of any command, not a traceback."""

from __future__ import annotations

import signal
import sys
import threading
from itertools import pairwise
from pathlib import PurePath


def is_command() -> bool:
    """Tell whether this process is the command `roberval`, or `python -m roberval`."""
    if sys.argv[:1] == ["-m"]:
        options = sys.orig_argv
        return ("-m", "roberval") in pairwise(options)
    return PurePath(sys.argv[0]).stem == "roberval" if sys.argv else False


def give_to_system() -> None:
    """Let Ctrl-C end the process where Python would raise KeyboardInterrupt."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)


def take_from_system() -> None:
    """Undo `give_to_system`; a shell's wish that Ctrl-C be ignored stays."""
    if signal.getsignal(signal.SIGINT) is signal.SIG_DFL:
        signal.signal(signal.SIGINT, signal.default_int_handler)


if threading.current_thread() is threading.main_thread() and is_command():
    give_to_system()
