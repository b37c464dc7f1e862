"""How sure an answer is, and what decided it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from . import _core
from .arrays import Array


@dataclass(frozen=True)
class Structure:
    """How the exact engine decided.

    Attributes
    ----------
    rank : int
        b, decided without a tolerance.
    primes, seeds : tuple of int
        The prime fields that agreed, and the seeds of their random values.
    failure_probability : float
        An upper bound of the probability that the rank is too low. It is never too high.
    generic : tuple of str
        Angles with too many digits for a common unit, taken as unrelated; as written.
    tree_rank : int or None
        The rank of the tree without couples, of a robot that has some.
    removed : tuple of str
        The base parameters of that tree that the couples remove.
    """

    rank: int
    primes: tuple[int, ...]
    seeds: tuple[int, ...]
    failure_probability: float
    generic: tuple[str, ...]
    tree_rank: int | None = None
    removed: tuple[str, ...] = ()


@dataclass(frozen=True)
class Precision:
    """How high-precision floats decided, where there is no exact decision.

    Attributes
    ----------
    rank : int
        b.
    tolerance : float
        What counts as zero, relative to the column.
    smallest_kept, largest_dropped : float or None
        What is nearest to the tolerance on either side; None if nothing is there.
    samples, redrawn : int
        Samples used, and configurations of loops that were drawn again: they were singular
        or on another branch.
    tree_rank : int or None
        b of the tree without its constraints.
    removed : tuple of str
        What these remove beyond the tree.
    """

    rank: int
    tolerance: float
    smallest_kept: float | None
    largest_dropped: float | None
    samples: int
    redrawn: int
    tree_rank: int | None = None
    removed: tuple[str, ...] = ()

    @property
    def gap(self) -> float | None:
        """Smallest kept over largest dropped value; None if nothing is on one side."""
        if not self.smallest_kept or not self.largest_dropped:
            return None
        return self.smallest_kept / self.largest_dropped


@dataclass(frozen=True)
class Witness:
    """What a float engine makes of the robot that the exact engine decided.

    Attributes
    ----------
    engine : str
        The engine.
    rank : int
        The rank it finds.
    gap, gap_at_structural : float or None
        The gap of its spectrum at its own rank, and at the exact one.
    spectrum : tuple of float
        What it decides on, nonincreasing.
    tolerance : float
        Entries of the spectrum at or below it count as zero.
    """

    engine: str
    rank: int
    gap: float | None
    gap_at_structural: float | None
    spectrum: tuple[float, ...]
    tolerance: float


class Blame(NamedTuple):
    """A number of the robot file, and the rank with this number the other way."""

    what: str
    rank: int


@dataclass(frozen=True)
class Literal:
    """What the robot file gives when it is taken as written.

    Attributes
    ----------
    rank : int
        The exact rank of the file as written.
    blame : tuple of Blame
        The numbers that bring more base parameters when they are taken as written.
    near_misses : tuple of Blame
        Numbers left as written that would bring another rank if they were set right.
    """

    rank: int
    blame: tuple[Blame, ...]
    near_misses: tuple[Blame, ...]


@dataclass(frozen=True, eq=False)
class Diagnosis:
    """How sure the rank is.

    Attributes
    ----------
    clear : bool
        Whether there is no doubt.
    spectrum : ndarray
        What a float rank is decided on: |T_ii| (qrii; the exact engine shows it too), sigma_i
        (svd), or what the kept columns before leave of each column, relative to its norm (qr).
    spectrum_labels : tuple of str
        The parameters of the spectrum's entries; empty where they belong to none.
    tolerance : float
        Entries of the spectrum at or below it count as zero in floats.
    gap : float or None
        Smallest kept over largest dropped entry; None if nothing was kept or dropped.
    residual : float
        Largest miss of the relations at samples that decided nothing, relative.
    messages : tuple of str
        What the user should know.
    structure : Structure or None
        How the exact engine decided; None for the float engines.
    precision : Precision or None
        How high-precision floats decided; None if another engine did.
    witnesses : tuple of Witness
        What the float engines make of what the exact one decided.
    literal : Literal or None
        What the file gives as written, where numbers were set right or nearly.
    """

    clear: bool
    spectrum: Array
    spectrum_labels: tuple[str, ...]
    tolerance: float
    gap: float | None
    residual: float
    messages: tuple[str, ...]
    structure: Structure | None
    precision: Precision | None
    witnesses: tuple[Witness, ...]
    literal: Literal | None

    @classmethod
    def _of(cls, core: _core.Answer, labels: tuple[str, ...]) -> Diagnosis:
        spectrum = core.spectrum()
        spectrum.flags.writeable = False
        return cls(
            clear=core.clear,
            spectrum=spectrum,
            spectrum_labels=tuple(labels[column] for column in core.spectrum_columns),
            tolerance=core.tolerance,
            gap=core.gap,
            residual=core.residual,
            messages=tuple(core.messages),
            structure=_structure(core, labels),
            precision=_precision(core, labels),
            witnesses=tuple(
                Witness(engine, rank, gap, at, tuple(spectrum), tolerance)
                for engine, rank, gap, at, spectrum, tolerance in core.witnesses
            ),
            literal=_literal(core),
        )


def _structure(core: _core.Answer, labels: tuple[str, ...]) -> Structure | None:
    if core.structure is None:
        return None
    rank, primes, seeds, probability, generic = core.structure
    tree, removed = core.opened or (None, [])
    return Structure(
        rank,
        tuple(primes),
        tuple(seeds),
        probability,
        tuple(generic),
        tree,
        tuple(labels[column] for column in removed),
    )


def _precision(core: _core.Answer, labels: tuple[str, ...]) -> Precision | None:
    if core.precision is None:
        return None
    rank, tolerance, (kept, dropped), samples, redrawn = core.precision
    tree, removed = core.opened or (None, [])
    names = tuple(labels[column] for column in removed)
    return Precision(rank, tolerance, kept, dropped, samples, redrawn, tree, names)


def _literal(core: _core.Answer) -> Literal | None:
    if core.literal is None:
        return None
    rank, blame, near = core.literal
    return Literal(rank, tuple(Blame(*b) for b in blame), tuple(Blame(*b) for b in near))
