"""Plots with matplotlib, which is imported when one is drawn. Each returns its axes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from .errors import MissingPackageError

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .base import BaseParameters
    from .robot import Robot

KINDS = ("XX", "XY", "XZ", "YY", "YZ", "ZZ", "MX", "MY", "MZ", "M", "Ia")

COLOURS = {
    "no effect": "#e8e9eb",
    "unchanged": "#6fb58d",
    "regrouped into": "#7d9fdd",
    "regrouped": "#eab676",
}

MARKS = {"no effect": "", "unchanged": "=", "regrouped into": "+", "regrouped": "o"}

INCH = 0.28
"""Height of a row of a grid, so that names can be read."""


def _pyplot() -> Any:
    try:
        import matplotlib.pyplot
    except ImportError:
        raise MissingPackageError("plots need matplotlib: pip install matplotlib") from None
    return matplotlib.pyplot


def _axes(ax: Axes | None, width: float, height: float, **subplot: Any) -> Any:
    if ax is not None:
        return ax
    figure = _pyplot().figure(figsize=(width, height), layout="constrained")
    return figure.add_subplot(**subplot)


class BasePlots:
    """Plots of base parameters: `BaseParameters.plot`."""

    __slots__ = ("_base",)

    def __init__(self, base: BaseParameters) -> None:
        self._base = base

    def spectrum(self, ax: Axes | None = None) -> Axes:
        """Draw the spectra of the float engines, the gap and the tolerance.

        Parameters
        ----------
        ax : matplotlib Axes
            Where to draw; new ones by default.
        """
        ax = _axes(ax, 7, 3.6)
        base, diagnosis = self._base, self._base.diagnosis
        shown = [
            (w.engine, list(w.spectrum), w.tolerance)
            for w in diagnosis.witnesses
            if w.engine in ("qrii", "svd")
        ] or [(base.engine, sorted(diagnosis.spectrum.tolist(), reverse=True), diagnosis.tolerance)]
        for number, (engine, spectrum, tolerance) in enumerate(shown):
            place = np.arange(1, len(spectrum) + 1)
            ax.semilogy(place, spectrum, "ov"[number], ms=4, color=f"C{number}", label=engine)
            ax.axhline(tolerance, color=f"C{number}", lw=0.8, ls="--")
        ax.axvline(base.rank + 0.5, color="0.6", lw=0.8)
        gap = "" if diagnosis.gap is None else f", gap {diagnosis.gap:.0e}"
        ax.set(xlabel="number", ylabel="value (dashed: tolerance)", title=f"rank {base.rank}{gap}")
        ax.legend()
        return ax

    def classification(self, ax: Axes | None = None) -> Axes:
        """Draw the links by kinds of parameters: what becomes of each.

        Parameters
        ----------
        ax : matplotlib Axes
            Where to draw; new ones by default.
        """
        pyplot = _pyplot()
        links = [link.name for link in self._base.robot.links]
        ax = _axes(ax, 6.4, 1.4 + INCH * len(links))
        classes = self._base.classes
        for row, link in enumerate(links):
            for column, kind in enumerate(KINDS):
                name = classes.get(f"{kind}_{link}")
                if name is None:
                    continue
                cell = pyplot.Rectangle((column, row), 1, 1, fc=COLOURS[name], ec="white", lw=1.5)
                ax.add_patch(cell)
                ax.text(column + 0.5, row + 0.5, MARKS[name], ha="center", va="center", fontsize=8)
        ax.set(xlim=(0, len(KINDS)), ylim=(len(links), 0))
        ax.set_xticks(np.arange(len(KINDS)) + 0.5, KINDS)
        ax.set_yticks(np.arange(len(links)) + 0.5, links)
        ax.tick_params(length=0, labeltop=True, labelbottom=False)
        ax.spines[:].set_visible(False)
        handles = [pyplot.Rectangle((0, 0), 1, 1, fc=colour) for colour in COLOURS.values()]
        ax.legend(
            handles, COLOURS, loc="upper center", bbox_to_anchor=(0.5, 0), ncols=4, frameon=False
        )
        return ax

    def beta(self, ax: Axes | None = None) -> Axes:
        """Draw the regrouping coefficients of the rows that are not zero.

        Parameters
        ----------
        ax : matplotlib Axes
            Where to draw; new ones by default.
        """
        base = self._base
        rows = [i for i, label in enumerate(base.base) if label in set(base.regrouped_into)]
        values = base.beta[rows]
        ax = _axes(ax, 2 + 0.24 * values.shape[1], 1.6 + 0.24 * len(rows))
        limit = float(np.abs(values).max()) if values.size else 1.0
        image = ax.imshow(
            np.where(values == 0, np.nan, values), cmap="coolwarm_r", vmin=-limit, vmax=limit
        )
        ax.set_xticks(range(values.shape[1]), base.regrouped, rotation=90, fontsize=7)
        ax.set_yticks(range(len(rows)), [base.base[i] for i in rows], fontsize=7)
        ax.set_facecolor("0.96")
        ax.figure.colorbar(image, ax=ax, shrink=0.8)
        ax.set_title("beta: rows take up columns")
        return ax

    def tree(self, ax: Axes | None = None) -> Axes:
        """Draw the robot, coloured by how many parameters each link keeps.

        Parameters
        ----------
        ax : matplotlib 3D axes
            Where to draw; new ones by default.
        """
        kept = {link.name: 0 for link in self._base.robot.links}
        for label in self._base.base:
            kept[label.split("_", 1)[1]] += 1
        axes: Axes = draw_tree(self._base.robot, kept, ax)
        return axes


def draw_tree(robot: Robot, kept: dict[str, int] | None, ax: Any) -> Any:
    """Draw the robot's links and joint axes at joint variables 0 in 3D axes."""
    ax = _axes(ax, 5.5, 5.5, projection="3d")
    frames = robot.frames()
    index = {link.name: j for j, link in enumerate(robot.links)}
    points = np.vstack([np.zeros(3), frames[:, :3, 3]])
    size = max(float(np.ptp(points, axis=0).max()), 1e-3)
    colours = _pyplot().get_cmap("viridis_r")
    for j, link in enumerate(robot.links):
        above = None if link.antecedent is None else index[link.antecedent]
        start = np.zeros(3) if above is None else frames[above, :3, 3]
        end = frames[j, :3, 3]
        count = None if kept is None or link.antecedent is None else kept[link.antecedent]
        colour = "0.7" if count is None else colours(count / len(KINDS))
        ax.plot(*np.stack([start, end]).T, color=colour, lw=4, solid_capstyle="round")
        axis = frames[j, :3, :3] @ robot.axes[j] * 0.07 * size
        joint = "0.3" if kept is None else colours(kept[link.name] / len(KINDS))
        style = {"revolute": "-", "prismatic": ":", "fixed": ""}[link.joint]
        if style:
            ax.plot(*np.stack([end - axis, end + axis]).T, color=joint, lw=8, ls=style)
        name = link.name if len(robot.links) <= 16 else ""
        ax.text(*(end + 0.03 * size), name, fontsize=8)
    centre = (points.max(axis=0) + points.min(axis=0)) / 2
    for k, letter in enumerate("xyz"):
        getattr(ax, f"set_{letter}lim")(centre[k] - size / 2, centre[k] + size / 2)
        getattr(ax, f"set_{letter}label")(f"{letter} (m)")
    ax.set_title(robot.name)
    return ax


class RobotPlots:
    """Plots of a robot: `Robot.plot`."""

    __slots__ = ("_robot",)

    def __init__(self, robot: Robot) -> None:
        self._robot = robot

    def tree(self, ax: Axes | None = None) -> Axes:
        """Draw links and joint axes at joint variables 0.

        Parameters
        ----------
        ax : matplotlib 3D axes
            Where to draw; new ones by default.
        """
        axes: Axes = draw_tree(self._robot, None, ax)
        return axes
