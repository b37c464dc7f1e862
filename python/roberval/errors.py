"""What can go wrong, as exceptions and warnings.

Every exception of roberval is a `RobervalError`; each is also the built-in exception that a
caller would expect (`ValueError`, `KeyError`, ...).
"""

from __future__ import annotations

__all__ = [
    "ArrayError",
    "CheckpointError",
    "DoubtfulRankWarning",
    "InternalError",
    "MissingPackageError",
    "NumericalError",
    "OptionError",
    "RobervalError",
    "RobotError",
    "RobotWarning",
    "ShapeError",
    "UnknownParameterError",
]


class RobervalError(Exception):
    """Base class of all exceptions of roberval."""


class RobotError(RobervalError, ValueError):
    """A robot file or description is not valid, or there is none.

    Attributes
    ----------
    code : str or None
        Stable number of the fault, such as ``"E130"``.
    file : str or None
        The file, or the name given to the text.
    line, column : int or None
        Where in the file, from 1.
    """

    code: str | None = None
    file: str | None = None
    line: int | None = None
    column: int | None = None


class ArrayError(RobervalError, ValueError):
    """An array is not usable: its type, its memory, or numbers that are not finite.

    Attributes
    ----------
    row : int or None
        The row of the arrays given that `ObservationQR.update` could not take in, from 0.
    """

    row: int | None = None


class ShapeError(ArrayError):
    """An array has the wrong shape."""


class CheckpointError(RobervalError, ValueError):
    """A checkpoint is damaged, or of another robot or processor."""


class OptionError(RobervalError, ValueError):
    """An option has a value that it cannot have."""


class UnknownParameterError(RobervalError, KeyError):
    """A label is no parameter of the robot."""

    def __str__(self) -> str:
        # KeyError would show the representation of the message.
        return str(self.args[0]) if self.args else ""


class NumericalError(RobervalError, ArithmeticError):
    """A factorisation failed."""


class MissingPackageError(RobervalError, ImportError):
    """An optional package is needed and not installed."""


class InternalError(RobervalError, RuntimeError):
    """A mistake of roberval itself: please report it."""


class RobotWarning(UserWarning):
    """Something in a robot file that the user should know."""


class DoubtfulRankWarning(UserWarning):
    """The number of base parameters is in doubt; the result's diagnosis says why."""
