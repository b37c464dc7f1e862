"""Relations in symbols."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Any

from . import _core
from .errors import MissingPackageError
from .rendering import Rendered


class SymbolicRelations(Rendered, Mapping[str, str]):
    """The relations that are not trivial, in symbols: base parameter -> its sum.

    ``symbolic["XX_2"]`` is ``"XX_2 - YY_2 - D3^2 (M_3 + M_4 + M_5 + M_6)"``. They hold for
    generic values of the symbols; `special` tells where the given values are not. Immutable.

    Made by `BaseParameters.relations_symbolic`, and by `Robot.closed_form_rules` for what the
    closed-form rules alone say.
    """

    __slots__ = ("_content",)

    _inner: _core.Symbolic
    _content: dict[str, Any]

    def __init__(self) -> None:
        made = "BaseParameters.relations_symbolic or Robot.closed_form_rules"
        raise TypeError(f"make SymbolicRelations with {made}")

    @classmethod
    def _of(cls, core: _core.Symbolic) -> SymbolicRelations:
        answer = object.__new__(cls)
        answer._inner = core
        answer._content = json.loads(core.render("json"))
        return answer

    def __getitem__(self, label: str) -> str:
        text: str = self._content["relations"][label]["text"]
        return text

    def __iter__(self) -> Iterator[str]:
        return iter(self._content["relations"])

    def __len__(self) -> int:
        return len(self._content["relations"])

    def __str__(self) -> str:
        return "\n".join(f"{label}: {text}" for label, text in self.items())

    @property
    def rank(self) -> int:
        """The number of base parameters for generic values of the symbols.

        For the rules alone, the number of parameters that they leave.
        """
        rank: int = self._content["rank"]
        return rank

    @property
    def symbols(self) -> Mapping[str, float]:
        """The symbols and their values as given (m or rad)."""
        return MappingProxyType({s["name"]: s["value"] for s in self._content["symbols"]})

    @property
    def latex(self) -> Mapping[str, str]:
        """The relations as formulas of LaTeX."""
        relations = self._content["relations"].items()
        return MappingProxyType({label: forms["latex"] for label, forms in relations})

    @property
    def origins(self) -> Mapping[str, str]:
        """The rule or elimination that removes each parameter which is not kept."""
        return MappingProxyType(self._content["origins"])

    @property
    def made_by(self) -> Mapping[str, tuple[str, ...]]:
        """The rules or elimination that each relation comes from."""
        relations = self._content["relations"].items()
        return MappingProxyType({label: tuple(forms["made_by"]) for label, forms in relations})

    @property
    def left_over(self) -> tuple[str, ...]:
        """The parameters that the numerical method removes of those that the rules leave."""
        return tuple(self._content["left_over"])

    @property
    def special(self) -> tuple[tuple[tuple[str, ...], int], ...]:
        """The causes by which the given values lower the rank, and how many parameters each does.

        A cause is the conditions that it needs: ``D3 = 0``, ``L1 = L2``, ``A = 90 deg``. Of one
        that has a part which is a cause too, only those are counted that the part leaves.
        """
        return tuple((tuple(s["values"]), s["fewer"]) for s in self._content["special"])

    @property
    def failure_probability(self) -> float:
        """An upper bound of the probability that a relation is wrong."""
        probability: float = self._content["verification"]["failure_probability"]
        return probability

    def sympy_source(self) -> str:
        """Return a Python module that defines the relations for SymPy."""
        return self._inner.sympy()

    def to_sympy(self) -> dict[str, Any]:
        """Return the relations as expressions of SymPy, lengths and angles real symbols.

        Raises
        ------
        MissingPackageError
            If SymPy is not installed.
        """
        try:
            import sympy  # type: ignore[import-untyped,import-not-found,unused-ignore]
        except ImportError:
            raise MissingPackageError("to_sympy needs SymPy: pip install sympy") from None
        symbols = self._content["symbols"]
        real = {s["sympy"]: sympy.Symbol(s["name"], real=True) for s in symbols}
        names = self._content["sympy_names"].values()
        scope = {name: sympy.Symbol(name) for name in names} | real
        relations = self._content["relations"].items()
        return {label: sympy.sympify(forms["sympy"], scope) for label, forms in relations}

    def __repr__(self) -> str:
        return f"SymbolicRelations({dict(self)!r})"
