"""The relations between base parameters and standard ones."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from types import MappingProxyType


class Relations(Mapping[str, Mapping[str, float]]):
    """The relations of the base parameters: label -> {label: coefficient}, itself included.

    ``str()`` gives those that are not trivial in the field's notation.
    """

    __slots__ = ("_terms", "text")

    text: tuple[str, ...]
    """The relations that are not trivial, such as ``XXR_6 = XX_6 - YY_6``."""

    def __init__(self, terms: dict[str, dict[str, float]], text: Iterable[str]) -> None:
        self._terms = terms
        self.text = tuple(text)

    def __getitem__(self, label: str) -> Mapping[str, float]:
        return MappingProxyType(self._terms[label])

    def __iter__(self) -> Iterator[str]:
        return iter(self._terms)

    def __len__(self) -> int:
        return len(self._terms)

    def __str__(self) -> str:
        return "\n".join(self.text)

    def __repr__(self) -> str:
        return f"Relations({self._terms!r})"
