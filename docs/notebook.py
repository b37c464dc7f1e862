"""Write docs/notebook.ipynb, executed; with --check, say whether it still runs.

python docs/notebook.py [--check]
"""

from __future__ import annotations

import sys
from pathlib import Path

import nbformat
from nbclient import NotebookClient

PATH = Path(__file__).with_name("notebook.ipynb")

CELLS = [
    "# A robot in a notebook\n\nLoad a robot and look at it. Results show themselves as tables.",
    ">import roberval as rv\n\nrobot = rv.load('puma560')\nrobot",
    "Its links in space:",
    ">%matplotlib inline\nax = robot.plot.tree()",
    "Which parameters can its motion tell? Green ones stay as they are, blue ones take up the"
    " orange ones, grey ones have no effect.",
    ">base = robot.base_parameters()\nbase",
    "Why so many and not more? After the fortieth value the spectrum falls by nearly fifteen"
    " powers of ten. The number itself was decided exactly; this is the witness.",
    ">ax = base.plot.spectrum()",
    "The coefficients of the sums:",
    ">ax = base.plot.beta()",
    "They are exact where the geometry is:",
    ">base.beta_exact['XX_3']",
    "Now break it: the same arm with angles rounded to four decimals, taken as written.",
    ">rounded = robot.to_toml().replace('90 deg', '1.5708')\n"
    "import warnings\n"
    "with warnings.catch_warnings():\n"
    "    warnings.simplefilter('ignore')\n"
    "    literal = rv.Robot.from_toml(rounded, snap='off').base_parameters(engine='svd')\n"
    "literal.rank, literal.diagnosis.messages",
    "One parameter more, which no experiment would see. Read as usual, the roundings are set right"
    " and listed:",
    ">with warnings.catch_warnings():\n"
    "    warnings.simplefilter('ignore')\n"
    "    cleaned = rv.Robot.from_toml(rounded)\n"
    "    rank = cleaned.base_parameters().rank\n"
    "rank, cleaned.changes[0]",
    "Identification by least squares, with noise on the torques:",
    ">import numpy as np\n\n"
    "random = np.random.default_rng(0)\n"
    "q, qd, qdd = random.uniform(-2, 2, (3, 1000, robot.n))\n"
    "torque = robot.torques(q, qd, qdd) + random.normal(0, 0.05, (1000, robot.n))\n"
    "W1 = base.regressor(q, qd, qdd).reshape(-1, base.rank)\n"
    "found, *_ = np.linalg.lstsq(W1, torque.ravel())\n"
    "frame = base.to_frame().loc[list(base.base), ['XB']].assign(found=found)\n"
    "frame.head(8).round(3)",
]


def main() -> None:
    """Build and execute the notebook."""
    notebook = nbformat.v4.new_notebook(
        cells=[
            nbformat.v4.new_code_cell(text[1:], id=f"cell-{number}")
            if text.startswith(">")
            else nbformat.v4.new_markdown_cell(text, id=f"cell-{number}")
            for number, text in enumerate(CELLS)
        ],
        metadata={
            "kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}
        },
    )
    NotebookClient(notebook, timeout=300, kernel_name="python3", record_timing=False).execute()
    notebook.metadata.pop("language_info", None)
    if "--check" not in sys.argv:
        nbformat.write(notebook, PATH)


if __name__ == "__main__":
    main()
