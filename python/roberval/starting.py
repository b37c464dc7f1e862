"""Ctrl-C while the command is still being imported: the end of any command, not a traceback.

Nothing is imported here that takes time: until this module has run, Python answers Ctrl-C.
"""

from __future__ import annotations

import signal
import sys
from itertools import pairwise

SCRIPTS = ("roberval", "roberval.exe")
"""What the command is called."""


def is_command() -> bool:
    """Tell whether this process is the command `roberval`, or `python -m roberval`."""
    program = sys.argv[0] if sys.argv else ""
    if program == "-m":
        return ("-m", "roberval") in pairwise(sys.orig_argv)
    return program.replace("\\", "/").rpartition("/")[2] in SCRIPTS


def give_to_system() -> None:
    """Let Ctrl-C end the process where Python would raise KeyboardInterrupt."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)


def take_from_system() -> None:
    """Undo `give_to_system`; a shell's wish that Ctrl-C be ignored stays."""
    if signal.getsignal(signal.SIGINT) is signal.SIG_DFL:
        signal.signal(signal.SIGINT, signal.default_int_handler)


if is_command():
    give_to_system()
