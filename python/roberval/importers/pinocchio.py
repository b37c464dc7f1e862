"""Pinocchio models.

Links are named by the body whose frame is the joint's, where there is one, else by the joint.
Their frames are the joints' frames.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from ..arrays import Array
from ..conventions import convention
from ..errors import RobotError
from . import Text, missing, placed
from .placed import Couple, Link

AXIS = 1e-9
"""A motion subspace is a unit axis to this."""


def library() -> Any:
    """Import Pinocchio or say what to install."""
    try:
        import pinocchio
    except ImportError:
        raise missing("reading Pinocchio models", "pin") from None
    return pinocchio


def from_model(model: Any) -> Text:
    """Write a model as robot TOML."""
    pinocchio = library()
    if not isinstance(model, pinocchio.Model):
        raise RobotError(f"from_pinocchio takes a pinocchio.Model, not {type(model).__name__}")
    reader = Reader(pinocchio, model)
    for joint in range(1, model.njoints):
        reader.joint(joint)
    if not reader.links:
        raise RobotError("the Pinocchio model has no joint: nothing moves")
    text = placed.toml(
        model.name or "robot",
        model.gravity.linear,
        reader.links,
        reader.couples,
        warnings=reader.warnings,
    )
    return Text("toml", text)


class Reader:
    """What has been read: links, and the link of each joint."""

    def __init__(self, pinocchio: Any, model: Any) -> None:
        self.model = model
        self.links: list[Link] = []
        self.couples: list[Couple] = []
        self.warnings: list[str] = []
        roots = [joint for joint in range(1, model.njoints) if model.parents[joint] == 0]
        self.floats = roots == [1] and "FreeFlyer" in model.joints[1].shortname()
        self.taken: set[str] = set()
        self.of_joint: dict[int, Link | None] = {0: None}
        self.bodies: dict[int, str] = {}
        for frame in model.frames:
            at_joint = frame.type == pinocchio.FrameType.BODY and frame.placement.isIdentity()
            if at_joint:
                self.bodies.setdefault(int(frame.parentJoint), frame.name)

    def joint(self, joint: int) -> None:
        """Add the links that a joint moves."""
        model = self.model
        link = self.of_joint[int(model.parents[joint])]
        name = model.names[joint]
        placement = model.jointPlacements[joint]
        rotation, origin = placement.rotation, placement.translation
        steps = list(self.steps(model.joints[joint], name))
        armature = model.armature[model.idx_vs[joint] : model.idx_vs[joint] + len(steps)]
        for number, (kind, axis, before, ending) in enumerate(steps):
            last = number + 1 == len(steps)
            if before is not None:
                rotation, origin = (
                    rotation @ before.rotation,
                    origin + rotation @ before.translation,
                )
            body = self.bodies.get(joint, name)
            link = Link(
                name=placed.unique(body if last else f"{body}/{name}{ending}", self.taken),
                antecedent=None if link is None else link.name,
                joint=kind,
                joint_name=name + ending,
                rotation=rotation,
                origin=origin,
                axis=axis,
                armature=float(armature[number]) if number < len(armature) else 0.0,
            )
            self.links.append(link)
            rotation, origin = np.eye(3), np.zeros(3)
        self.of_joint[joint] = link
        if link is not None:
            ten = convention("pinocchio").to_paper(model.inertias[joint].toDynamicParameters())
            link.inertia = link.inertia + placed.moved(ten, rotation, origin)
        if "Mimic" in model.joints[joint].shortname():
            self.mimic(joint, link)

    def steps(self, joint: Any, name: str) -> Iterator[tuple[str, Array, Any, str]]:
        """Give kind, axis, placement and name's ending of each single motion of a joint."""
        kind = joint.shortname()
        if "FreeFlyer" in kind and self.floats:
            yield "floating", np.zeros(3), None, ""
            return
        if "FreeFlyer" in kind:
            self.warnings.append(f"free-flyer joint {name!r}: its body is held still as the base")
            return
        if "Composite" in kind:
            composite = joint.extract()
            for number, part in enumerate(composite.joints):
                before = composite.jointPlacements[number]
                for motion, axis, _, ending in self.steps(part, name):
                    yield motion, axis, before, f"_{number}{ending}"
            return
        if "Spherical" in kind:
            self.warnings.append(f"spherical joint {name!r} is taken as three hinges")
            for ending, direction in zip(("_x", "_y", "_z"), np.eye(3), strict=True):
                yield "revolute", direction, None, ending
            return
        if "Planar" in kind or "Translation" in kind:
            raise RobotError(f"joint {name!r} of type {kind} is not supported yet")
        yield *self.axis(joint, name), None, ""

    def axis(self, joint: Any, name: str) -> tuple[str, Array]:
        """Read kind and axis of a joint of one degree of freedom off its motion subspace."""
        subspace = np.asarray(joint.createData().S).reshape(6, -1)
        if "Mimic" in joint.shortname():
            subspace = subspace / joint.extract().scaling
        if subspace.shape[1] == 1:
            linear, angular = subspace[:3, 0], subspace[3:, 0]
            for kind, axis, other in (
                ("revolute", angular, linear),
                ("prismatic", linear, angular),
            ):
                if abs(np.linalg.norm(axis) - 1) < AXIS and np.linalg.norm(other) < AXIS:
                    return kind, axis
        raise RobotError(f"joint {name!r} of type {joint.shortname()} is not supported yet")

    def mimic(self, joint: int, link: Link | None) -> None:
        """Add the couple of a mimic joint."""
        mimic = self.model.joints[joint].extract()
        place = list(self.model.mimicking_joints).index(joint)
        primary = self.of_joint.get(int(self.model.mimicked_joints[place]))
        if link is None or primary is None:
            return
        self.couples.append(Couple(link.name, {primary.name: mimic.scaling}, mimic.offset))
