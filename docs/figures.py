"""Draw the figures of the documentation from the answers themselves.

python docs/figures.py
"""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
import roberval as rv

FOLDER = Path(__file__).with_name("figures")


def main() -> None:
    """Write classification.svg and spectrum.svg, the same bytes each time."""
    mpl.use("svg")
    mpl.rcParams.update({"svg.hashsalt": "roberval", "svg.fonttype": "path"})
    base = rv.load("puma560").base_parameters()
    for name in ("classification", "spectrum"):
        axes = getattr(base.plot, name)()
        axes.figure.savefig(FOLDER / f"{name}.svg", metadata={"Date": None})


if __name__ == "__main__":
    main()
