"""Samples that scale the observation matrix W (Gautier 1991, "Scaling of W")."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, SupportsIndex, TypedDict

from . import _core
from .arrays import Array
from .errors import OptionError
from .options import integer, text


@dataclass(frozen=True)
class Grade:
    """How well a set of samples shows the parameters.

    Attributes
    ----------
    s : float
        S = max |W_ij| / min |W_ij| over the nonzero entries.
    norm : float
        Frobenius norm of W.
    j : float
        The criterion J = l1 ||W||_F + l2 S.
    rank : int
        Rank of W by QR with column pivoting.
    gap : float or None
        |T_bb| / |T_b+1,b+1|; None if nothing is left over.
    """

    s: float
    norm: float
    j: float
    rank: int
    gap: float | None


@dataclass(frozen=True, eq=False)
class Scaling:
    """Samples that scale W, and what they gain. Made by `Robot.scale`.

    Attributes
    ----------
    model : str
        d, d0 or h.
    q, qd, qdd : ndarray, shape (N, m)
        The samples; for h the first one is the reference.
    columns : tuple of str
        The c parameters with an effect.
    W : ndarray, shape (r, c)
        The observation matrix at the samples.
    row_s : ndarray, shape (r,)
        S of each row alone.
    before, after : Grade
        As many random samples, and the samples found.
    """

    model: str
    q: Array
    qd: Array
    qdd: Array
    columns: tuple[str, ...]
    W: Array
    row_s: Array
    before: Grade
    after: Grade

    @classmethod
    def _of(cls, model: str, labels: tuple[str, ...], core: _core.Scaling) -> Scaling:
        q, qd, qdd = core.samples()
        return cls(
            model=model,
            q=q,
            qd=qd,
            qdd=qdd,
            columns=tuple(labels[column] for column in core.columns),
            W=core.w(),
            row_s=core.row_s(),
            before=Grade(*core.before),
            after=Grade(*core.after),
        )

    def __repr__(self) -> str:
        return (
            f"Scaling(model {self.model}, W {self.W.shape[0]} x {self.W.shape[1]}: "
            f"S from {self.before.s:.3g} to {self.after.s:.3g})"
        )


class ScalingOptions(TypedDict):
    """What the core is asked to do; None leaves it its default."""

    model: str
    seed: int
    rows: int | None
    target: float | None
    starts: int | None
    rounds: int | None
    weights: list[float] | None


def scaling_options(
    model: str,
    seed: SupportsIndex,
    rows: SupportsIndex | None,
    target: float | None,
    starts: SupportsIndex | None,
    rounds: SupportsIndex | None,
    weights: Any,
) -> ScalingOptions:
    """Return the options as the core takes them."""
    return {
        "model": text("model", model),
        "seed": integer("seed", seed, 0, 2**64 - 1),
        "rows": None if rows is None else integer("rows", rows, 1, 2**63 - 1),
        "target": None if target is None else _number("target", target, 1.0),
        "starts": None if starts is None else integer("starts", starts, 1, 10**9),
        "rounds": None if rounds is None else integer("rounds", rounds, 0, 10**9),
        "weights": None if weights is None else _weights(weights),
    }


def _weights(weights: Any) -> list[float]:
    listed = list(weights)
    if len(listed) != 2:
        raise OptionError(f"weights is {weights!r}, expected the two numbers l1 and l2")
    return [_number("a weight", weight, 0.0) for weight in listed]


def _number(name: str, value: Any, least: float) -> float:
    try:
        number = float(value)
    except (TypeError, ValueError):
        number = math.nan
    if not least <= number < math.inf:
        raise OptionError(f"{name} is {value!r}, expected a finite number of at least {least:g}")
    return number
