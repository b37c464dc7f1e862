"""Numbers without rounding."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias


@dataclass(frozen=True)
class Surd:
    """A sum of fractions times square roots.

    Attributes
    ----------
    terms : mapping from int to Fraction
        n -> r stands for ``r sqrt(n)``; n = 1 is the rational part.
    """

    terms: Mapping[int, Fraction]

    def __float__(self) -> float:
        return math.fsum(float(r) * math.sqrt(n) for n, r in self.terms.items())

    def __str__(self) -> str:
        terms = (f"{r}" if n == 1 else f"{r} sqrt({n})" for n, r in self.terms.items())
        return " + ".join(terms).replace("+ -", "- ")

    def __hash__(self) -> int:
        return hash(tuple(self.terms.items()))


Exact: TypeAlias = Fraction | Surd | float
"""A coefficient: exact where it has such a form, else correctly rounded."""


def coefficient(core: str | list[tuple[int, str]] | float) -> Exact:
    """Return a coefficient of the core."""
    if isinstance(core, str):
        return Fraction(core)
    if isinstance(core, float):
        return core
    return Surd({n: Fraction(r) for n, r in core})
