"""The progress bar of a reduction."""

from __future__ import annotations

import sys
import time

WIDTH = 32
"""Places of the bar."""


class Progress:
    """A line on the terminal that is drawn again; with `shown` false, nothing."""

    def __init__(self, files: int, samples: int, shown: bool) -> None:
        self.files, self.before = files, samples
        self.shown = shown and sys.stderr.isatty()
        self.started, self.drawn = time.monotonic(), False

    def draw(self, done: float, samples: int) -> None:
        """Draw the bar; `done` counts files, `samples` those of the checkpoint too."""
        if not self.shown:
            return
        part = done / self.files
        full = int(WIDTH * part)
        bar = "#" * full + "." * (WIDTH - full)
        seconds = max(time.monotonic() - self.started, 1e-3)
        rate = (samples - self.before) / seconds / 1e6
        line = f"\r[{bar}] {part:4.0%}, {samples} samples, {rate:.2f} M/s "
        print(line, end="", file=sys.stderr, flush=True)
        self.drawn = True

    def __enter__(self) -> Progress:
        return self

    def __exit__(self, *_: object) -> None:
        """End the line: whatever is said next has its own."""
        if self.drawn:
            print(file=sys.stderr, flush=True)
