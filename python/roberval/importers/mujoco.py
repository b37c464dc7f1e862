"""MuJoCo models.

A body with several joints becomes several links, the first ones massless; a ball joint becomes
three hinges; a free joint makes a base that floats if all other joints are on it and no loop is
closed on the world; bodies without joints are lumped into their parents. The frame of a link lies
at its joint, in the axes of its body.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Array
from ..conventions import convention
from ..errors import RobotError
from . import Text, missing, placed
from .placed import Couple, Link, Loop


def library(what: str = "reading MuJoCo models") -> Any:
    """Import MuJoCo or say what to install."""
    try:
        import mujoco
    except ImportError:
        raise missing(what, "mujoco") from None
    return mujoco


def from_file(path: Path) -> Text:
    """Read a MJCF file."""
    mujoco = library(f"{path}: reading MJCF")
    try:
        model = mujoco.MjModel.from_xml_path(str(path))
    except ValueError as error:
        raise RobotError(f"{path}: MuJoCo cannot read it: {error}") from None
    return from_model(model, path.stem)


def from_any(model: Any) -> Text:
    """Read a MjModel, a MjSpec, MJCF text or the path of a MJCF file."""
    mujoco = library()
    if isinstance(model, (str, os.PathLike)):
        text = os.fspath(model)
        if not text.lstrip("\ufeff \t\r\n").startswith("<"):
            path = Path(text)
            if not path.is_file():
                raise RobotError(f"{path}: there is no such file")
            return from_file(path)
        try:
            model = mujoco.MjModel.from_xml_string(text)
        except ValueError as error:
            raise RobotError(f"MuJoCo cannot read the text: {error}") from None
    if isinstance(model, mujoco.MjSpec):
        model = model.compile()
    if not isinstance(model, mujoco.MjModel):
        raise RobotError(
            "from_mujoco takes a MjModel, a MjSpec, MJCF text or a path,"
            f" not {type(model).__name__}"
        )
    return from_model(model, "robot")


def from_model(model: Any, fallback: str) -> Text:
    """Write a model as robot TOML."""
    reader = Reader(model)
    for body in range(1, model.nbody):
        reader.body(body)
    if not reader.links:
        raise RobotError(f"{fallback}: no body of the MuJoCo model has a joint: nothing moves")
    couples, loops = reader.constraints()
    if loops:
        reader.driven()
    names = bytes(model.names)
    name = names[: names.index(b"\0")].decode("utf-8", "replace") or fallback
    if name == "MuJoCo Model":
        name = fallback
    text = placed.toml(name, model.opt.gravity, reader.links, couples, loops, reader.warnings)
    return Text("toml", text)


class End(NamedTuple):
    """A side of a connect or weld: a body, and the frame on it that coincides with the other's."""

    body: int
    rotation: Array
    point: Array


