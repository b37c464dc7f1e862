"""All models by all engines: whether they agree."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from . import _core, rendering
from .base import BaseParameters
from .options import Options
from .rendering import Rendered

if TYPE_CHECKING:
    from .robot import Robot


@dataclass(frozen=True)
class Route:
    """One model analysed by one engine.

    Attributes
    ----------
    answer : BaseParameters
        What this route found.
    same_columns : bool
        Whether it has the first route's columns without effect, kept and regrouped.
    beta_difference : float
        Largest difference to the first route's beta, relative to its largest entry.
    """

    answer: BaseParameters
    same_columns: bool
    beta_difference: float


def _of_route(options: Options, answer: _core.Answer) -> Options:
    return {**options, "model": answer.model, "engine": answer.engine}


class Comparison(Rendered):
    """All models by all engines. Made by `Robot.compare`.

    Attributes
    ----------
    agree : bool
        Whether all give one answer and none is in doubt.
    routes : tuple of Route
        Model by model, engine by engine.
    doubts : tuple of str
        Why they are not one clear answer; empty if they are.
    """

    __slots__ = ("agree", "doubts", "routes")

    _inner: _core.Comparison
    agree: bool
    routes: tuple[Route, ...]
    doubts: tuple[str, ...]

    def __init__(self) -> None:
        raise TypeError("make a Comparison with Robot.compare")

    @classmethod
    def _of(cls, robot: Robot, options: Options, core: _core.Comparison) -> Comparison:
        comparison = object.__new__(cls)
        comparison._inner = core
        comparison.agree = core.agree
        comparison.doubts = tuple(core.doubts)
        comparison.routes = tuple(
            Route(BaseParameters._of(robot, _of_route(options, answer), answer), same, difference)
            for answer, same, difference in core.routes
        )
        return comparison

    def __repr__(self) -> str:
        ranks = sorted({route.answer.rank for route in self.routes})
        verdict = "agree" if self.agree else "do not agree"
        found = ", ".join(map(str, ranks))
        return f"Comparison({len(self.routes)} routes {verdict}: {found} base parameters)"

    def _repr_html_(self) -> str:
        header = ["model", "engine", "base parameters", "same columns", "beta differs", "clear"]
        rows = (
            [
                route.answer.model,
                route.answer.engine,
                str(route.answer.rank),
                "yes" if route.same_columns else "no",
                f"{route.beta_difference:.1e}",
                "yes" if route.answer.diagnosis.clear else "no",
            ]
            for route in self.routes
        )
        doubts = "".join(rendering.paragraph(doubt) for doubt in self.doubts)
        return rendering.paragraph(repr(self)) + doubts + rendering.grid(header, rows)
