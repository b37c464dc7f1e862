"""Base inertial parameters of robots (Gautier 1991).

>>> import roberval as rv
>>> robot = rv.load("puma560")
>>> base = robot.base_parameters()
>>> base.rank
40
"""

from ._core import __version__
from .base import BaseParameters, Comparison, Diagnosis, Relations, Route
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
from .loading import CatalogueEntry, catalogue, load
from .options import Choice, Engine, Model
from .robot import Link, Robot
from .scaling import Grade, Scaling

__all__ = [
    "ArrayError",
    "BaseParameters",
    "CatalogueEntry",
    "Choice",
    "Comparison",
    "Diagnosis",
    "DoubtfulRankWarning",
    "Engine",
    "Grade",
    "InternalError",
    "Link",
    "MissingPackageError",
    "Model",
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
    "UnknownParameterError",
    "__version__",
    "catalogue",
    "load",
]