class Reader:
    """What has been read: links, and where each body is on them."""

    def __init__(self, model: Any) -> None:
        self.mujoco = library()
        self.model = model
        self.links: list[Link] = []
        self.by_joint: dict[int, Link] = {}
        self.warnings: list[str] = []
        roots = {int(model.body_rootid[body]) for body in model.jnt_bodyid}
        self.floats = len(roots) == 1 and not self.is_held()
        self.taken: set[str] = set()
        # The link that a body belongs to, and the body's frame on it.
        self.place: dict[int, tuple[Link | None, Array, Array]] = {
            0: (None, np.eye(3), np.zeros(3))
        }

    def is_held(self) -> bool:
        """Tell whether a connect or weld holds a body to the world."""
        model = self.model
        for number in np.flatnonzero(model.eq_active0):
            bodies = [body for body, _, _ in self.ends(int(number)) or ()]
            if any(model.body_weldid[body] == 0 for body in bodies):
                return True
        return False

    def name(self, kind: str, index: int) -> str:
        """Return the name of an object, or one made of its number."""
        objects = {
            "body": self.mujoco.mjtObj.mjOBJ_BODY,
            "joint": self.mujoco.mjtObj.mjOBJ_JOINT,
            "equality": self.mujoco.mjtObj.mjOBJ_EQUALITY,
        }
        return self.mujoco.mj_id2name(self.model, objects[kind], index) or f"{kind}{index}"

    def body(self, body: int) -> None:
        """Add the links of a body, or lump it into its parent."""
        model = self.model
        link, rotation, origin = self.place[int(model.body_parentid[body])]
        origin = origin + rotation @ model.body_pos[body]
        rotation = rotation @ matrix(model.body_quat[body])
        name = self.name("body", body)
        steps = list(self.steps(body))
        for number, (joint, kind, axis, anchor, suffix) in enumerate(steps):
            last = number + 1 == len(steps)
            joint_name = self.name("joint", joint) + suffix
            link = Link(
                name=placed.unique(name if last else f"{name}/{joint_name}", self.taken),
                antecedent=None if link is None else link.name,
                joint=kind,
                joint_name=joint_name,
                rotation=rotation,
                origin=origin + rotation @ anchor,
                axis=axis,
                armature=float(model.dof_armature[model.jnt_dofadr[joint]]),
            )
            self.links.append(link)
            if not suffix:
                self.by_joint[joint] = link
            rotation, origin = np.eye(3), -anchor
        self.place[body] = (link, rotation, origin)
        if link is not None:
            link.inertia = link.inertia + placed.moved(inertia(model, body), rotation, origin)

    def steps(self, body: int) -> Iterator[tuple[int, str, Array, Array, str]]:
        """Give joint, kind, axis, anchor and name's ending of each single motion of a body."""
        model, types = self.model, self.mujoco.mjtJoint
        start = int(model.body_jntadr[body])
        for joint in range(start, start + int(model.body_jntnum[body])):
            kind, axis = model.jnt_type[joint], model.jnt_axis[joint].copy()
            anchor = model.jnt_pos[joint].copy()
            if kind == types.mjJNT_HINGE:
                yield joint, "revolute", axis, anchor, ""
            elif kind == types.mjJNT_SLIDE:
                yield joint, "prismatic", axis, anchor, ""
            elif kind == types.mjJNT_BALL:
                self.warnings.append(
                    f"ball joint {self.name('joint', joint)!r} is taken as three hinges"
                )
                for ending, direction in zip(("_x", "_y", "_z"), np.eye(3), strict=True):
                    yield joint, "revolute", direction, anchor, ending
            elif self.floats:
                yield joint, "floating", axis, np.zeros(3), ""
            else:
                self.warnings.append(
                    f"free joint {self.name('joint', joint)!r} of body"
                    f" {self.name('body', body)!r}: the body is held still as the base"
                )

    def constraints(self) -> tuple[list[Couple], list[Loop]]:
        """Read the equality constraints that couples and loops hold; warn of the others."""
        model, kinds = self.model, self.mujoco.mjtEq
        couples, loops = [], []
        for number in range(model.neq):
            name, kind = self.name("equality", number), model.eq_type[number]
            if not model.eq_active0[number]:
                self.warnings.append(f"equality {name!r} is not active: left out")
            elif kind == kinds.mjEQ_JOINT:
                if (couple := self.couple(number)) is not None:
                    couples.append(couple)
                else:
                    self.warnings.append(
                        f"equality {name!r} is no straight line between two single joints:"
                        " not applied"
                    )
            elif (loop := self.loop(number)) is not None:
                loops.append(loop)
            else:
                self.warnings.append(self.not_applied(number))
        return couples, loops

    def not_applied(self, number: int) -> str:
        """Say what is not applied, why, and what follows."""
        what = self.mujoco.mjtEq(self.model.eq_type[number]).name.removeprefix("mjEQ_").lower()
        why = (
            "only joint, connect and weld are read"
            if self.ends(number) is None
            else "it joins two bodies that no joint moves against each other"
        )
        return (
            f"equality {self.name('equality', number)!r} ({what}) is not applied: {why};"
            " the joints move freely"
        )

    def couple(self, number: int) -> Couple | None:
        """Read an equality of two joints: q1 = a0 + a1 q2."""
        model = self.model
        dependent = self.by_joint.get(int(model.eq_obj1id[number]))
        free = self.by_joint.get(int(model.eq_obj2id[number]))
        offset, slope, *higher = model.eq_data[number][:5].tolist()
        if any(higher) or slope == 0 or dependent is None or free is None:
            return None
        return Couple(dependent.name, {free.name: slope}, offset)

    def ends(self, number: int) -> tuple[End, End] | None:
        """Return the two bodies of a connect or weld and the frames that coincide on them."""
        model, kinds = self.model, self.mujoco.mjtEq
        objects = (int(model.eq_obj1id[number]), int(model.eq_obj2id[number]))
        kind, of_what = kinds(model.eq_type[number]), model.eq_objtype[number]
        if kind not in (kinds.mjEQ_CONNECT, kinds.mjEQ_WELD):
            return None
        if of_what == self.mujoco.mjtObj.mjOBJ_SITE:
            first, second = (
                End(int(model.site_bodyid[s]), matrix(model.site_quat[s]), model.site_pos[s])
                for s in objects
            )
            return first, second
        if of_what != self.mujoco.mjtObj.mjOBJ_BODY:
            return None
        data, one = model.eq_data[number], np.eye(3)
        if kind == kinds.mjEQ_CONNECT:
            return End(objects[0], one, data[:3]), End(objects[1], one, data[3:6])
        return End(objects[0], matrix(data[6:10]), data[3:6]), End(objects[1], one, data[:3])

    def loop(self, number: int) -> Loop | None:
        """Read a connect or weld of two bodies or two sites."""
        if (ends := self.ends(number)) is None:
            return None
        places = [self.place[end.body] for end in ends]
        names = [None if link is None else link.name for link, _, _ in places]
        if names[0] == names[1]:
            return None
        first, second = (
            (rotation @ end.rotation, origin + rotation @ end.point)
            for (_, rotation, origin), end in zip(places, ends, strict=True)
        )
        connects = self.model.eq_type[number] == self.mujoco.mjtEq.mjEQ_CONNECT
        return Loop((names[0], names[1]), (first, second), "spherical" if connects else "fixed")

    def driven(self) -> None:
        """Let only joints with an actuator be driven: in loops the others follow."""
        model, kinds = self.model, self.mujoco.mjtTrn
        at_joints = (int(kinds.mjTRN_JOINT), int(kinds.mjTRN_JOINTINPARENT))
        with_motor = {
            int(model.actuator_trnid[a][0])
            for a in range(model.nu)
            if int(model.actuator_trntype[a]) in at_joints
        }
        if with_motor:
            for joint, link in self.by_joint.items():
                link.active = joint in with_motor


def matrix(quaternion: Array) -> Array:
    """Return the rotation of a quaternion w x y z."""
    w, x, y, z = quaternion / np.linalg.norm(quaternion)
    return np.array(
        [
            [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
        ]
    )


def inertia(model: Any, body: int) -> Array:
    """Return the ten parameters of a body about its own frame."""
    numbers = [
        model.body_mass[body],
        *model.body_ipos[body],
        *model.body_iquat[body],
        *model.body_inertia[body],
    ]
    return convention("mujoco").to_paper(numbers)
