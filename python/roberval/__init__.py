"""Base inertial parameters of robots (Gautier 1991).

>>> import roberval as rv
>>> robot = rv.load("puma560")
>>> base = robot.base_parameters()
>>> base.rank
40
"""

from ._core import __version__
from .base import BaseParameters, Comparison, Relations, Route
from .diagnosis import Blame, Diagnosis, Literal, Structure, Witness
from .errors import (
    ArrayError,
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
from .loading import CatalogueEntry, catalogue, load
from .options import Choice, Engine, Model, Number, Snap
from .robot import Couple, Link, Robot
from .scaling import Grade, Scaling

__all__ = [
    "ArrayError",
    "BaseParameters",
    "Blame",
    "CatalogueEntry",
    "Choice",
    "Comparison",
    "Couple",
    "Diagnosis",
    "DoubtfulRankWarning",
    "Engine",
    "Exact",
    "Grade",
    "InternalError",
    "Link",
    "Literal",
    "MissingPackageError",
    "Model",
    "Number",
    "NumericalError",
    "OptionError",
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
    "UnknownParameterError",
    "Witness",
    "__version__",
    "catalogue",
    "load",
]
