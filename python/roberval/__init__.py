"""Base inertial parameters of robots (Gautier 1991).

>>> import roberval as rv
>>> robot = rv.load("puma560")
>>> base = robot.base_parameters()
>>> base.rank
40
"""

# First: what follows takes a tenth of a second.
from . import starting  # noqa: F401  # isort: split
from ._core import __version__
from .base import BaseParameters
from .code import Code, Compiled, Count
from .comparison import Comparison, Route
from .conventions import Convention, ParameterOrder, convention
from .datasets import reduce_dataset
from .description import Couple, Link, Loop
from .diagnosis import Blame, Diagnosis, Literal, Precision, Structure, Witness
from .errors import (
    ArrayError,
    CheckpointError,
    DoubtfulRankWarning,
    InternalError,
    MissingPackageError,
    NumericalError,
    OptionError,
    RobervalError,
    RobotError,
    RobotWarning,
    ShapeError,
    UnknownParameterError,
)
from .exact import Exact, Surd
from .linting import Finding, lint
from .loading import CatalogueEntry, Cleaned, catalogue, clean_file, load
from .options import Choice, Engine, Model, Number, Snap
from .reduction import ObservationQR
from .relations import Relations
from .robot import Robot
from .scaling import Grade, Scaling
from .symbolic import SymbolicRelations

__all__ = [
    "ArrayError",
    "BaseParameters",
    "Blame",
    "CatalogueEntry",
    "CheckpointError",
    "Choice",
    "Cleaned",
    "Code",
    "Comparison",
    "Compiled",
    "Convention",
    "Count",
    "Couple",
    "Diagnosis",
    "DoubtfulRankWarning",
    "Engine",
    "Exact",
    "Finding",
    "Grade",
    "InternalError",
    "Link",
    "Literal",
    "Loop",
    "MissingPackageError",
    "Model",
    "Number",
    "NumericalError",
    "ObservationQR",
    "OptionError",
    "ParameterOrder",
    "Precision",
    "Relations",
    "RobervalError",
    "Robot",
    "RobotError",
    "RobotWarning",
    "Route",
    "Scaling",
    "ShapeError",
    "Snap",
    "Structure",
    "Surd",
    "SymbolicRelations",
    "UnknownParameterError",
    "Witness",
    "__version__",
    "catalogue",
    "clean_file",
    "convention",
    "lint",
    "load",
    "reduce_dataset",
]
